"""A point and points compared in a real browser: lines that make a view again, biases, the keyboard, saved pictures."""

from __future__ import annotations

import math
import re
from itertools import combinations, pairwise
from pathlib import Path
from urllib.parse import parse_qs

import numpy as np
import pytest
from playwright.sync_api import Page, Route, expect

from browsing import (
    MINUS,
    Opens,
    clock,
    drag,
    drawn,
    pixels,
    run_curl,
    run_python,
    said,
    scene,
    shown_lines,
    taken,
    trace,
    until,
    written,
)
from drillsweep import Client, DrillsweepWarning, Sweep
from service import SHORT, Service, make_token


@pytest.fixture(scope="module")
def untwisted(client: Client) -> Sweep:
    """A point for which torsion was not solved."""
    return client.submit("paper-200m", set=SHORT | {"effects.torsion": "off"}, name="untwisted").wait(timeout=120.0)


@pytest.fixture(scope="module")
def ends(client: Client) -> Sweep:
    """A point whose recorded nodes are those at the top and at the bit."""
    changes = SHORT | {"recording.nodes": [{"node": 1}, {"node": 297}]}
    with pytest.warns(DrillsweepWarning, match="the top node is held"):
        sweep = client.submit("paper-200m", set=changes, axes={"flow_rate": [0.01]}, name="ends")
    return sweep.wait(timeout=120.0)


def focused(page: Page) -> str:
    """The name of what has the keyboard's focus."""
    read = "() => { const at = document.activeElement; return at.getAttribute('aria-label') ?? at.textContent; }"
    return str(page.evaluate(read))


def test_the_keyboards_focus_stays_where_controls_are_made_anew(opened: Opens, sweep: Sweep) -> None:
    page = opened(f"#/sweeps/{sweep.id}/points/1?view=motion")
    drawn(page, "Orbit of node")
    page.get_by_label("From [s]").focus()
    page.keyboard.press("Control+A")
    page.keyboard.type("0.2")
    page.keyboard.press("Enter")
    until(page, lambda: "from=0.2" in page.url)
    assert focused(page) == "From [s]"
    page.keyboard.press("Tab")
    assert focused(page) == "To [s]"
    page.keyboard.press("Control+A")
    page.keyboard.type("0.4")
    page.keyboard.press("Tab")
    until(page, lambda: "to=0.4" in page.url)
    assert focused(page) == "Orbit shows"
    page.get_by_label("Node", exact=True).focus()
    page.keyboard.press("ArrowDown")
    until(page, lambda: "node=49" in page.url)
    drawn(page, "Orbit of node 49")
    assert focused(page) == "Node"
    units = page.get_by_role("button", name="Units: SI. Switch")
    units.focus()
    page.keyboard.press("Enter")
    expect(page.get_by_role("button", name="Units: field. Switch")).to_be_focused()
    page = opened(f"#/sweeps/{sweep.id}?view=map")
    drawn(page, "over flow rate")
    colour = page.get_by_label("Colour", exact=True)
    before = colour.input_value()
    colour.focus()
    page.keyboard.press("ArrowDown")
    until(page, lambda: colour.input_value() != before)
    until(page, lambda: f"colour={colour.input_value()}" in page.url)
    expect(colour).to_be_focused()


PROFILE = ["measured_depth_top", "measured_depth_bottom"]
ORBIT = ["time", "u", "v", "radius"]
SPACE = ["measured_depth", "north", "east", "true_vertical_depth", "u", "v", "low_side_angle", "clearance"]
STATISTICS = ["node", "measured_depth", "orbit_radius_rms"]
LINES_OF_A_POINT = {
    "profiles": {"profile": [*PROFILE, "friction_coefficient"], "contacts": ["measured_depth", "largest_normal_force"]},
    "profiles&profiles=largest_normal_force,stick_time": {
        "contacts": ["measured_depth", "largest_normal_force", "stick_time"]
    },
    "motion&node=49&from=0.2&to=0.4": {
        "history": ["time", "u_49", "rotation_speed_49", "torque_49"],
        "orbit": ORBIT,
        "spectrum": ["frequency", "amplitude"],
        "statistics": STATISTICS,
    },
    "spectrogram&node=49&range=50": {"spectrogram": ["time", "frequency", "amplitude"]},
    "string": {
        "snapshots": ["time", "node", "u", "v", "normal_force", "rotation_speed", "torque"],
        "history_297": ["time", "rotation_speed_297", "torque_297"],
    },
    "well": {"statics": [*SPACE, "normal_force"]},
    "well&colour=friction_coefficient": {"statics": SPACE, "profile": [*PROFILE, "friction_coefficient"]},
    "energy": {"energy": ["time", "kinetic", "stored", "residual"]},
}
"""By view of a point: the tables that its pictures are made of, with columns that they show."""


