"""The views of a point's motion in a real browser: the string in its hole, contacts over time, the spectrogram."""

from __future__ import annotations

import contextlib
import json
import re
from typing import Literal
from urllib.parse import parse_qs

import numpy as np
import pytest
from playwright.sync_api import Error, Route, expect

from browsing import MINUS, Opens, clock, drawn, pixels, requested, scene, trace, until
from drillsweep import Client, Sweep
from service import SHORT


@pytest.mark.parametrize("theme", ["light", "dark"])
def test_the_string_moves_is_stopped_and_is_shown_at_any_time(
    opened: Opens, recorded: Sweep, theme: Literal["light", "dark"]
) -> None:
    page = opened(f"#/sweeps/{recorded.id}/points/1?view=string&exaggerate=300&speed=0.1", color_scheme=theme)
    picture = scene(page)
    # With everything in its place nothing changes the size of the picture.
    drawn(page, "Contact force")
    drawn(page, "Rotation speed and torque")
    assert clock(page) == pytest.approx(0.01)
    at_first = pixels(picture)
    page.get_by_role("button", name="Play").click()
    until(page, lambda: clock(page) > 0.05)
    # The keyboard stops it where the picture has the focus.
    picture.focus()
    page.keyboard.press("Space")
    expect(page.get_by_role("button", name="Play")).to_be_visible()
    stopped, then = clock(page), pixels(picture)
    assert then != at_first
    page.wait_for_timeout(100)
    assert (clock(page), pixels(picture)) == (stopped, then)
    # Back where it was, it looks as it did.
    page.get_by_label("Time", exact=True).fill("0.01")
    assert clock(page) == pytest.approx(0.01)
    until(page, lambda: pixels(picture) == at_first)
    page.keyboard.press("End")
    assert clock(page) == pytest.approx(0.49, abs=0.011)
    picture.focus()
    turned = pixels(picture)
    page.keyboard.press("ArrowLeft")
    until(page, lambda: pixels(picture) != turned)


def test_the_string_is_coloured_by_what_is_chosen_in_the_units_shown(opened: Opens, recorded: Sweep) -> None:
    page = opened(f"#/sweeps/{recorded.id}/points/1?view=string")
    picture = scene(page)
    seen = {pixels(picture)}
    for name, unit in [
        ("whirl amplitude", "mm"),
        ("distance from the axis", "mm"),
        ("friction coefficient C_f", ""),
        ("effective tension", "kN"),
        ("rotation speed", "rad/s"),
        ("torque", "kN·m"),
    ]:
        page.get_by_label("Colour", exact=True).select_option(label=name)
        expect(page.locator(".scale")).to_contain_text(f"{name} [{unit}]" if unit else name)
        until(page, lambda: pixels(picture) not in seen)
        seen.add(pixels(picture))
    page.get_by_label("Colour", exact=True).select_option(label="whirl amplitude")
    snapshots = recorded.point(1).snapshots(fields=["u", "v"])
    place = (snapshots["u"] + 1j * snapshots["v"]).reshape(-1, snapshots.attributes["nodes"])
    most = 1e3 * np.sqrt(np.mean(np.abs(place - place.mean(axis=0)) ** 2, axis=0)).max()
    expect(page.locator(".scale .number").last).to_have_text(re.compile(f"^{float(f'{most:.3g}'):g}$"))
    # A stretch of depth fills the picture.
    whole = pixels(picture)
    page.get_by_label("From depth [m]").fill("150")
    page.get_by_label("From depth [m]").blur()
    until(page, lambda: pixels(picture) != whole)
    assert "top=150" in page.url


