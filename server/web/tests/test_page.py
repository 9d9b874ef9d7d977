"""The web page in a real browser, over a real server: what an engineer does there, and that nothing fails unseen."""

from __future__ import annotations

import functools
import re
from pathlib import Path
from typing import Literal

import pytest
from axe_playwright_python.sync_playwright import Axe
from playwright.sync_api import Locator, Page, Request, Route, expect

from browsing import (
    COMPARED,
    GONE,
    MINUS,
    NASTY,
    REFUSED,
    RULES_OF_THEME,
    Opens,
    drag,
    drawn,
    parallel,
    pixels,
    requested,
    trace,
    until,
)
from drillsweep import Axis, Client, Outputs, Sweep
from service import SHORT, Service, make_token, revoke_token, tokens_of

POINT_VIEWS = ["profiles", "motion", "well", "energy", "hydraulics", "drag", "forced", "about"]


def test_a_name_of_markup_is_text(opened: Opens, named: Sweep) -> None:
    page = opened()
    link = page.get_by_role("link", name=NASTY).first
    expect(link).to_be_visible()
    expect(page.get_by_role("link", name="<b>bold</b>").first).to_be_visible()
    link.click()
    expect(page.get_by_role("heading", level=1)).to_have_text(NASTY)
    assert page.locator("main img, main script").count() == 0
    assert page.title() == f"{NASTY}, Map · drillsweep"


def test_a_sweep_is_submitted_and_watched_until_it_is_complete(opened: Opens) -> None:
    page = opened("#/new?preset=paper-200m")
    page.get_by_role("textbox", name="Name", exact=True).fill("from the page")
    rows = page.get_by_role("region", name="Parameters")
    rows.get_by_role("textbox", name="Values").nth(0).fill("0.015, 0.035")
    rows.get_by_role("textbox", name="Values").nth(1).fill("1300")
    page.get_by_label("Accuracy", exact=True).select_option("draft")
    for field, value in [("duration", "0.5"), ("recording.spectrum_windows", "[]"), ("recording.orbit_window", "null")]:
        page.get_by_role("button", name="Add a change").click()
        page.get_by_role("combobox", name="Field").last.fill(field)
        page.get_by_role("textbox", name="Value", exact=True).last.fill(value)
    page.get_by_role("textbox", name="Verify a sample").fill("1")
    plan = page.get_by_role("region", name="Plan")
    expect(plan.get_by_text("1, 0 of the reference runs known already")).to_be_visible()
    page.get_by_role("button", name="Submit 2 points").click()
    expect(page.get_by_role("heading", level=1)).to_have_text("from the page")
    expect(page.get_by_text("2 of 2 succeeded")).to_be_visible(timeout=60_000)
    drawn(page, "over flow rate")


def test_what_is_typed_stays_when_colours_and_units_are_switched(opened: Opens) -> None:
    page = opened("#/new?preset=paper-200m")
    values = page.get_by_role("region", name="Parameters").get_by_role("textbox", name="Values").first
    values.fill("0.015, not a number")
    page.get_by_role("button", name="Dark theme").click()
    expect(page.locator("html")).to_have_attribute("data-theme", "dark")
    expect(values).to_have_value("0.015, not a number")
    page.get_by_role("button", name="Units: SI").click()
    expect(page.get_by_role("button", name="Units: field")).to_be_visible()
    # The number stays in other units: 0.015 m3/s.
    expect(values).to_have_value("237.755, not a number")


def test_a_sweep_like_another_one_is_its_request(opened: Opens, client: Client) -> None:
    # Part of it has no field in the form.
    points = [{"flow_rate": 0.021}, {"flow_rate": 0.022}]
    outputs: Outputs = {"orbits": {"nodes": [{"node": 49}]}}
    first = client.submit("paper-200m", set=SHORT, design="list", points=points, priority=4, outputs=outputs)
    page = opened(f"#/new?from={first.id}")
    page.get_by_role("button", name="Submit 2 points").click()
    expect(page.get_by_text("2 of 2 succeeded")).to_be_visible(timeout=60_000)
    second = client.sweep(page.url.rsplit("/", 1)[1])
    assert second.id != first.id
    assert {**second.request, "owner": None} == {**first.request, "owner": None}


def test_a_problem_stands_at_its_field(opened: Opens, troubles: list[str]) -> None:
    page = opened("#/new?preset=paper-200m")
    rows = page.get_by_role("region", name="Parameters")
    rows.get_by_role("textbox", name="Values").nth(0).fill("0.01:0.06")
    expect(rows.get_by_text("A range needs a count")).to_be_visible()
    rows.get_by_role("textbox", name="Values").nth(0).fill("-1")
    expect(rows.locator("[data-problem]")).to_be_visible()
    expect(rows.get_by_role("textbox", name="Values").nth(0)).to_be_visible()
    expect(page.get_by_role("button", name="Submit")).to_be_disabled()
    # The browser writes of every answer that refuses.
    troubles[:] = [text for text in troubles if "status of 422" not in text]