def assert_lines_run(page: Page, expected: dict[str, list[str]], directory: Path, token: str = "") -> None:
    lines = shown_lines(page)
    found = run_curl(lines["curl"], directory, token)
    for name, columns in expected.items():
        assert set(columns) <= set(found[name if len(found) > 1 else ""]), (name, found)
    tables = run_python(lines["Python"], token)
    for name, columns in expected.items():
        assert set(columns) <= set(tables[name]), (name, tables)
    for name in expected:
        assert re.search(rf"^{re.escape(name) if len(found) > 1 else 'table'} = webread", lines["MATLAB"], re.MULTILINE)


@pytest.mark.parametrize("view", LINES_OF_A_POINT)
def test_the_lines_of_a_view_read_what_it_shows(opened: Opens, recorded: Sweep, view: str, tmp_path: Path) -> None:
    page = opened(f"#/sweeps/{recorded.id}/points/1?view={view}")
    if view.startswith("well"):
        scene(page, "The string at rest")
    else:
        drawn(page, "Rotation speed and torque at bit and top" if view == "string" else ".")
    expected = {name if name != "point" else "": columns for name, columns in LINES_OF_A_POINT[view].items()}
    if len(expected) == 1 and "motion" not in view:
        (name,) = expected
        lines = shown_lines(page)
        assert set(expected[name]) <= set(run_curl(lines["curl"], tmp_path / "curl")[""])
        assert set(expected[name]) <= set(run_python(lines["Python"])[name])
    else:
        assert_lines_run(page, expected, tmp_path / "curl")


def test_the_lines_of_effects_and_downloads_read_them(opened: Opens, sweep: Sweep, tmp_path: Path) -> None:
    page = opened(f"#/sweeps/{sweep.id}/points/1?view=about")
    lines = shown_lines(page)
    found = run_curl(lines["curl"], tmp_path / "curl")
    assert {"summary", "provenance"} <= set(found["point"])
    assert "effects" in found["plan"]
    assert "artifacts" in found["artifacts"]
    run_python(lines["Python"])


def test_lines_carry_the_token_where_one_is_needed(opened: Opens, troubles: list[str], tmp_path: Path) -> None:
    token = make_token(tmp_path, "submit")
    service = Service("up", "--workers", "1", "--listen", "127.0.0.1:0", "--data", str(tmp_path))
    try:
        with Client(service.server, token=token) as client:
            sweep = client.run("paper-200m", set=SHORT).wait(timeout=120.0)
        page = opened(f"#/sweeps/{sweep.id}/points/1?view=energy", service.server)
        page.get_by_label("Token").fill(token)
        page.get_by_role("dialog").get_by_role("button", name="Log in").click()
        drawn(page, "Energy by account")
        lines = shown_lines(page)
        assert "kinetic" in run_curl(lines["curl"], tmp_path / "curl", token)[""]
        assert "kinetic" in run_python(lines["Python"], token)["energy"]
        assert 'HeaderFields=["Authorization", "Bearer " + getenv("DRILLSWEEP_TOKEN")]' in lines["MATLAB"]
        page.close()
    finally:
        service.stop()
    troubles[:] = [text for text in troubles if "status of 401" not in text]


def test_the_lines_that_submit_and_list_carry_the_token_too(opened: Opens, troubles: list[str], tmp_path: Path) -> None:
    token = make_token(tmp_path, "submit")
    service = Service("up", "--workers", "0", "--listen", "127.0.0.1:0", "--data", str(tmp_path))
    try:
        page = opened("#/new?preset=paper-200m", service.server)
        page.get_by_label("Token").fill(token)
        page.get_by_role("dialog").get_by_role("button", name="Log in").click()
        expect(page.get_by_role("button", name=re.compile(r"Submit \d+ points"))).to_be_enabled()
        lines = shown_lines(page)
        assert 'HeaderFields=["Authorization", "Bearer " + getenv("DRILLSWEEP_TOKEN")]' in lines["MATLAB"]
        assert "links" in run_curl(lines["curl"], tmp_path / "submit", token)[""]
        page.get_by_role("link", name="Sweeps").first.click()
        expect(page.get_by_role("table", name="Sweeps").locator("tbody tr")).to_have_count(1)
        assert "sweeps" in run_curl(shown_lines(page)["curl"], tmp_path / "list", token)[""]
        page.close()
    finally:
        service.stop()
    troubles[:] = [text for text in troubles if "status of 401" not in text]


def test_statistics_carry_the_bias_where_the_window_is_the_usual_one(opened: Opens, client: Client) -> None:
    changes = SHORT | {"recording.orbit_window": None}
    verified = client.submit("paper-200m", set=changes, axes={"flow_rate": [0.01]}, verify=1).wait(timeout=180.0)
    bias = float(verified.verification()["bias_orbit_radius_rms_10"][0])
    page = opened(f"#/sweeps/{verified.id}/points/1?view=motion")
    size = page.locator("dt", has_text="Orbit size (rms").locator("xpath=following-sibling::dd[1]")
    expect(size).to_contain_text(f"(bias {said(bias)})")
    # It is the last third of the run, as that of the summary.
    summary = verified.point(1).summary
    assert summary is not None
    value = float(str(size.text_content()).partition(" ")[0])
    assert value == pytest.approx(1e3 * summary["orbit_radius_rms_10"], rel=1e-3)
    page.get_by_role("button", name="Whole run").click()
    expect(size).not_to_contain_text("bias")


