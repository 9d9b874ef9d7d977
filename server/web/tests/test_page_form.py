"""Fields of the form for a new sweep that are lists, tables and choices: mesh, windows, string, data kept."""

from __future__ import annotations

import io
import json
import re
import zipfile
from collections.abc import Iterator
from pathlib import Path
from typing import Any
from xml.sax.saxutils import escape, quoteattr

import pytest
from playwright.sync_api import Locator, Page, Request, Route, expect

from browsing import Opens, requested, until
from drillsweep import Client

SCENARIO = "#/new?preset=paper-200m"


def changes(page: Page) -> dict[str, Any]:
    return dict(requested(page).get("set", {}))


def enter(box: Locator, text: str) -> None:
    """Types a number and leaves its field."""
    box.fill(text)
    box.blur()


def planned(page: Page) -> None:
    """Waits until the service has accepted the request."""
    expect(page.get_by_role("button", name=re.compile("^Submit 12 points"))).to_be_enabled(timeout=60_000)


@pytest.fixture
def refused(opened: Opens, troubles: list[str]) -> Iterator[None]:
    """Takes away what a browser writes of requests that are refused on the way to one that is not."""
    del opened  # It is requested so that this ends before its pages do.
    yield
    troubles[:] = [text for text in troubles if "422" not in text and "400" not in text]


def test_the_plan_is_requested_once_before_the_form_is_loaded(opened: Opens) -> None:
    page = opened("#/nowhere")
    asked: list[str] = []
    held: list[Route] = []

    def note(request: Request) -> None:
        if request.method == "POST" and "dry_run" in request.url:
            asked.append(request.post_data or "")

    page.on("request", note)
    page.route("**/submit/view.js", lambda route: held.append(route))
    address = page.url.replace("#/nowhere", "#/new")
    for link in (address, None):
        # The second time it is the request that the form has put into the link.
        link = link or page.url
        asked.clear()
        page.goto("about:blank")
        page.goto(link, wait_until="commit")
        until(page, lambda: len(held) == 1 and len(asked) == 1)
        held.pop().continue_()
        planned(page)
        assert len(asked) == 1
        assert requested(page) == json.loads(asked[0])
    # Another request than the one of the link is planned anew.
    page.get_by_role("textbox", name="Name", exact=True).fill("other")
    until(page, lambda: len(asked) == 2)
    planned(page)


def test_the_mesh_is_a_rule_a_factor_or_lengths(opened: Opens) -> None:
    page = opened(SCENARIO)
    page.locator("summary", has_text=re.compile("^Mesh$")).click()
    way = page.get_by_label("Element lengths")
    expect(way).to_have_value("lengths")
    # One number is one change, which may be varied just as well.
    enter(page.get_by_label("Elements of collar"), "0.4")
    until(page, lambda: changes(page) == {"mesh.collar": 0.4})
    planned(page)
    page = opened("#/new?preset=paper-200m-damped")
    page.locator("summary", has_text=re.compile("^Mesh$")).click()
    way = page.get_by_label("Element lengths")
    expect(way).to_have_value("auto")
    way.select_option("factor")
    enter(page.get_by_label("Factor on the element lengths"), "0.5")
    until(page, lambda: changes(page) == {"mesh": {"auto": 0.5}})
    planned(page)
    # It is shown here alone.
    expect(page.get_by_role("textbox", name="Value", exact=True)).to_have_count(0)
    page.get_by_role("button", name="Take back mesh").click()
    until(page, lambda: changes(page) == {})
    expect(way).to_have_value("auto")


def test_lengths_of_elements_are_in_the_readers_units(opened: Opens) -> None:
    page = opened(SCENARIO)
    page.get_by_role("button", name="Units: SI. Switch").click()
    page.locator("summary", has_text=re.compile("^Mesh")).click()
    expect(page.get_by_label("Elements of collar")).to_have_value("1.64042")
    enter(page.get_by_label("Elements of collar"), "1.5")
    until(page, lambda: changes(page) == {"mesh.collar": 0.4572})
    planned(page)
    # Another way proposes all lengths.
    page = opened("#/new?preset=paper-200m-damped")
    page.locator("summary", has_text=re.compile("^Mesh")).click()
    page.get_by_label("Element lengths").select_option("lengths")
    until(
        page, lambda: set(changes(page).get("mesh", {})) == {"drillpipe", "tool_joint", "collar", "stabilizer", "bit"}
    )


