"""Classes of points in a real browser: the headline of a point, causes of lines, and classes over a sweep."""

from __future__ import annotations

import re
from pathlib import Path

from playwright.sync_api import expect

from browsing import Opens, drawn, run_curl, run_python, shown_lines, until
from drillsweep import Client, Sweep
from service import SHORT


def test_a_point_begins_with_its_class_and_the_numbers_behind_it(opened: Opens, sweep: Sweep) -> None:
    page = opened(f"#/sweeps/{sweep.id}/points/1")
    judged = page.get_by_role("region", name="Judgement")
    diagnosis = sweep.point(1).diagnosis()
    first, *others = diagnosis["findings"]
    expect(judged.locator(".verdict > p")).to_have_text(f"{first['class'].replace('_', ' ')} {first['sentence']}")
    assert judged.locator("li").count() == len(others)
    summary = sweep.point(1).summary
    assert summary is not None
    side_force = judged.locator("div", has=page.get_by_text("Largest side force", exact=True)).last.locator("dd")
    force, depth = (float(number) for number in re.findall(r"[\d.]+", side_force.inner_text())[:2])
    assert abs(force - summary["largest_side_force"] / 1e3) <= 0.01 * force
    assert abs(depth - summary["largest_side_force_depth"]) <= 0.001 * depth
    page.get_by_role("button", name="Units: SI. Switch").click()
    expect(side_force).to_contain_text("klbf")


def test_an_overview_leads_from_small_pictures_to_their_views(opened: Opens, sweep: Sweep) -> None:
    page = opened(f"#/sweeps/{sweep.id}/points/1")
    summary = sweep.point(1).summary
    assert summary is not None
    sizes = {node: summary[f"orbit_radius_rms_{node}"] for node in (10, 49, 282)}
    largest = max(sizes, key=lambda node: float(sizes[node]))
    overview = page.locator("details.overview")
    tiles = overview.get_by_role("link")
    expect(tiles).to_have_count(4)
    track = overview.get_by_role("img", name=re.compile("String over depth: drill pipe, .*bit to 200 m"))
    expect(track).to_be_visible()
    for picture in overview.get_by_role("img").all():
        assert picture.evaluate("canvas => canvas.getContext('2d').getImageData(0, 0, 300, 100).data.some(Boolean)")
    expect(overview).to_contain_text(f"{float(f'{1000 * sizes[largest]:.3g}'):g} mm rms")
    tiles.filter(has_text="looking downhole").click()
    expect(page.get_by_role("figure", name=re.compile(f"Orbit of node {largest} "))).to_be_visible()


def test_a_point_without_a_result_has_no_headline(opened: Opens, client: Client) -> None:
    waiting = client.submit("paper-200m", name="waiting", priority=-10)
    waiting.cancel()
    page = opened(f"#/sweeps/{waiting.id}/points/1")
    expect(page.get_by_role("heading", name="Point 1")).to_be_visible()
    expect(page.get_by_role("status").filter(has_text="result")).to_be_visible()
    expect(page.get_by_role("region", name="Judgement")).to_have_count(0)


def test_lines_of_a_spectrum_have_the_causes_of_the_diagnosis(opened: Opens, client: Client) -> None:
    window = {"from": 0.1, "to": 0.5}
    changes = SHORT | {"recording.spectrum_windows": [window]}
    point = client.submit("paper-200m", set=changes, name="causes").wait(timeout=120.0).point(1)
    lines = [line for line in point.diagnosis()["lines"] if line["node"] == 49 and "cause" in line]
    assert lines
    page = opened(f"#{point.path.removeprefix('/v1')}?view=motion&node=49&from=0.1&to=0.5&range=100")
    cells = page.locator("[data-frequency]")
    expect(cells.first).not_to_have_text("\N{HORIZONTAL ELLIPSIS}", timeout=60_000)
    shown = {float(cell.get_attribute("data-frequency") or "nan"): cell.inner_text() for cell in cells.all()}
    near = {
        frequency: min(lines, key=lambda line: abs(line["frequency_hz"] - frequency))
        for frequency in shown
        if any(abs(line["frequency_hz"] - frequency) < 1e-3 for line in lines)
    }
    assert near
    for frequency, line in near.items():
        assert line["sentence"].endswith(f" Hz: {shown[frequency]}")