def test_profiles_do_not_lie_over_each_other_on_a_phone(opened: Opens, sweep: Sweep) -> None:
    page = opened(f"#/sweeps/{sweep.id}/points/1?view=profiles", viewport={"width": 390, "height": 844})
    picture = drawn(page, "Profiles over measured depth")
    names = ("friction", "damping", "eccentricity", "effective", "torque", "largest")
    ends = sorted((word["left"], word["right"]) for word in written(picture) if word["text"].startswith(names))
    assert len(ends) == 6
    for (_, right), (left, _) in pairwise(ends):
        assert right < left
    # Their place is scrolled, not the page.
    assert page.evaluate("document.documentElement.scrollWidth") <= 390


def test_a_profile_is_read_as_its_picture_says(opened: Opens, sweep: Sweep) -> None:
    page = opened(f"#/sweeps/{sweep.id}/points/1?view=profiles&profiles=effective_tension,normal_force")
    picture = drawn(page, "Profiles over measured depth")
    picture.locator(".area").first.scroll_into_view_if_needed()
    box = picture.locator(".area").first.bounding_box()
    assert box is not None
    labels = picture.locator(".reading")
    reading = page.get_by_role("status").filter(has_text=re.compile("^(At|Point at) "))

    def agrees() -> bool:
        seen = {
            float(text.replace(MINUS, "-"))
            for text in labels.all_text_contents()
            if re.fullmatch(rf"[-{MINUS}\d.]+", text)
        }
        said = re.search(r"effective tension (\S+) kN", str(reading.text_content()))
        return said is not None and any(
            float(said.group(1).replace(MINUS, "-")) == pytest.approx(value, rel=2e-4) for value in seen
        )

    before = [reading.text_content()]
    for part in (0.31, 0.485, 0.62):
        page.mouse.move(box["x"] + 0.5 * box["width"], box["y"] + part * box["height"], steps=3)
        until(page, lambda: reading.text_content() not in before and agrees())
        before.append(reading.text_content())


def test_keys_move_the_depth_cursor_of_profiles(opened: Opens, sweep: Sweep) -> None:
    page = opened(f"#/sweeps/{sweep.id}/points/1?view=profiles&profiles=effective_tension,normal_force")
    picture = drawn(page, "Profiles over measured depth")
    statics, profile = sweep.point(1).statics(), sweep.point(1).profile()
    depths = statics["measured_depth"]
    cursor = page.get_by_role("slider", name="Depth cursor")
    reading = page.get_by_role("status").filter(has_text=re.compile("^(At|Point at) "))
    line = "place => (place.picture.layout.shapes ?? []).map(({ y0, y1 }) => [y0, y1])"

    def stands_at(node: int) -> None:
        depth, force = float(depths[node]), float(statics["normal_force"][node]) / 1e3
        tension = float(profile["effective_tension"][max(0, node - 1)]) / 1e3
        until(page, lambda: picture.evaluate(line) == [pytest.approx([depth, depth], rel=1e-6)])
        words = re.fullmatch(r"At (\S+) m: effective tension (\S+) kN · .*side force (\S+) k?N", reading.inner_text())
        assert words is not None, reading.inner_text()
        assert [float(word.replace(MINUS, "-")) for word in words.groups()[:2]] == pytest.approx(
            [depth, tension], rel=1e-3
        )
        assert float(words.group(3).replace(MINUS, "-")) == pytest.approx(force, rel=1e-3, abs=1e-9)
        expect(cursor).to_have_attribute("aria-valuetext", f"{words.group(1)} m")

    cursor.focus()
    last = len(depths) - 1
    keys = {"ArrowDown": 1, "PageDown": 11, "ArrowUp": 10, "ArrowRight": 11, "PageUp": 1, "End": last, "Home": 0}
    for key, node in keys.items():
        page.keyboard.press(key)
        stands_at(node)
    for _ in range(3):
        page.keyboard.press("PageDown")
    stands_at(30)
    # The link holds where the cursor is, in any unit.
    other = opened(f"#{page.url.partition('#')[2]}")
    copy = drawn(other, "Profiles over measured depth")
    until(other, lambda: len(copy.evaluate(line)) == 1)
    other.get_by_role("button", name="Units: SI. Switch").click()
    in_feet = float(depths[30]) / 0.3048
    until(other, lambda: copy.evaluate(line) == [pytest.approx([in_feet, in_feet], rel=1e-6)])
    # The mouse takes it along, and has a line of its own.
    box = picture.locator(".area").first.bounding_box()
    assert box is not None
    page.mouse.move(box["x"] + 0.5 * box["width"], box["y"] + 0.5 * box["height"], steps=3)
    until(page, lambda: picture.evaluate(line) == [])
    until(page, lambda: float(depths[int(cursor.input_value())]) == pytest.approx(100.0, abs=10.0))