def test_contacts_rotation_and_torque_are_those_of_the_service(opened: Opens, recorded: Sweep) -> None:
    page = opened(f"#/sweeps/{recorded.id}/points/1?view=string")
    scene(page)
    snapshots = recorded.point(1).snapshots()
    nodes = snapshots.attributes["nodes"]
    contacts = drawn(page, "Contact force over depth and time")
    shown = trace(contacts, 0)
    force = snapshots["normal_force"].reshape(-1, nodes)
    # In kilonewtons, over depth and time.
    np.testing.assert_allclose(np.array(shown["z"]), force.T / 1e3, rtol=1e-6)
    np.testing.assert_allclose(shown["x"], snapshots["time"][::nodes], atol=1e-9)
    np.testing.assert_allclose(shown["y"], recorded.point(1).statics()["measured_depth"])
    turning = drawn(page, "Rotation speed and torque at bit and top")
    shown = {name: trace(turning, number)["y"] for number, name in enumerate(turning.evaluate(NAMES))}
    # The history has the bit, with more samples than the snapshots, which have the top.
    expect(page.get_by_text("The bit is from the recorded history, the top from the snapshots.")).to_be_visible()
    history = recorded.point(1).history(node=297, time=(0.01, 0.5))
    assert len(history["time"]) > 5 * snapshots.attributes["snapshots"]
    np.testing.assert_allclose(shown["speed, bit"], history["rotation_speed_297"], rtol=1e-6)
    np.testing.assert_allclose(shown["torque, bit"], history["torque_297"] / 1e3, rtol=1e-6)
    speed, torque = (snapshots[name].reshape(-1, nodes)[:, 0] for name in ("rotation_speed", "torque"))
    np.testing.assert_allclose(shown["speed, top"], speed, rtol=1e-6)
    np.testing.assert_allclose(shown["torque, top"], torque / 1e3, rtol=1e-6)
    # The top turns as it is told to.
    np.testing.assert_allclose(speed, 120.0 * np.pi / 30, rtol=1e-6)


NAMES = "place => place.picture.traces.map(({ name }) => name)"


@pytest.mark.parametrize("theme", ["light", "dark"])
def test_a_spectrogram_is_drawn_of_the_node_that_is_chosen(
    opened: Opens, recorded: Sweep, theme: Literal["light", "dark"]
) -> None:
    page = opened(f"#/sweeps/{recorded.id}/points/1?view=spectrogram&node=49&range=50", color_scheme=theme)
    picture = drawn(page, "Spectrogram of node 49")
    expect(page.get_by_text(re.compile("Node 49 at 57.73 m"))).to_be_visible()
    table = recorded.point(1).spectrogram(node=49, range_hz=50)
    shown = trace(picture, 0)
    frequency = np.array(shown["y"])
    away = np.abs(frequency) >= 2.5 * table.attributes["resolution"]
    amplitude = table["amplitude"].reshape(table.attributes["windows"], -1).T
    levels = np.array([row for row, is_kept in zip(shown["z"], away, strict=True) if is_kept], dtype=float)
    # Their logarithms, in millimetres.
    np.testing.assert_allclose(10**levels, 1e3 * amplitude[away], rtol=1e-6)
    page.get_by_label("Node", exact=True).select_option("10")
    drawn(page, "Spectrogram of node 10")


def test_a_point_without_snapshots_says_what_to_ask_for(opened: Opens, sweep: Sweep) -> None:
    page = opened(f"#/sweeps/{sweep.id}/points/1?view=string")
    expect(page.get_by_text('"recording.snapshots": {"rate_hz":25}')).to_be_visible()
    page.get_by_role("link", name="Compute this point with snapshots").click()
    expect(page.get_by_role("button", name="Submit 1 point")).to_be_enabled()
    scenario = json.loads(page.get_by_label("Scenario as JSON").input_value())
    assert scenario["recording"]["snapshots"] == {"rate_hz": 25}


