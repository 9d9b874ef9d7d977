"""The page's list of sweeps, the views of a sweep and the form for a new one, in a real browser over a real server."""

from __future__ import annotations

import json
import re
from pathlib import Path
from typing import Any

import pytest
from playwright.sync_api import Page, expect

from drillsweep import Client
from service import REPOSITORY, SHORT
from test_page import Opens, browser, drawn, named, opened, requested, troubles, until

__all__ = ["browser", "named", "opened", "troubles"]

PRESETS = REPOSITORY / "sim" / "presets"


def module(page: Page, name: str, expression: str, argument: Any = None) -> Any:
    """What an expression gives that has a module of the page as `module`, and `argument`."""
    source = page.locator("script[type=module]").first.get_attribute("src") or ""
    base = source.rpartition("/")[0]
    call = f"async ([path, argument]) => {{ const module = await import(path); return ({expression}); }}"
    return page.evaluate(call, [f"{base}/{name}", argument])


@pytest.fixture
def tomllib() -> Any:
    """Python's own reader of TOML, which Python 3.10 has not."""
    return pytest.importorskip("tomllib")


@pytest.mark.parametrize("path", sorted(PRESETS.rglob("*.toml")), ids=lambda path: path.stem)
def test_scenario_files_are_read_as_elsewhere(opened: Opens, tomllib: Any, path: Path) -> None:
    text = path.read_text(encoding="utf-8")
    assert module(opened(), "toml.js", "module.readToml(argument)", text) == tomllib.loads(text)


def test_toml_is_read_as_its_specification_says(opened: Opens, tomllib: Any) -> None:
    text = '''
    # A comment.
    plain.dotted."quoted key".'literal' = "tab\\t \\u00e4 \\" end" # another
    numbers = [+1, -2_000, 3.5e-3, 1e+5, 0x1F, 0o17, 0b101, -0.0,
      # within a list
      7, ]
    flags = { yes = true, no = false, deep.er = [[1], ["a", 'b\\']] }
    empty = { }
    lines = """
first \\
      joined
"quoted" end""""
    raw = \'\'\'
no \\escape\'\'\'
    __proto__ = 1
    [one.two]
    x = 1
    [one]
    y = 2
    [[list]]
    a = 1
    [list.inner]
    b = 2
    [[list]]
    a = 3
    '''
    page = opened()
    read = "JSON.stringify(module.readToml(argument))"
    assert json.loads(module(page, "toml.js", read, text)) == tomllib.loads(text)
    windows = "a = 1\r\n[b]\r\nc = '''x\r\ny'''\r\n"
    assert json.loads(module(page, "toml.js", read, windows)) == {"a": 1, "b": {"c": "x\ny"}}


@pytest.mark.parametrize(
    "text",
    [
        "a = 1\na = 2",
        "[a]\n[a]",
        "a.b = 1\n[a]",
        "[a]\nx = 1\n[b]\n[a.x]",
        "a = {b = 1}\na.c = 2",
        "a = [1]\n[[a]]",
        "a = 01",
        "a = 1 b = 2",
        "a = ",
        "a = [1 2]",
        "a = {b = 1,\n}",
        'a = "open',
        'a = "\\q"',
        "a = 1_",
        "a = yes",
        "= 1",
        "[a",
        "a b = 1",
    ],
)
def test_what_is_no_toml_is_refused(opened: Opens, tomllib: Any, text: str) -> None:
    with pytest.raises(tomllib.TOMLDecodeError):
        tomllib.loads(text)
    call = "(() => { try { module.readToml(argument); return 'read'; } catch (error) { return error.message; } })()"
    assert re.match(r"Line \d+: ", module(opened(), "toml.js", call, text))


@pytest.mark.parametrize("name", ["well.toml", "well.json"])
def test_a_scenario_file_becomes_a_sweep(
    opened: Opens, client: Client, tomllib: Any, tmp_path: Path, name: str
) -> None:
    text = (PRESETS / "paper-200m.toml").read_text(encoding="utf-8")
    file = tmp_path / name
    file.write_text(text if name.endswith("toml") else json.dumps(tomllib.loads(text)), encoding="utf-8")
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


def test_a_file_that_cannot_be_read_says_where(opened: Opens, tmp_path: Path) -> None:
    file = tmp_path / "well.toml"
    file.write_text("duration = 1\nname = nonsense\n")
    page = opened("#/new?preset=paper-200m")
    expect(page.get_by_role("button", name=re.compile(r"Submit \d+ points"))).to_be_enabled()
    page.get_by_label("Scenario file").set_input_files(file)
    expect(page.get_by_text("This is not TOML. Line 2: nonsense is no value")).to_be_visible()
    expect(page.get_by_role("combobox", name="Scenario", exact=True)).to_have_value("paper-200m")


def test_the_plan_says_what_tables_and_snapshots_take(opened: Opens, client: Client) -> None:
    changes: dict[str, Any] = {"duration": 0.5, "recording.snapshots": {"rate_hz": 25}}
    body = {"preset": "paper-200m", "set": changes}
    page = opened(f"#/new?request={json.dumps(body)}")
    answer = client.plan("paper-200m", set=changes).data["plan"]["footprint"]
    tables, snapshots = (answer[f"{name}_bytes"] / 1000 for name in ("table", "snapshot"))
    plan = page.get_by_role("region", name="Plan")
    said = f"about {tables:.0f} kB before compression at each accuracy, of that {snapshots:.0f} kB of snapshots"
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
    values = "() => document.querySelector('.js-plotly-plot').data[0].y"
    until(page, lambda: sorted(set(page.evaluate(values))) == pytest.approx([60, 90, 120]))


def test_a_survey_is_summed_up_in_the_units_shown(opened: Opens) -> None:
    stations = [{"measured_depth": depth, "inclination_deg": 60, "azimuth_deg": 0} for depth in (0, 304.8)]
    body = {"preset": "paper-200m", "set": {"well.survey": stations}}
    page = opened(f"#/new?request={json.dumps(body)}")
    expect(page.get_by_text("2 stations down to 304.8 m")).to_be_visible()
    page.get_by_role("button", name=re.compile("Units")).click()
    expect(page.get_by_text("2 stations down to 1000 ft")).to_be_visible()


def test_histories_in_part_can_be_dropped_from_a_sweep_like_another(opened: Opens, client: Client) -> None:
    outputs = {"orbits": {"nodes": [{"node": 49}]}}
    first = client.submit("paper-200m", set=SHORT, axes={"flow_rate": [0.01, 0.02]}, outputs=outputs)
    page = opened(f"#/new?from={first.id}")
    until(page, lambda: requested(page).get("outputs", {}).get("orbits", {}).get("nodes") == [{"node": 49}])
    page.get_by_label("Kept of each point").select_option("spectra")
    until(page, lambda: requested(page).get("outputs") == "spectra")
    page.get_by_label("Kept of each point").select_option("")
    until(page, lambda: "outputs" not in requested(page))
