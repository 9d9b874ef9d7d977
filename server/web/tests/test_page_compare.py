"""Comparisons of points in a real browser: what points lack, and how points are found and kept."""

from __future__ import annotations

import re
from pathlib import Path
from typing import Any, Literal

import numpy as np
import pytest
from axe_playwright_python.sync_playwright import Axe
from playwright.sync_api import Page, Route, expect

from browsing import (
    COMPARED,
    MINUS,
    REFUSED,
    RULES_OF_THEME,
    Opens,
    drag,
    drawn,
    pixels,
    run_curl,
    run_python,
    said,
    scene,
    shown_lines,
    taken,
    until,
)
from drillsweep import Client, Sweep
from service import SHORT, Service, make_token


@pytest.fixture(scope="module")
def summarized(client: Client) -> Sweep:
    """A point of which only the summary is stored."""
    axes = {"flow_rate": [0.012]}
    return client.submit("paper-200m", set=SHORT, axes=axes, outputs="summary", name="summary").wait(timeout=120.0)


@pytest.fixture(scope="module")
def elsewhere(client: Client) -> Sweep:
    """A point that recorded other nodes than the preset's, and snapshots."""
    changes = {**SHORT, "recording.nodes": [{"depth": 40.0}, {"depth": 195.0}], "recording.snapshots": {"rate_hz": 100}}
    return client.submit("paper-200m", set=changes, axes={"flow_rate": [0.013]}, name="elsewhere").wait(timeout=120.0)


def key(sweep: Sweep, ordinal: int = 1) -> str:
    return f"{sweep.id}:{ordinal}"


def names(page: Page, picture: str) -> list[str]:
    """The lines that a picture has in its legend."""
    read = "place => place.picture.traces.filter(trace => trace.showlegend).map(trace => trace.name)"
    return list(drawn(page, picture).evaluate(read))


@pytest.mark.parametrize(
    ("view", "picture"),
    COMPARED.items(),
)
def test_a_comparison_draws_the_points_that_have_what_it_needs_and_says_what_others_lack(
    opened: Opens, named: Sweep, summarized: Sweep, elsewhere: Sweep, troubles: list[str], view: str, picture: str
) -> None:
    points = ",".join([key(summarized), key(named, 2), key(elsewhere)])
    page = opened(f"#/compare?points={points}&view={view}")
    missing = page.get_by_role("status", name="What is missing")
    expect(missing).to_contain_text(re.compile(r"^Point 1 is missing.*keep the summary only\."))
    assert {name[0] for name in names(page, picture)} == {"2", "3"}
    expect(missing.get_by_role("paragraph").filter(has_text=re.compile("Point [23] "))).to_have_count(0)
    # The browser writes of every answer that refuses.
    troubles[:] = [text for text in troubles if "status of 404" not in text]


def test_each_point_is_compared_at_its_recorded_node_nearest_to_the_depth(
    opened: Opens, named: Sweep, elsewhere: Sweep
) -> None:
    page = opened(f"#/compare?points={key(named)},{key(elsewhere)}&view=history")
    drawn(page, "Histories")
    depths = [
        statistics["measured_depth"] for statistics in (sweep.point(1).statistics() for sweep in (named, elsewhere))
    ]
    page.get_by_label("Node nearest to").select_option(label="57.73 m")
    nearest = [min(recorded, key=lambda depth: abs(depth - 57.73)) for recorded in depths]
    assert nearest[0] != nearest[1]
    shown = [f"at {float(f'{depth:.4g}'):g} m" for depth in nearest]
    expect(page.get_by_text(re.compile(f"point 1 node 49 {shown[0]}; point 2 node \\d+ {shown[1]}"))).to_be_visible()
    # Another view of the comparison keeps the depth.
    page.get_by_role("link", name="Full spectra").click()
    drawn(page, "Full spectra")
    expect(page.get_by_text(re.compile(f"point 1 node 49 {shown[0]}"))).to_be_visible()


def test_a_failed_point_of_a_comparison_says_why(opened: Opens, named: Sweep, client: Client) -> None:
    # Without its wall the string is buckled by the weight on bit.
    failed = client.run("paper-200m", set={**SHORT, "effects.contact": "off"}).wait(timeout=120.0)
    error = failed.point(1).error
    assert error is not None
    page = opened(f"#/compare?points={key(named)},{key(failed)}&view=profiles")
    drawn(page, "Profiles")
    expect(page.get_by_text(f"it failed ({error.kind}): {error.reason}")).to_be_visible()