def test_motion_is_enlarged_apart_from_sag_and_a_stripe_shows_the_rotation(opened: Opens, recorded: Sweep) -> None:
    page = opened(f"#/sweeps/{recorded.id}/points/1?view=string&time=0.25")
    picture = scene(page)
    enlarged = page.get_by_label("Motion about the mean")
    expect(enlarged.locator("option:checked")).to_have_text(re.compile(r"as it suits, \d+ times more"))
    suited = int(re.findall(r"\d+", enlarged.locator("option:checked").inner_text())[0])
    assert suited > 1
    usual = pixels(picture)
    enlarged.select_option(str(suited))
    assert pixels(picture) == usual
    enlarged.select_option("1")
    until(page, lambda: pixels(picture) != usual)
    # The string at rest and the hole stay; a choice is kept in the link.
    assert "motion=1" in page.url
    plain = pixels(picture)
    page.get_by_label("Stripe").uncheck()
    until(page, lambda: pixels(picture) != plain)
    assert "stripe=no" in page.url


def test_snapshots_are_a_change_of_a_new_sweep(opened: Opens, troubles: list[str]) -> None:
    page = opened("#/new?preset=paper-200m")
    plan = page.locator("dt", has_text="Storage").locator("xpath=following-sibling::dd[1]")
    expect(plan).to_be_visible()
    without = plan.text_content()
    tick = page.get_by_role("checkbox", name=re.compile("Keep the string in motion"))
    expect(page.locator("label", has=tick)).to_contain_text(re.compile(r"about \S+ MB a point"))
    before = page.locator("label", has=tick).inner_text()
    tick.check()
    until(page, lambda: plan.text_content() != without)
    assert requested(page)["set"] == {"recording.snapshots": {"rate_hz": 25}}
    expect(page.get_by_role("button", name=re.compile(r"Submit \d+ points"))).to_be_enabled()
    # The size that was estimated is the planned one.
    assert page.locator("label", has=tick).inner_text() == before
    rate = page.get_by_label("Snapshots a second")
    rate.fill("30")
    rate.blur()
    expect(page.get_by_text("a whole part of recording.rate_hz")).to_be_visible()
    expect(page.get_by_role("button", name="Submit")).to_be_disabled()
    # The browser writes of every answer that refuses.
    troubles[:] = [text for text in troubles if "status of 422" not in text]


def test_a_phone_shows_the_string_without_sideways_scrolling(opened: Opens, recorded: Sweep) -> None:
    for view in ("string", "spectrogram"):
        page = opened(f"#/sweeps/{recorded.id}/points/1?view={view}", viewport={"width": 390, "height": 844})
        page.wait_for_load_state("networkidle")
        assert page.evaluate("document.documentElement.scrollWidth") <= 390, view


def test_a_map_of_contacts_is_saved_as_a_picture(opened: Opens, recorded: Sweep) -> None:
    page = opened(f"#/sweeps/{recorded.id}/points/1?view=string")
    picture = drawn(page, "Contact force over")
    saved = {}
    for format in ("PNG", "SVG"):
        with page.expect_download() as download:
            picture.get_by_role("button", name=f"Save as {format}").click()
        assert download.value.suggested_filename.endswith(f".{format.lower()}")
        saved[format] = download.value.path().read_bytes()
    assert saved["PNG"].startswith(b"\x89PNG\r\n")
    drawing = saved["SVG"].decode()
    assert drawing.startswith("<svg")
    # Its cells are there, not only its axes.
    assert "<image" in drawing
    assert "time [s]" in drawing


@pytest.fixture(scope="module")
def lasting(client: Client) -> Sweep:
    """One point with 150 snapshots, of 0 to 5.96 s."""
    changes = SHORT | {"duration": 6, "recording.snapshots": {"rate_hz": 25}}
    return client.submit("paper-200m", set=changes, axes={"flow_rate": [0.01]}, name="lasting").wait(timeout=300.0)