def test_the_string_is_drawn_next_to_profiles_on_their_axis(opened: Opens, sweep: Sweep) -> None:
    page = opened(f"#/sweeps/{sweep.id}/points/1?view=profiles&profiles=effective_tension,torque")
    picture = drawn(page, "Profiles over measured depth")
    words = written(picture)
    bit = next(word for word in words if word["text"] == "bit")
    # It stands between the numbers of the depth, which grow downwards, and the first profile.
    numbers = [word for word in words if word["right"] < bit["left"] and word["text"].isdigit()]
    depths = [float(word["text"]) for word in sorted(numbers, key=lambda word: word["top"])]
    assert len(depths) > 2
    assert depths == sorted(depths)
    assert bit["right"] < min(word["left"] for word in words if "tension" in word["text"])
    bits = "({ picture }) => picture.traces.find(({ name }) => name === 'bit').y"
    assert picture.evaluate(bits)[0] == pytest.approx(sweep.point(1).statics()["measured_depth"][-1], abs=1.0)
    # A zoom along the depth leaves its width.
    width = "({ picture }) => picture.axis('xaxis0').range"
    before = picture.evaluate(width)
    picture.locator(".area").last.scroll_into_view_if_needed()
    drag(page, picture.locator(".area").last, (0.5, 0.3), (0.5, 0.6))
    until(page, lambda: "zoom.profiles=y" in page.url)
    assert picture.evaluate(width) == before
    expect(page.get_by_text(re.compile("At the left the string: drill pipe, .*bit to 200 m"))).to_be_visible()


def test_names_of_bars_of_energy_have_their_numbers_and_room(opened: Opens, sweep: Sweep) -> None:
    page = opened("#/nowhere", viewport={"width": 600, "height": 800})

    def lost(route: Route) -> None:
        """A ledger in which what is stored falls by a little of what the rotation supplies."""
        answer = route.fetch()
        ledger = answer.json()
        ledger["columns"]["stored"] = [-0.01 * value for value in ledger["columns"]["work_rotation"]]
        route.fulfill(response=answer, json=ledger)

    page.route("**/energy?**", lost)
    page.goto(page.url.replace("#/nowhere", f"#/sweeps/{sweep.id}/points/1?view=energy"))
    picture = drawn(page, "Energy by account")
    names = [word for word in written(picture) if re.search(r" .?J$", word["text"])]
    assert len(names) > 5
    for one, other in combinations(names, 2):
        assert one["bottom"] <= other["top"] + 1 or other["bottom"] <= one["top"] + 1, (one, other)
    # Each name is followed by its energy, all of which is seen.
    assert all(re.search(r", [\d.\s]+ .?J$", name["text"]) and name["left"] >= 0 for name in names), names
    areas = picture.evaluate("place => place.querySelector('.area').offsetLeft")
    assert all(name["right"] <= areas for name in names), names


def test_snapshots_are_downloaded_as_csv(opened: Opens, recorded: Sweep) -> None:
    page = opened(f"#/sweeps/{recorded.id}/points/1?view=about")
    row = page.get_by_role("region", name="Downloads").get_by_role("row").filter(has_text="snapshots").first
    with page.expect_download() as download:
        row.get_by_role("link", name="CSV").click()
    assert download.value.suggested_filename.endswith("snapshots.csv")
    assert "normal_force" in download.value.path().read_text()


def test_rotation_of_a_node_says_of_which(opened: Opens, sweep: Sweep) -> None:
    page = opened(f"#/sweeps/{sweep.id}/points/1?view=motion&node=49")
    picture = drawn(page, "Rotation speed and torque of node 49 at 57.73 m")
    expect(page.get_by_role("heading", name="Rotation speed and torque of node 49 at 57.73 m")).to_be_visible()
    right = picture.evaluate("({ picture }) => picture.frame.right")
    ticks = [word["text"] for word in written(picture) if word["left"] > right]
    values = sorted(float(text.replace(MINUS, "-")) for text in ticks if re.match(rf"[{MINUS}\d]", text))
    assert len(values) >= 2
    steps = {round(after - before, 9) for before, after in pairwise(values)}
    assert len(steps) == 1
    assert all(value / step == pytest.approx(round(value / step), abs=1e-6) for value in values for step in steps)


@pytest.mark.parametrize("view", ["point", "compare"])
def test_a_well_that_is_turned_stays_so(opened: Opens, sweep: Sweep, view: str) -> None:
    shown = f"#/sweeps/{sweep.id}/points/1?view=well"
    page = opened(shown if view == "point" else f"#/compare?points={sweep.id}:1,{sweep.id}:2&view=well")
    picture = scene(page, "The string at rest")
    section = pixels(picture)
    picture.focus()
    for key in ("ArrowRight", "ArrowUp", "+"):
        page.keyboard.press(key)
    until(page, lambda: "turn=" in page.url)
    turned = pixels(picture)
    assert turned != section
    page.get_by_label("Colour", exact=True).select_option(label="friction coefficient C_f")
    expect(page.locator(".scale")).to_contain_text("friction coefficient")
    picture = scene(page, "The string at rest")
    until(page, lambda: pixels(picture) not in (section, turned))
    other = opened(f"#{page.url.partition('#')[2]}")
    copy = scene(other, "The string at rest")
    until(other, lambda: pixels(copy) == pixels(picture))
    other.get_by_role("button", name="Section").click()
    until(other, lambda: "turn=" not in other.url)