def test_an_unknown_point_of_a_link_is_named_next_to_the_others(
    opened: Opens, named: Sweep, troubles: list[str]
) -> None:
    unknown = "01a00000-0000-7000-8000-000000000000:1"
    page = opened(f"#/compare?points={key(named, 99)},{key(named)},{unknown}&view=energy")
    drawn(page, "Energy")
    expect(page.get_by_text(re.compile("Point 1 of the link was not found: .* has no point 99"))).to_be_visible()
    expect(page.get_by_text(re.compile("Point 3 of the link was not found: there is no sweep"))).to_be_visible()
    page.get_by_role("button", name="Take it out").first.click()
    until(page, lambda: page.get_by_text("has no point 99").count() == 0)
    expect(page.get_by_role("table", name="Points compared").get_by_role("row")).to_have_count(1)
    # The browser writes of every answer that refuses.
    troubles[:] = [text for text in troubles if "status of 404" not in text]


def test_a_sweep_that_is_not_among_the_newest_is_found_by_its_name(
    opened: Opens, named: Sweep, elsewhere: Sweep
) -> None:
    page = opened("#/nowhere")

    def newest(route: Route) -> None:
        """The list as if it had a page more, without one sweep."""
        answer = route.fetch()
        listed = answer.json()
        listed["sweeps"] = [sweep for sweep in listed["sweeps"] if sweep["id"] != elsewhere.id]
        route.fulfill(response=answer, json={**listed, "next": "more"})

    page.route("**/v1/sweeps?limit=100", newest)
    page.goto(page.url.replace("#/nowhere", f"#/compare?points={key(named)}&view=energy"))
    drawn(page, "Energy")
    sweeps = page.get_by_role("combobox", name="Sweep", exact=True)
    expect(page.get_by_text(re.compile("The newest \\d+ are offered"))).to_be_visible()
    assert "elsewhere" not in sweeps.locator("option").all_text_contents()
    page.get_by_role("searchbox", name="Search sweeps").fill("ELSEW")
    expect(sweeps.locator("option")).to_have_text(["elsewhere"])
    page.get_by_label("Point", exact=True).fill("1")
    page.get_by_role("button", name="Add").click()
    expect(page.get_by_role("table", name="Points compared").get_by_role("row")).to_have_count(2)
    page.get_by_role("searchbox", name="Search sweeps").fill("no such sweep")
    expect(page.get_by_text("No sweep has no such sweep in its name.")).to_be_visible()


def test_a_point_is_added_to_the_comparison_that_was_opened_last(opened: Opens, named: Sweep) -> None:
    page = opened(f"#/sweeps/{named.id}/points/1?view=energy")
    drawn(page, "Energy by account")
    page.get_by_role("link", name="Compare", exact=True).last.click()
    drawn(page, "Profiles")
    page.get_by_role("link", name="Energy", exact=True).click()
    drawn(page, "Energy")
    page.goto(page.url.partition("#")[0] + f"#/sweeps/{named.id}/points/2?view=energy")
    page.get_by_role("link", name="Add to the comparison of 1").click()
    expect(page.get_by_role("table", name="Points compared").get_by_role("row")).to_have_count(2)
    # As it was left.
    assert [name[0] for name in names(page, "^Energy$")] == ["1", "2"]
    page.goto(page.url.partition("#")[0] + f"#/sweeps/{named.id}/points/2?view=energy")
    expect(page.get_by_role("link", name="Back to the comparison")).to_be_visible()
    page.get_by_role("link", name="New comparison").click()
    expect(page.get_by_role("table", name="Points compared").get_by_role("row")).to_have_count(1)


def cells(page: Page, name: str, row: str) -> list[str]:
    """Row of a table of a comparison, by point."""
    head = page.get_by_role("rowheader", name=row, exact=True)
    found = page.get_by_role("table", name=name, exact=True).get_by_role("row").filter(has=head)
    expect(found).to_be_visible(timeout=30_000)
    return found.get_by_role("cell").all_text_contents()