def test_the_string_moves_before_all_snapshots_have_arrived(opened: Opens, server: str, lasting: Sweep) -> None:
    page = opened("#/sweeps")
    held: list[Route] = []
    holds = {"next": False, "others": True}

    def hold(route: Route) -> None:
        if holds["next"]:
            held.append(route)
        else:
            holds["next"] = holds["others"]
            route.continue_()

    def release() -> None:
        holds.update(next=False, others=False)
        while held:
            # One that its view has given up needs no answer.
            with contextlib.suppress(Error):
                held.pop().continue_()

    page.route(re.compile(r"/snapshots\?.*format=npz"), hold)
    point = f"{server}/#/sweeps/{lasting.id}/points/1?view=string&speed=2"
    page.goto(point)
    scene(page)
    slider = page.get_by_label("Time", exact=True)

    def reach() -> float:
        return float(slider.get_attribute("max") or 0)

    assert reach() == pytest.approx(0.28)
    expect(page.get_by_text("up to 6 s on the way")).to_be_visible()
    # It waits at the end of what is there, and goes on as more arrives.
    page.get_by_role("button", name="Play").click()
    until(page, lambda: clock(page) == pytest.approx(0.28))
    expect(page.get_by_role("button", name="Pause")).to_be_visible()
    release()
    until(page, lambda: reach() == pytest.approx(5.96))
    until(page, lambda: clock(page) == pytest.approx(5.96))
    expect(page.get_by_text("on the way")).to_have_count(0)
    expect(page.get_by_text("150 snapshots, 0.04 s apart")).to_be_visible()
    drawn(page, "Contact force")
    # A time of the link is shown once it is there.
    holds.update(others=True)
    page.goto(f"{point}&time=4&colour=torque")
    scene(page)
    expect(page.get_by_text("on the way")).to_be_visible()
    assert clock(page) == pytest.approx(0.0)
    release()
    until(page, lambda: clock(page) == pytest.approx(4.0))
    expect(page.locator(".scale")).to_contain_text("torque")
    assert "time=4" in page.url


def test_one_time_cursor_moves_all_views_of_a_point(opened: Opens, recorded: Sweep) -> None:
    page = opened(f"#/sweeps/{recorded.id}/points/1?view=string")
    picture = scene(page)
    contacts = drawn(page, "Contact force over depth and time")
    turning = drawn(page, "Rotation speed and torque at bit and top")
    lines = {name: page.get_by_role("slider", name=f"Time cursor: {name}") for name in ("Contact", "Rotation")}
    assert "time=" not in page.url

    def times() -> list[float]:
        moved = [line.get_attribute("aria-valuenow") for line in lines.values()]
        return [clock(page), *(float(value or 0) for value in moved)]

    def at(expected: float, tolerance: float = 1e-9) -> bool:
        return all(abs(time - expected) <= tolerance + 0.005 for time in times())

    # The player's slider takes the lines along.
    page.get_by_label("Time", exact=True).fill("0.3")
    until(page, lambda: at(0.3))
    until(page, lambda: "time=0.3" in page.url)
    then = pixels(picture)
    # A line that is dragged takes the player along, and the values at its time are said.
    turning.scroll_into_view_if_needed()
    box = turning.locator(".area").first.bounding_box()
    start = lines["Rotation"].bounding_box()
    assert box is not None
    assert start is not None
    page.mouse.move(start["x"] + start["width"] / 2, start["y"] + start["height"] / 2)
    page.mouse.down()
    page.mouse.move(box["x"] + 0.25 * box["width"], box["y"] + 20, steps=4)
    page.mouse.up()
    until(page, lambda: at(0.13, 0.02))
    until(page, lambda: pixels(picture) != then)
    read = re.compile(rf"^At 0\.1\d* s: speed, bit {MINUS}?[\d.]+ rad/s · torque, bit")
    expect(page.get_by_text(read)).to_be_visible()
    # Arrow keys move it by small steps.
    before = clock(page)
    lines["Contact"].focus()
    page.keyboard.press("PageUp")
    until(page, lambda: clock(page) > before)
    until(page, lambda: at(clock(page)))
    # So does a click in a picture over time.
    contacts.scroll_into_view_if_needed()
    area = contacts.locator(".area").first.bounding_box()
    assert area is not None
    page.mouse.click(area["x"] + 0.8 * area["width"], area["y"] + 0.5 * area["height"])
    until(page, lambda: at(0.4, 0.02))
    chosen = clock(page)
    until(page, lambda: abs(float(parse_qs(page.url.partition("?")[2])["time"][0]) - chosen) < 0.006)
    # Another view of the point is at the same time, with a dot on the orbit.
    page.get_by_role("link", name="Orbit, history, spectrum").click()
    orbit = drawn(page, "Orbit of node")
    history = page.get_by_role("slider", name="Time cursor: History of node")
    until(page, lambda: abs(float(history.get_attribute("aria-valuenow") or 0) - chosen) < 0.006)
    expect(orbit.locator(".time-dots i")).to_have_count(1)
    place = orbit.locator(".time-dots i").bounding_box()
    history.focus()
    page.keyboard.press("PageDown")
    until(page, lambda: orbit.locator(".time-dots i").bounding_box() != place)
    page.keyboard.press("Home")
    until(page, lambda: re.search(r"time=0(&|$)", page.url) is not None)
    page.get_by_role("link", name="Spectrogram").click()
    drawn(page, "Spectrogram of node")
    spectrogram = page.get_by_role("slider", name="Time cursor: Spectrogram")
    expect(spectrogram).to_have_attribute("aria-valuetext", "0 s")


