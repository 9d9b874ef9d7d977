"""The page's list of sweeps, the views of a sweep and the form for a new one, in a real browser over a real server."""

from __future__ import annotations

import contextlib
import csv
import io
import json
import os
import re
import sqlite3
import subprocess
import sys
from collections.abc import Iterator
from pathlib import Path
from typing import Any
from urllib.parse import quote

import pytest
from playwright.sync_api import Page, Route, expect

from browsing import GONE, Opens, drag, drawn, parallel, pixels, requested, scene, taken, until
from drillsweep import Axis, Client, Outputs, Range, Sweep
from service import REPOSITORY, SHORT, Service, binary

PRESETS = REPOSITORY / "scenario" / "presets"
AXES: dict[str, Any] = {"flow_rate": {"values": [0.01, 0.04]}, "mud_density": {"values": [1200, 1500]}}


@pytest.mark.parametrize("name", ["well.toml", "well.json"])
def test_a_scenario_file_becomes_a_sweep(opened: Opens, client: Client, tmp_path: Path, name: str) -> None:
    text = (PRESETS / "paper-200m.toml").read_text(encoding="utf-8")
    file = tmp_path / name
    scenario_of_preset = client.get_json("/v1/scenarios/paper-200m")["scenario"]
    file.write_text(text if name.endswith("toml") else json.dumps(scenario_of_preset), encoding="utf-8")
    page = opened("#/new")
    page.get_by_label("Scenario file").set_input_files(file)
    expect(page.get_by_role("combobox", name="Scenario", exact=True)).to_have_value("")
    expect(page.get_by_role("textbox", name="Scenario as JSON")).to_have_value(re.compile("measured_depth"))
    scenario = page.get_by_role("region", name="Scenario", exact=True)
    scenario.get_by_text("All fields, with units").click()
    scenario.locator("summary", has_text=re.compile("^mud$")).click()
    scenario.get_by_label("yield stress [Pa]").fill("3.5")
    until(page, lambda: page.get_by_role("textbox", name="Value", exact=True).count() == 1)
    page.get_by_label("Kept of each point").select_option("summary")
    submit = page.get_by_role("button", name=re.compile(r"Submit \d+ points"))
    submit.click()
    expect(page.get_by_role("heading", level=1)).to_have_text(re.compile("Sweep"))
    sweep = client.sweep(page.url.rsplit("/", 1)[1])
    sweep.cancel()
    assert sweep.request["set"] == {"mud.yield_stress": 3.5}
    assert sweep.request["scenario"]["mud"] == client.get_json("/v1/scenarios/paper-200m")["scenario"]["mud"]


@pytest.mark.parametrize(
    ("left", "field"),
    [("#/new?preset=paper-200m", "input[maxlength='200']"), ("#/sweeps", "[aria-label='Search names']")],
)
def test_what_is_typed_just_before_a_view_is_left_stays_out_of_the_next_link(
    opened: Opens, named: Sweep, left: str, field: str
) -> None:
    page = opened(left)
    box = page.locator(field)
    expect(box).to_be_visible()
    # The longest rest after which a view keeps what was typed is 400 ms.
    box.evaluate(
        """async (box, next) => {
            box.value = "typed at last";
            box.dispatchEvent(new Event("input", { bubbles: true }));
            location.hash = next;
            await new Promise((resolve) => setTimeout(resolve, 600));
        }""",
        f"#/sweeps/{named.id}",
    )
    expect(page.get_by_role("heading", level=1)).to_have_text(str(named.name))
    assert "typed" not in page.url
    assert "request" not in page.url


def test_field_units_hold_in_the_form_and_the_request_is_in_si_units(opened: Opens) -> None:
    page = opened("#/new?preset=paper-200m")
    page.get_by_role("button", name="Units: SI. Switch").click()
    rows = page.get_by_role("region", name="Parameters")
    flows, densities = (rows.get_by_role("textbox", name="Values").nth(row) for row in (0, 1))
    expect(densities).to_have_value("10.0145:17.5253:4")
    # Values that nobody has touched stay as they were.
    assert requested(page)["axes"]["mud_density"] == {"from": 1200, "to": 2100, "count": 4}
    gallon_a_minute = 231 * 0.0254**3 / 60
    flows.fill("300, 600 gpm, 0.02 m³/s")
    expected = {"values": pytest.approx([300 * gallon_a_minute, 600 * gallon_a_minute, 0.02], rel=1e-14)}
    until(page, lambda: requested(page)["axes"]["flow_rate"] == expected)
    scenario = page.get_by_role("region", name="Scenario", exact=True)
    scenario.get_by_text("All fields, with units").click()
    scenario.locator("summary", has_text=re.compile("^operation$")).click()
    weight = scenario.get_by_label("weight on bit [klbf]")
    weight.fill("20")
    until(page, lambda: "operation.weight_on_bit" in requested(page).get("set", {}))
    assert requested(page)["set"]["operation.weight_on_bit"] == pytest.approx(20e3 * 0.45359237 * 9.80665, rel=1e-14)
    page.get_by_role("button", name="Units: field. Switch").click()
    expect(scenario.get_by_label("weight on bit [N]")).to_have_value("88964.43230521")
    expect(page.get_by_role("button", name="Submit 12 points")).to_be_enabled()


def test_recorded_nodes_and_windows_are_lists(opened: Opens) -> None:
    page = opened("#/new?preset=paper-200m")
    page.get_by_text("Recorded nodes, windows of statistics and spectra").click()
    expect(page.get_by_label("Node 2", exact=True)).to_have_value("49")
    page.get_by_role("button", name="Remove node 1").click()
    page.get_by_role("button", name="Add a node").click()
    box = page.get_by_label("Node 3", exact=True)
    box.fill("120.5")
    box.blur()
    until(
        page, lambda: requested(page).get("set") == {"recording.nodes": [{"node": 49}, {"node": 282}, {"depth": 120.5}]}
    )
    for _ in range(2):
        page.get_by_role("button", name="Remove window 1").click()
    until(page, lambda: requested(page)["set"].get("recording.spectrum_windows") == [])
    # Both are shown as lists alone.
    expect(page.get_by_role("textbox", name="Value", exact=True)).to_have_count(0)
    expect(page.get_by_role("button", name="Submit 12 points")).to_be_enabled()
    for _ in range(2):
        page.get_by_role("button", name="Take back").first.click()
    until(page, lambda: "set" not in requested(page))


def test_presets_stand_in_groups_and_the_button_stays_in_sight(opened: Opens) -> None:
    page = opened("#/new", viewport={"width": 1280, "height": 700})
    select = page.get_by_role("combobox", name="Scenario", exact=True)
    expect(select.locator("optgroup").last).to_have_attribute("label", "Hard cases")
    select.select_option("hard/light-mud")
    expect(page.get_by_role("button", name="Submit")).to_be_in_viewport()


def test_what_is_submitted_is_what_was_planned(opened: Opens) -> None:
    page = opened("#/new?preset=paper-200m")
    submit = page.get_by_role("button", name=re.compile(r"Submit \d+ points"))
    expect(submit).to_be_enabled()
    tags = page.get_by_role("textbox", name="Tags", exact=True)
    typed_then_disabled = """(box) => {
        box.value = "late";
        box.dispatchEvent(new Event("input", { bubbles: true }));
        return document.querySelector("form button[type=submit]").disabled;
    }"""
    assert tags.evaluate(typed_then_disabled)
    expect(submit).to_be_enabled()
    assert requested(page)["tags"] == ["late"]


def test_a_plan_that_comes_while_somebody_types_lets_nothing_be_submitted(opened: Opens) -> None:
    page = opened("#/new?preset=paper-200m")
    submit = page.locator("form button[type=submit]")
    expect(submit).to_be_enabled()
    held: list[Route] = []
    page.route("**/v1/sweeps?dry_run=true", lambda route: held.append(route), times=1)
    tags = page.get_by_role("textbox", name="Tags", exact=True)
    tags.fill("planned")
    until(page, lambda: held != [])
    # The form waits for 400 ms of rest before it plans again.
    tags.evaluate(
        """(box) => {
            const submit = document.querySelector("form button[type=submit]");
            const type = () => box.dispatchEvent(new Event("input", { bubbles: true }));
            type();
            window.typing = setInterval(type, 20);
            window.wasEnabled = false;
            new MutationObserver(() => (window.wasEnabled ||= !submit.disabled)).observe(submit, { attributes: true });
        }"""
    )
    with page.expect_response("**/v1/sweeps?dry_run=true"):
        held[0].continue_()
    taken(page)
    assert not page.evaluate("() => window.wasEnabled")
    page.evaluate("() => clearInterval(window.typing)")
    expect(submit).to_be_enabled()
    assert page.evaluate("() => window.wasEnabled")


def test_a_file_of_a_preset_with_changes_fills_the_form(opened: Opens) -> None:
    page = opened("#/new?preset=paper-200m-damped")
    page.get_by_label("Scenario file").set_input_files(PRESETS / "hard" / "light-mud.toml")
    expect(page.get_by_role("combobox", name="Scenario", exact=True)).to_have_value("paper-200m")
    until(page, lambda: "mud.density" in requested(page).get("set", {}))
    changes = requested(page)["set"]
    assert changes["mud.density"] == 500
    assert list(requested(page)["axes"]) == ["flow_rate"]
    expect(page.get_by_role("button", name=re.compile(r"Submit \d+ points"))).to_be_enabled()
    assert changes["recording.orbit_window"] == {"from": 0, "to": 1}


