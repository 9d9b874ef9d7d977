"""Forced response of a point's string on the page."""

from __future__ import annotations

import re
from pathlib import Path

import pytest
from playwright.sync_api import Locator, expect

from browsing import Opens, run_curl, run_python, shown_lines
from drillsweep import Sweep

KILONEWTON = 1e3
DIGITS = 5e-3
"""Rounding of three digits."""


def largest(caption: Locator, unit: str) -> float:
    """The value that a caption names as the largest."""
    found = re.search(rf"rpm: (\S+) {unit},", caption.text_content() or "")
    assert found is not None
    return float(found[1])


def test_a_forced_response_names_its_peak_and_keeps_its_choices_in_the_link(
    opened: Opens, sweep: Sweep, tmp_path: Path
) -> None:
    table = sweep.point(1).forced_response(speeds=range(40, 241)).to_pandas()
    page = opened(f"#/sweeps/{sweep.id}/points/1?view=forced")
    caption = page.locator("figcaption[aria-live]")
    highest = table.loc[table["forced_displacement"].idxmax()]
    expect(caption).to_contain_text(f"Largest at {highest['rotation_speed_rpm']:g} rpm")
    expect(caption).to_contain_text(str(highest["component"]))
    lowest = page.get_by_label("Lowest speed")
    lowest.fill("100")
    lowest.blur()
    page.get_by_label("Response", exact=True).select_option("forced_side_force")
    page.wait_for_url(re.compile("rpm=100%3A240.*response=forced_side_force"))
    # 201 speeds from 100 to 240 rpm.
    speeds = [100 + 0.7 * step for step in range(201)]
    forces = sweep.point(1).forced_response(speeds=speeds).to_pandas()["forced_side_force"]
    expect(caption).to_contain_text(re.compile("rpm: .* kN, "))
    assert largest(caption, "kN") * KILONEWTON == pytest.approx(forces.max(), rel=DIGITS)
    lines = shown_lines(page)
    assert "forced_side_force" in run_curl(lines["curl"], tmp_path / "curl")[""]
    assert "forced_side_force" in run_python(lines["Python"])["response"]
    lowest.fill("300")
    lowest.blur()
    expect(page.get_by_text("Speeds must be above 0, the lowest first.")).to_be_visible()