def test_statistics_effects_modes_and_cost_are_compared_in_tables(
    opened: Opens, named: Sweep, elsewhere: Sweep, summarized: Sweep, troubles: list[str]
) -> None:
    points = ",".join([key(named), key(summarized), key(elsewhere)])
    page = opened(f"#/compare?points={points}&view=statistics&depth=57.73&from=0.1&to=0.4")
    has = [named.point(1), elsewhere.point(1)]
    sizes = [point.statistics(depth=57.73, nearest=True, time=(0.1, 0.4))["orbit_radius_rms"][0] for point in has]
    assert cells(page, "Statistics", "Orbit size (rms about the mean)") == [
        f"{float(f'{1e3 * size:.4g}'):g} mm" for size in sizes
    ]
    expect(page.get_by_role("status", name="What is missing")).to_contain_text("Point 2 is missing")
    page.get_by_role("link", name="Modes", exact=True).click()
    lowest = [min(mode["frequency_hz"] for mode in point.modes(to_hz=20.0)["modes"]) for point in has]
    shown = cells(page, "Modes", "1")
    assert [float(text.split(" Hz")[0]) for text in (shown[0], shown[-1])] == pytest.approx(lowest, rel=1e-3)
    # The shift of a frequency is that from the first point.
    rows = page.get_by_role("table", name="Modes", exact=True).locator("tbody tr").all()
    compared = 0
    for first, *others in [row.get_by_role("cell").all_text_contents() for row in rows]:
        for other in others:
            if shift := re.search(r"\(([^)]*) %\)", other):
                ratio = float(other.split(" Hz")[0]) / float(first.split(" Hz")[0])
                assert float(shift[1].replace(MINUS, "-")) == pytest.approx(100 * (ratio - 1), rel=0.1, abs=0.1)
                compared += 1
    assert compared > 0
    page.get_by_role("link", name="Effects", exact=True).click()
    plans = [{effect["effect"]: effect for effect in point.plan()["effects"]} for point in has]
    for name in plans[0]:
        shown = cells(page, "Effects", name.replace("_", " "))
        said = [f"{'on' if plan[name]['active'] else 'off'} {plan[name]['reason']}" for plan in plans]
        assert [shown[0], shown[-1]] == said
    page.get_by_role("link", name="Cost", exact=True).click()
    assert cells(page, "Cost", "Elements")[0] == str((has[0].provenance or {})["elements"])
    page.get_by_role("link", name="Accuracy", exact=True).click()
    resolved = [float((point.summary or {})["resolved_hz"]) for point in has]
    shown = cells(page, "Accuracy", "Resolved up to")
    assert [float(text.split(" Hz")[0]) for text in (shown[0], shown[-1])] == pytest.approx(resolved, rel=1e-3)
    assert len(cells(page, "Accuracy", "Mesh: error of the mean radius at rest")) == len(shown)
    # The browser writes of every answer that refuses.
    troubles[:] = [text for text in troubles if "status of 404" not in text]


def test_compared_statistics_carry_the_bias_of_the_window_that_was_verified(opened: Opens, client: Client) -> None:
    verified = client.submit("paper-200m", set=SHORT, axes={"flow_rate": [0.01]}, verify=1).wait(timeout=180.0)
    bias = said(float(verified.verification()["bias_orbit_radius_rms_49"][0]))
    view = f"#/compare?points={key(verified)}&view=statistics&depth=57.73"
    page = opened(f"{view}&from=0.1&to=0.5")
    assert cells(page, "Statistics", "Orbit size (rms about the mean)")[0].endswith(f"(bias {bias})")
    page.get_by_role("button", name="Whole run").click()
    row = page.get_by_role("rowheader", name="Orbit size (rms about the mean)").locator("..")
    expect(row).not_to_contain_text("bias")


def test_points_are_compared_in_the_window_of_their_statistics(opened: Opens, named: Sweep, client: Client) -> None:
    size = "orbit_radius_rms_49"
    table = named.table()
    page = opened(f"#/compare?points={key(named)},{key(named, 2)}&view=statistics&depth=57.73")
    assert cells(page, "Statistics", "Orbit size (rms about the mean)") == [
        f"{float(f'{1e3 * value:.4g}'):g} mm" for value in list(table[size])[:2]
    ]
    other = {**SHORT, "recording.orbit_window": {"from": 0.3, "to": 0.5}}
    apart = client.submit("paper-200m", set=other, axes={"flow_rate": [0.01]}, name="apart").wait(timeout=120.0)
    page = opened(f"#/compare?points={key(named)},{key(apart)}&view=statistics&depth=57.73")
    expect(page.get_by_text("point 1 0.1 to 0.5 s, point 2 0.3 to 0.5 s")).to_be_visible()
    expect(page.get_by_label("From [s]")).to_have_value("0.3")
    page.get_by_role("button", name="Whole run").click()
    expect(page.get_by_text("of different windows")).to_have_count(0)


def test_compared_wells_are_coloured_on_one_scale(opened: Opens, named: Sweep, tmp_path: Path) -> None:
    page = opened(f"#/compare?points={key(named)},{key(named, 8)}&view=well")
    pictures = page.get_by_role("application", name=re.compile("The string at rest in its hole, [12]: "))
    expect(pictures).to_have_count(2)
    expect(page.locator(".scale > *")).to_have_count(0)
    page.get_by_label("Colour", exact=True).select_option(label="friction coefficient C_f")
    ends = page.locator(".scale .number")
    expect(ends).to_have_count(2)
    expected = []
    for point in (named.point(1), named.point(8)):
        elements = np.array(point.profile()["friction_coefficient"])
        # At a node the mean of both elements next to it.
        expected.append(np.concatenate([elements[:1], (elements[1:] + elements[:-1]) / 2, elements[-1:]]))
    shown = [float(text) for text in ends.all_text_contents()]
    assert shown == pytest.approx([min(map(min, expected)), max(map(max, expected))], rel=1e-2)
    lines = shown_lines(page)
    answers = run_curl(lines["curl"], tmp_path / "curl")
    assert sum("friction_coefficient" in found for found in answers.values()) == 2
    tables = run_python(lines["Python"])
    assert "friction_coefficient" in tables["profile[1]"]
    assert "true_vertical_depth" in tables["statics[1]"]