def test_a_request_that_is_too_long_for_the_link_is_there_again(opened: Opens) -> None:
    page = opened("#/new?preset=paper-200m")
    told = page.get_by_text("too long for the link")
    expect(page.get_by_role("button", name=re.compile(r"Submit \d+ points"))).to_be_enabled()
    expect(told).to_have_count(0)
    page.get_by_role("combobox", name="Scenario", exact=True).select_option("")
    text = page.get_by_label("Scenario as JSON")
    scenario = json.loads(text.input_value())
    scenario["well"]["survey"] = [
        {"measured_depth": 2.0 * station, "inclination_deg": 30.0, "azimuth_deg": 0.0} for station in range(101)
    ]
    text.fill(json.dumps(scenario))
    page.get_by_role("textbox", name="Name", exact=True).fill("too long for a link")
    until(page, lambda: "held=tab" in page.url)
    expect(told).to_be_visible()
    assert "request=" not in page.url
    link = f"#{page.url.partition('#')[2]}"

    def is_there() -> None:
        expect(page.get_by_role("textbox", name="Name", exact=True)).to_have_value("too long for a link")
        assert json.loads(text.input_value()) == scenario
        expect(page.get_by_role("button", name=re.compile(r"Submit \d+ points"))).to_be_enabled()
        expect(told).to_be_visible()

    page.reload()
    is_there()
    page.get_by_role("link", name="Sweeps").first.click()
    expect(page.get_by_role("table", name="Sweeps")).to_be_visible()
    page.go_back()
    is_there()
    page.go_forward()
    expect(page.get_by_role("table", name="Sweeps")).to_be_visible()
    page.go_back()
    is_there()
    # A new sweep is not the one that was begun.
    page.get_by_role("link", name="New sweep").first.click()
    expect(page.get_by_role("textbox", name="Name", exact=True)).to_have_value("")
    # Elsewhere it is said that the link does not hold it.
    other = opened(link)
    expect(other.get_by_text("only the tab in which it was made keeps it")).to_be_visible()


def test_a_file_that_cannot_be_read_says_where(opened: Opens, troubles: list[str], tmp_path: Path) -> None:
    file = tmp_path / "well.toml"
    file.write_text("duration = 1\nname = nonsense\n")
    page = opened("#/new?preset=paper-200m")
    expect(page.get_by_role("button", name=re.compile(r"Submit \d+ points"))).to_be_enabled()
    page.get_by_label("Scenario file").set_input_files(file)
    expect(page.get_by_text("at line 2, column 8")).to_be_visible()
    expect(page.get_by_role("combobox", name="Scenario", exact=True)).to_have_value("paper-200m")
    troubles[:] = [text for text in troubles if "status of 422" not in text]


def test_the_plan_says_what_tables_and_snapshots_take(opened: Opens, client: Client) -> None:
    changes: dict[str, Any] = {"duration": 0.5, "recording.snapshots": {"rate_hz": 25}}
    body = {"preset": "paper-200m", "set": changes}
    page = opened(f"#/new?request={json.dumps(body)}")
    answer = client.plan("paper-200m", set=changes).data["plan"]["footprint"]
    tables, snapshots = (answer[f"{name}_bytes"] / 1000 for name in ("table", "snapshot"))
    plan = page.get_by_role("region", name="Plan")
    said = f"about {tables:.0f} kB before compression, of that {snapshots:.0f} kB of snapshots"
    expect(plan.get_by_text(said)).to_be_visible()


def test_the_preview_shows_the_parameters_that_are_chosen(opened: Opens) -> None:
    axes = {
        "flow_rate": {"values": [0.01, 0.04]},
        "mud_density": {"values": [1200, 1500]},
        "operation.rotation_speed_rpm": {"values": [60, 90, 120]},
    }
    page = opened(f"#/new?request={json.dumps({'preset': 'paper-200m', 'axes': axes})}")
    preview = page.get_by_role("region", name="Preview")
    drawn(page, "Preview")
    preview.get_by_label("Up").select_option("operation.rotation_speed_rpm")
    values = "() => document.querySelector('.plot:has(canvas.picture)').picture.traces[0].y"
    until(page, lambda: sorted(set(page.evaluate(values))) == pytest.approx([60, 90, 120]))


def test_a_survey_is_summed_up_in_the_units_shown(opened: Opens) -> None:
    stations = [{"measured_depth": depth, "inclination_deg": 60, "azimuth_deg": 0} for depth in (0, 304.8)]
    body = {"preset": "paper-200m", "set": {"well.survey": stations}}
    page = opened(f"#/new?request={json.dumps(body)}")
    expect(page.get_by_text("2 stations down to 304.8 m")).to_be_visible()
    page.get_by_role("button", name=re.compile("Units")).click()
    expect(page.get_by_text("2 stations down to 1000 ft")).to_be_visible()


def test_histories_in_part_can_be_dropped_from_a_sweep_like_another(opened: Opens, client: Client) -> None:
    outputs: Outputs = {"orbits": {"nodes": [{"node": 49}]}}
    first = client.submit("paper-200m", set=SHORT, axes={"flow_rate": [0.01, 0.02]}, outputs=outputs)
    page = opened(f"#/new?from={first.id}")
    until(page, lambda: requested(page).get("outputs", {}).get("orbits", {}).get("nodes") == [{"node": 49}])
    page.get_by_label("Kept of each point").select_option("full")
    until(page, lambda: requested(page).get("outputs") == "full")
    page.get_by_label("Kept of each point").select_option("")
    until(page, lambda: "outputs" not in requested(page))


def test_the_selected_sweep_stays_so_when_another_arrives(opened: Opens, client: Client) -> None:
    tag = "selection"
    first, second = (client.submit("paper-200m", set=SHORT, tags=[tag], name=name) for name in ("older", "newer"))
    page = opened(f"#/sweeps?tag={tag}")
    expect(page.get_by_role("table", name="Sweeps").locator("tbody tr")).to_have_count(2)
    selected = page.locator("tr[aria-selected]")
    page.keyboard.press("j")
    expect(selected).to_contain_text("newer")
    client.submit("paper-200m", set=SHORT, tags=[tag], name="newest")
    expect(page.get_by_role("link", name="newest")).to_be_visible()
    expect(selected).to_contain_text("newer")
    page.keyboard.press("k")
    expect(selected).to_contain_text("newest")
    for _ in range(2):
        page.keyboard.press("j")
    expect(selected).to_contain_text("older")
    page.keyboard.press("Enter")
    expect(page.get_by_role("heading", level=1)).to_have_text("older")
    assert page.url.endswith(first.id)
    assert second.id != first.id


def test_next_to_a_selected_sweep_that_is_deleted_its_neighbour_is_selected(opened: Opens, client: Client) -> None:
    tag = "neighbours"
    names = ["last", "middle", "first"]
    sweeps = {name: client.submit("paper-200m", set=SHORT, tags=[tag], name=name).wait(timeout=60.0) for name in names}
    page = opened(f"#/sweeps?tag={tag}")
    expect(page.get_by_role("table", name="Sweeps").locator("tbody tr")).to_have_count(3)
    selected = page.locator("tr[aria-selected]")
    for _ in range(2):
        page.keyboard.press("j")
    expect(selected).to_contain_text("middle")
    sweeps["middle"].delete()
    # The one below, which also has the keyboard.
    expect(selected).to_contain_text("last")
    expect(page.get_by_role("link", name="last")).to_be_focused()
    # Below the last one there is none.
    sweeps["last"].delete()
    expect(selected).to_contain_text("first")
    page.keyboard.press("Enter")
    expect(page.get_by_role("heading", level=1)).to_have_text("first")


def test_the_keyboard_stays_at_a_sweep_whose_row_changes(opened: Opens, client: Client) -> None:
    sweep = client.submit("paper-200m", set=SHORT, tags=["changing"], name="changes", priority=-10)
    page = opened("#/sweeps?tag=changing")
    expect(page.get_by_role("link", name="changes")).to_be_visible()
    page.keyboard.press("j")
    expect(page.get_by_role("link", name="changes")).to_be_focused()
    sweep.change(name="has changed")
    expect(page.get_by_role("link", name="has changed")).to_be_focused()


def test_the_time_left_is_unknown_while_a_sweep_waits(idle: str, opened: Opens) -> None:
    with Client(idle) as client:
        sweep = client.submit("paper-200m", set=SHORT, axes={"flow_rate": [0.01, 0.02]}, name="waits")
    expect(opened("", address=idle).get_by_text("0 of 2 succeeded, time left unknown")).to_be_visible()
    page = opened(f"#/sweeps/{sweep.id}", address=idle)
    expect(page.get_by_text("0 of 2 succeeded, time left unknown")).to_be_visible()


def test_a_sweep_that_has_not_begun_waits_behind_others(idle: str, opened: Opens) -> None:
    with Client(idle) as client:
        first, second = (
            client.submit("paper-200m", set=SHORT, axes={"flow_rate": [0.01, rate]}, name=f"at {rate}")
            for rate in (0.02, 0.03)
        )
        page = opened(f"#/sweeps/{second.id}", address=idle)
        expect(page.locator(".state").first).to_have_text("waiting")
        expect(page.get_by_text("0 of 2 succeeded, behind 1 sweep, time left unknown")).to_be_visible()
        first.cancel()
        expect(page.get_by_text("0 of 2 succeeded, time left unknown")).to_be_visible()


def test_a_state_has_one_colour_on_the_page(opened: Opens, named: Sweep) -> None:
    page = opened(f"#/sweeps/{named.id}?view=map&colour=state")
    picture = drawn(page, "over flow rate")
    of_word = "element => getComputedStyle(element, '::before').color"
    word = page.locator(".state.succeeded, .state.completed").first.evaluate(of_word)
    of_cell = "({ picture }) => { const span = document.createElement('span');"
    of_cell += " span.style.color = picture.traces[0].colorscale[0][1];"
    of_cell += " document.body.append(span); const { color } = getComputedStyle(span); span.remove(); return color; }"
    assert picture.evaluate(of_cell) == word