def test_a_change_waits_for_its_value_and_tells_it_there(opened: Opens, troubles: list[str]) -> None:
    page = opened("#/new?preset=paper-200m")
    submit = page.get_by_role("button", name="Submit")
    expect(submit).to_be_enabled()
    page.get_by_role("button", name="Add a change").click()
    page.get_by_role("combobox", name="Field").last.fill("duration")
    # The service is not asked about what is not written yet: its refusal would stand on the console.
    row = page.locator('[data-pointer="/set/duration"]')
    expect(row.get_by_text("A value is missing")).to_be_visible()
    expect(submit).to_be_disabled()
    assert troubles == []
    value = row.get_by_role("textbox", name="Value", exact=True)
    value.fill("-1")
    expect(row.locator("[data-problem]")).to_be_visible()
    expect(row.get_by_text("A value is missing")).to_be_hidden()
    value.fill("0.5")
    expect(submit).to_be_enabled()
    page.get_by_role("button", name="Remove duration").click()
    expect(row).to_have_count(0)
    # The browser writes of every answer that refuses, also of one that comes late.
    troubles[:] = [text for text in troubles if "status of 422" not in text]


def test_a_survey_is_pasted_from_a_spreadsheet(opened: Opens) -> None:
    page = opened("#/new?preset=paper-200m")
    scenario = page.get_by_role("region", name="Scenario", exact=True)
    scenario.get_by_text("Survey from a spreadsheet").click()
    survey = scenario.get_by_role("textbox", name=re.compile("^Survey"))
    # As a spreadsheet of a country of decimal commas gives it, with its head and a column more.
    survey.fill("MD\tIncl\tAzi\tTVD\n0\t60,5\t0\t0\n328,084\t75\t7\t90\n656,168\t93\t36\t100\n")
    scenario.get_by_role("combobox", name="Depths in").select_option("ft")
    expect(scenario.get_by_text("3 stations down to 200 m, inclination up to 93°.")).to_be_visible()
    stations = [
        {"measured_depth": depth, "inclination_deg": inclination, "azimuth_deg": azimuth}
        for depth, inclination, azimuth in [(0, 60.5, 0), (100, 75, 7), (200, 93, 36)]
    ]
    until(page, lambda: requested(page).get("set", {}).get("well.survey") == stations)
    expect(page.get_by_role("button", name=re.compile(r"Submit \d+ points"))).to_be_enabled()
    # The link brings it back, in metres.
    page.reload()
    expect(survey).to_have_value("0\t60.5\t0\n100\t75\t7\n200\t93\t36")
    # Spaces and commas part columns as well; between spaces a comma is a decimal sign.
    for text in [
        "0 60,5 0\n100 75,0 7\n200,5 93 36",
        "0, 60.5, 0\n100, 75, 7\n200.5, 93, 36",
        "0,60.5,0\n100,75,7\n200.5,93,36",
    ]:
        survey.fill(text)
        scenario.get_by_role("combobox", name="Depths in").select_option("m")
        expect(scenario.get_by_text("3 stations down to 200.5 m, inclination up to 93°.")).to_be_visible()
    survey.fill("0 60 0\n100 nonsense 7")
    expect(scenario.get_by_text("Line 2 does not begin with three numbers")).to_be_visible()
    expect(page.get_by_role("button", name="Submit")).to_be_disabled()


@pytest.mark.parametrize("view", ["map", "window", "scatter", "parallel", "effects", "difference", "table", "failures"])
@pytest.mark.parametrize("theme", ["light", "dark"])
def test_every_view_of_a_sweep_is_shown(
    opened: Opens, named: Sweep, view: str, theme: Literal["light", "dark"]
) -> None:
    page = opened(f"#/sweeps/{named.id}?view={view}", color_scheme=theme)
    if view == "table":
        expect(page.locator(".rows tbody tr:not(.gap)")).to_have_count(8)
    elif view == "failures":
        expect(page.get_by_text("No point of this sweep has failed.")).to_be_visible()
    elif view == "difference":
        expect(page.get_by_text("Choose the sweep whose results")).to_be_visible()
    elif view == "parallel":
        assert parallel(page).locator(".axis-brush").count() == 5
    else:
        drawn(page, "." if view != "effects" else "Shares of the variance")


