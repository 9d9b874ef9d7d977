"""Torque and drag of a point's string on the page."""

from __future__ import annotations

import re
from pathlib import Path
from typing import Any

import pytest
from playwright.sync_api import Page, expect

from browsing import MINUS, Opens, drawn, run_curl, run_python, shown_lines
from drillsweep import Sweep

KILONEWTON, KILOPOUND, FOOT_POUND = 1e3, 4_448.222, 1.355_818
"""Units by NIST's Special Publication 811."""
DIGITS = 6e-4
"""Rounding of four digits, of the largest number of a column."""


def forces_of(page: Page) -> dict[str, list[float]]:
    """Hook load and surface torque at the deepest bit by motion and friction factor."""
    table = page.get_by_role("table", name="Forces and margins at the deepest bit")
    expect(table).to_be_visible()
    numbers = {}
    for row in table.locator("tbody tr").all():
        cells = [text.replace("\u202f", "").replace(MINUS, "-") for text in row.locator("td").all_text_contents()]
        numbers[str(row.locator("th").text_content())] = [float(text) for text in cells[:2]]
    return numbers


def served(point: Any, **query: Any) -> dict[str, list[float]]:
    """The same of the service, in N and N m."""
    table = point.torque_drag(**query).to_pandas()
    deepest = table[table["bit_depth"] == table["bit_depth"].max()]
    names = [
        mode.replace("_", " ") + ("" if friction != friction else f", {friction:g}")
        for mode, friction in zip(deepest["drag_mode"], deepest["friction_factor"].astype(float), strict=True)
    ]
    return dict(zip(names, deepest[["hook_load", "surface_torque"]].to_numpy().tolist(), strict=True))


def compare(shown: dict[str, list[float]], expected: dict[str, list[float]], sizes: list[float]) -> None:
    """Compares forces in units of some sizes with those in SI."""
    assert list(shown) == list(expected)
    for column, size in enumerate(sizes):
        largest = max(abs(values[column]) for values in expected.values())
        for name, values in expected.items():
            assert shown[name][column] * size == pytest.approx(values[column], abs=DIGITS * largest), name


def test_forces_are_those_of_the_service_in_either_units_and_choices_are_in_the_link(
    opened: Opens, sweep: Sweep, tmp_path: Path
) -> None:
    point = sweep.point(1)
    page = opened(f"#/sweeps/{sweep.id}/points/1?view=drag")
    drawn(page, "Hook load and surface torque")
    expect(page.get_by_text("Friction factors are the dynamic ones of the hole sections.")).to_be_visible()
    compare(forces_of(page), served(point), [KILONEWTON, 1e3])
    page.get_by_role("group", name="Motions").get_by_label("slack off").uncheck()
    factors = page.get_by_label("Friction factors")
    factors.fill("0.2, 0.3")
    factors.blur()
    deepest = page.get_by_label("Deepest bit depth")
    deepest.fill("150")
    deepest.blur()
    page.wait_for_url(re.compile("motions=pick_up%2Crotate.*friction=0.2%2C0.3.*bit=5%3A150%3A40"))
    expect(page.get_by_role("heading", name="Bit at 150 m")).to_be_visible()
    query = {"modes": ["pick_up", "rotate"], "friction": [0.2, 0.3], "depths": [150.0]}
    compare(forces_of(page), served(point, **query), [KILONEWTON, 1e3])
    page.get_by_role("button", name=re.compile("Units")).click()
    expect(page.get_by_role("columnheader", name="hook load [klbf]")).to_be_visible()
    compare(forces_of(page), served(point, **query), [KILOPOUND, FOOT_POUND])
    lines = shown_lines(page)
    assert {"hook_load", "surface_torque"} <= set(run_curl(lines["curl"], tmp_path / "curl")[""])
    assert {"hook_load", "surface_torque"} <= set(run_python(lines["Python"])["drag"])


def test_a_stiff_string_has_its_own_forces_and_too_many_of_its_cases_are_refused(
    opened: Opens, sweep: Sweep, troubles: list[str]
) -> None:
    page = opened(f"#/sweeps/{sweep.id}/points/1?view=drag&motions=pick_up&bit=100:200:2")
    soft = forces_of(page)
    page.get_by_label("String", exact=True).select_option("stiff")
    expect(page.get_by_text("Stiff string: equilibria of the finite elements")).to_be_visible()
    stiff = forces_of(page)
    compare(stiff, served(sweep.point(1), modes=["pick_up"], depths=[100.0, 200.0], stiff=True), [KILONEWTON, 1e3])
    assert stiff != soft
    count = page.get_by_label("Number of bit depths")
    count.fill("61")
    count.blur()
    refusal = page.get_by_role("alert")
    expect(refusal).to_have_text("61 cases of the stiff string are requested, of 60 at most")
    count = page.get_by_label("Number of bit depths")
    count.fill("0")
    count.blur()
    expect(refusal).to_have_text("Bit depths must be above 0, the shallowest first, and one or more.")
    # The browser reports every refusal.
    troubles[:] = [text for text in troubles if "status of 4" not in text]


def test_reaming_has_an_axial_speed_and_hook_loads_a_travelling_weight(opened: Opens, sweep: Sweep) -> None:
    page = opened(f"#/sweeps/{sweep.id}/points/1?view=drag&motions=ream")
    expect(page.get_by_text("Reaming requires an axial speed, negative upwards.")).to_be_visible()
    for label, value in {"Axial speed of reaming": "0.3", "Travelling weight": "200000"}.items():
        box = page.get_by_label(label)
        box.fill(value)
        box.blur()
    page.wait_for_url(re.compile("ream=0.3.*travelling=200000"))
    expect(page.get_by_text("Reaming requires")).to_have_count(0)
    expect(page.get_by_role("table", name="Forces and margins")).to_contain_text("ream")
    query = {"modes": ["ream"], "axial_speed": 0.3, "travelling_weight": 2e5}
    page.wait_for_load_state("networkidle")
    compare(forces_of(page), served(sweep.point(1), **query), [KILONEWTON, 1e3])