def test_compared_spectra_name_lines_and_shade_what_is_not_resolved(opened: Opens, named: Sweep) -> None:
    page = opened(f"#/compare?points={key(named)},{key(named, 2)}&view=spectrum&depth=57.73&range=100")
    picture = drawn(page, "Full spectra")
    read = "place => place.picture.layout.annotations.map(({ text, yref }) => [yref, text])"
    names = [(where, text) for where, text in picture.evaluate(read) if where != "paper"]
    own = [named.point(number).spectrum(node=49, time=(0.1, 0.5), window="hann", range_hz=100) for number in (1, 2)]
    lines = [
        (panel, f"{'+' if peak['frequency'] > 0 else MINUS}{abs(peak['frequency']):.2f} Hz")
        for panel, table in zip(("y", "y2"), own, strict=True)
        for peak in table.attributes["peaks"]
    ]
    assert names
    assert set(names) <= set(lines)
    shades = picture.evaluate("place => place.picture.layout.shapes.map(({ x0 }) => x0)")
    resolved = min(table.attributes["resolved_hz"] for table in own)
    assert shades[:1] == pytest.approx([resolved] if resolved < 100 else [])
    assert len(page.locator("figcaption", has_text="Shaded:").all()) == (resolved < 100)
    # Each has a panel of its own, on one scale, so that none hides another.
    panels = picture.evaluate("""place => ["yaxis", "yaxis2"].map(name => {
        const { range, own } = place.picture.axis(name);
        return { range: [...range], domain: own.domain };
    })""")
    assert panels[0]["range"] == panels[1]["range"]
    assert panels[0]["domain"][0] > panels[1]["domain"][1]


def test_energy_is_compared_over_time(opened: Opens, named: Sweep) -> None:
    page = opened(f"#/compare?points={key(named)},{key(named, 2)}&view=energy")
    picture = drawn(page, "^Energy$")
    read = "place => place.picture.traces.map(({ x, y }) => ({ x: [...x], y: [...y] }))"
    table = named.point(2).energy()
    # All accounts, the smallest too, are bars on a logarithmic scale.
    bars = picture.evaluate(read)[1]
    assert picture.evaluate("place => place.picture.axis('xaxis').isLog")
    friction = bars["x"][bars["y"].index("dissipated by friction")]
    assert friction == pytest.approx(
        float(table["dissipated_friction"][-1] - table["dissipated_friction"][0]), rel=1e-6
    )
    assert min(bars["x"]) > 0
    page.get_by_label("Shows", exact=True).select_option("kinetic")
    until(page, lambda: len(picture.evaluate(read)[0]["x"]) == len(table["time"]))
    np.testing.assert_allclose(picture.evaluate(read)[1]["x"], table["time"], rtol=1e-6)
    assert "account=kinetic" in page.url


def test_points_of_the_same_words_are_told_apart(opened: Opens, client: Client) -> None:
    axes = {"flow_rate": [0.01]}
    speeds = [
        client.submit("paper-200m", set=SHORT | {"operation.rotation_speed_rpm": speed}, axes=axes, name="speeds")
        for speed in (110, 120)
    ]
    again = client.submit("paper-200m", set=SHORT | {"operation.rotation_speed_rpm": 120}, axes=axes, name="again")
    for sweep in (*speeds, again):
        sweep.wait(timeout=120.0)
    page = opened(f"#/compare?points={key(speeds[0])},{key(speeds[1])}&view=orbit")
    shown = names(page, "Orbits")
    assert [re.sub(".*rotation speed ", "", name) for name in shown] == ["110 rpm", "120 rpm"]
    page = opened(f"#/compare?points={key(speeds[1])},{key(again)}&view=orbit")
    assert [name.rpartition(", ")[2] for name in names(page, "Orbits")] == ["speeds", "again"]
    page = opened(f"#/compare?points={key(speeds[0])},{key(speeds[1])},{key(again)}&view=orbit")
    shown = [re.sub(".*rotation speed ", "", name) for name in names(page, "Orbits")]
    assert shown == ["110 rpm", "120 rpm, speeds", "120 rpm, again"]
    # Their names make no difference.
    preset = client.get_json("/v1/scenarios/paper-200m")["scenario"]
    called = [
        client.submit(scenario=preset | {"name": name}, set=SHORT | {"operation.rotation_speed_rpm": speed}, axes=axes)
        for name, speed in (("one", 110), ("other", 120))
    ]
    for sweep in called:
        sweep.wait(timeout=120.0)
    page = opened(f"#/compare?points={key(called[0])},{key(called[1])}&view=orbit")
    told = [name.partition(": ")[2].split(", ")[2:] for name in names(page, "Orbits")]
    assert told == [["rotation speed 110 rpm"], ["rotation speed 120 rpm"]]


