"""Looks that carry a meaning: numbers below each other, bars in cells, quiet words, varied parameters in the list."""

from __future__ import annotations

import json
import re

from playwright.sync_api import Route, expect

from browsing import MINUS, Opens, drawn
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


def test_names_above_compared_points_are_whole_on_a_phone(opened: Opens, named: Sweep) -> None:
    points = f"{named.id}:1,{named.id}:8"
    for view, name in (("orbit", "Orbits"), ("history", "Histories"), ("spectrum", "Full spectra")):
        page = opened(f"#/compare?points={points}&view={view}", viewport={"width": 390, "height": 800})
        picture = drawn(page, name)
        read = """place => {
            const pen = document.createElement("canvas").getContext("2d");
            pen.font = `12px ${getComputedStyle(place).fontFamily}`;
            const { layout, frame } = place.picture;
            return layout.annotations.filter(({ mark }) => mark).map(({ text, x }) => ({
                text: text.replaceAll("<br>", " "),
                end: frame.left + x * (frame.right - frame.left) + 28
                    + Math.max(...text.split("<br>").map(line => pen.measureText(line).width)),
                width: place.clientWidth,
            }));
        }"""
        shown = picture.evaluate(read)
        assert len(shown) == 2
        for number, one in enumerate(shown, 1):
            assert re.match(rf"{number}: flow rate .* m³/s, mud density .* kg/m³, rotation speed .* rpm$", one["text"])
            assert one["end"] <= one["width"]


def test_points_that_are_dragged_over_in_the_scatter_are_compared(opened: Opens, named: Sweep) -> None:
    page = opened(f"#/sweeps/{named.id}?view=scatter&x=flow_rate&y=mud_density&colour=friction_coefficient_max")
    picture = drawn(page, "mud density against flow rate")
    page.get_by_role("button", name="Choose points").click()
    area = picture.locator(".area").first.bounding_box()
    assert area is not None
    page.mouse.move(area["x"] + 1, area["y"] + 1)
    page.mouse.down()
    page.mouse.move(area["x"] + 0.5 * area["width"], area["y"] + 0.5 * area["height"], steps=4)
    page.mouse.up()
    # The points of the lesser flow rate and the denser mud, at either speed.
    expect(page.get_by_text("2 points are within")).to_be_visible()
    page.get_by_role("link", name="Compare 2 points").click()
    rows = page.get_by_role("table", name="Points compared").get_by_role("row")
    expect(rows).to_have_count(2)
    expect(rows.filter(has_text="flow rate 0.01 m³/s, mud density 1800 kg/m³")).to_have_count(2)


def test_negative_numbers_have_one_sign_and_its_rule(opened: Opens, named: Sweep) -> None:
    page = opened(f"#/sweeps/{named.id}?view=table&columns=ordinal,torque_top,tension_top")
    cell = page.locator(".rows tbody tr:not(.gap)").first.locator("td.number").nth(1)
    expect(cell).to_have_text(re.compile(rf"^{MINUS}[\d.]+$"))
    expect(page.get_by_text("Torque is negative if it opposes clockwise rotation.")).to_be_visible()
    page = opened(f"#/sweeps/{named.id}/points/1?profiles=effective_tension,torque")
    drawn(page, "Profiles")
    expect(page.get_by_text("Tension is positive, compression negative. Torque is")).to_be_visible()
    expect(page.locator("main")).not_to_contain_text(re.compile(r"(^|\s)-\d"))