@pytest.fixture
def other(client: Client) -> Sweep:
    """Two of the points of `named`, at another friction."""
    axes: dict[str, Axis] = {"flow_rate": [0.01, 0.04], "mud_density": [1200]}
    changes = {**SHORT, "operation.rotation_speed_rpm": 90}
    return client.submit("paper-200m", set=changes, axes=axes, name="it's the other").wait(timeout=120.0)


def lines_of(page: Page) -> dict[str, str]:
    """The lines under a view, by language."""
    page.get_by_text("Lines that made this view").click()
    lines = page.locator("details.lines[open]")
    expect(lines.locator("pre")).to_have_count(4)
    names = lines.locator("h2").all_text_contents()
    return dict(zip(names, lines.locator("pre").all_text_contents(), strict=True))


def run(*command: str) -> str:
    """Output of a command, which succeeds."""
    environment = {**os.environ, "PATH": f"{Path(binary()).parent}{os.pathsep}{os.environ['PATH']}"}
    ended = subprocess.run(command, capture_output=True, text=True, timeout=60.0, env=environment, check=False)
    assert ended.returncode == 0, ended.stderr
    return ended.stdout


COLUMNS = {
    "map&colour=friction_coefficient_max": {"friction_coefficient_max"},
    "scatter&x=torque_top&y=contact_count&colour=tension_top": {"torque_top", "contact_count", "tension_top"},
    "parallel&colour=torque_top&beside=contact_count": {"torque_top", "contact_count"},
    "effects&result=contact_count": {"contact_count"},
    "difference&colour=contact_count": {"contact_count"},
    "table&columns=ordinal,contact_count": {"contact_count"},
}


@pytest.mark.parametrize("view", COLUMNS)
def test_the_lines_of_a_view_get_what_it_shows(
    opened: Opens, named: Sweep, other: Sweep, tmp_path: Path, view: str
) -> None:
    is_difference = view.startswith("difference")
    page = opened(f"#/sweeps/{named.id}?view={view}{f'&with={other.id}' if is_difference else ''}")
    if view.startswith("table"):
        expect(page.locator(".rows tbody tr:not(.gap)")).to_have_count(8)
    elif view.startswith("parallel"):
        parallel(page)
    else:
        drawn(page, "." if not view.startswith("effects") else "Shares of the variance")
    lines = lines_of(page)
    tables = run("sh", "-c", lines["curl"]).split("ordinal")[1:]
    assert len(tables) == (2 if is_difference else 1)
    expected = COLUMNS[view]
    for table in tables:
        head, *rows = f"ordinal{table}".strip().splitlines()
        assert expected <= set(head.split(","))
        assert len(rows) == (2 if is_difference and table is tables[1] else 8)
    script = tmp_path / "lines.py"
    names = ["table", "other_table"][: len(tables)]
    check = "\n".join(f"print('COLUMNS', *{name}.columns)" for name in names)
    script.write_text(f"{lines['Python']}\n{check}\n", encoding="utf-8")
    found = [line.split()[1:] for line in run(sys.executable, str(script)).splitlines() if line.startswith("COLUMNS")]
    assert found == [f"ordinal{table}".splitlines()[0].split(",") for table in tables]
    run("sh", "-c", f"cd {tmp_path}; {lines['Command line']}")
    assert (tmp_path / "results").is_dir()
    assert (tmp_path / "other_results").is_dir() == is_difference
    assert lines["MATLAB"].count("webread") == len(tables)


def test_the_lines_of_failures_get_them(opened: Opens, client: Client, tmp_path: Path) -> None:
    # Without its wall the string is buckled by the weight on bit.
    axes = {"flow_rate": [0.01, 0.012]}
    failing = client.submit("paper-200m", set={**SHORT, "effects.contact": "off"}, axes=axes).wait(timeout=120.0)
    page = opened(f"#/sweeps/{failing.id}?view=failures")
    expect(page.get_by_role("link", name="2", exact=True)).to_be_visible()
    lines = lines_of(page)
    rows = list(csv.DictReader(io.StringIO(run("sh", "-c", lines["curl"]))))
    reasons = [error.reason for error in (failing.point(number).error for number in (1, 2)) if error is not None]
    assert [(row["ordinal"], row["state"], row["error"]) for row in rows] == [
        (str(number), "failed", reason) for number, reason in zip((1, 2), reasons, strict=True)
    ]
    printed = run(sys.executable, "-c", f"{lines['Python']}\nprint(*table['error'], sep='\\n')")
    assert printed.splitlines()[-2:] == reasons
    run("sh", "-c", f"cd {tmp_path}; {lines['Command line']}")
    assert (tmp_path / "results").is_dir()
    assert "error_time" in lines["MATLAB"]


NEW: dict[str, dict[str, Any]] = {
    "preset": {
        "preset": "paper-200m",
        "set": {**SHORT, "effects.buoyancy": "off"},
        "axes": {
            "flow_rate": {"from": 0.01, "to": 0.04, "count": 4, "scale": "log"},
            "mud_density": {"values": [1250]},
        },
        "outputs": "summary",
        "name": "it's new",
        "tags": ["a tag"],
        "priority": -10,
    },
    "design": {
        "preset": "paper-200m",
        "set": SHORT,
        "axes": {"flow_rate": {"from": 0.01, "to": 0.04}, "mud_density": {"from": 1200, "to": 1800}},
        "design": "latin_hypercube",
        "samples": 3,
        "seed": 7,
        "outputs": "summary",
    },
}


@pytest.mark.parametrize("form", NEW)
def test_the_lines_of_a_new_sweep_submit_it(idle: str, opened: Opens, form: str) -> None:
    page = opened(f"#/new?request={quote(json.dumps(NEW[form]))}", address=idle)
    expect(page.get_by_role("button", name=re.compile(r"Submit \d+ points"))).to_be_enabled()
    body = requested(page)
    lines = lines_of(page)
    with Client(idle) as client:
        for language, command in [
            ("curl", ["sh", "-c", lines["curl"]]),
            # Nobody computes it here.
            ("Python", [sys.executable, "-c", lines["Python"].replace("sweep.wait()", "")]),
            ("Command line", ["sh", "-c", f"{lines['Command line']} --detach"]),
        ]:
            known = {sweep.id for sweep in client.sweeps()}
            run(*command)
            (made,) = [sweep for sweep in client.sweeps() if sweep.id not in known]
            assert asked_for(made.request) == asked_for(body), language
    assert json.loads(lines["MATLAB"].split("'", 1)[1].rpartition("'")[0].replace("''", "'")) == body


def asked_for(request: dict[str, Any]) -> dict[str, Any]:
    """A request without what is usual anyway, and without who asks."""
    usual = {"design": "grid", "priority": 0, "owner": request.get("owner")}
    named = {name: value for name, value in request.items() if value is not None and usual.get(name) != value}
    axes = {
        path: {name: value for name, value in axis.items() if value is not None and value != "linear"}
        for path, axis in request["axes"].items()
    }
    return {**named, "axes": axes}


def test_the_lines_of_a_finer_grid_add_it(idle: str, opened: Opens) -> None:
    axes: dict[str, Axis] = {"flow_rate": [0.01, 0.04], "mud_density": [1200, 1800]}
    with Client(idle) as client:
        for language in ("curl", "Python"):
            coarse = client.submit("paper-200m", set=SHORT, axes=axes, outputs="summary")
            region = "finer=flow_rate:0.01:0.03:3,mud_density:1200:1200:1"
            page = opened(f"#/sweeps/{coarse.id}?view=map&colour=state&{region}", address=idle)
            panel = page.get_by_role("region", name="Finer grid")
            panel.get_by_text("The same request").click()
            lines = panel.locator("details.lines[open]")
            names = lines.locator("h2").all_text_contents()
            texts = dict(zip(names, lines.locator("pre").all_text_contents(), strict=True))
            run(*(["sh", "-c", texts["curl"]] if language == "curl" else [sys.executable, "-c", texts["Python"]]))
            # Of the three new ones the sweep has one already.
            assert client.sweep(coarse.id).counts.total == 6
            table = coarse.table().to_pandas()
            rates = sorted(table[table["mud_density"] == 1200]["flow_rate"])
            assert rates == pytest.approx([0.01, 0.02, 0.03, 0.04])
            asked = json.loads(texts["MATLAB"].split("'", 1)[1].rpartition("'")[0])
            assert asked == {
                "axes": {"flow_rate": {"from": 0.01, "to": 0.03, "count": 3}, "mud_density": {"values": [1200]}}
            }


def test_the_lines_of_the_list_get_what_it_shows(opened: Opens, other: Sweep) -> None:
    page = opened("#/sweeps?name=it's+the+other&state=completed")
    expect(page.get_by_role("link", name="it's the other").first).to_be_visible()
    lines = lines_of(page)
    listed = json.loads(run("sh", "-c", lines["curl"]))["sweeps"]
    assert other.id in [sweep["id"] for sweep in listed]
    assert {sweep["name"] for sweep in listed} == {"it's the other"}
    printed = run(sys.executable, "-c", lines["Python"])
    assert printed.splitlines()[0].startswith(listed[0]["id"])
    commanded = json.loads(run("sh", "-c", f"{lines['Command line']} --json"))
    assert [sweep["id"] for sweep in commanded["sweeps"]] == [sweep["id"] for sweep in listed]


def test_a_sweep_to_compare_with_is_searched_among_all(opened: Opens, named: Sweep, other: Sweep) -> None:
    page = opened(f"#/sweeps/{named.id}?view=difference&colour=contact_count")
    chooser = page.get_by_role("combobox", name="Compared with")
    expect(chooser).to_be_visible()
    with page.expect_response(lambda answer: "name=the" in answer.url):
        page.get_by_role("searchbox", name="Search sweeps").press_sequentially("the other")
    expect(chooser.locator("option", has_text="it's the other").first).to_be_attached()
    expect(page.get_by_role("searchbox", name="Search sweeps")).to_have_value("the other")
    until(page, lambda: {"— choose a sweep", "it's the other"} == set(chooser.locator("option").all_text_contents()))
    chooser.select_option(other.id)
    drawn(page, "difference of")
    # Whatever is searched, what is chosen is called by its name.
    page.reload()
    expect(chooser.locator("option:checked")).to_have_text("it's the other")