def test_what_takes_seconds_says_so(opened: Opens, named: Sweep) -> None:
    page = opened("#/nowhere")
    asked: list[Route] = []
    page.route("**/modes?**", lambda route: asked.append(route))
    page.goto(page.url.replace("#/nowhere", f"#/compare?points={key(named)}&view=modes"))
    waiting = page.get_by_role("region", name="Modes, scrollable").get_by_text("Loading")
    expect(waiting).to_be_visible()
    until(page, lambda: len(asked) == 1)
    asked[0].continue_()
    assert cells(page, "Modes", "1")
    expect(waiting).to_have_count(0)


def test_compared_orbits_have_the_hole_of_each(opened: Opens, client: Client, named: Sweep) -> None:
    axes = {"well.hole_diameter": [0.2159, 0.26]}
    holes = client.submit("paper-200m", set=SHORT, axes=axes, name="two holes").wait(timeout=120.0)
    page = opened(f"#/compare?points={key(holes)},{key(holes, 2)}&view=orbit&depth=57.73&zoom=hole")
    circles = "({ picture }) => picture.traces.filter(({ isSilent }) => isSilent).map(({ x, xaxis }) => [x[0], xaxis])"
    picture = drawn(page, "Orbits")
    statics = [point.statics() for point in (holes.point(1), holes.point(2))]
    clearances = [float(table["clearance"][list(table["node"]).index(49)]) for table in statics]
    shown = picture.evaluate(circles)
    assert [radius for radius, _ in shown] == pytest.approx([1e3 * clearance for clearance in clearances])
    assert [panel for _, panel in shown] == ["x", "x2"]
    # On one scale.
    scale = "place => ['xaxis', 'xaxis2', 'yaxis', 'yaxis2'].map((name) => place.picture.axis(name))"
    scale += ".map(({ length, range }) => length / (range[1] - range[0]))"
    assert picture.evaluate(scale) == pytest.approx(4 * [picture.evaluate(scale)[0]], rel=1e-6)
    caption = page.locator("figcaption")
    for number, clearance in enumerate(clearances, 1):
        expect(caption).to_contain_text(f"point {number} {float(f'{1e3 * clearance:.4g}'):g} mm from the axis")
    # One hole is said once.
    page = opened(f"#/compare?points={key(named)},{key(named, 2)}&view=orbit&depth=57.73")
    assert len(drawn(page, "Orbits").evaluate(circles)) == 2
    said = re.compile(r"On the grey circle the node touches the wall, \S+ mm from the axis\.")
    expect(page.locator("figcaption")).to_contain_text(said)


def test_points_over_time_have_a_panel_each_on_one_scale(opened: Opens, named: Sweep) -> None:
    points = ",".join(key(named, ordinal) for ordinal in (1, 2, 3))
    for view, picture, count in [
        ("history", "Histories", 3),
        ("rotation", "Rotation and torque", 3),
        ("bit", "Rotation at bit and top", 6),
    ]:
        page = opened(f"#/compare?points={points}&view={view}")
        shown = drawn(page, picture)
        read = "place => place.picture.traces.map(({ yaxis }) => yaxis)"
        assert shown.evaluate(read) == ["y", *(f"y{number}" for number in range(2, count + 1))]
        spans = "place => [1, 2, 3].map((number) => place.picture.axis(`yaxis${number > 1 ? number : ''}`).range)"
        first, *others = shown.evaluate(spans)
        assert others == [pytest.approx(first), pytest.approx(first)]
        headings = shown.evaluate(
            "place => place.picture.layout.annotations.map(({ text }) => text.split(': ')[0].at(-1))"
        )
        assert headings == (["1", "2", "3"] * 2)[:count]


def test_compared_orbits_are_below_each_other_on_a_phone(opened: Opens, named: Sweep) -> None:
    points = ",".join(key(named, ordinal) for ordinal in (1, 2, 3))
    page = opened(f"#/compare?points={points}&view=orbit", viewport={"width": 390, "height": 844})
    picture = drawn(page, "Orbits")
    widths = picture.evaluate("place => ['xaxis', 'xaxis2', 'xaxis3'].map((name) => place.picture.axis(name).length)")
    assert min(widths) > 150
    assert page.evaluate("document.documentElement.scrollWidth") <= 390