def test_cells_of_a_map_have_the_colours_of_their_values(opened: Opens, named: Sweep) -> None:
    colour = "orbit_radius_rms_49"
    picture = drawn(opened(f"#/sweeps/{named.id}?view=map&colour={colour}"), "over flow rate")
    # Its four cells, by the colour in the middle of each: of the least value the darkest, of the largest the brightest.
    read = """place => {
        const canvas = place.querySelector("canvas.picture");
        const pen = canvas.getContext("2d");
        const { width, height } = canvas;
        const at = (x, y) => [...pen.getImageData(x * width, y * height, 1, 1).data].slice(0, 3);
        return [at(0.3, 0.7), at(0.7, 0.7), at(0.3, 0.2), at(0.7, 0.2)];
    }"""
    shown = [sum(cell) for cell in picture.evaluate(read)]
    table = named.table().to_pandas()
    held_speed = table[table["operation.rotation_speed_rpm"] == 90].sort_values(["mud_density", "flow_rate"])
    values = list(held_speed[colour])
    assert sorted(range(4), key=shown.__getitem__) == sorted(range(4), key=values.__getitem__)
    assert [min(shown), max(shown)] == [68 + 1 + 84, 253 + 231 + 37]


def test_all_pictures_of_the_next_view_are_seen_at_once(opened: Opens, named: Sweep) -> None:
    page = opened(f"#/sweeps/{named.id}?view=map")
    drawn(page, "over flow rate")
    # Of the pictures of the view that takes its place, how many are drawn in the frame in which the first is.
    page.evaluate("""() => {
        const look = () => {
            const places = [...document.querySelectorAll("main .plot")];
            const isNext = places.every((place) => !place.getAttribute("aria-label").includes("over flow rate"));
            const seen = places.filter((place) => place.querySelector("canvas.picture"));
            if (isNext && seen.length) window.seen = [seen.length, places.length];
            else requestAnimationFrame(() => setTimeout(look));
        };
        look();
    }""")
    page.get_by_role("link", name="Sensitivities").click()
    drawn(page, "Shares of the variance")
    drawn(page, "Main effects")
    assert page.evaluate("window.seen") == [2, 2]


def test_the_map_holds_the_parameters_that_it_does_not_show(opened: Opens, named: Sweep) -> None:
    page = opened(f"#/sweeps/{named.id}?view=map&colour=friction_coefficient_max")
    drawn(page, "friction coefficient C_f max|friction coefficient max")

    def shows(expected: list[float]) -> bool:
        cells = page.evaluate("() => document.querySelector('.plot:has(canvas.picture)').picture.traces[0].z.flat()")
        return sorted(cells) == pytest.approx(sorted(expected), rel=1e-12)

    table = named.table().to_pandas()
    for speed in (90, 120):
        page.get_by_label("rotation speed", exact=True).select_option(str(speed))
        held = table[table["operation.rotation_speed_rpm"] == speed]
        until(page, functools.partial(shows, list(held["friction_coefficient_max"])))


def test_the_table_sorts_and_filters_in_the_units_shown(opened: Opens, named: Sweep) -> None:
    page = opened(f"#/sweeps/{named.id}?view=table&sort=flow_rate&order=down")
    first = page.locator(".rows tbody tr:not(.gap)").first
    # After the tick, number, state and class of a point.
    expect(first.locator("td").nth(4)).to_have_text("0.04")
    page.get_by_role("searchbox").fill("mud_density>1500 flow_rate=0.01")
    # At once, not after a rest of typing: what draws the view again meanwhile must not lose it.
    assert "filter=mud_density" in page.evaluate("location.hash")
    expect(page.get_by_text("2 of 8 points")).to_be_visible()
    page.get_by_role("button", name=re.compile("Units")).click()
    # The same numbers, now in gallons a minute and pounds a gallon.
    expect(page.get_by_text("0 of 8 points")).to_be_visible()
    page.get_by_role("searchbox").fill("mud_density<11")
    expect(page.get_by_text("4 of 8 points")).to_be_visible()
    page.get_by_role("searchbox").fill("nonsense>1")
    expect(page.get_by_text("There is no column nonsense.")).to_be_visible()


@pytest.mark.parametrize(
    ("view", "picture"),
    [("profiles", "Profiles"), ("motion", "Orbit of node"), ("energy", "Energy by account")],
)
def test_every_view_of_a_point_is_shown(opened: Opens, named: Sweep, view: str, picture: str) -> None:
    drawn(opened(f"#/sweeps/{named.id}/points/1?view={view}"), picture)


def test_pictures_are_saved_here_and_sent_nowhere(opened: Opens, named: Sweep) -> None:
    page = opened(f"#/sweeps/{named.id}/points/1?view=motion&node=49")
    picture = drawn(page, "History of node")
    bar = picture.get_by_role("toolbar", name="Picture")
    names = [button.get_attribute("aria-label") for button in bar.get_by_role("button").all()]
    assert {"Save as PNG", "Save as SVG"} <= set(names)
    assert not [name for name in names if name is None or re.search("(?i)cloud|share|send|link", name)]
    for ending, start in {"png": b"\x89PNG", "svg": b"<svg"}.items():
        picture.hover()
        with page.expect_download() as download:
            bar.get_by_role("button", name=f"Save as {ending.upper()}").click()
        assert re.fullmatch(rf"history-of-node-49.*\.{ending}", download.value.suggested_filename)
        assert download.value.path().read_bytes().startswith(start)