def test_the_link_holds_what_is_brushed_on_parallel_coordinates(opened: Opens, named: Sweep) -> None:
    page = opened(f"#/sweeps/{named.id}?view=parallel&brush=mud_density:1100:1500,flow_rate:0.005:0.02")
    picture = parallel(page)
    expect(picture.locator(".range")).to_have_count(2)
    kept = page.get_by_role("status", name="Points that are kept")
    expect(kept).to_have_text("2 of 8 points are kept.")
    axis = picture.locator(".axis-brush").nth(1)
    drag(page, axis, (0.5, 0.05), (0.5, 0.3))
    until(page, lambda: page.url.count("mud_density") == 2)
    other = opened(f"#{page.url.partition('#')[2]}")
    expect(parallel(other).locator(".range")).to_have_count(3)
    # A filter is moved as a whole, changed at its end, and removed by a click.
    other_kept = other.get_by_role("status", name="Points that are kept")
    axis = parallel(other).locator(".axis-brush").nth(1)
    drag(other, axis, (0.5, 0.2), (0.5, 0.1))
    expect(other_kept).to_have_text("4 of 8 points are kept.")
    box = axis.bounding_box()
    assert box is not None
    other.mouse.click(box["x"] + box["width"] / 2, box["y"] + 0.1 * box["height"])
    expect(parallel(other).locator(".range")).to_have_count(2)
    until(other, lambda: other.url.count("mud_density") == 1)


def test_axes_of_parallel_coordinates_are_brushed_by_the_keyboard(opened: Opens, named: Sweep) -> None:
    page = opened(f"#/sweeps/{named.id}?view=parallel")
    picture = parallel(page)
    kept = page.get_by_role("status", name="Points that are kept")
    summary = page.locator("summary", has_text="Keep points by numbers")
    summary.focus()
    page.keyboard.press("Enter")
    page.get_by_label("mud density [kg/m³], from").focus()
    page.keyboard.type("1500")
    page.keyboard.press("Tab")
    expect(picture.locator(".range")).to_have_count(1)
    expect(kept).to_have_text("4 of 8 points are kept.")
    assert "mud_density%3A1500%3A" in page.url
    expect(page.get_by_label("mud density [kg/m³], to")).to_be_focused()
    page.get_by_label("flow rate [m³/s], to").focus()
    page.keyboard.type("0.02")
    page.keyboard.press("Enter")
    expect(kept).to_have_text("2 of 8 points are kept.")
    expect(picture.locator(".range")).to_have_count(2)
    # In the units of who opens the link.
    other = opened(f"#{page.url.partition('#')[2]}")
    expect(parallel(other).locator(".range")).to_have_count(2)
    expect(other.get_by_role("status", name="Points that are kept")).to_have_text("2 of 8 points are kept.")
    other.get_by_role("button", name="Units: SI. Switch").click()
    expect(other.locator("legend", has_text="mud density [ppg]")).to_have_count(1)
    other.locator("summary", has_text="Keep points by numbers").click()
    field = other.get_by_label("mud density [ppg], from", exact=True)
    expect(field).to_have_value(re.compile(r"^12\.5"))
    # What is brushed by the mouse stands in the fields, a second stretch of an axis in those of its own.
    axis = picture.locator(".axis-brush").nth(1)
    drag(page, axis, (0.5, 0.7), (0.5, 0.9))
    second = page.get_by_label("mud density [kg/m³], from, range 2")
    expect(second).to_have_value(re.compile(r"^1[56]\d\d"))
    until(page, lambda: page.url.count("mud_density") == 2)
    # Without its numbers an axis keeps all.
    for name in ("flow rate [m³/s], to", "mud density [kg/m³], from, range 2"):
        page.get_by_label(name, exact=True).fill("")
        page.get_by_label(name, exact=True).press("Enter")
    expect(second).to_have_count(0)
    expect(picture.locator(".range")).to_have_count(1)


def test_a_line_of_parallel_coordinates_tells_its_point(opened: Opens, named: Sweep) -> None:
    page = opened(f"#/sweeps/{named.id}?view=parallel&colour=torque_top&beside=contact_count")
    picture = parallel(page)
    said = page.get_by_role("status", name="The point that is read")
    # The keyboard reads the points that are kept, one after the other.
    page.get_by_label("Point cursor").focus()
    for key, expected in (("End", 8), ("ArrowLeft", 7), ("Home", 1)):
        page.keyboard.press(key)
        expect(said.get_by_role("link")).to_have_text(f"Point {expected}")
    expect(picture.locator("polyline.mark")).to_have_count(1)
    picture.scroll_into_view_if_needed()
    # Between the first two axes, on the line of one point, as far from its neighbours as these are apart.
    axes = picture.locator(".axis-brush")
    boxes = [axes.nth(number).bounding_box() for number in range(2)]
    table = named.table().to_pandas()
    heights = []
    for name, value, box in zip(("flow_rate", "mud_density"), (0.04, 1200), boxes, strict=True):
        assert box is not None
        part = (value - table[name].min()) / (table[name].max() - table[name].min())
        heights.append((box["x"] + box["width"] / 2, box["y"] + (1 - part) * box["height"]))
    (left, top), (right, bottom) = heights
    page.mouse.move(left + 0.3 * (right - left), top + 0.3 * (bottom - top) + 4, steps=5)
    expect(said).to_contain_text("flow rate 0.04 m³/s · mud density 1200 kg/m³")
    ordinal = int(str(said.get_by_role("link").text_content()).removeprefix("Point "))
    row = table[table["ordinal"] == ordinal].iloc[0]
    assert (row["flow_rate"], row["mud_density"]) == (0.04, 1200)
    expect(said).to_contain_text(f"{int(row['contact_count'])}")
    said.get_by_role("link").click()
    expect(page.get_by_role("heading", level=1)).to_have_text(f"Point {ordinal}")


def test_the_link_holds_the_region_of_a_finer_grid(opened: Opens, named: Sweep) -> None:
    page = opened(f"#/sweeps/{named.id}?view=map&colour=state")
    drawn(page, "over flow rate")
    page.get_by_role("button", name="Finer grid").click()
    panel = page.get_by_role("region", name="Finer grid")
    panel.get_by_label("From [m³/s]").fill("0.02")
    panel.get_by_label("Values").first.fill("3")
    until(page, lambda: "finer=flow_rate%3A0.02%3A0.04%3A3" in page.url)
    other = opened(f"#{page.url.partition('#')[2]}")
    panel = other.get_by_role("region", name="Finer grid")
    expect(panel.get_by_label("From [m³/s]")).to_have_value("0.02")
    expect(panel.get_by_label("Values").first).to_have_value("3")
    panel.get_by_role("button", name="Close").click()
    until(other, lambda: "finer" not in other.url)


def test_the_bar_of_colours_says_the_depth_of_its_node(opened: Opens, named: Sweep) -> None:
    page = opened(f"#/sweeps/{named.id}?view=map&colour=orbit_radius_rms_49")
    picture = drawn(page, "node 49 over flow rate")
    statics = named.point(1).statics()
    depth = float(statics["measured_depth"][list(statics["node"]).index(49)])
    title = "place => place.picture.traces[0].colorbar.title.text"
    assert picture.evaluate(title) == f"lateral vibration at {float(f'{depth:.4g}'):g} m [mm]"


def test_the_list_is_asked_for_once_and_waits_for_nothing_beside_it(opened: Opens, named: Sweep) -> None:
    page = opened("#/sweeps?tag=%3Cb%3Ebold&name=img+")
    beside = page.get_by_role("region", name="Workers and queue")
    expect(beside).to_contain_text("process")
    # Leave the page first: its late requests must not count.
    url = page.url
    page.goto("about:blank")
    asked: list[str] = []
    held: list[Route] = []
    page.on("request", lambda request: asked.append(request.url))
    page.route("**/v1/workers", lambda route: held.append(route))
    page.goto(url)
    expect(page.get_by_text("No sweep matches these filters")).to_be_visible()
    assert [url.partition("?")[2] for url in asked if "/v1/sweeps?" in url] == ["name=img&tag=%3Cb%3Ebold&limit=100"]
    assert beside.text_content() == ""
    for route in held:
        route.continue_()
    expect(beside).to_contain_text("process")


def test_a_map_does_not_wait_for_the_depths_of_nodes(opened: Opens, named: Sweep) -> None:
    page = opened("#/nowhere")
    held: list[Route] = []
    page.route("**/statics?*", lambda route: held.append(route))
    page.goto(page.url.replace("#/nowhere", f"#/sweeps/{named.id}?view=map&colour=orbit_radius_rms_49"))
    picture = drawn(page, "node 49 over flow rate")
    title = "place => place.picture.traces[0].colorbar.title.text"
    assert picture.evaluate(title) == "lateral vibration, node 49 [mm]"
    until(page, lambda: held != [])
    held[0].continue_()
    until(page, lambda: " m [mm]" in picture.evaluate(title))


def test_names_do_without_the_depths_of_an_equilibrium_that_is_gone(
    opened: Opens, named: Sweep, troubles: list[str]
) -> None:
    page = opened("#/nowhere")
    gone = json.dumps({"title": "Gone", "status": 410, "detail": "the table has expired"})
    page.route("**/statics?*", lambda route: route.fulfill(status=410, body=gone))
    with page.expect_response("**/statics?*"):
        page.goto(page.url.replace("#/nowhere", f"#/sweeps/{named.id}?view=map&colour=orbit_radius_rms_49"))
    picture = drawn(page, "node 49 over flow rate")
    assert picture.evaluate("place => place.picture.traces[0].colorbar.title.text") == "lateral vibration, node 49 [mm]"
    assert page.locator("#notices").text_content() == ""
    # The browser writes of every answer that refuses.
    troubles[:] = [text for text in troubles if "status of 410" not in text]


