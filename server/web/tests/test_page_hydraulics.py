"""Pressures of the mud's circuit on the page of a point."""

from __future__ import annotations

import re
from pathlib import Path

import pytest
from playwright.sync_api import Locator, Page, expect

from browsing import Opens, run_curl, run_python, shown_lines
from drillsweep import Client, Sweep
from service import SHORT

SHOE = 100.0
PRESSURES = {"SI units": ("MPa", 1e6), "field units": ("psi", 6_894.757)}
DENSITIES = {"SI units": ("kg/m³", 1.0), "field units": ("ppg", 119.826_4)}
"""Units with their sizes by NIST's Special Publication 811."""
DIGITS = 6e-5
"""Rounding of five digits, of the largest number of a table or of a density."""


@pytest.fixture(scope="module")
def cased(client: Client) -> Sweep:
    """A point with a casing shoe, surface lines and a rotation that thins its mud, and one of a dry hole."""
    cased = [{"from": 0, "name": "casing", "hole_diameter": 0.2445}, {"from": SHOE, "name": "open hole"}]
    changes = {"hydraulics.surface_case": 4, "mud.rotation_factor": True, "well.section": cased}
    return client.submit("paper-200m", set=SHORT | changes, axes={"flow_rate": [0.04]}).wait(timeout=120.0)


@pytest.fixture(scope="module")
def dry(client: Client) -> Sweep:
    axes = {"operation.weight_on_bit": [-1e5]}
    return client.submit("paper-200m", set=SHORT | {"mud": None}, axes=axes).wait(timeout=120.0)


def rows_of(table: Locator) -> dict[str, list[float]]:
    """Numbers of a table by the names of its rows."""
    rows = table.locator("tbody tr").filter(has=table.page.locator("td"))
    numbers = {}
    for row in rows.all():
        cells = [text.replace("\u202f", "") for text in row.locator("td").all_text_contents()]
        numbers[str(row.locator("th").text_content())] = [float(text) for text in cells]
    return numbers


def table_of(page: Page) -> Locator:
    return page.get_by_role("table", name="Pressures and densities by sets of formulas")


def test_pressures_and_densities_are_those_of_the_service_in_either_units(opened: Opens, cased: Sweep) -> None:
    point = cased.point(1)
    circuit = point.hydraulics()
    columns = circuit["columns"]
    shoe = next(depth for depth in circuit["depths"] if depth["end_of_section"] == "casing")
    page = opened(f"#/sweeps/{cased.id}/points/1?view=hydraulics")
    table = table_of(page)
    for system in ("SI units", "field units"):
        (pressure, pascals), (density, kilograms) = PRESSURES[system], DENSITIES[system]
        expect(table.get_by_role("rowheader", name=f"Pressure [{pressure}]", exact=True)).to_be_visible()
        expect(table.get_by_role("rowheader", name=f"Equivalent circulating density [{density}]")).to_be_visible()
        rows = rows_of(table)
        for name, column in {
            "surface lines": "surface_loss",
            "bore": "bore_loss",
            "bit": "bit_loss",
            "annulus": "annulus_loss",
            "standpipe pressure": "standpipe_pressure",
        }.items():
            served = [one[column] / pascals for one in columns]
            assert rows[name] == pytest.approx(served, rel=DIGITS, abs=DIGITS * max(rows["standpipe pressure"])), name
        assert rows["tools"] == [0.0] * 5
        of_shoe = next(values for name, values in rows.items() if name.startswith("end of casing"))
        served = [one / kilograms for one in shoe["equivalent_circulating_densities"]]
        assert of_shoe == pytest.approx(served, rel=DIGITS)
        of_bit = next(values for name, values in rows.items() if name.startswith("bit, "))
        assert of_bit == pytest.approx(
            [one["equivalent_circulating_density"] / kilograms for one in columns], rel=DIGITS
        )
        if system == "SI units":
            page.get_by_role("button", name=re.compile("Units")).click()


def test_the_column_of_the_points_own_pressures_is_marked_and_differences_have_reasons(
    opened: Opens, cased: Sweep
) -> None:
    page = opened(f"#/sweeps/{cased.id}/points/1?view=hydraulics")
    heads = table_of(page).get_by_role("columnheader")
    expect(heads).to_have_text(
        ["eccentric", "eccentric, turning (this point)", "concentric", "concentric, turning", "RP 13D"]
    )
    summary = cased.point(1).summary
    assert summary is not None
    marked = rows_of(table_of(page))["standpipe pressure"][1]
    assert marked == pytest.approx(summary["standpipe_pressure"] / 1e6, rel=DIGITS)
    for reason in ("the string lies at a mean eccentricity", "RP 13D has", "lower bound"):
        expect(page.get_by_role("listitem").filter(has_text=reason)).to_be_visible()


def test_the_circuit_is_requested_when_its_view_is_opened(opened: Opens, cased: Sweep, tmp_path: Path) -> None:
    page = opened(f"#/sweeps/{cased.id}/points/1?view=energy")
    requests: list[str] = []
    page.on("request", lambda request: requests.append(request.url))
    page.reload()
    page.wait_for_load_state("networkidle")
    assert not any("hydraulics" in url for url in requests)
    page.get_by_role("link", name="Hydraulics").click()
    expect(table_of(page)).to_be_visible()
    lines = shown_lines(page)
    assert {"columns", "parts", "depths"} <= set(run_curl(lines["curl"], tmp_path / "curl")[""])
    assert {"losses", "standpipe_pressure"} <= set(run_python(lines["Python"])["pressures"])


def test_a_point_without_mud_has_no_view_of_it_and_a_link_to_it_says_why(
    opened: Opens, dry: Sweep, troubles: list[str]
) -> None:
    page = opened(f"#/sweeps/{dry.id}/points/1")
    expect(page.get_by_role("link", name="Energy", exact=True)).to_be_visible()
    expect(page.get_by_role("link", name="Hydraulics")).to_have_count(0)
    page = opened(f"#/sweeps/{dry.id}/points/1?view=hydraulics")
    expect(page.get_by_role("alert").filter(has_text="without mud there are no pressures")).to_be_visible()
    # The browser reports every refusal.
    troubles[:] = [text for text in troubles if "status of 409" not in text]