def test_compared_wells_say_how_far_from_the_axis_strings_are_drawn(opened: Opens, named: Sweep) -> None:
    page = opened(f"#/compare?points={key(named)},{key(named, 2)}&view=well")
    caption = page.locator("figcaption")
    expect(caption).to_contain_text("drawn 100 times as large")
    before = pixels(scene(page, "The string at rest"))
    page.get_by_label("Distance from the axis").select_option("1")
    expect(caption).to_contain_text("drawn to scale")
    until(page, lambda: pixels(scene(page, "The string at rest")) != before)
    assert "exaggerate=1" in page.url


def test_a_window_dragged_across_histories_is_that_of_the_other_views(opened: Opens, named: Sweep) -> None:
    page = opened(f"#/compare?points={key(named)},{key(named, 2)}&view=history&from=0&to=0.5")
    picture = drawn(page, "Histories").locator(".area").first
    picture.scroll_into_view_if_needed()
    drag(page, picture, (0.4, 0.5), (0.8, 0.5))
    start, end = page.get_by_label("From [s]"), page.get_by_label("To [s]")
    until(page, lambda: float(start.input_value()) > 0.1 and float(end.input_value()) < 0.45)
    chosen = start.input_value(), end.input_value()
    page.get_by_role("link", name="Orbits", exact=True).click()
    drawn(page, "Orbits")
    assert (start.input_value(), end.input_value()) == chosen
    page.get_by_role("button", name="Whole run").click()
    expect(start).to_have_value("0")
    expect(end).to_have_value("0.5")


def test_snapshots_are_compared_side_by_side(
    opened: Opens, named: Sweep, elsewhere: Sweep, troubles: list[str]
) -> None:
    points = f"{key(elsewhere)},{key(named)}"
    page = opened(f"#/compare?points={points}&view=contacts")
    shown = drawn(page, "Contact force over depth and time, point 1").evaluate("place => place.picture.traces[0].z")
    snapshots = elsewhere.point(1).snapshots(fields=["normal_force"])
    force = snapshots["normal_force"].reshape(-1, snapshots.attributes["nodes"])
    np.testing.assert_allclose(np.array(shown), force.T / 1e3, rtol=1e-6)
    missing = page.get_by_role("status", name="What is missing")
    expect(missing).to_contain_text(re.compile(r"Point 2 is missing: .*recording\.snapshots"))
    page.get_by_role("link", name="Strings in motion").click()
    picture = page.get_by_role("application", name=re.compile("The string moving in its hole, 1:"))
    expect(picture).to_have_attribute("data-drawn", re.compile(r"\d+"), timeout=30_000)
    expect(missing).to_contain_text("Point 2 is missing")
    # Nothing was asked for that is not there.
    assert troubles == []
    page.get_by_role("link", name="Rotation at bit and top").click()
    picture = drawn(page, "Rotation at bit and top")
    speeds = "place => place.picture.traces.filter(({ showlegend }) => showlegend).map(({ y }) => [...y])"
    # The histories of all have the bit, at the same rate.
    caption = page.locator("figcaption")
    expect(caption).to_contain_text("From the recorded histories.")
    for speed, sweep in zip(picture.evaluate(speeds), (elsewhere, named), strict=True):
        bit = int(sweep.point(1).statics()["node"][-1])
        history = sweep.point(1).history(node=bit, time=(0.1, 0.5))
        np.testing.assert_allclose(speed, history[f"rotation_speed_{bit}"], rtol=1e-6)
    page.get_by_label("End of the string").select_option("top")
    expect(missing).to_contain_text("Point 2 is missing: Rotation speed and torque at the top")
    expect(caption).to_contain_text("From the snapshots.")
    top = elsewhere.point(1).snapshots(node=1, time=(0.1, 0.5))
    torque = picture.evaluate("place => [...place.picture.traces.find(({ yaxis }) => yaxis === 'y2').y]")
    np.testing.assert_allclose(torque, top["torque"] / 1e3, rtol=1e-6)


def test_spectrograms_are_compared_on_one_scale(opened: Opens, named: Sweep) -> None:
    page = opened(f"#/compare?points={key(named)},{key(named, 2)}&view=spectrogram&depth=57.73&range=50")
    scales = [
        drawn(page, f"Spectrogram, point {number}").evaluate(
            "place => [place.picture.traces[0].zmin, place.picture.traces[0].zmax]"
        )
        for number in (1, 2)
    ]
    assert scales[0] == scales[1]
    own = [named.point(number).spectrogram(node=49, range_hz=50, time=(0.1, 0.5)) for number in (1, 2)]
    most = max(
        float(table["amplitude"][abs(table["frequency"]) >= 2.5 * table.attributes["resolution"]].max())
        for table in own
    )
    assert 10 ** scales[0][1] == pytest.approx(1e3 * most, rel=1e-6)