def test_a_sweep_whose_tables_have_expired_shows_what_is_left(
    opened: Opens, troubles: list[str], tmp_path: Path
) -> None:
    service = Service("up", "--workers", "1", "--listen", "127.0.0.1:0", "--data", str(tmp_path))
    try:
        axes: dict[str, Axis] = {"flow_rate": [0.01, 0.04], "mud_density": [1200, 1800]}
        with Client(service.server) as client:
            sweep = client.submit("paper-200m", set=SHORT, axes=axes).wait(timeout=120.0)
        collected = run(
            *(binary(), "gc", "--data", str(tmp_path), "--tables-days", "0", "--recordings-days", "0", "--json")
        )
        assert json.loads(collected)["artifacts"] > 0
        colour = "orbit_radius_rms_49"
        page = opened(f"#/sweeps/{sweep.id}?view=map&colour={colour}", address=service.server)
        picture = drawn(page, "node 49 over flow rate")
        values = picture.evaluate("place => place.picture.traces[0].z.flat()")
        assert sorted(values) == pytest.approx(sorted(1e3 * value for value in sweep_values(service, sweep, colour)))
        page.wait_for_load_state("networkidle")
        assert page.locator("#notices").text_content() == ""
        page.get_by_role("link", name="Table", exact=True).click()
        expect(page.locator(".rows tbody tr:not(.gap)")).to_have_count(4)
        for view in ("profiles", "motion", "well", "energy"):
            page = opened(f"#/sweeps/{sweep.id}/points/1?view={view}", address=service.server)
            expect(page.get_by_role("alert").filter(has_text="expired")).to_be_visible()
        page.get_by_role("link", name="Effects, accuracy, downloads").click()
        expect(page.get_by_role("region", name="Effects").get_by_text("the wall has friction").first).to_be_visible()
    finally:
        service.stop()
    # The browser writes of every answer that refuses, and of a server that is gone.
    troubles[:] = [text for text in troubles if not (GONE.search(text) or re.search("status of (404|410)", text))]


def sweep_values(service: Service, sweep: Sweep, name: str) -> list[float]:
    with Client(service.server) as client:
        return list(client.sweep(sweep.id).table()[name])


def test_points_are_ticked_and_compared(opened: Opens, named: Sweep) -> None:
    page = opened(f"#/sweeps/{named.id}?view=table&sort=orbit_radius_rms_49")
    expect(page.get_by_role("button", name="Compare")).to_be_disabled()
    for ordinal in (5, 2, 7):
        page.get_by_role("checkbox", name=f"Compare point {ordinal}").check()
    # A tick opens no point, and the link holds all of them.
    assert "ticked=5%2C2%2C7" in page.url
    page.get_by_role("link", name="Compare 3 points").click()
    rows = page.get_by_role("table", name="Points compared").get_by_role("row")
    expect(rows).to_have_count(3)
    assert [f"point {ordinal}" in str(rows.nth(at).text_content()) for at, ordinal in enumerate((5, 2, 7))] == [
        True
    ] * 3
    # At the node by which the table was sorted.
    page.get_by_role("link", name="Statistics").click()
    expect(page.get_by_text(re.compile("point 1 node 49 at .*; point 2 node 49 at"))).to_be_visible()


def test_the_table_is_saved_as_it_is_shown(opened: Opens, named: Sweep) -> None:
    page = opened(f"#/sweeps/{named.id}?view=table&columns=ordinal,flow_rate,torque_top&sort=torque_top&order=down")
    page.get_by_label("Filter, in units as shown").fill("flow_rate=0.04")
    expect(page.locator(".rows tbody tr:not(.gap)")).to_have_count(4)
    with page.expect_download() as download:
        page.get_by_role("button", name="Save as CSV").click()
    assert download.value.suggested_filename.endswith(".csv")
    rows = list(csv.DictReader(download.value.path().read_text().splitlines()))
    table = named.table().to_pandas()
    wanted = table[table["flow_rate"] == 0.04].sort_values("torque_top", ascending=False)
    assert list(rows[0]) == ["ordinal", "flow_rate", "torque_top"]
    assert {int(row["ordinal"]) for row in rows} == set(wanted["ordinal"])
    assert [float(row["torque_top"]) for row in rows] == list(wanted["torque_top"])


def test_titles_tell_sweeps_points_and_views_apart(opened: Opens, recorded: Sweep) -> None:
    for view, title in [
        (f"sweeps/{recorded.id}?view=table", "snapshots, Table"),
        (f"sweeps/{recorded.id}/points/1", "Point 1 of snapshots, Profiles"),
        (f"sweeps/{recorded.id}/points/1?view=energy", "Point 1 of snapshots, Energy"),
        (f"compare?points={recorded.id}:1&view=energy", "Compare points, Energy"),
    ]:
        expect(opened(f"#/{view}")).to_have_title(f"{title} · drillsweep")


def test_a_point_keeps_node_and_window_in_its_links(opened: Opens, named: Sweep, troubles: list[str]) -> None:
    page = opened(f"#/sweeps/{named.id}?view=table&sort=orbit_radius_rms_49")
    page.get_by_role("link", name="2", exact=True).click()
    page.get_by_role("link", name="Orbit, history, spectrum").click()
    drawn(page, "Orbit of node 49")
    page.get_by_label("From [s]").fill("0.3")
    page.get_by_label("From [s]").blur()
    until(page, lambda: "from=0.3" in page.url)
    page.get_by_role("link", name="Next").click()
    drawn(page, "Orbit of node 49")
    expect(page.get_by_label("From [s]")).to_have_value("0.3")
    page.get_by_role("link", name="Spectrogram").click()
    drawn(page, "Spectrogram of node 49")
    page.get_by_role("link", name="Compare", exact=True).last.click()
    page.get_by_role("link", name="Statistics").click()
    expect(page.get_by_text("point 1 node 49 at")).to_be_visible()
    expect(page.get_by_label("From [s]")).to_have_value("0.3")
    for view in ("motion", "spectrogram"):
        page = opened(f"#/sweeps/{named.id}/points/1?view={view}&node=50")
        expect(page.get_by_text("This point did not record node 50. It recorded node 10, node 49")).to_be_visible()
    page.get_by_label("Node", exact=True).select_option("49")
    drawn(page, "Spectrogram of node 49")


def test_a_map_ends_at_its_samples_and_marks_them(opened: Opens, named: Sweep) -> None:
    colour = "orbit_radius_rms_49"
    page = opened(f"#/sweeps/{named.id}?view=map&colour={colour}&at.operation.rotation_speed_rpm=90")
    picture = drawn(page, "over flow rate")
    read = "place => place.picture.traces.map(({ type, x, y, text, customdata }) => ({ type, x, y, text, customdata }))"
    table = named.table().to_pandas()
    table = table[table["operation.rotation_speed_rpm"] == 90]
    cells, samples, ringed = picture.evaluate(read)[:3]
    assert [cells["x"][0], cells["x"][-1], cells["y"][0], cells["y"][-1]] == pytest.approx([0.01, 0.04, 1200, 1800])
    assert sorted(zip(samples["x"], samples["y"], strict=True)) == [
        (0.01, 1200),
        (0.01, 1800),
        (0.04, 1200),
        (0.04, 1800),
    ]
    values = table.set_index("ordinal")[colour]
    texts = [float(text.replace("<br>", "")) for text in samples["text"]]
    printed = dict(zip(samples["customdata"], texts, strict=True))
    assert printed == {ordinal: pytest.approx(1e3 * value, rel=6e-3) for ordinal, value in values.items()}
    least, largest = values.idxmin(), values.idxmax()
    assert ringed["customdata"] == [least, largest]
    caption = page.get_by_role("region", name="Map").locator("figcaption")
    expect(caption).to_contain_text(re.compile(f"Ringed: least .* mm at point {least}, largest .* at point {largest}"))
    expect(caption).to_contain_text("Each cell has the colour of the sample in it")
    page.get_by_label("Drawn as").select_option("contour")
    expect(caption).to_contain_text("colours and lines between them are interpolated")
    # A sample is opened by a click on its dot, that of the rim too.
    box = picture.locator(".area").first.bounding_box()
    assert box is not None
    spare = 0.03 / 1.06
    page.mouse.move(box["x"] + (1 - spare) * box["width"] + 1, box["y"] + spare * box["height"] - 1, steps=3)
    expect(picture.locator(".reading")).to_be_visible()
    page.mouse.down()
    page.mouse.up()
    corner = table[(table["flow_rate"] == 0.04) & (table["mud_density"] == 1800)]["ordinal"].iloc[0]
    page.wait_for_url(f"**/sweeps/{named.id}/points/{corner}*")


def test_arrow_keys_go_over_the_points_of_a_map(opened: Opens, named: Sweep) -> None:
    page = opened(f"#/sweeps/{named.id}?view=map&colour=contact_count&at.operation.rotation_speed_rpm=90")
    picture = drawn(page, "over flow rate")
    said = page.get_by_role("region", name="Map").get_by_role("status").first
    picture.focus()
    for key, flow_rate, density in [
        ("ArrowRight", "0.01", "1200"),
        ("ArrowRight", "0.04", "1200"),
        ("ArrowRight", "0.04", "1200"),
        ("ArrowUp", "0.04", "1800"),
        ("ArrowLeft", "0.01", "1800"),
        ("ArrowDown", "0.01", "1200"),
    ]:
        page.keyboard.press(key)
        expect(said).to_contain_text(f"flow rate {flow_rate} m³/s")
        expect(said).to_contain_text(re.compile(f"density {density} kg/m³"))
    # A picture that is drawn again keeps the point.
    page.get_by_label("Drawn as").select_option("contour")
    expect(page.get_by_role("region", name="Map").locator("figcaption")).to_contain_text("are interpolated")
    expect(said).to_contain_text("flow rate 0.01 m³/s")
    picture.focus()
    page.keyboard.press("ArrowUp")
    expect(said).to_contain_text(re.compile("flow rate 0.01 m³/s.*density 1800 kg/m³"))
    page.keyboard.press("ArrowDown")
    page.keyboard.press("Enter")
    page.wait_for_url(f"**/sweeps/{named.id}/points/1*")


