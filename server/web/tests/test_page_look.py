"""Looks that carry a meaning: numbers below each other, bars in cells, quiet words, varied parameters in the list."""

from __future__ import annotations

import json
import re

from playwright.sync_api import Route, expect

from browsing import Opens, drawn
from drillsweep import Sweep


def test_numbers_of_a_column_have_equal_decimals_and_bars(opened: Opens, named: Sweep) -> None:
    columns = "ordinal,flow_rate,mud_density,friction_coefficient_max"
    page = opened(f"#/sweeps/{named.id}?view=table&columns={columns}&sort=ordinal")
    cells = page.locator(".rows tbody tr:not(.gap)")
    expect(cells).to_have_count(8)
    texts = [cells.nth(row).locator("td.number").all_text_contents() for row in range(8)]
    for column in range(1, 4):
        decimals = {len(text[column].partition(".")[2]) for text in texts}
        assert len(decimals) == 1, [text[column] for text in texts]
    assert {text[1] for text in texts} == {"0.01", "0.04"}
    # A bar is the place of a value in the range of its column.
    width = "cell => cell.style.getPropertyValue('--place')"
    assert {cells.nth(row).locator("td.number").nth(1).evaluate(width) for row in range(8)} == {"0.000", "1.000"}
    assert cells.first.locator("td.number").first.evaluate(width) == ""


def test_words_of_states_are_quiet_unless_something_failed(opened: Opens, named: Sweep) -> None:
    page = opened(f"#/sweeps/{named.id}?view=table")
    expect(page.locator(".rows .state.succeeded").first).to_have_css("font-weight", "400")
    page.evaluate(
        """() => {
            const word = document.createElement("span");
            word.className = "state failed";
            word.textContent = "failed";
            document.body.append(word);
        }"""
    )
    expect(page.locator("body > .state")).to_have_css("font-weight", "600")


def test_no_text_is_smaller_than_a_caption(opened: Opens, named: Sweep) -> None:
    smallest = """() => Math.min(...[...document.querySelectorAll("main *")]
        .filter((one) => !one.closest("svg"))
        .filter((one) => [...one.childNodes].some((node) => node.nodeType === 3 && node.data.trim()))
        .map((one) => parseFloat(getComputedStyle(one).fontSize)))"""
    for view in (f"sweeps/{named.id}?view=table", f"sweeps/{named.id}/points/1?view=about", "new", "sweeps"):
        page = opened(f"#/{view}")
        page.wait_for_load_state("networkidle")
        assert page.evaluate(smallest) >= 13


def test_curves_of_profiles_keep_away_from_the_frame(opened: Opens, named: Sweep) -> None:
    page = opened(f"#/sweeps/{named.id}/points/1?profiles=effective_tension,torque")
    picture = drawn(page, "Profiles")
    read = """place => [["x", "xaxis", 0], ["y", "yaxis", 0], ["x", "xaxis2", 1]].map(([letter, axis, number]) => {
        const values = [...place.picture.traces[number][letter]].filter((value) => value !== null);
        const ends = [...place.picture.axis(axis).range].sort((a, b) => a - b);
        const [least, largest] = [Math.min(...values), Math.max(...values)];
        return [least - ends[0], ends[1] - largest].map((room) => room / (largest - least));
    })"""
    for rooms in picture.evaluate(read):
        assert all(abs(room - 0.04) < 1e-6 for room in rooms), rooms


def test_the_list_names_the_varied_parameters(opened: Opens, named: Sweep) -> None:
    page = opened("#/new")

    def answer(route: Route) -> None:
        page_of_list = route.fetch().json()
        for sweep in page_of_list["sweeps"]:
            sweep.pop("varied", None)
            if sweep["id"] == named.id:
                sweep["varied"] = ["flow_rate", "mud.density"]
        route.fulfill(body=json.dumps(page_of_list), content_type="application/json")

    page.route(re.compile(r"/v1/sweeps(\?|$)"), answer)
    page.get_by_role("link", name="Sweeps", exact=True).click()
    row = page.locator(f'tr[data-sweep="{named.id}"]')
    expect(row.locator(".varied")).to_have_text("Flow rate \N{MULTIPLICATION SIGN} mud density")
    # A service that names none leaves the line out.
    expect(page.locator("tr[data-sweep] .varied")).to_have_count(1)