def test_keys_read_the_profiles_of_all_points_at_a_depth(opened: Opens, named: Sweep) -> None:
    ordinals = (1, 3)
    points = ",".join(key(named, ordinal) for ordinal in ordinals)
    page = opened(f"#/compare?points={points}&view=profiles&profiles=effective_tension,normal_force")
    picture = drawn(page, "Profiles")
    depths = named.point(1).statics()["measured_depth"]
    line = "place => (place.picture.layout.shapes ?? []).map(({ y0, y1 }) => [y0, y1])"
    cursor = page.get_by_role("slider", name="Depth cursor")
    cursor.focus()
    for _ in range(3):
        page.keyboard.press("PageDown")
    depth = float(depths[30])
    until(page, lambda: picture.evaluate(line) == [pytest.approx([depth, depth], rel=1e-6)])
    reading = page.get_by_role("status").filter(has_text=re.compile("^At "))
    # Of the element above the node.
    tensions = [float(named.point(ordinal).profile()["effective_tension"][29]) / 1e3 for ordinal in ordinals]
    assert tensions[0] != pytest.approx(tensions[1], rel=2e-3)
    expect(reading.get_by_role("paragraph")).to_have_count(len(ordinals))
    for number, tension in enumerate(tensions, 1):
        text = reading.get_by_role("paragraph").nth(number - 1).inner_text()
        words = re.fullmatch(rf"{number}: .*: effective tension (\S+) kN · .*side force \S+ k?N", text)
        assert words is not None, text
        assert float(words.group(1).replace(MINUS, "-")) == pytest.approx(tension, rel=1e-3)
    # The link holds where the cursor is.
    other = opened(f"#{page.url.partition('#')[2]}")
    copy = drawn(other, "Profiles")
    until(other, lambda: copy.evaluate(line) == [pytest.approx([depth, depth], rel=1e-6)])
    expect(other.get_by_role("status").filter(has_text=re.compile("^At "))).to_have_text(reading.text_content() or "")


def test_below_the_end_of_a_string_there_is_nothing_to_read(opened: Opens, client: Client, named: Sweep) -> None:
    changes = {**SHORT, "string.sections[0].length": 3.0, "string.gauges[2].measured_depth": 198.0}
    shorter = client.submit("paper-200m", set=changes, axes={"flow_rate": [0.014]}, name="shorter").wait(timeout=120.0)
    assert shorter.counts.succeeded == 1
    end = float(shorter.point(1).statics()["measured_depth"][-1])
    last = float(named.point(1).statics()["measured_depth"][-1])
    assert end < last - 0.5
    page = opened(f"#/compare?points={key(shorter)},{key(named)}&view=profiles&profiles=effective_tension")
    drawn(page, "Profiles")
    page.get_by_role("slider", name="Depth cursor").focus()
    page.keyboard.press("End")
    readings = page.get_by_role("status").filter(has_text=re.compile("^At ")).get_by_role("paragraph")
    expect(readings.nth(0)).to_have_text(re.compile("^1: .*: its string ends above$"))
    expect(readings.nth(1)).to_have_text(re.compile(r"^2: .*: effective tension \S+ kN$"))


@pytest.mark.parametrize("theme", ["light", "dark"])
def test_no_view_of_a_comparison_keeps_anybody_out(
    opened: Opens, server: str, named: Sweep, elsewhere: Sweep, theme: Literal["light", "dark"], troubles: list[str]
) -> None:
    page = opened("", color_scheme=theme)
    views = ["profiles", "orbit", "history", "rotation", "spectrum", "statistics", "spectrogram", "bit", "string"]
    views += ["contacts", "well", "energy", "energy&account=kinetic", "modes", "effects", "accuracy", "cost"]
    links = [f"#/compare?points={key(named)},{key(elsewhere)}&view={view}" for view in views]
    links += [f"#/sweeps/{elsewhere.id}/points/1?view={view}" for view in ("string", "spectrogram")]
    links += [f"#/sweeps/{named.id}/points/1?view=string"]
    for view in links:
        page.goto("about:blank")
        page.goto(f"{server}/{view}")
        page.locator("main h1").wait_for()
        page.wait_for_load_state("networkidle")
        for details in page.locator("main details").all():
            details.evaluate("details => { details.open = true }")
        found = Axe().run(page, options=RULES_OF_THEME[theme])
        assert found.violations_count == 0, f"{view}\n{found.generate_report()}"
    # The browser writes of every answer that refuses.
    troubles[:] = [text for text in troubles if "status of 404" not in text]