def test_biases_stand_in_every_picture_of_a_sweep(opened: Opens, client: Client, other: Sweep) -> None:
    axes: dict[str, Axis] = {"flow_rate": [0.01, 0.04], "mud_density": [1200, 1700]}
    verified = client.submit("paper-200m", set=SHORT, axes=axes, verify=4).wait(timeout=180.0)
    colour = "orbit_radius_rms_49"
    for view in ("map", "parallel", "scatter", "difference"):
        page = opened(f"#/sweeps/{verified.id}?view={view}&colour={colour}&with={other.id}")
        if view == "parallel":
            parallel(page)
        else:
            drawn(page, ".")
        expect(page.locator("figcaption", has_text="Bias against reference runs at 4 points: mean")).to_be_visible()
        if view != "parallel":
            hover = page.locator(".plot:has(canvas.picture)").evaluate("place => place.picture.traces[0].text.flat()")
            assert all("(bias " in text for text in hover), hover


def test_a_finer_grid_leaves_the_coarse_cells_in_the_map(opened: Opens, client: Client) -> None:
    axes = {"flow_rate": Range(0.01, 0.04, 4), "mud_density": Range(1200, 1800, 4)}
    coarse = client.submit("paper-200m", set=SHORT, axes=axes, outputs="summary")
    coarse.append({"flow_rate": Range(0.02, 0.03, 3), "mud_density": Range(1400, 1500, 3)})
    coarse.append({"flow_rate": [0.033], "mud_density": [1250]})
    coarse.wait(timeout=180.0)
    page = opened(f"#/sweeps/{coarse.id}?view=map&colour=contact_count")
    picture = drawn(page, "over flow rate")
    cells = "place.picture.traces.filter(one => one.type === 'heatmap')"
    layers = picture.evaluate(f"place => {cells}.map(one => ({{ z: one.z, points: one.customdata, x: one.x }}))")
    assert [(len(layer["z"]), len(layer["z"][0])) for layer in layers] == [(4, 4), (3, 3), (1, 1)]
    # No cell is empty, and each shows the value of its own point.
    values = coarse.table().to_pandas().set_index("ordinal")["contact_count"]
    for layer in layers:
        for points, shown in zip(layer["points"], layer["z"], strict=True):
            assert list(values.loc[points]) == shown
    shown_points = {point for layer in layers for row in layer["points"] for point in row}
    assert shown_points == set(values.index)
    # A single point's cell ends halfway to the next values.
    assert layers[2]["x"] == pytest.approx([0.0315, 0.0365])
    # Half a second shows no settled motion: a cross on each.
    crosses = picture.evaluate("place => place.picture.traces.find(one => one.name === 'not settled').customdata")
    assert set(crosses) == shown_points


def test_an_incomplete_grid_says_how_its_indices_are_estimated(opened: Opens, client: Client) -> None:
    axes = {"flow_rate": Range(0.01, 0.04, 4), "mud_density": Range(1200, 1800, 3)}
    sweep = client.submit("paper-200m", set=SHORT, axes=axes, outputs="summary")
    sweep.append({"flow_rate": [0.033], "mud_density": [1250]})
    sweep.wait(timeout=180.0)
    page = opened(f"#/sweeps/{sweep.id}?view=effects&result=tension_top")
    drawn(page, "Shares of the variance")
    said = "The points are no full grid: first-order indices are estimated from the points as they are"
    expect(page.get_by_text(said)).to_be_visible()
    expect(page.get_by_text("95 % intervals")).to_be_visible()


@pytest.fixture
def idle(tmp_path: Path) -> Iterator[str]:
    """A server without workers."""
    service = Service("serve", "--listen", "127.0.0.1:0", "--data", str(tmp_path / "data"))
    yield service.server
    service.stop()


def test_a_thousand_sweeps_are_listed(idle: str, opened: Opens) -> None:
    with Client(idle) as client:
        for number in range(1000):
            client.submit("paper-200m", set=SHORT, name=f"sweep {number:04d}", outputs="summary")
    page = opened("", address=idle)
    rows = page.get_by_role("table", name="Sweeps").locator("tbody tr")
    expect(rows.first).to_contain_text("sweep 0999")
    assert rows.count() < 1000

    # A reader who is at the end again before the browser has seen that there was another one.
    page.get_by_role("table", name="Sweeps").locator("tbody").evaluate(
        """(body) => {
            const end = () => scrollTo(0, document.body.scrollHeight);
            new MutationObserver(end).observe(body, { childList: true });
            end();
        }"""
    )
    expect(rows).to_have_count(1000)
    expect(rows.last).to_contain_text("sweep 0000")
    expect(page.get_by_text("1000 sweeps.")).to_be_visible()
    page.get_by_role("searchbox", name="Search names").fill("0123")
    expect(rows).to_have_count(1)
    expect(rows.first).to_contain_text("sweep 0123")
    page.get_by_role("link", name="sweep 0123").click()
    expect(page.get_by_role("heading", level=1)).to_have_text("sweep 0123")


def test_a_hundred_thousand_points_are_shown_with_their_results(
    idle: str, opened: Opens, named: Sweep, tmp_path: Path
) -> None:
    axes = {"flow_rate": Range(0.01, 0.06, 400), "mud_density": Range(1200, 2100, 250)}
    with Client(idle) as client:
        large = client.submit("paper-200m", set=SHORT, axes=axes, name="large", outputs="summary")
    complete(tmp_path / "data" / "drillsweep.sqlite", named)
    page = opened(f"#/sweeps/{large.id}?view=table&columns=ordinal,contact_count,orbit_radius_rms_49", address=idle)
    expect(page.get_by_text("100000 points", exact=True)).to_be_visible(timeout=60_000)
    page.locator(".rows").evaluate("rows => { rows.scrollTop = rows.scrollHeight }")
    last = page.get_by_role("row").filter(has=page.get_by_role("link", name="100000", exact=True))
    # After the tick, in millimetres: as many as the point's number.
    expect(last.get_by_role("cell").nth(3)).to_have_text(re.compile(r"^100\D?000$"))
    assert page.locator(".rows tbody tr").count() < 200
    page.get_by_role("searchbox").fill("orbit_radius_rms_49>99990")
    expect(page.get_by_text("10 of 100000 points")).to_be_visible()
    page.get_by_role("link", name="Map", exact=True).click()
    page.get_by_label("Colour", exact=True).select_option("orbit_radius_rms_49")
    picture = drawn(page, "node 49.* over flow rate and mud density")
    read = "place => { const { z } = place.picture.traces[0]; return [z.length, z[0].length, z[0][0], z[249][399]]; }"
    assert picture.evaluate(read) == pytest.approx([250, 400, 1, 100_000])


def complete(database: Path, known: Sweep) -> None:
    """Gives all points of a store without workers the result of another point, its orbit as large as their number."""
    point = known.point(1)
    with contextlib.closing(sqlite3.connect(database, timeout=60.0)) as store:
        ((trigger,),) = store.execute("SELECT sql FROM sqlite_master WHERE name = 'work_changes_state'")
        with store:
            # It counts points one by one.
            store.execute("DROP TRIGGER work_changes_state")
            store.execute(
                "INSERT INTO result (work_key, summary, provenance, created) SELECT work_key, json_set(?, "
                "'$.orbit_radius_rms_49', 0.001 * ordinal), ?, 0 FROM point GROUP BY work_key",
                (json.dumps(point.summary), json.dumps(point.provenance)),
            )
            store.execute("UPDATE work SET state = 'done'")
            store.execute("UPDATE sweep SET points_done = points_queued, points_queued = 0, finished = created")
            store.execute(trigger)


def test_a_sweep_that_passes_the_filters_no_more_leaves_the_list(idle: str, opened: Opens) -> None:
    with Client(idle) as client:
        names = ["oldest", "stays", "leaves"]
        sweeps = {name: client.submit("paper-200m", set=SHORT, name=name, tags=["kept"]) for name in names}
        page = opened("#/sweeps?state=running", address=idle)
        rows = page.get_by_role("table", name="Sweeps").locator("tbody tr")
        expect(rows).to_have_count(3)
        sweeps["leaves"].cancel()
        expect(rows).to_have_count(2)
        expect(page.get_by_text("2 sweeps.")).to_be_visible()
        # One that comes back has its old place.
        sweeps["stays"].pause()
        expect(rows).to_have_count(1)
        sweeps["stays"].resume()
        expect(rows).to_have_count(2)
        expect(rows.first).to_contain_text("stays")
        page = opened("#/sweeps?name=OLD", address=idle)
        expect(rows := page.get_by_role("table", name="Sweeps").locator("tbody tr")).to_have_count(1)
        sweeps["oldest"].change(name="renamed")
        expect(rows).to_have_count(0)
        expect(page.get_by_text("No sweep matches these filters.")).to_be_visible()


@pytest.fixture(scope="module")
def failing(client: Client) -> Sweep:
    """Two points that fail: without its wall the string is buckled by the weight on bit."""
    axes: dict[str, Axis] = {"flow_rate": [0.013, 0.014], "mud_density": [1200]}
    changes = {**SHORT, "effects.contact": "off"}
    return client.submit("paper-200m", set=changes, axes=axes, name="all of it fails").wait(timeout=120.0)