def test_the_window_of_the_statistics_settles_or_is_fixed(opened: Opens) -> None:
    page = opened(SCENARIO)
    page.get_by_text("Recorded nodes, windows of statistics").click()
    way = page.get_by_label("Window", exact=True)
    way.select_option("settled")
    until(page, lambda: changes(page) == {"recording.orbit_window": "settled"})
    planned(page)
    way.select_option("fixed")
    enter(page.get_by_label("Statistics from [s]"), "20")
    enter(page.get_by_label("Statistics to [s]"), "50")
    until(page, lambda: changes(page) == {"recording.orbit_window": {"from": 20, "to": 50}})
    planned(page)
    expect(page.get_by_role("textbox", name="Value", exact=True)).to_have_count(0)
    page.get_by_role("button", name="Take back window of the statistics").click()
    until(page, lambda: changes(page) == {})


@pytest.mark.usefixtures("refused")
def test_sections_are_changed_inserted_and_removed(opened: Opens) -> None:
    page = opened(SCENARIO)
    page.get_by_text("String: tally, gauges, unbalance").click()
    tally = page.get_by_role("group", name="Tally")
    expect(tally.locator("tbody tr")).to_have_count(8)
    expect(tally).to_contain_text("The string is 200 m long")
    # It is drawn as its results will show it.
    expect(tally.get_by_role("img", name=re.compile("String over depth: .*bit to 200 m"))).to_be_visible()
    # One number is one change, which may be varied just as well.
    enter(page.get_by_label("Outer diameter of section 3", exact=True), "0.165")
    until(page, lambda: changes(page) == {"string.sections[2].outer_diameter": 0.165})
    planned(page)
    page.get_by_role("button", name="Insert a section above 3").click()
    enter(page.get_by_label("Length of one of section 3", exact=True), "10")
    page.get_by_role("button", name="Remove section 5").click()
    enter(page.get_by_label("Length of one of section 4", exact=True), "25")

    def lengths() -> list[float]:
        return [section["length"] for section in changes(page).get("string.sections", [])]

    until(page, lambda: lengths() == [4, 9.5, 10, 25, 40, 2, 33, 0.5])
    assert set(changes(page)) == {"string.sections"}
    assert [section["outer_diameter"] for section in changes(page)["string.sections"]][2:4] == [0.165, 0.165]
    expect(tally).to_contain_text("200 m long")
    planned(page)
    page.get_by_role("button", name="Take back tally").click()
    until(page, lambda: changes(page) == {})
    expect(page.get_by_label("Outer diameter of section 3", exact=True)).to_have_value("0.159")


@pytest.mark.usefixtures("refused")
def test_a_tally_of_a_file_fills_its_table_and_shows_what_it_left_out(opened: Opens, tmp_path: Path) -> None:
    file = tmp_path / "tally.csv"
    file.write_text("Item;Length;OD (in);ID (in)\nBit;0,5;6;2\nCollar;9;6;x\nCollar;199,5;6,5;2,5\n")
    page = opened(SCENARIO)
    page.get_by_text("String: tally, gauges, unbalance").click()
    tally = page.get_by_role("group", name="Tally")
    page.get_by_label("Columns without a unit").select_option("si")
    page.get_by_label("File of a tally").set_input_files(file)
    expect(tally.locator("tbody tr")).to_have_count(2)
    expect(tally).to_contain_text("Row 3, column D, “x”: no number")
    expect(tally).to_contain_text("length: B, “Length”, in m, which the file does not give")

    def sections() -> list[dict[str, Any]]:
        return list(changes(page).get("string.sections", []))

    until(page, lambda: [section["length"] for section in sections()] == [199.5, 0.5])
    assert [section["outer_diameter"] for section in sections()] == [0.1651, 0.1524]