def ranges(picture: Locator) -> list[float]:
    """The ends of both axes, as they are drawn."""
    read = "({ picture }) => ['xaxis', 'yaxis'].flatMap((name) => picture.axis(name).range)"
    return list(picture.evaluate(read))


def test_the_link_holds_how_a_picture_is_zoomed(opened: Opens, named: Sweep) -> None:
    page = opened(f"#/sweeps/{named.id}/points/1?view=motion&node=49")
    spectrum = drawn(page, "Full spectrum of node")
    whole = ranges(spectrum)
    spectrum.scroll_into_view_if_needed()
    drag(page, spectrum.locator(".area").first, (0.4, 0.2), (0.7, 0.9))
    until(page, lambda: "zoom.spectrum=" in page.url)
    width = whole[1] - whole[0]
    chosen = ranges(spectrum)
    assert chosen[:2] == pytest.approx([whole[0] + part * width for part in (0.4, 0.7)], abs=0.01 * width)
    # Who opens the link sees the same, in the units that are theirs.
    other = opened(f"#{page.url.partition('#')[2]}")
    until(other, lambda: ranges(drawn(other, "Full spectrum of node")) == pytest.approx(chosen, rel=1e-6))
    other.get_by_role("button", name="Units: SI. Switch").click()
    in_inches = [*chosen[:2], *(end / 25.4 for end in chosen[2:])]
    until(other, lambda: ranges(drawn(other, "Full spectrum of node")) == pytest.approx(in_inches, rel=1e-6))
    # Shown as a whole again, it is no part of the link any more.
    spectrum.locator(".area").first.dblclick()
    until(page, lambda: "zoom" not in page.url)
    assert ranges(spectrum) == pytest.approx(whole)


def test_a_zoom_goes_with_the_axes_that_it_was_of(opened: Opens, named: Sweep) -> None:
    page = opened(f"#/sweeps/{named.id}?view=map&zoom.map=x:0.008:0.02,y:1100:1500")
    picture = drawn(page, "over flow rate and mud density")
    until(page, lambda: ranges(picture)[2:] == pytest.approx([1100, 1500]))
    page.get_by_label("Colour", exact=True).select_option("friction_coefficient_max")
    picture = drawn(page, "friction coefficient.* over flow rate")
    until(page, lambda: ranges(picture)[2:] == pytest.approx([1100, 1500]))
    page.get_by_label("Up", exact=True).select_option("operation.rotation_speed_rpm")
    drawn(page, "over flow rate and rotation speed")
    until(page, lambda: "zoom" not in page.url)


def test_a_point_says_which_effects_took_part_and_why(opened: Opens, named: Sweep) -> None:
    page = opened(f"#/sweeps/{named.id}/points/1?view=about")
    effects = page.get_by_role("region", name="Effects")
    expect(effects.get_by_text("the wall has friction").first).to_be_visible()
    expect(page.get_by_role("region", name="Downloads").get_by_role("link", name="history.parquet")).to_be_visible()


def test_a_brushed_window_gives_the_statistics_of_the_service(opened: Opens, named: Sweep) -> None:
    page = opened(f"#/sweeps/{named.id}/points/1?view=motion&node=49")
    history = drawn(page, "History of node")
    shown = page.locator("dt", has_text="Orbit size (rms").locator("xpath=following-sibling::dd[1]")
    expect(shown).to_be_visible()
    history.scroll_into_view_if_needed()
    box = history.locator(".area").first.bounding_box()
    assert box is not None
    # The service's statistics come later than those of the samples that are shown.
    held: list[Route] = []
    is_released = False
    page.route("**/statistics?*", lambda route: route.continue_() if is_released else held.append(route))
    # The orbit follows while the window is brushed.
    orbit = drawn(page, "Orbit of node").locator("canvas.picture")
    before = pixels(orbit)
    page.mouse.move(box["x"] + 0.4 * box["width"], box["y"] + 40)
    page.mouse.down()
    page.mouse.move(box["x"] + 0.7 * box["width"], box["y"] + 50, steps=8)
    until(page, lambda: pixels(orbit) != before)
    samples = "place => place.picture.traces[1].x.length"
    until(page, lambda: 0 < orbit.locator("xpath=..").evaluate(samples) < 300)
    expect(shown).to_contain_text("≈")
    rough = float(str(shown.text_content()).removeprefix("≈ ").removesuffix(" mm"))
    # Where the mouse rests they take their place.
    until(page, lambda: bool(held))
    is_released = True
    held[-1].continue_()
    expect(shown).not_to_contain_text("≈")
    page.mouse.up()
    until(page, lambda: "from=" in page.url and "to=" in page.url)
    start, end = (float(page.get_by_label(f"{name} [s]").input_value()) for name in ("From", "To"))
    assert (start, end) == pytest.approx((0.2, 0.35), abs=0.01)
    table = named.point(1).orbit(node=named.point(1).scenario["recording"]["nodes"][1]["node"], time=(start, end))
    u, v = table["u"], table["v"]
    size = float((((u - u.mean()) ** 2 + (v - v.mean()) ** 2).mean()) ** 0.5)
    assert rough == pytest.approx(1e3 * size, rel=0.02)
    # As the page writes it: four digits, in millimetres.
    expect(shown).to_have_text(f"{float(f'{1e3 * size:.4g}'):g} mm")