def test_a_sweep_in_which_points_failed_is_marked_so(opened: Opens, failing: Sweep, client: Client) -> None:
    axes: dict[str, Axis] = {"flow_rate": [0.013, 0.015], "operation.rotation_speed_rpm": [90]}
    mark = "element => [getComputedStyle(element).color, getComputedStyle(element, '::before').content]"
    page = opened(f"#/sweeps/{failing.id}")
    state = page.locator(".state").filter(has_text="completed, 2 failed")
    expect(state).to_be_visible()
    colour, sign = state.evaluate(mark)
    assert sign == '"✕"'
    page = opened(f"#/sweeps?name={quote('all of it fails')}")
    expect(page.locator("tbody .state").first).to_have_text("completed, 2 failed")
    done = client.submit("paper-200m", set=SHORT, axes=axes, name="nothing fails").wait(timeout=120.0)
    page = opened(f"#/sweeps/{done.id}")
    assert page.locator(".state", has_text=re.compile("^completed$")).evaluate(mark) != [colour, sign]


def test_a_failure_of_the_list_is_shown_with_its_cause(opened: Opens, failing: Sweep) -> None:
    error = failing.point(1).error
    assert error is not None
    page = opened("#/sweeps", viewport={"width": 900, "height": 800})
    reason = page.get_by_role("region", name="What failed lately").get_by_text(error.reason).first
    expect(reason).to_be_visible()
    assert reason.evaluate("element => element.scrollHeight <= element.clientHeight + 1")


def test_the_tab_of_failures_counts_them_as_they_come(opened: Opens, client: Client) -> None:
    axes = {"flow_rate": [0.016, 0.017, 0.018]}
    changes = {**SHORT, "effects.contact": "off"}
    sweep = client.submit("paper-200m", set=changes, axes=axes, name="fails by and by")
    sweep.pause()
    page = opened(f"#/sweeps/{sweep.id}?view=table")
    failed = sweep.refresh().counts.failed
    tabs = page.get_by_role("navigation", name="Views of the sweep")
    expect(tabs.get_by_role("link", name=f"Failures ({failed})" if failed else "Failures", exact=True)).to_be_visible()
    sweep.resume().wait(timeout=120.0)
    expect(tabs.get_by_role("link", name="Failures (3)")).to_be_visible()


def test_a_difference_tells_what_else_the_sweeps_differ_in(opened: Opens, named: Sweep, other: Sweep) -> None:
    # The other one turns at 90 rpm, by a change.
    view = f"#/sweeps/{named.id}?view=difference&colour=contact_count&with={other.id}"
    speed = "operation.rotation_speed_rpm"
    page = opened(f"{view}&at.{speed}=120")
    drawn(page, "difference of")
    caption = page.locator("figcaption")
    expect(caption).to_contain_text(
        re.compile("also has other parameters than .*: rotation speed 90 rpm instead of 120 rpm")
    )
    page.get_by_role("combobox", name="rotation speed").select_option("90")
    expect(caption).to_contain_text("2 points that both have")
    expect(caption).not_to_contain_text("other parameters")


def test_the_first_view_of_a_sweep_that_failed_leads_to_its_failures(opened: Opens, failing: Sweep) -> None:
    page = opened(f"#/sweeps/{failing.id}")
    expect(page.get_by_text("All points of this sweep failed")).to_be_visible()
    expect(page.get_by_role("figure", name="Map of the sweep")).to_be_hidden()
    page.get_by_role("region", name="Map").get_by_role("link", name="Failures").click()
    expect(page.get_by_role("link", name="2", exact=True)).to_be_visible()


def test_intervals_of_indices_are_shown_to_their_ends(opened: Opens, client: Client) -> None:
    axes = {"flow_rate": Range(0.01, 0.06), "mud_density": Range(1200, 2100)}
    drawn_points = client.submit(
        "paper-200m", set=SHORT, axes=axes, design="latin_hypercube", samples=16, seed=3, outputs="summary"
    )
    drawn_points.wait(timeout=180.0)
    page = opened(f"#/sweeps/{drawn_points.id}?view=effects&result=tension_top")
    picture = drawn(page, "Shares of the variance")
    read = """place => {
        const [{ x, error_x }] = place.picture.traces;
        const ends = x.flatMap((value, at) => [value - error_x.arrayminus[at], value + error_x.array[at]]);
        return { ends, range: place.picture.layout.xaxis.range };
    }"""
    found = picture.evaluate(read)
    assert min(found["ends"]) < -0.01, "an interval that reaches below what was shown"
    assert found["range"][0] <= min(found["ends"])
    assert max(found["ends"]) <= found["range"][1]


def test_the_link_holds_the_order_of_axes_of_parallel_coordinates(opened: Opens, named: Sweep) -> None:
    page = opened(f"#/sweeps/{named.id}?view=parallel&colour=torque_top&beside=contact_count")
    picture = parallel(page)
    before = ["flow_rate", "mud_density", "operation.rotation_speed_rpm", "contact_count", "torque_top"]
    titles = picture.locator(".axis-title")
    first, second = (titles.nth(number).bounding_box() for number in range(2))
    assert first is not None
    assert second is not None
    page.mouse.move(first["x"] + first["width"] / 2, first["y"] + first["height"] / 2)
    page.mouse.down()
    page.mouse.move(second["x"] + second["width"], second["y"] + second["height"] / 2, steps=10)
    page.mouse.up()
    moved = [before[1], before[0], *before[2:]]
    until(page, lambda: f"order={'%2C'.join(moved)}" in page.url)
    copy = opened(f"#{page.url.partition('#')[2]}")
    expect(parallel(copy).locator(".axis-title").first).to_have_text("mud density [kg/m³]")


def test_names_of_parallel_axes_do_not_overlap_on_a_phone(opened: Opens, named: Sweep) -> None:
    page = opened(f"#/sweeps/{named.id}?view=parallel", viewport={"width": 390, "height": 844})
    picture = parallel(page)
    read = "place => [...place.querySelectorAll('.axis-title, .axis-extent')].map((text) => {"
    read += " const { left, right, top, bottom } = text.getBoundingClientRect(); return [left, right, top, bottom]; })"
    texts = [text for text in picture.evaluate(read) if text[1] > text[0]]
    assert len(texts) >= 5 * 3
    for at, (left, right, top, bottom) in enumerate(texts):
        for other_left, other_right, other_top, other_bottom in texts[:at]:
            assert right <= other_left or other_right <= left or bottom <= other_top or other_bottom <= top
    # Its place is scrolled, not the page.
    assert page.evaluate("document.documentElement.scrollWidth") <= 390


def test_axes_of_parallel_coordinates_are_moved_by_the_keyboard(opened: Opens, named: Sweep) -> None:
    page = opened(f"#/sweeps/{named.id}?view=parallel&colour=torque_top&beside=contact_count")
    picture = parallel(page)
    usual = ["flow_rate", "mud_density", "operation.rotation_speed_rpm", "contact_count", "torque_top"]
    titles = dict(zip(usual, picture.locator(".axis-title").all_text_contents(), strict=True))
    assert titles["flow_rate"] == "flow rate [m³/s]"
    page.locator("summary", has_text="move axes").click()
    right, left = (page.get_by_role("button", name=f"Move flow rate [m³/s] {where}") for where in ("right", "left"))
    orders = [[*usual[1 : place + 1], "flow_rate", *usual[place + 1 :]] for place in range(len(usual))]

    def shows(names: list[str]) -> None:
        expect(picture.locator(".axis-title")).to_have_text([titles[name] for name in names])

    right.focus()
    for names in orders[1:]:
        page.keyboard.press("Enter")
        shows(names)
        assert f"order={'%2C'.join(names)}" in page.url
        expect(right).to_be_focused()
    expect(right).to_have_attribute("aria-disabled", "true")
    page.keyboard.press("Enter")
    left.focus()
    for names in reversed(orders[:-1]):
        page.keyboard.press("Enter")
        shows(names)
    assert "order=" not in page.url


LEFT = """({ url }) => {
    const real = fetch;
    window.fetch = (asked, ...more) => {
        if (!String(asked).includes("/profile?")) return real(asked, ...more);
        location.hash = url;
        return new Promise(() => {});
    };
}"""
"""Leaves a view of profiles for another one before their data have come."""


def test_nothing_is_preloaded_in_vain_for_a_view_that_was_left(opened: Opens, named: Sweep) -> None:
    page = opened("#/nowhere")
    warnings: list[str] = []
    page.on("console", lambda message: warnings.append(message.text) if "preload" in message.text else None)
    point = f"#/sweeps/{named.id}/points/1"
    page.add_init_script(f"({LEFT})({json.dumps({'url': f'{point}?view=well'})})")
    page.goto(f"{page.url.partition('#')[0]}?{point}")
    scene(page, "The string at rest")
    # Chromium complains of what is preloaded and not used a few seconds after the page has loaded.
    page.wait_for_timeout(6000)
    assert warnings == []


def test_dots_of_many_points_are_read_and_opened(idle: str, opened: Opens) -> None:
    axes: dict[str, Axis] = {"flow_rate": Range(0.01, 0.04, 80), "mud_density": Range(1200, 1800, 40)}
    with Client(idle) as client:
        many = client.submit("paper-200m", set=SHORT, axes=axes)
    page = opened(f"#/sweeps/{many.id}?view=scatter&x=flow_rate&y=mud_density&colour=state", idle)
    picture = drawn(page, "mud density against flow rate")
    picture.scroll_into_view_if_needed()
    dots = picture.locator("canvas.picture")
    ends = "place => ['xaxis', 'yaxis'].map((name) => place.picture.axis(name).range)"
    (left, right), (low, high) = picture.evaluate(ends)
    assert left < 0.01 < 0.04 < right
    assert low < 1200 < 1800 < high
    box = picture.locator(".area").bounding_box()
    assert box is not None
    # The point of the tenth flow rate and the fifth density.
    flow, density = 0.01 + 9 * 0.03 / 79, 1200 + 4 * 600 / 39
    place = (
        box["x"] + (flow - left) / (right - left) * box["width"],
        box["y"] + (high - density) / (high - low) * box["height"],
    )
    page.mouse.move(*place)
    label = picture.locator(".reading")
    expect(label).to_contain_text(f"mud density {density:.0f}")
    ordinal = int(str(label.locator("div").first.text_content()).removeprefix("point "))
    # Zooming the axes paints the dots anew.
    before = pixels(dots)
    drag(page, picture.locator(".area"), (0.1, 0.1), (0.6, 0.6))
    until(page, lambda: pixels(dots) != before)
    picture.hover()
    picture.get_by_role("button", name="Reset axes").click()
    until(page, lambda: picture.evaluate(ends) == [[left, right], [low, high]])
    until(page, lambda: pixels(dots) == before)
    page.mouse.click(*place)
    until(page, lambda: page.url.partition("?")[0].endswith(f"/points/{ordinal}"))


