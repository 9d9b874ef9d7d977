"""The panel of a point with what accuracy costs, of points whose scenario is a cost study."""

from __future__ import annotations

import json

import pytest
from playwright.sync_api import Route, expect

from browsing import MINUS, Opens, drawn, taken, trace, until
from drillsweep import Client, Sweep
from service import SHORT


@pytest.fixture(scope="module")
def study(client: Client) -> Sweep:
    alpha = {"integrator": "generalized_alpha", "steps": [1e-3, 5e-4]}
    changes = SHORT | {"cost_study": {"duration": 0.1, "presets": ["draft", "standard"], "methods": [alpha]}}
    return client.submit("paper-200m", set=changes, axes={"flow_rate": [0.01]}, name="study").wait(timeout=300.0)


def test_rows_of_a_cost_study_are_drawn_next_to_predicted_times(opened: Opens, study: Sweep) -> None:
    report = study.point(1).cost()
    page = opened(f"#/sweeps/{study.id}/points/1?view=about")
    panel = page.get_by_role("region", name="What accuracy costs")
    picture = drawn(page, "Error of orbit size against processor time")
    rows = {row["name"]: row for row in report["methods"]}
    accuracies, others = trace(picture, 3), trace(picture, 4)
    assert accuracies["x"] == [rows[name]["cpu_time"] for name in ("draft", "standard")]
    measured = [rows[name]["errors"]["orbit_size"]["bias"] for name in ("draft", "standard")]
    assert accuracies["y"] == [pytest.approx(max(1e-3, 100 * abs(error))) for error in measured]
    # Two steps of a method, and both methods of the reference.
    assert len(others["x"]) == 4
    expect(panel).to_contain_text("Measured by the cost study of this point")
    expect(panel).to_contain_text("Dotted: predicted times of this point")
    for advice in report["recommendations"]:
        expect(panel).to_contain_text(advice["text"])


def test_effects_of_a_study_have_what_leaving_them_out_changes_and_saves(opened: Opens, study: Sweep) -> None:
    report = study.point(1).cost()
    whole = report["references"][0]
    errors = whole["errors"] | {"orbit_size": whole["errors"]["orbit_size"] | {"bias": -0.25}}
    cheaper = {"cpu_per_simulated_second": 0.6 * whole["cpu_per_simulated_second"]}
    # Such a study takes minutes: its rows are those of the other one.
    report["effects"] = [
        whole | cheaper | {"effect": "axial_motion", "errors": errors},
        whole | {"effect": "contact", "errors": None, "failure": "no equilibrium after 400 iterations"},
    ]
    page = opened("#/sweeps")
    page.route(
        "**/points/1/cost", lambda route: route.fulfill(body=json.dumps(report), content_type="application/json")
    )
    page.goto(f"{page.url.partition('#')[0]}#/sweeps/{study.id}/points/1?view=about")
    table = page.get_by_role("region", name="Effects, each left out")
    motion, contact = (
        table.locator("tr", has=page.get_by_role("rowheader", name=name)) for name in ("axial motion", "contact")
    )
    expect(motion.locator("td").first).to_have_text(f"{MINUS}25 %")
    expect(motion.locator("td").last).to_have_text("+40 %")
    expect(contact).to_contain_text("no equilibrium after 400 iterations")
    # The whole scenario is no measured row of such a study.
    expect(page.get_by_role("figure", name="Error of orbit size against processor time")).to_be_hidden()


def test_a_point_leads_to_the_cost_study_of_its_scenario(opened: Opens, client: Client) -> None:
    sweep = client.submit("paper-200m", set=SHORT, axes={"flow_rate": [0.013]}).wait(timeout=120.0)
    page = opened(f"#/sweeps/{sweep.id}/points/1?view=about")
    panel = page.get_by_role("region", name="What accuracy costs")
    panel.get_by_role("link", name="Request a cost study of this scenario").click()
    tag = page.get_by_label("Tags").input_value()
    expect(page.get_by_role("button", name="Submit 1 point")).to_be_enabled()
    # The study that the form would submit, but of one method and a tenth of a second.
    study = {"duration": 0.1, "presets": ["draft"], "methods": []}
    changes = SHORT | {"mud.flow_rate": 0.013, "cost_study": study}
    answer = client.submit("paper-200m", set=changes, tags=[tag])
    page = opened(f"#/sweeps/{sweep.id}/points/1?view=about")
    page.get_by_role("link", name="Cost study of this scenario").click()
    page.wait_for_url(f"**/sweeps/{answer.id}/points/1*")


def test_a_link_that_late_answers_draw_again_under_the_mouse_is_followed(opened: Opens, client: Client) -> None:
    sweep = client.submit("paper-200m", set=SHORT, axes={"flow_rate": [0.014]}).wait(timeout=120.0)
    page = opened("#/sweeps")
    held: list[Route] = []
    page.route("**/points/1/plan", lambda route: held.append(route))
    page.goto(f"{page.url.partition('#')[0]}#/sweeps/{sweep.id}/points/1?view=about")
    panel = page.get_by_role("region", name="What accuracy costs")
    link = panel.get_by_role("link", name="Request a cost study of this scenario")
    link.hover()
    until(page, lambda: bool(held))
    page.mouse.down()
    held[0].continue_()
    expect(page.get_by_role("cell", name="axial motion", exact=True)).to_be_visible()
    taken(page)
    page.mouse.up()
    expect(page.get_by_label("Tags")).to_be_visible()