def workbook(sheets: dict[str, list[list[str | float]]]) -> bytes:
    """An Excel workbook of cells with texts and numbers (ECMA-376)."""

    def cell(value: str | float) -> str:
        if isinstance(value, str):
            return f'<c t="inlineStr"><is><t>{escape(value)}</t></is></c>'
        return f"<c><v>{value}</v></c>"

    main = "http://schemas.openxmlformats.org/spreadsheetml/2006/main"
    links = "http://schemas.openxmlformats.org/officeDocument/2006/relationships"
    listed = "".join(
        f"<sheet name={quoteattr(name)} sheetId='{at}' r:id='r{at}'/>" for at, name in enumerate(sheets, 1)
    )
    related = "".join(
        f"<Relationship Id='r{at}' Type='{links}/worksheet' Target='worksheets/sheet{at}.xml'/>"
        for at in range(1, len(sheets) + 1)
    )
    package = "http://schemas.openxmlformats.org/package/2006/relationships"
    files = {
        "_rels/.rels": f"<Relationships xmlns='{package}'><Relationship Id='r1' Type='{links}/officeDocument' "
        "Target='xl/workbook.xml'/></Relationships>",
        "xl/workbook.xml": f"<workbook xmlns='{main}' xmlns:r='{links}'><sheets>{listed}</sheets></workbook>",
        "xl/_rels/workbook.xml.rels": f"<Relationships xmlns='{package}'>{related}</Relationships>",
    }
    for at, rows in enumerate(sheets.values(), 1):
        data = "".join(f"<row>{''.join(map(cell, row))}</row>" for row in rows)
        files[f"xl/worksheets/sheet{at}.xml"] = f"<worksheet xmlns='{main}'><sheetData>{data}</sheetData></worksheet>"
    made = io.BytesIO()
    with zipfile.ZipFile(made, "w", zipfile.ZIP_DEFLATED) as archive:
        for name, text in files.items():
            archive.writestr(name, text)
    return made.getvalue()


@pytest.mark.usefixtures("refused")
def test_a_hole_is_read_from_a_sheet_of_a_workbook(opened: Opens, tmp_path: Path) -> None:
    file = tmp_path / "well.xlsx"
    casings: list[list[str | float]] = [
        ["Section", "Top (m)", "Bottom (m)", "ID (mm)", "Hole size (mm)"],
        ["casing", 0, 120, 224.5, ""],
        ["open hole", 120, 200, "", 215.9],
    ]
    file.write_bytes(workbook({"Notes & plans": [["Hole of the well"]], "Casings": casings}))
    page = opened(SCENARIO)
    page.locator("summary", has_text="Hole: casings and open hole").click()
    hole = page.get_by_role("group", name="Hole sections")
    page.get_by_label("File of a hole").set_input_files(file)
    sheet = hole.get_by_label("Sheet")
    expect(sheet.locator("option")).to_have_text(["Notes & plans", "Casings"])
    expect(hole.locator("p.wrong")).to_contain_text("well.xlsx: ")
    sheet.select_option("Casings")
    expect(hole.locator("tbody tr")).to_have_count(2)
    expect(hole.get_by_label("Diameter of hole section 1")).to_have_value("0.2245")

    def sections() -> list[dict[str, Any]]:
        return list(changes(page).get("well.section", []))

    until(page, lambda: [section["from"] for section in sections()] == [0, 120])
    assert [section["hole_diameter"] for section in sections()] == [0.2245, 0.2159]
    planned(page)
    # A file without sheets has none to choose.
    other = tmp_path / "hole.csv"
    other.write_text("Section;Top (m);ID (mm)\nopen hole;0;215,9\n")
    page.get_by_label("File of a hole").set_input_files(other)
    expect(hole.locator("tbody tr")).to_have_count(1)
    expect(sheet).to_have_count(0)