def test_a_well_is_read_and_saved(opened: Opens, sweep: Sweep) -> None:
    page = opened(f"#/sweeps/{sweep.id}/points/1?view=well&colour=effective_tension")
    picture = scene(page, "The string at rest")
    picture.scroll_into_view_if_needed()
    box = picture.bounding_box()
    assert box is not None
    reading = page.get_by_role("status", name="The place that the mouse is at")
    for step in range(200):
        page.mouse.move(box["x"] + box["width"] / 2, box["y"] + (step + 0.5) / 200 * box["height"])
        taken(page)
        if reading.text_content():
            break
    expect(reading).to_have_text(re.compile(r"^[\d.]+ m measured depth · effective tension \S+ kN$"))
    numbers = re.findall(rf"[{MINUS}-]?[\d.]+", str(reading.text_content()))
    depth, tension = (float(text.replace(MINUS, "-")) for text in numbers)
    statics = sweep.point(1).statics()
    node = int(np.argmin(np.abs(np.array(statics["measured_depth"]) - depth)))
    elements = np.array(sweep.point(1).profile()["effective_tension"])
    assert 1000 * tension == pytest.approx(np.mean(elements[max(node - 1, 0) : node + 1]), rel=2e-3)
    for format in ("PNG", "SVG"):
        with page.expect_download() as download:
            page.get_by_role("button", name=f"Save the well as {format}").click()
        assert download.value.suggested_filename == f"well.{format.lower()}"
    drawing = download.value.path().read_text()
    assert drawing.startswith("<svg")
    assert "effective tension [kN]" in drawing


def test_the_highest_line_of_a_window_of_the_summary_carries_its_bias(opened: Opens, client: Client) -> None:
    windows = [{"from": 0.0, "to": 0.4}, {"from": 0.1, "to": 0.5}]
    changes = SHORT | {"recording.spectrum_windows": windows}
    verified = client.submit("paper-200m", set=changes, axes={"flow_rate": [0.01]}, verify=1).wait(timeout=180.0)
    bias = float(verified.verification()["bias_line_frequency_hz_49_w2"][0])
    page = opened(f"#/sweeps/{verified.id}/points/1?view=motion&node=49&from=0.1&to=0.5&range=100")
    lines = page.get_by_role("region", name="Lines, scrollable").get_by_role("row")
    expect(lines.filter(has_text="(bias ")).to_have_count(1)
    shown = re.search(r"\(bias (\S+) Hz\)", lines.nth(1).inner_text())
    assert shown
    # To two digits.
    assert float(shown[1].replace("\N{MINUS SIGN}", "-")) == pytest.approx(bias, rel=0.05)
    for window in ("from=0.1&to=0.45", "from=0.1&to=0.5&window=rectangular"):
        page.goto("about:blank")
        page.goto(f"{client.server}/#/sweeps/{verified.id}/points/1?view=motion&node=49&{window}")
        expect(lines.nth(1)).to_be_visible()
        expect(lines.filter(has_text="(bias ")).to_have_count(0)


def test_the_wall_is_named_where_it_is_seen_and_the_axes_by_the_low_side(opened: Opens, sweep: Sweep) -> None:
    page = opened(f"#/sweeps/{sweep.id}/points/1?view=motion&node=49")
    drawn(page, "Orbit of node 49")
    panel = page.locator(".panel", has=page.get_by_role("heading", name="Orbit, looking downhole"))
    expect(panel).to_contain_text("The wall is outside the picture, at least")
    page.get_by_label("Orbit shows").select_option("hole")
    expect(panel).to_contain_text("On the grey circle the node touches the wall.")
    angle = math.degrees(float(sweep.point(1).statics().to_pandas().set_index("node").low_side_angle[49]))
    expected = f"u points {float(f'{abs(angle):.3g}'):g}° " if abs(angle) >= 0.5 else "u points to the low side"
    expect(page.get_by_text(expected)).to_be_visible()


def test_a_legend_hides_lines_and_shows_one_alone(opened: Opens, sweep: Sweep) -> None:
    page = opened(f"#/sweeps/{sweep.id}/points/1?view=energy")
    picture = drawn(page, "Energy over time")
    names = picture.locator(".legend").get_by_role("button")
    shown = (
        "names => names.filter((name) => name.getAttribute('aria-pressed') === 'true').map((name) => name.textContent)"
    )
    everything = names.evaluate_all(shown)
    assert len(everything) > 3
    canvas = picture.locator("canvas.picture")
    whole = pixels(canvas)
    first = names.first
    first.focus()
    page.keyboard.press("Enter")
    assert names.evaluate_all(shown) == everything[1:]
    until(page, lambda: pixels(canvas) != whole)
    expect(first).to_be_focused()
    page.keyboard.press("Enter")
    until(page, lambda: pixels(canvas) == whole)
    page.keyboard.press("Shift+Enter")
    assert names.evaluate_all(shown) == everything[:1]
    first.dblclick()
    assert names.evaluate_all(shown) == everything
    names.nth(2).dblclick()
    assert names.evaluate_all(shown) == everything[2:3]