def test_a_class_is_a_word_of_the_table_and_of_the_map(opened: Opens, sweep: Sweep, client: Client) -> None:
    classes = list(sweep.table()["class"])
    words = [str(word).replace("_", " ") for word in classes]
    page = opened(f"#/sweeps/{sweep.id}?view=table")
    shown = page.get_by_role("table", name="Points").locator(".class-word")
    expect(shown).to_have_text(words)
    colours = {str(shown.nth(row).evaluate("word => word.style.background")) for row in range(len(words))}
    assert len(colours) == len(set(words))
    page.goto("about:blank")
    page.goto(f"{client.server}/#/sweeps/{sweep.id}?view=map&colour=class")
    picture = drawn(page, "class over")
    read = (
        "({ picture: { traces: [{ colorbar, colorscale }] } }) => [colorbar.ticktext, colorscale.map(([, ink]) => ink)]"
    )
    names, scale = picture.evaluate(read)
    assert sorted(names) == sorted(set(words))
    rgb = {f"rgb({int(one[1:3], 16)}, {int(one[3:5], 16)}, {int(one[5:7], 16)})" for one in scale}
    assert rgb == colours


def test_limits_that_are_moved_judge_the_points_anew(opened: Opens, sweep: Sweep, tmp_path: Path) -> None:
    page = opened(f"#/sweeps/{sweep.id}?view=window")
    counts = page.get_by_role("list", name="Points by class")
    picture = drawn(page, "class over")

    def shows(limits: dict[str, float | None]) -> None:
        window = sweep.window(limits)
        for name, count in window.attributes["points_by_class"].items():
            expect(counts.get_by_role("listitem").filter(has_text=f"{name.replace('_', ' ')} {count}")).to_be_visible()
        uncertain = [reason for reason in window["class_uncertain"] if isinstance(reason, str) and reason]
        if uncertain:
            expect(page.get_by_text(re.compile(f"^{len(uncertain)} uncertain point"))).to_be_visible()
        words = {str(name).replace("_", " ") for name in window["class"]}
        until(page, lambda: set(picture.evaluate("place => place.picture.traces[0].colorbar.ticktext")) == words)

    shows({})
    name = "largest equivalent stress of all elements"
    page.get_by_label(f"{name} [MPa]", exact=True).fill("1")
    shows({"largest_equivalent_stress": 1e6})
    until(page, lambda: "limits=largest_equivalent_stress%3A1000000" in page.url)
    table = page.get_by_role("link", name="Table (JSON)").get_attribute("href") or ""
    assert "limits=largest_equivalent_stress%3A1000000" in table
    lines = shown_lines(page)
    assert "class_uncertain" in run_curl(lines["curl"], tmp_path / "curl")[""]
    assert "class_uncertain" in run_python(lines["Python"])["table"]
    page.get_by_role("checkbox", name=f"Limit of {name}").uncheck()
    shows({"largest_equivalent_stress": None})
    slider = page.get_by_label("Slider: stick-slip severity of the bit", exact=True)
    assert float(slider.get_attribute("max") or "nan") == 2.0
    slider.fill("0.01")
    shows({"largest_equivalent_stress": None, "bit_stick_slip_severity": 0.01})


def test_a_link_holds_the_limits_of_a_window(opened: Opens, sweep: Sweep) -> None:
    page = opened(f"#/sweeps/{sweep.id}?view=window&limits=largest_equivalent_stress:1e6,largest_side_force:20000")
    force = page.get_by_label("largest side force of all nodes [kN]", exact=True)
    expect(force).to_have_value("20")
    expect(page.get_by_label("largest equivalent stress of all elements [MPa]", exact=True)).to_have_value("1")
    expect(page.get_by_role("list", name="Points by class")).to_contain_text("over limit 4")
    page.get_by_role("button", name="Units: SI. Switch").click()
    force = page.get_by_label("largest side force of all nodes [klbf]", exact=True)
    expect(force).to_have_value("4.496")