def test_a_pipe_of_the_catalogue_fills_a_row_of_the_tally(opened: Opens, client: Client) -> None:
    name = '5" 19.5# S-135 NC50'
    page = opened(SCENARIO)
    page.get_by_text("String: tally, gauges, unbalance").click()
    box = page.get_by_label("Pipe of the catalogue of section 2", exact=True)
    box.focus()
    expect(page.locator("#pipes option")).to_have_count(len(client.pipes()))
    enter(box, name)
    expect(page.get_by_label("Outer diameter of section 2", exact=True)).to_have_value("0.127")
    expect(page.get_by_label("Name of section 2", exact=True)).to_have_value(name)
    planned(page)
    row = changes(page)["string.sections"][1]
    [pipe] = [pipe for pipe in client.pipes() if pipe["name"] == name]
    assert (row["count"], row["length"], row["mass_per_length"]) == (9, 9.5, pipe["mass_per_length"])
    # The same as by its name alone.
    by_name = {"pipe": name, "count": 9, "length": 9.5}
    keys = [client.plan("paper-200m", set={"string.sections[1]": one}).points[0].key for one in (row, by_name)]
    assert keys[0] == keys[1]
    enter(page.get_by_label("Pipe of the catalogue of section 3", exact=True), "no such pipe")
    expect(page.get_by_label("Pipe of the catalogue of section 3", exact=True)).to_have_attribute(
        "aria-invalid", "true"
    )


@pytest.mark.usefixtures("refused")
def test_a_section_has_a_material_and_joints_of_its_own(opened: Opens) -> None:
    page = opened(SCENARIO)
    page.get_by_text("String: tally, gauges, unbalance").click()
    page.get_by_label("Material of section 2", exact=True).select_option("aluminium 2014-T6")
    page.get_by_label("Joint material of section 2").select_option("steel")
    enter(page.get_by_label("Material of section 2: density", exact=True), "2780")
    page.get_by_label("Joint material of section 2: grade").select_option("S-135")

    def pipe() -> dict[str, Any]:
        return dict((changes(page).get("string.sections") or [{}, {}])[1])

    until(page, lambda: pipe().get("tool_joint", {}).get("material", {}).get("grade") == "S-135")
    assert pipe()["material"] == {"youngs_modulus": 7.3e10, "density": 2780, "poissons_ratio": 0.33}
    planned(page)
    # A pipe without numbers of its joints has none.
    for name in ("Joint length", "Joint outer d.", "Joint inner d."):
        enter(page.get_by_label(f"{name} of section 2", exact=True), "")
    until(page, lambda: set(pipe().get("tool_joint", {})) == {"material"})
    page.get_by_label("Joint material of section 2", exact=True).select_option("")
    until(page, lambda: "tool_joint" not in pipe())
    planned(page)


def test_gauges_and_masses_are_tables(opened: Opens) -> None:
    page = opened(SCENARIO)
    page.get_by_text("String: tally, gauges, unbalance").click()
    page.get_by_role("button", name="Remove gauge 1").click()
    until(page, lambda: len(changes(page).get("string.gauges", [])) == 2)
    enter(page.get_by_label("Phase of mass 2", exact=True), "-90")
    until(page, lambda: changes(page).get("string.unbalance[1].phase_deg") == -90)
    planned(page)


@pytest.mark.usefixtures("refused")
def test_a_mass_has_its_place_in_a_section(opened: Opens) -> None:
    page = opened(SCENARIO)
    page.get_by_text("String: tally, gauges, unbalance").click()
    enter(page.get_by_label("Name of section 3", exact=True), "collars")
    enter(page.get_by_label("or in section of mass 1", exact=True), "collars")
    enter(page.get_by_label("above its end of mass 1", exact=True), "1.5")
    expect(page.get_by_text("give either measured_depth or above_bit or section, not both")).to_be_visible()
    enter(page.get_by_label("Measured depth of mass 1", exact=True), "")
    planned(page)
    mass = changes(page)["string.unbalance"][0]
    assert (mass["section"], mass["above_end"], mass.get("measured_depth")) == ("collars", 1.5, None)