def test_compared_points_are_read_at_one_time(opened: Opens, sweep: Sweep) -> None:
    points = f"{sweep.id}:1,{sweep.id}:2"
    page = opened(f"#/compare?points={points}&view=history&time=0.3")
    drawn(page, "Histories")
    line = page.get_by_role("slider", name="Time cursor: Histories")
    expect(line).to_have_attribute("aria-valuenow", "0.3")
    expect(page.get_by_text(re.compile(r"^At 0\.3 s: \S.* mm · \S.* mm"))).to_be_visible()
    line.focus()
    page.keyboard.press("PageUp")
    until(page, lambda: "time=0.32" in page.url)
    page.get_by_role("link", name="Orbits").click()
    expect(drawn(page, "Orbits").locator(".time-dots i")).to_have_count(2)


def test_a_tab_that_is_held_down_while_the_link_takes_the_time_opens(opened: Opens, sweep: Sweep) -> None:
    points = f"{sweep.id}:1,{sweep.id}:2"
    for view, name, tab, other in [
        (f"compare?points={points}&view=history&time=0.3", "Histories", "Orbits", "view=orbit"),
        (f"sweeps/{sweep.id}/points/1?view=motion&time=0.3", "History of node", "Spectrogram", "view=spectrogram"),
        (f"sweeps/{sweep.id}/points/1?view=motion&time=0.3", "History of node", "Next →", "points/2"),
    ]:
        page = opened(f"#/{view}")
        drawn(page, name)
        page.get_by_role("link", name=tab, exact=True).hover()
        page.mouse.down()
        page.get_by_role("slider", name=f"Time cursor: {name}").dispatch_event("keydown", {"key": "PageUp"})
        expect(page).not_to_have_url(re.compile(r"time=0\.3(&|$)"))
        page.mouse.up()
        expect(page).to_have_url(re.compile(re.escape(other)))
        assert "time=0.3" in page.url


def test_a_view_opened_at_once_after_a_move_of_the_time_cursor_begins_at_its_time(
    opened: Opens, recorded: Sweep
) -> None:
    page = opened(f"#/sweeps/{recorded.id}/points/1?view=motion&time=0.3")
    drawn(page, "History of node")
    page.get_by_role("slider", name="Time cursor: History of node").focus()
    # Both are events of one task, so that no time passes between them.
    page.evaluate("""() => {
        document.activeElement.dispatchEvent(new KeyboardEvent("keydown", { key: "Home", bubbles: true }));
        document.querySelector("nav.tabs [data-view=spectrogram]").click();
    }""")
    drawn(page, "Spectrogram of node")
    assert re.search(r"time=0(\.0\d*)?(&|$)", page.url)