def test_a_finer_grid_is_dragged_over_points_that_were_drawn(idle: str, opened: Opens) -> None:
    speed = "operation.rotation_speed_rpm"
    axes = {"flow_rate": Range(0.01, 0.05), "mud_density": Range(1200, 1800), speed: Range(80, 120)}
    with Client(idle) as client:
        sweep = client.submit(
            "paper-200m", set=SHORT, axes=axes, design="latin_hypercube", samples=12, outputs="summary"
        )
        page = opened(f"#/sweeps/{sweep.id}?view=map&colour=state", address=idle)
        picture = drawn(page, "over flow rate")
        page.get_by_role("button", name="Finer grid").click()
        panel = page.get_by_role("region", name="Finer grid")
        # Across and up a grid; what is not shown is held, at first in the middle of what was drawn from.
        expect(panel.get_by_label("rotation speed [rpm]")).to_have_value("100")
        until(page, lambda: picture.evaluate("place => place.picture.layout.dragmode") == "select")
        drag(page, picture.locator(".area"), (0.25, 0.25), (0.75, 0.75))
        dragged = panel.get_by_label("From [m³/s]")
        until(page, lambda: 0.015 < float(dragged.input_value()) < 0.025)
        panel.get_by_label("rotation speed [rpm]").fill("90")
        for values in panel.get_by_label("Values").all():
            values.fill("3")
        panel.get_by_role("button", name="Add 9 points").click()
        expect(page.get_by_text("9 points are added.")).to_be_visible()
        table = sweep.table().to_pandas()
        added = table[table["ordinal"] > 12]
        assert set(added[speed]) == {90}
        assert (added["flow_rate"].nunique(), added["mud_density"].nunique()) == (3, 3)
        kept = f"finer=flow_rate:0.02:0.03:3,mud_density:1300:1500:2&at.{speed}=95"
        other = opened(f"#/sweeps/{sweep.id}?view=map&colour=state&{kept}", address=idle)
        expect(other.get_by_role("region", name="Finer grid").get_by_label("rotation speed [rpm]")).to_have_value("95")


def test_known_points_are_told_at_each_accuracy(opened: Opens, client: Client) -> None:
    changes = {**SHORT, "operation.rotation_speed_rpm": 117}
    axes = {"flow_rate": [0.011, 0.021, 0.031]}
    client.submit("paper-200m", set=changes, axes=axes, outputs="summary").wait(timeout=120.0)
    standard = {**changes, "accuracy": "standard"}
    few = {"flow_rate": [0.011]}
    client.submit("paper-200m", set=standard, axes=few, outputs="summary").wait(timeout=120.0)
    body = {"preset": "paper-200m", "set": changes, "axes": {"flow_rate": {"values": axes["flow_rate"]}}}
    page = opened(f"#/new?request={quote(json.dumps({**body, 'outputs': 'summary'}))}")
    rows = page.get_by_role("region", name="Plan").locator("tbody tr")
    expect(rows).to_have_count(3)
    for row, (accuracy, known) in zip(rows.all(), [("draft", 3), ("standard", 1), ("reference", 0)], strict=True):
        expect(row.get_by_role("cell").nth(0)).to_contain_text(accuracy)
        expect(row.get_by_role("cell").nth(4)).to_have_text(str(known))
    expect(rows.nth(0).get_by_role("cell").nth(5)).to_have_text("none")
    # A worker has measured its machine.
    expect(rows.nth(1).get_by_role("cell").nth(5)).to_have_text(re.compile(r"^[1-9].* m?s$"))


def test_many_points_are_not_looked_up_at_other_accuracies(opened: Opens) -> None:
    axes = {"flow_rate": {"from": 0.01, "to": 0.06, "count": 5001}}
    body = {
        "preset": "paper-200m",
        "set": {**SHORT, "operation.rotation_speed_rpm": 118},
        "axes": axes,
        "outputs": "summary",
    }
    page = opened(f"#/new?request={quote(json.dumps(body))}")
    rows = page.get_by_role("region", name="Plan").locator("tbody tr")
    # Five thousand scenarios are made and looked up, without optimisation and beside workers.
    expect(rows).to_have_count(3, timeout=60_000)
    expect(rows.nth(0).get_by_role("cell").nth(4)).to_have_text("0")
    expect(rows.nth(1).get_by_role("cell").nth(4)).to_have_text("not looked up")


def test_points_are_not_shown_beside_a_request_that_cannot_be_read(opened: Opens) -> None:
    page = opened(f"#/new?request={quote(json.dumps({'preset': 'paper-200m', 'axes': AXES}))}")
    drawn(page, "Preview")
    values = page.get_by_role("textbox", name="Values").first
    values.fill("0.01, 0.0x")
    expect(page.get_by_text("The plan appears here once the request can be read.")).to_be_visible()
    expect(page.get_by_role("region", name="Preview")).to_be_hidden()
    values.fill("0.01, 0.02")
    expect(page.get_by_role("region", name="Preview")).to_be_visible()
    drawn(page, "Preview")


def test_a_finer_grid_is_planned_where_all_points_failed(opened: Opens, failing: Sweep) -> None:
    page = opened(f"#/sweeps/{failing.id}")
    expect(page.get_by_text("All points of this sweep failed")).to_be_visible()
    button = page.get_by_role("button", name="Finer grid")
    expect(button).to_have_attribute("aria-expanded", "false")
    button.click()
    panel = page.get_by_role("region", name="Finer grid")
    expect(panel.get_by_label("From [m³/s]")).to_have_value("0.013")
    expect(button).to_have_attribute("aria-expanded", "true")
    panel.get_by_role("button", name="Close").click()
    expect(button).to_have_attribute("aria-expanded", "false")


def test_a_difference_to_a_sweep_that_comes_late_is_not_shown(
    opened: Opens, named: Sweep, other: Sweep, client: Client
) -> None:
    axes: dict[str, Axis] = {"flow_rate": [0.01, 0.04], "mud_density": [1200, 1800]}
    third = client.submit("paper-200m", set=SHORT, axes=axes, name="the third").wait(timeout=120.0)
    page = opened("#/nowhere")
    held: list[Route] = []
    page.route(f"**/v1/sweeps/{other.id}/table?**", lambda route: held.append(route))
    page.goto(page.url.replace("#/nowhere", f"#/sweeps/{named.id}?view=difference&colour=contact_count"))
    chooser = page.get_by_role("combobox", name="Compared with")
    expect(chooser).to_be_visible()
    chooser.select_option(other.id)
    until(page, lambda: len(held) == 1)
    chooser.select_option(third.id)
    expect(page.locator("figcaption")).to_contain_text("the third less")
    with page.expect_response(f"**/v1/sweeps/{other.id}/table?**"):
        held[0].continue_()
    taken(page)
    expect(page.locator("figcaption")).to_contain_text("the third less")
    expect(chooser).to_have_value(third.id)


def test_a_difference_to_a_sweep_that_is_gone_offers_others(
    opened: Opens, named: Sweep, other: Sweep, troubles: list[str]
) -> None:
    unknown = "01a00000-0000-7000-8000-000000000000"
    page = opened(f"#/sweeps/{named.id}?view=difference&colour=contact_count&with={unknown}")
    expect(page.get_by_text("The sweep of the link was not found")).to_be_visible()
    page.get_by_role("combobox", name="Compared with").select_option(other.id)
    drawn(page, "difference of")
    # The browser writes of every answer that refuses.
    troubles[:] = [text for text in troubles if "status of 404" not in text]


def test_who_searches_goes_on_typing_where_the_selected_sweep_leaves_the_list(idle: str, opened: Opens) -> None:
    with Client(idle) as client:
        sweeps = [client.submit("paper-200m", set=SHORT, name=name) for name in ("first", "second")]
        page = opened("#/sweeps?state=running", address=idle)
        rows = page.get_by_role("table", name="Sweeps").locator("tbody tr")
        expect(rows).to_have_count(2)
        page.keyboard.press("j")
        expect(rows.first).to_have_attribute("aria-selected", "true")
        search = page.get_by_role("searchbox", name="Search names")
        search.focus()
        sweeps[1].cancel()
        expect(rows).to_have_count(1)
        expect(rows.first).to_have_attribute("aria-selected", "true")
        expect(search).to_be_focused()


def test_a_finer_grid_is_of_the_slice_that_is_shown(opened: Opens, named: Sweep) -> None:
    page = opened(f"#/sweeps/{named.id}?view=map")
    drawn(page, "over flow rate")
    page.get_by_role("button", name="Finer grid").click()
    panel = page.get_by_role("region", name="Finer grid")
    expect(panel.get_by_text("Held: rotation speed 90 rpm.")).to_be_visible()
    panel.get_by_label("To [m³/s]").fill("0.03")
    page.get_by_role("combobox", name="rotation speed").select_option("120")
    expect(panel.get_by_text("Held: rotation speed 120 rpm.")).to_be_visible()
    expect(panel.get_by_label("To [m³/s]")).to_have_value("0.03")