def test_lines_stand_next_to_the_modes_of_the_service(opened: Opens, named: Sweep) -> None:
    page = opened(f"#/sweeps/{named.id}/points/1?view=motion&node=49&from=0&to=0.5")
    modes = named.point(1).modes(to_hz=20.0)["modes"]
    expect(page.get_by_text(f"{len(modes)} modes were found up to 20 Hz")).to_be_visible(timeout=60_000)
    cells = page.locator("[data-frequency]")
    assert cells.count() > 0
    for cell in cells.all():
        frequency = abs(float(cell.get_attribute("data-frequency") or "nan"))
        text = cell.text_content() or ""
        if found := re.fullmatch(r"next to a mode: [^,]+, ([\d.]+) Hz, .*", text):
            shown = float(found[1])
            assert any(mode["frequency_hz"] == pytest.approx(shown, rel=1e-3) for mode in modes), text
            # Half of the 2 Hz that half a second resolves, and 1 %.
            assert abs(shown - frequency) <= 1.0 + 0.011 * frequency
        else:
            assert re.fullmatch(r"no cause found|\d+ \N{MULTIPLICATION SIGN} .*", text), text


def test_biases_stand_next_to_the_numbers_that_they_touch(opened: Opens, client: Client) -> None:
    axes: dict[str, Axis] = {"flow_rate": [0.01, 0.04], "mud_density": [1300, 1700]}
    verified = client.submit("paper-200m", set=SHORT, axes=axes, verify=2).wait(timeout=180.0)
    table = verified.verification()
    name = "orbit_radius_rms_49"
    mean = 100 * table.attributes["statistics"][name]["mean"]
    said = "below 0.01 %" if abs(mean) < 0.01 else f"{'+' if mean > 0 else MINUS}{float(f'{abs(mean):.2g}'):g} %"
    page = opened(f"#/sweeps/{verified.id}?view=map&colour={name}")
    drawn(page, "node 49 over flow rate")
    expect(page.get_by_text(f"Bias against reference runs at 2 points: mean {said}")).to_be_visible()
    page = opened(f"#/sweeps/{verified.id}?view=table&columns=ordinal,{name}")
    expect(page.get_by_role("columnheader", name=re.compile(re.escape(f"mean bias {said}")))).to_be_visible()
    biased = page.locator(".rows tbody td", has_text="bias")
    expect(biased).to_have_count(2)
    ordinal = int(table["ordinal"][0])
    page = opened(f"#/sweeps/{verified.id}/points/{ordinal}?view=about")
    trust = page.get_by_role("region", name="How far to trust it")
    expect(trust.get_by_text(re.compile(r"Verified against reference runs: .*node 49 \(bias "))).to_be_visible()
    error = page.get_by_role("group", name="Error of orbit size")
    sizes = [column for column in table.columns if column.startswith("bias_orbit_radius_rms_")]
    worst = 100 * max(abs(float(table[column][0])) for column in sizes)
    expect(error.locator("div", has_text="measured by verification")).to_contain_text(f"{float(f'{worst:.2g}'):g} %")
    summary = verified.point(ordinal).summary
    assert summary is not None
    promised = summary["promised_error"]
    expect(error.locator("div", has_text="promised")).to_contain_text(f"{100 * promised:g} %")
    expect(error).to_contain_text(
        f"Believe the measurement, {'within' if worst <= 100 * promised else 'beyond'} the promise"
    )
    costs = drawn(page, "Error of orbit size against processor time")
    itself, others = trace(costs, 1), trace(costs, 2)
    assert itself["y"] == [pytest.approx(worst)]
    times = verified.point(int(table["ordinal"][1])).provenance
    assert times is not None
    assert others["x"] == [pytest.approx(times["transient_cpu_time"] + times["statics_cpu_time"])]