def test_a_picture_is_moved_and_zoomed_by_its_buttons(opened: Opens, sweep: Sweep) -> None:
    page = opened(f"#/sweeps/{sweep.id}/points/1?view=energy")
    picture = drawn(page, "Energy over time")
    picture.hover()
    read = "({ picture }) => picture.axis('xaxis').range"
    whole = picture.evaluate(read)
    bar = picture.get_by_role("toolbar", name="Picture")
    move = bar.get_by_role("button", name="Move by dragging")
    # One stop of the Tab key leads to all buttons.
    bar.get_by_role("button", name="Zoom by dragging").focus()
    page.keyboard.press("ArrowRight")
    expect(move).to_be_focused()
    page.keyboard.press("Enter")
    expect(move).to_have_attribute("aria-pressed", "true")
    drag(page, picture.locator(".area"), (0.6, 0.5), (0.4, 0.5))
    width = whole[1] - whole[0]
    moved = pytest.approx([end + 0.2 * width for end in whole], abs=0.01 * width)
    until(page, lambda: picture.evaluate(read) == moved)
    until(page, lambda: "zoom.curves=" in page.url)
    bar.get_by_role("button", name="Reset axes").click()
    until(page, lambda: picture.evaluate(read) == whole and "zoom" not in page.url)
    bar.get_by_role("button", name="Zoom in").click()
    half = pytest.approx([whole[0] + width / 4, whole[1] - width / 4])
    until(page, lambda: picture.evaluate(read) == half)
    bar.get_by_role("button", name="Zoom out").click()
    until(page, lambda: picture.evaluate(read) == pytest.approx(whole))
    # The numbers of an axis are dragged, too.
    drag(page, picture.locator(".strip[data-axis=x]"), (0.6, 0.5), (0.4, 0.5))
    until(page, lambda: picture.evaluate(read) == moved)
    picture.locator(".strip[data-axis=x]").dblclick()
    until(page, lambda: picture.evaluate(read) == whole)


def test_energies_are_sorted_bars_on_a_logarithmic_scale(opened: Opens, sweep: Sweep) -> None:
    page = opened(f"#/sweeps/{sweep.id}/points/1?view=energy")
    picture = drawn(page, "Energy by account")
    names = picture.evaluate("place => place.picture.axis('yaxis').words")
    assert picture.evaluate("place => place.picture.axis('xaxis').isLog")
    table = sweep.point(1).energy().to_pandas()
    # The top of this string is held, its torque on bit is constant, and nothing but its unbalance shakes it.
    hidden = ["time", "residual", "contact_work", "radiated_top", "work_bit", "work_excitation", "work_drive"]
    sizes = (table.iloc[-1] - table.iloc[0]).abs().drop(hidden, errors="ignore")
    sizes = sizes.sort_values(ascending=False)
    words = {"work_rotation": "work of the rotation", "dissipated_friction": "dissipated by friction"}
    assert [words[name] for name in sizes.index if name in words] == [
        name.partition(",")[0] for name in reversed(names) if name.partition(",")[0] in words.values()
    ]
    assert len(names) == len(sizes)
    ends = [
        (name, end)
        for number in range(3)
        for name, end in picture.evaluate(
            "({ picture: { traces } }, number) => traces[number].y.map((name, at) => [name, traces[number].x[at]])"
            ".filter((_, at) => at % 3 === 1)",
            number,
        )
    ]
    rotation = next(end for name, end in ends if name.startswith("work of the rotation"))
    assert rotation == pytest.approx(sizes["work_rotation"])


def test_a_full_spectrum_goes_as_far_as_is_chosen(opened: Opens, sweep: Sweep) -> None:
    page = opened(f"#/sweeps/{sweep.id}/points/1?view=motion&node=49")
    last = "place => Math.max(...place.picture.traces[0].x)"
    picture = drawn(page, "Full spectrum of node 49")
    assert 15.0 < picture.evaluate(last) <= 20.0
    with page.expect_request(re.compile(r"/modes\?to_hz=50$")):
        page.get_by_label("Frequencies up to").select_option("100")
    until(page, lambda: 90.0 < picture.evaluate(last) <= 100.0)
    assert "range=100" in page.url
    lines = shown_lines(page)
    assert "range_hz=100" in lines["curl"]
    assert "range_hz=100" in lines["Python"]