@pytest.mark.usefixtures("refused")
def test_a_problem_of_the_string_stands_at_its_table(opened: Opens) -> None:
    page = opened(SCENARIO)
    page.get_by_text("String: tally, gauges, unbalance").click()
    page.get_by_role("button", name="Remove section 1", exact=True).click()
    enter(page.get_by_label("Inner diameter of section 3", exact=True), "0.5")
    tally = page.get_by_role("group", name="Tally")
    expect(tally.locator("[data-problem]", has_text="must be smaller than the outer diameter")).to_be_visible()


@pytest.mark.usefixtures("refused")
def test_histories_in_part_have_fields(opened: Opens) -> None:
    page = opened(SCENARIO)
    page.get_by_label("Kept of each point").select_option("part")
    page.get_by_label("Histories of nodes").fill("49, 2 ft")
    enter(page.get_by_label("Every n-th sample"), "5")
    enter(page.get_by_label("Histories to [s]"), "30")
    orbits = {"nodes": [{"node": 49}, {"depth": 0.6096}], "decimation": 5, "window": {"from": 0, "to": 30}}
    until(page, lambda: requested(page).get("outputs") == {"orbits": orbits})
    page.get_by_label("Histories of nodes").fill("bit")
    expect(page.get_by_text("Nodes are numbers or depths")).to_be_visible()


@pytest.mark.usefixtures("refused")
def test_an_accuracy_is_an_allowed_error_or_a_step(opened: Opens) -> None:
    page = opened(SCENARIO)
    way = page.get_by_label("Accuracy", exact=True)
    way.select_option("statistics")
    enter(page.get_by_label("Allowed error, relative"), "0.02")
    until(page, lambda: changes(page) == {"accuracy": {"statistics": 0.02}})
    planned(page)
    way.select_option("steps")
    page.get_by_label("Integrator", exact=True).select_option("generalized_alpha")
    enter(page.get_by_label("Step", exact=True), "0.00025")
    enter(page.get_by_label("Spectral radius", exact=True), "0.7")
    steps = {"integrator": "generalized_alpha", "step": 0.00025, "spectral_radius": 0.7}
    until(page, lambda: changes(page) == {"accuracy": steps})
    planned(page)
    # A link with it shows it in the same fields.
    again = opened("#" + page.url.partition("#")[2])
    expect(again.get_by_label("Spectral radius", exact=True)).to_have_value("0.7")
    expect(again.get_by_role("textbox", name="Value", exact=True)).to_have_count(0)


def test_no_field_of_the_form_is_json(opened: Opens) -> None:
    page = opened(SCENARIO)
    page.get_by_text("All fields, with units").click()
    form = page.locator(".schema")
    expect(form.locator("summary", has_text=re.compile("^cost study$"))).to_be_visible()

    def folded() -> Locator:
        return form.locator("details.section:not([open]) > summary").locator("visible=true")

    while folded().count():
        folded().first.click()
    for box in form.get_by_label(re.compile("^Give ")).all():
        box.check()
    while folded().count():
        folded().first.click()
    expect(form.locator("textarea")).to_have_count(0)


def test_a_cost_study_is_given_by_fields(opened: Opens) -> None:
    page = opened(SCENARIO)
    page.get_by_text("All fields, with units").click()
    page.locator("summary", has_text=re.compile("^cost study$")).click()
    page.get_by_label("Give cost study").check()
    page.get_by_label("members").fill("3")
    page.get_by_label("standard", exact=True).check()
    enter(page.get_by_label("mesh factors"), "0.5, 1")
    page.locator("summary", has_text=re.compile("^methods$")).first.click()
    page.get_by_role("button", name="Add a row").click()
    enter(page.get_by_label("Steps of row 1"), "0.001, 0.0005")
    methods = [{"integrator": "esdirk4", "steps": [0.001, 0.0005]}]
    study = {"members": 3, "presets": ["standard"], "mesh_factors": [0.5, 1], "methods": methods}
    until(page, lambda: changes(page).get("cost_study") == study)