@pytest.mark.parametrize("theme", ["light", "dark"])
def test_the_dialog_that_asks_for_a_token_keeps_nobody_out(
    opened: Opens, troubles: list[str], tmp_path: Path, theme: Literal["light", "dark"]
) -> None:
    make_token(tmp_path, "read")
    service = Service("serve", "--listen", "127.0.0.1:0", "--data", str(tmp_path))
    try:
        page = opened("", service.server, color_scheme=theme)
        dialog = page.get_by_role("dialog")
        dialog.get_by_label("Token").fill("not one of its tokens, but long enough")
        dialog.get_by_role("button", name="Log in").click()
        expect(dialog.get_by_role("alert")).not_to_be_empty()
        found = Axe().run(page)
        assert found.violations_count == 0, found.generate_report()
        page.close()
    finally:
        service.stop()
    troubles[:] = [text for text in troubles if not REFUSED.search(text)]


@pytest.mark.parametrize(
    ("view", "columns"),
    [
        ("profiles&profiles=friction_coefficient", {"friction_coefficient"}),
        ("profiles&profiles=stick_time", {"stick_time"}),
        ("history&depth=57.73", {"time", "u", "v"}),
        ("rotation&depth=57.73", {"time", "rotation_speed_49", "torque_49"}),
        ("spectrum&depth=57.73", {"frequency", "amplitude"}),
        ("spectrogram&depth=57.73", {"time", "frequency", "amplitude"}),
        ("statistics&depth=57.73", {"node", "orbit_radius_rms"}),
        ("well", {"north", "east", "true_vertical_depth"}),
        ("energy", {"time", "kinetic"}),
        ("modes", {"modes"}),
        ("effects", {"effects"}),
        ("accuracy", {"summary"}),
        ("cost", {"provenance"}),
    ],
)
def test_the_lines_of_a_comparison_read_what_it_shows(
    opened: Opens, named: Sweep, view: str, columns: set[str], tmp_path: Path
) -> None:
    page = opened(f"#/compare?points={key(named)},{key(named, 2)}&view={view}")
    expect(page.get_by_role("heading", level=1)).to_have_text("Compare points")
    lines = shown_lines(page)
    answers = run_curl(lines["curl"], tmp_path / "curl")
    assert len(answers) == 2
    assert all(columns <= set(found) for found in answers.values())
    tables = run_python(lines["Python"])
    is_table = view not in ("modes", "effects", "accuracy", "cost")
    is_drawn = view.startswith("spectrum&")
    assert not is_table or is_drawn or sum(columns <= set(found) for found in tables.values()) == 2


def test_an_answer_of_a_comparison_that_comes_late_is_not_shown(opened: Opens, named: Sweep) -> None:
    page = opened("#/nowhere")
    held: list[tuple[Route, Any]] = []
    page.route("**/statistics?*from=0.1&*", lambda route: held.append((route, route.fetch().json())))
    page.goto(page.url.replace("#/nowhere", f"#/compare?points={key(named)}&view=statistics&from=0.2&to=0.5"))
    first = cells(page, "Statistics", "Samples")
    page.get_by_label("From [s]").fill("0.1")
    page.get_by_label("From [s]").blur()
    until(page, lambda: len(held) == 1)
    page.get_by_label("From [s]").fill("0.3")
    page.get_by_label("From [s]").blur()
    until(page, lambda: cells(page, "Statistics", "Samples") != first)
    newest = cells(page, "Statistics", "Samples")
    route, answer = held[0]
    answer["attributes"]["samples"] = 12345
    route.fulfill(json=answer)
    taken(page)
    assert cells(page, "Statistics", "Samples") == newest


def test_the_lines_of_a_comparison_follow_what_is_chosen(opened: Opens, named: Sweep) -> None:
    page = opened(f"#/compare?points={key(named)}&view=spectrum")
    drawn(page, "Full spectra")
    assert "range_hz=20" in shown_lines(page)["curl"]
    page.get_by_label("Frequencies up to").select_option("100")
    until(page, lambda: "range_hz=100" in shown_lines(page)["curl"])
    # Without a number the window begins where it usually does, in the link as in the view.
    page.get_by_label("From [s]").fill("0.3")
    page.get_by_label("From [s]").blur()
    until(page, lambda: "from=0.3" in page.url)
    page.get_by_label("From [s]").fill("")
    page.get_by_label("From [s]").blur()
    until(page, lambda: "from=" not in page.url)
    expect(page.get_by_label("From [s]")).to_have_value("0.1")


def test_the_whole_hole_is_shown_where_it_is_chosen(opened: Opens, named: Sweep) -> None:
    page = opened(f"#/compare?points={key(named)}&view=orbit&zoom.orbit=x:0.001:0.002,y:0.001:0.002")
    picture = drawn(page, "Orbits")
    width = "place => place.picture.axis('xaxis').range[1] - place.picture.axis('xaxis').range[0]"
    assert picture.evaluate(width) < 10.0
    page.get_by_label("Shows", exact=True).select_option("hole")
    statics = named.point(1).statics()
    clearance = 1e3 * float(statics["clearance"].max())
    until(page, lambda: picture.evaluate(width) > clearance)
    assert "zoom.orbit" not in page.url