def test_two_sweeps_are_compared_where_both_have_points(opened: Opens, client: Client, sweep: Sweep) -> None:
    axes: dict[str, Axis] = {"flow_rate": [0.04, 0.02], "mud_density": [1200, 1800]}
    changes = {**SHORT, "operation.rotation_speed_rpm": 90}
    other = client.submit("paper-200m", set=changes, axes=axes, name="slower").wait(timeout=120.0)
    page = opened(f"#/sweeps/{sweep.id}?view=difference&colour=orbit_radius_rms_49")
    page.get_by_label("Compared with").select_option(label="slower")
    drawn(page, "difference of lateral vibration, node 49")
    expect(page.get_by_text("slower less short, at 2 points that both have")).to_be_visible()
    assert f"with={other.id}" in page.url
    mine, theirs = (of.table().to_pandas().set_index(["flow_rate", "mud_density"]) for of in (sweep, other))
    for kind, relative in [("absolute", False), ("relative", True)]:
        page.get_by_role("combobox", name="Difference").select_option(kind)
        expected = [
            (theirs.loc[at, "orbit_radius_rms_49"] - mine.loc[at, "orbit_radius_rms_49"])
            * (100 / mine.loc[at, "orbit_radius_rms_49"] if relative else 1000)
            for at in [(0.04, 1200), (0.04, 1800)]
        ]

        def shows(expected: list[float] = expected) -> bool:
            cells = page.evaluate(
                "() => document.querySelector('.plot:has(canvas.picture)').picture.traces[0].z.flat()"
            )
            return list(cells) == pytest.approx(expected, rel=1e-9)

        until(page, shows)
    page.locator(".area").first.click(position={"x": 100, "y": 400})
    page.wait_for_url(re.compile("#/compare"))
    expect(page.get_by_role("table", name="Points compared").get_by_role("row")).to_have_count(2)


def test_a_finer_grid_is_dragged_over_a_region(opened: Opens, client: Client) -> None:
    axes: dict[str, Axis] = {"flow_rate": [0.01, 0.04], "mud_density": [1250, 1750]}
    coarse = client.submit("paper-200m", set=SHORT, axes=axes, name="coarse").wait(timeout=120.0)
    page = opened(f"#/sweeps/{coarse.id}?view=map&colour=state")
    picture = drawn(page, "over flow rate")
    page.get_by_role("button", name="Finer grid").click()
    panel = page.get_by_role("region", name="Finer grid")
    # Without a region, that of all points.
    expect(panel.get_by_label("From [m³/s]")).to_have_value("0.01")
    expect(panel.get_by_text("25 points; 4 are known")).to_be_visible()
    drag(page, picture.locator(".area").first, (0.3, 0.05), (0.5, 0.45))
    until(page, lambda: float(panel.get_by_label("From [m³/s]").input_value()) > 0.01)
    start, end = (float(panel.get_by_label(f"{name} [m³/s]").input_value()) for name in ("From", "To"))
    assert start < 0.025 < end + 0.002 < 0.035
    panel.get_by_label("From [m³/s]").fill("0.02")
    panel.get_by_label("To [m³/s]").fill("0.04")
    panel.get_by_label("From [kg/m³]").fill("1250")
    panel.get_by_label("To [kg/m³]").fill("1750")
    for values in panel.get_by_label("Values").all():
        values.fill("2")
    panel.get_by_text("The same request").click()
    appended = 'sweep.append({"flow_rate": Range(0.02, 0.04, 2), "mud_density": Range(1250, 1750, 2)})'
    expect(panel.get_by_text(appended)).to_be_visible()
    panel.get_by_role("button", name="Add 4 points").click()
    expect(page.get_by_text("2 points are added.")).to_be_visible()
    expect(page.get_by_text("6 of 6 succeeded")).to_be_visible(timeout=60_000)
    assert sorted(set(coarse.table()["flow_rate"])) == [0.01, 0.02, 0.04]


def test_a_change_is_made_in_the_form_of_the_schema(opened: Opens) -> None:
    page = opened("#/new?preset=paper-200m")
    scenario = page.get_by_role("region", name="Scenario", exact=True)
    scenario.get_by_text("All fields, with units").click()
    scenario.locator("summary", has_text=re.compile("^mud$")).click()
    stress = scenario.get_by_label("yield stress [Pa]")
    described = scenario.get_by_text(re.compile("^Yield stress tau_y .Pa., 0 or more; usual 0 to 15"))
    expect(described).to_be_visible()
    stress.fill("3.5")
    until(page, lambda: requested(page).get("set") == {"mud.yield_stress": 3.5})
    expect(scenario.get_by_text("The scenario has")).to_be_visible()
    # Sections are rows of a table next to the schema's fields.
    scenario.get_by_text("String: tally, gauges, unbalance").click()
    diameter = scenario.get_by_label("Outer diameter of section 3", exact=True)
    diameter.fill("0.16")
    diameter.blur()
    scenario.locator("summary", has_text=re.compile("^effects$")).click()
    scenario.get_by_role("combobox", name="buoyancy").select_option("off")
    changed = {"mud.yield_stress": 3.5, "string.sections[2].outer_diameter": 0.16, "effects.buoyancy": "off"}
    until(page, lambda: requested(page).get("set") == changed)
    expect(page.get_by_role("button", name=re.compile(r"Submit \d+ points"))).to_be_enabled()
    # What the scenario has anyway is no change.
    scenario.get_by_role("combobox", name="buoyancy").select_option("auto")
    scenario.get_by_role("button", name="Take back", exact=True).first.click()
    until(page, lambda: requested(page).get("set") == {"string.sections[2].outer_diameter": 0.16})