@pytest.mark.parametrize("choices", ["&node=10", "&node=49&from=0.2&to=0.4&range=50&window=rectangular"])
def test_a_motion_is_asked_for_before_its_module_is_there_and_once(opened: Opens, sweep: Sweep, choices: str) -> None:
    page = opened("#/nowhere")
    asked: list[str] = []
    held: list[Route] = []
    page.on("request", lambda request: asked.append(request.url.partition("/points/1/")[2]))
    page.route("**/point/motion.js", lambda route: held.append(route))
    address = page.url.replace("#/nowhere", f"#/sweeps/{sweep.id}/points/1?view=motion{choices}")
    page.goto("about:blank")
    page.goto(address, wait_until="commit")
    names = ["orbit", "orbit", "spectrum", "statics", "statistics"]

    def tables() -> list[str]:
        return sorted(url for url in asked if url.partition("?")[0] in names)

    until(page, lambda: [url.partition("?")[0] for url in tables()] == names)
    ahead = tables()
    is_other = "range" in choices
    assert [("range_hz=50" in url, "from=0.2" in url) for url in ahead if "spectrum" in url] == [(is_other,) * 2]
    for route in held:
        route.continue_()
    drawn(page, "Orbit of node")
    drawn(page, "Full spectrum of node")
    # The overview shows the same tables.
    expect(page.get_by_role("img", name="Full spectrum")).to_be_visible()
    assert tables() == ahead


def test_a_string_in_motion_is_requested_before_its_modules_and_needs_little(opened: Opens, recorded: Sweep) -> None:
    page = opened("#/nowhere")
    asked: list[str] = []
    held: list[Route] = []
    page.on("request", lambda request: asked.append(request.url.partition("/points/1/")[2]))
    page.route("**/point/string.js", lambda route: held.append(route))
    address = page.url.replace("#/nowhere", f"#/sweeps/{recorded.id}/points/1?view=string")
    page.goto("about:blank")
    page.goto(address, wait_until="commit")

    def tables() -> list[str]:
        return sorted(url for url in asked if url.startswith(("statics", "snapshots")) and "npz" not in url)

    until(page, lambda: len(tables()) == 3)
    ahead = tables()
    for route in held:
        route.continue_()
    expect(page.locator("canvas.scene[data-drawn]")).to_be_visible()
    # An answer is kept for 3 s, so that a slow machine requests the same again: never another table, nor a whole one.
    assert set(ahead) <= set(tables())
    assert all("fields=" in url or "node=1" in url for url in tables())


def test_multiples_of_the_highest_line_are_told_as_such(opened: Opens, sweep: Sweep) -> None:
    page = opened("#/nowhere")

    def harmonics(route: Route) -> None:
        """A spectrum whose lines are at 2.16 Hz and twice that."""
        answer = route.fetch()
        spectrum = answer.json()
        spectrum["attributes"]["resolution"] = 0.05
        spectrum["attributes"]["peaks"] = [
            {"frequency": frequency, "amplitude": amplitude, "whirl": "forward", "is_resolved": True}
            for frequency, amplitude in ((2.16, 0.002), (4.32, 0.001), (5.0, 0.0005))
        ]
        route.fulfill(response=answer, json=spectrum)

    page.route("**/spectrum?**", harmonics)
    page.goto(page.url.replace("#/nowhere", f"#/sweeps/{sweep.id}/points/1?view=motion"))
    rows = page.get_by_role("region", name="Lines, scrollable").get_by_role("row")
    expect(rows).to_have_count(4)
    marks = trace(drawn(page, "Full spectrum of node"), 1)
    assert [marks["x"], marks["y"]] == [[2.16, 4.32, 5.0], pytest.approx([2.0, 1.0, 0.5])]
    causes = [rows.nth(number).get_by_role("cell").nth(3) for number in (1, 2, 3)]
    expect(causes[1]).to_have_text("2 \N{MULTIPLICATION SIGN} 2.16 Hz")
    # Once the modes are found.
    expect(causes[0]).to_have_text(re.compile("mode|no cause"), timeout=60_000)
    expect(causes[2]).not_to_contain_text("\N{MULTIPLICATION SIGN}")


def test_the_link_holds_the_time_and_the_view_of_the_string(opened: Opens, recorded: Sweep) -> None:
    page = opened(f"#/sweeps/{recorded.id}/points/1?view=string&exaggerate=300")
    picture = scene(page)
    drawn(page, "Rotation speed and torque")
    page.get_by_label("Time", exact=True).fill("0.25")
    picture.focus()
    for key in ("ArrowLeft", "ArrowUp", "ArrowUp", "+"):
        page.keyboard.press(key)
    until(page, lambda: {"time", "turn"} <= set(parse_qs(page.url.partition("?")[2])))
    expected = pixels(picture)
    other = opened(f"#{page.url.partition('#')[2]}")
    again = scene(other)
    drawn(other, "Rotation speed and torque")
    until(other, lambda: pixels(again) == expected)
    assert clock(other) == clock(page) == pytest.approx(0.25)
    # The usual view, a section, is no part of the link.
    page.keyboard.press("Home")
    until(page, lambda: "turn=" not in page.url)
    section = pixels(picture)
    assert section != expected
    views = {section}
    for name in ("Plan", "Free view"):
        page.get_by_role("button", name=name).click()
        until(page, lambda: "turn=" in page.url and pixels(picture) not in views)
        views.add(pixels(picture))
    page.get_by_role("button", name="Section").click()
    until(page, lambda: "turn=" not in page.url and pixels(picture) == section)