def test_the_operating_point_names_the_nearest_computed_point(opened: Opens, named: Sweep, client: Client) -> None:
    page = opened(f"#/sweeps/{named.id}?view=window&point.flow_rate=0.02&point.mud_density=1500")
    drawn(page, "class over")
    chosen = page.get_by_role("region", name="Operating point")
    cross = page.get_by_role("button", name=re.compile("^Operating point"))
    table = named.table().to_pandas().set_index("ordinal")
    speed = "operation.rotation_speed_rpm"
    ranges = {"flow_rate": (0.01, 0.04), "mud_density": (1200, 1800), speed: (90, 120)}

    def nearest(**place: float) -> int:
        parts = [((table[name] - place[name]) / (to - start)) ** 2 for name, (start, to) in ranges.items()]
        return int(sum(parts[1:], parts[0]).idxmin())

    # Halfway between both densities the arrow key decides.
    cross.press("ArrowUp")
    place = {"flow_rate": 0.02, "mud_density": 1512.0, speed: 104.0}
    chosen.get_by_role("slider", name="rotation speed").fill("46.6667")
    expect(chosen.get_by_role("link", name=re.compile(r"^point \d+$"))).to_have_text(f"point {nearest(**place)}")
    word = str(table["class"][nearest(**place)]).replace("_", " ")
    expect(chosen.locator(".class-word").first).to_have_text(word)
    for _ in range(12):
        cross.press("ArrowRight")
    place["flow_rate"] += 12 * 0.02 * 0.03
    expect(chosen.get_by_role("link", name=re.compile(r"^point \d+$"))).to_have_text(f"point {nearest(**place)}")
    # The map shows the slice that is nearest to the held value.
    held = page.get_by_label("rotation speed", exact=True).first
    expect(held).to_have_value("90")
    chosen.get_by_role("slider", name="rotation speed").fill("90")
    expect(held).to_have_value("120")
    expect(chosen.get_by_role("img", name="Orbit")).to_be_visible()
    cross.scroll_into_view_if_needed()
    box = cross.bounding_box()
    assert box is not None
    page.mouse.move(box["x"] + box["width"] / 2, box["y"] + box["height"] / 2)
    page.mouse.down()
    page.mouse.move(box["x"] - 2000, box["y"] - 100, steps=4)
    page.mouse.up()
    until(page, lambda: "point.flow_rate=0.01&" in page.url + "&")


def test_edges_between_classes_are_refined_a_round_at_a_time(opened: Opens, client: Client) -> None:
    """The mean of the smallest and the largest value of a column is a limit that a sweep always crosses."""
    axes = {"flow_rate": [0.01, 0.03], "mud_density": [1200.0, 1800.0]}
    sweep = client.submit("paper-200m", set=SHORT, axes=axes, name="edges").wait(timeout=240.0)
    column = "largest_equivalent_stress"
    values = [float(value) for value in sweep.table()[column]]
    limit = 0.5 * (min(values) + max(values))
    page = opened(f"#/sweeps/{sweep.id}?view=window&limits={column}:{limit!r}")
    drawn(page, "class over")
    page.get_by_text("Refine the edges between classes").click()
    page.get_by_label("Points at most").fill("2")
    page.get_by_role("button", name="Add points").click()
    expect(
        page.get_by_text(re.compile(r"longer than the resolution, the longest 100(\.0)? % of an axis"))
    ).to_be_visible()
    added = sweep.refresh().wait(timeout=240.0)
    assert added.counts.total == 6
    places = {(point.parameters["flow_rate"], point.parameters["mud_density"]) for point in added.points()}
    middles = {(0.02, 1200.0), (0.02, 1800.0), (0.01, 1500.0), (0.03, 1500.0), (0.02, 1500.0)}
    assert len(places & middles) == 2