@pytest.mark.parametrize("theme", ["light", "dark"])
def test_no_view_keeps_anybody_out(
    opened: Opens, server: str, named: Sweep, sweep: Sweep, theme: Literal["light", "dark"]
) -> None:
    views = ["", "#/new?preset=paper-200m", "#/compare", f"#/compare?points={named.id}:1,{named.id}:2&view=orbit"]
    parts = ["map", "window", "scatter", "parallel", "effects", "table", "failures", f"difference&with={sweep.id}"]
    views += [f"#/sweeps/{named.id}?view={view}" for view in parts]
    views += [f"#/sweeps/{named.id}/points/1?view={view}" for view in POINT_VIEWS]
    page = opened("", color_scheme=theme)
    for view in views:
        page.goto("about:blank")
        page.goto(f"{server}/{view}")
        page.locator("main h1").wait_for()
        page.wait_for_load_state("networkidle")
        if "view=map" in view:
            page.get_by_role("button", name="Finer grid").click()
        for summary in page.locator("main details:not([open]) > summary").all():
            if summary.is_visible():
                summary.click()
        page.wait_for_load_state("networkidle")
        found = Axe().run(page, options=RULES_OF_THEME[theme])
        assert found.violations_count == 0, f"{view}\n{found.generate_report()}"


def test_points_are_compared_by_the_link(opened: Opens, named: Sweep) -> None:
    keys = ",".join(f"{named.id}:{number}" for number in (1, 2, 8))
    for view, picture in COMPARED.items():
        page = opened(f"#/compare?points={keys}&view={view}&node=49")
        drawn(page, picture)
        expect(page.get_by_role("table", name="Points compared").get_by_role("row")).to_have_count(3)
        page.get_by_text("Lines that made this view").click()
        expect(
            page.get_by_text(re.compile(r"^csv = weboptions.*point1\w* = webread.*point3\w* = webread", re.DOTALL))
        ).to_be_visible()


def test_keys_move_search_and_open(opened: Opens, named: Sweep, sweep: Sweep) -> None:
    page = opened()
    expect(page.get_by_role("link", name=NASTY)).to_be_visible()
    page.keyboard.press("/")
    page.keyboard.type("short")
    expect(page.get_by_role("link", name=NASTY)).not_to_be_visible()
    expect(page.get_by_role("link", name="short")).to_be_visible()
    page.keyboard.press("Escape")
    page.keyboard.press("j")
    page.keyboard.press("Enter")
    page.wait_for_url(re.compile(f"#/sweeps/{sweep.id}"))


def lists_asked_for(page: Page) -> list[str]:
    """Requests for the list of sweeps from now on, as they come."""
    asked: list[str] = []

    def note(request: Request) -> None:
        if re.search(r"/v1/sweeps(\?|$)", request.url):
            asked.append(request.url)

    page.on("request", note)
    return asked


def submit_slow(client: Client, name: str) -> Sweep:
    """A sweep of one point that takes some seconds, also if it was computed before."""
    changes = {"duration": 100, "accuracy": "draft", "recording.spectrum_windows": [], "recording.orbit_window": None}
    return client.run("paper-200m", set=changes, name=name, outputs="summary", cache="refresh")


def test_the_list_follows_all_changes(opened: Opens, client: Client) -> None:
    page = opened("#/sweeps")
    expect(page.get_by_role("heading", level=1)).to_have_text("Sweeps")
    followed = submit_slow(client, "followed")
    row = page.get_by_role("row").filter(has=page.get_by_role("link", name="followed", exact=True))
    expect(row).to_be_visible(timeout=20_000)
    followed.cancel()
    expect(row.get_by_text("cancelled", exact=True)).to_be_visible(timeout=20_000)
    followed.change(name="renamed")
    renamed = page.get_by_role("row").filter(has=page.get_by_role("link", name="renamed", exact=True))
    expect(renamed).to_be_visible(timeout=20_000)
    expect(row).not_to_be_visible()
    followed.delete()
    expect(renamed).not_to_be_visible(timeout=20_000)


def test_a_hidden_page_requests_no_list(opened: Opens) -> None:
    page = opened("#/nowhere")
    page.clock.install()
    page.goto(page.url.replace("#/nowhere", "#/sweeps"))
    page.get_by_role("region", name="Workers and queue").get_by_text("process").first.wait_for()
    hide = "is => Object.defineProperty(document, 'hidden', { value: is, configurable: true })"
    page.evaluate(hide, True)
    asked = lists_asked_for(page)
    page.clock.run_for(60_000)
    page.evaluate(hide, False)
    assert asked == []
    with page.expect_response(re.compile(r"/v1/sweeps\?")):
        page.evaluate("document.dispatchEvent(new Event('visibilitychange'))")
    with page.expect_response(re.compile(r"/v1/sweeps\?")):
        page.clock.run_for(4000)