def test_the_string_is_saved_as_it_is_shown(opened: Opens, recorded: Sweep) -> None:
    page = opened(f"#/sweeps/{recorded.id}/points/1?view=string&colour=torque&time=0.2")
    picture = scene(page)
    drawn(page, "Rotation speed and torque")
    saved = {}
    for format in ("PNG", "SVG"):
        with page.expect_download() as download:
            page.get_by_role("button", name=f"Save the string as {format}").click()
        assert download.value.suggested_filename == f"string-in-motion-0.20-s.{format.lower()}"
        saved[format] = download.value.path().read_bytes()
    assert saved["PNG"].startswith(b"\x89PNG\r\n")
    width = int.from_bytes(saved["PNG"][16:20], "big")
    assert width == 2 * int(picture.evaluate("canvas => canvas.clientWidth"))
    drawing = saved["SVG"].decode()
    assert drawing.startswith("<svg")
    assert "torque [kN·m]" in drawing
    # Marks of measured depth.
    assert set(re.findall(r">([\d.]+ m)</text>", drawing)) >= {"50 m", "100 m", "150 m", "200 m"}
    assert "0.20 s" in drawing
    # A stroke for each element of the string, whose colours differ.
    assert len(set(re.findall(r'stroke="(rgb[^"]+)"', drawing))) > 10


def test_without_snapshots_rotation_is_drawn_from_the_history_of_the_bit(
    opened: Opens, ends: Sweep, sweep: Sweep, untwisted: Sweep, tmp_path: Path
) -> None:
    page = opened(f"#/sweeps/{ends.id}/points/1?view=string")
    picture = drawn(page, "Rotation speed and torque at bit and top")
    expect(page.get_by_text(re.compile("its motion and the map of its contacts .* need them"))).to_be_visible()
    expect(page.get_by_text(re.compile("^From the recorded history"))).to_be_visible()
    history = ends.point(1).history(node=297)
    shown = [trace(picture, number)["y"] for number in range(4)]
    assert shown[0] == pytest.approx(list(history["rotation_speed_297"]))
    assert shown[1] == pytest.approx([force / 1e3 for force in history["torque_297"]])
    expected = {f"history_{node}": ["time", f"rotation_speed_{node}", f"torque_{node}"] for node in (1, 297)}
    assert_lines_run(page, expected, tmp_path / "curl")
    # Those of the bit are recorded whichever nodes are.
    page = opened(f"#/sweeps/{sweep.id}/points/1?view=string")
    assert len(drawn(page, "Rotation speed and torque at bit and top").evaluate("place => place.picture.traces")) == 2
    expect(page.get_by_text("The top was not recorded.")).to_be_visible()
    page = opened(f"#/sweeps/{untwisted.id}/points/1?view=string")
    expect(page.get_by_text("are not in this result: torsion was not solved for")).to_be_visible()


def test_an_answer_of_another_node_that_comes_late_is_not_shown(opened: Opens, sweep: Sweep) -> None:
    page = opened("#/nowhere")
    held: list[Route] = []
    page.route("**/history?*node=49&*", lambda route: held.append(route))
    page.goto(page.url.replace("#/nowhere", f"#/sweeps/{sweep.id}/points/1?view=motion&node=49"))
    drawn(page, "Orbit of node 49")
    until(page, lambda: len(held) == 1)
    page.get_by_label("Node", exact=True).select_option("10")
    picture = drawn(page, "Rotation speed and torque of node 10")
    shown = picture.evaluate("place => [...place.picture.traces[0].y]")
    with page.expect_response("**/history?*node=49&*"):
        held[0].continue_()
    taken(page)
    expect(page.get_by_role("heading", name="Rotation speed and torque of node")).to_contain_text("node 10 ")
    assert picture.evaluate("place => [...place.picture.traces[0].y]") == shown


def test_a_node_that_cannot_be_shown_leaves_the_others(opened: Opens, sweep: Sweep, troubles: list[str]) -> None:
    page = opened("#/nowhere")
    page.route("**/orbit?*node=49&*", lambda route: route.fulfill(status=503, json={"title": "Busy", "detail": "busy"}))
    page.goto(page.url.replace("#/nowhere", f"#/sweeps/{sweep.id}/points/1?view=motion&node=49"))
    expect(page.get_by_role("alert").filter(has_text="busy").first).to_be_visible()
    page.get_by_label("Node", exact=True).select_option("10")
    drawn(page, "Orbit of node 10")
    drawn(page, "History of node 10")
    expect(page.get_by_role("alert").filter(has_text="busy")).to_have_count(0)
    # The browser writes of every answer that refuses.
    troubles[:] = [text for text in troubles if "status of 503" not in text]


def test_a_window_that_is_not_waited_for_is_no_error(opened: Opens, sweep: Sweep) -> None:
    page = opened(f"#/sweeps/{sweep.id}/points/1?view=motion")
    drawn(page, "Orbit of node")
    held: list[Route] = []
    page.route("**/spectrum?**", lambda route: held.append(route))
    page.get_by_label("Frequencies up to").select_option("100")
    until(page, lambda: len(held) == 1)
    page.get_by_role("link", name="Energy", exact=True).click()
    drawn(page, "Energy by account")