def test_the_page_recovers_when_the_server_comes_back(opened: Opens, troubles: list[str], tmp_path: Path) -> None:
    service = Service("up", "--workers", "1", "--listen", "127.0.0.1:0", "--data", str(tmp_path))
    address = service.server
    page = opened("", address)
    expect(page.get_by_text("There are no sweeps yet.")).to_be_visible()
    service.kill()
    expect(page.get_by_text("The server does not answer.")).to_be_visible(timeout=15_000)
    service = Service("up", "--workers", "1", "--listen", address.removeprefix("http://"), "--data", str(tmp_path))
    try:
        expect(page.get_by_text("The server does not answer.")).not_to_be_visible(timeout=40_000)
        expect(page.get_by_text("There are no sweeps yet.")).to_be_visible()
        with Client(address) as client:
            submit_slow(client, "after all")
        row = page.get_by_role("row").filter(has=page.get_by_role("link", name="after all", exact=True))
        expect(row).to_be_visible()
        expect(row.get_by_text("1 of 1 succeeded")).to_be_visible(timeout=60_000)
    finally:
        page.close()
        service.stop()
    troubles[:] = [text for text in troubles if not GONE.search(text)]


def test_a_phone_shows_every_view_without_sideways_scrolling(opened: Opens, named: Sweep, sweep: Sweep) -> None:
    views = ["", "#/new", f"#/sweeps/{named.id}?view=difference&with={sweep.id}", f"#/compare?points={named.id}:1"]
    views += [f"#/sweeps/{named.id}?view={view}" for view in ("map", "window", "table")]
    views += [f"#/sweeps/{named.id}/points/1?view={view}" for view in POINT_VIEWS]
    for view in views:
        page = opened(view, viewport={"width": 390, "height": 844})
        page.wait_for_load_state("networkidle")
        if "view=map" in view:
            page.get_by_role("button", name="Finer grid").click()
        for summary in page.locator("main details:not([open]) > summary").all():
            if summary.is_visible():
                summary.click()
        page.wait_for_load_state("networkidle")
        assert page.evaluate("document.documentElement.scrollWidth") <= 390, view


def test_a_token_logs_in_and_out(opened: Opens, troubles: list[str], tmp_path: Path) -> None:
    token = make_token(tmp_path, "read")
    service = Service("serve", "--listen", "127.0.0.1:0", "--data", str(tmp_path))
    try:
        page = opened("", service.server)
        page.get_by_label("Token").fill("not one of its tokens, but long enough")
        dialog = page.get_by_role("dialog")
        dialog.get_by_role("button", name="Log in").click()
        expect(dialog.get_by_role("alert")).not_to_be_empty()
        page.get_by_label("Token").fill(token)
        dialog.get_by_role("button", name="Log in").click()
        expect(page.get_by_text("There are no sweeps yet.")).to_be_visible()
        page.get_by_role("link", name="New sweep").click()
        expect(page.get_by_role("button", name="Submit")).to_be_disabled()
        page.get_by_role("button", name="Log out").click()
        expect(dialog).to_be_visible()
        assert page.context.cookies() == []
        page.close()
    finally:
        service.stop()
    troubles[:] = [text for text in troubles if not REFUSED.search(text)]


@pytest.mark.parametrize("view", ["sweeps", "sweep", "new"])
def test_a_session_that_ends_is_asked_for_again(view: str, opened: Opens, troubles: list[str], tmp_path: Path) -> None:
    others = make_token(tmp_path, "submit")
    service = Service("serve", "--listen", "127.0.0.1:0", "--data", str(tmp_path))
    try:
        with Client(service.server, token=others) as client:
            sweep = submit_slow(client, "waits")
        before = tokens_of(tmp_path)
        token = make_token(tmp_path, "submit")
        (identifier,) = tokens_of(tmp_path) - before
        links = {"sweeps": "#/sweeps", "sweep": f"#/sweeps/{sweep.id}", "new": "#/new"}
        page = opened(links[view], service.server)
        dialog = page.get_by_role("dialog")
        page.get_by_label("Token").fill(token)
        dialog.get_by_role("button", name="Log in").click()
        expect(
            page.get_by_role("button", name="Submit") if view == "new" else page.get_by_text("0 of 1 succeeded")
        ).to_be_visible()
        expect(dialog).not_to_be_attached()
        revoke_token(tmp_path, identifier)
        if view == "new":
            page.get_by_role("combobox", name="Scenario", exact=True).select_option("paper-200m-dry")
        expect(dialog).to_be_visible()
        page.close()
    finally:
        service.stop()
    troubles[:] = [text for text in troubles if not REFUSED.search(text)]
