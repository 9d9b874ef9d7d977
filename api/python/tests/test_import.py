"""Files of other programs, read by a real service."""

from __future__ import annotations

from pathlib import Path

import pytest

from drillsweep import Client, InvalidRequest, Problem

TALLY = "Item;Jts;Length each (m);OD (in);ID (in)\nBit;1;0,3;8;3\nDC;3;9,2;8;2 13/16\nJar;1;9,6;6,5;x\n"


def test_a_survey_is_read_from_bytes_with_its_unit(client: Client) -> None:
    survey = client.import_survey(b"MD,Inc,Azi\n0,0,0\n1000,2.5,-1\n", depth_unit="ft")
    assert survey["stations"][1] == {"measured_depth": 304.8, "inclination_deg": 2.5, "azimuth_deg": 359.0}
    assert survey["columns"][0] | {"heading": "MD", "is_assumed": True} == survey["columns"][0]


def test_a_tally_and_a_hole_are_parts_of_a_scenario(client: Client, tmp_path: Path) -> None:
    file = tmp_path / "tally.csv"
    file.write_text(TALLY)
    tally = client.import_tally(file)
    assert [section["kind"] for section in tally["sections"]] == ["collar", "bit"]
    assert [(problem["row"], problem["column"]) for problem in tally["problems"]] == [(4, "E")]
    hole = client.import_hole(b"From\tHole size\tFF\n0\t9\t0.2\n", assumed_units="field")
    assert hole["sections"][0]["hole_diameter"] == pytest.approx(9 * 0.0254, rel=1e-15)
    scenario = client.scenario("paper-200m")
    scenario["string"] |= {"sections": tally["sections"], "gauges": [], "unbalance": []}
    scenario["well"]["section"] = hole["sections"]
    scenario["recording"]["nodes"] = [{"node": 2}]
    plan = client.plan(scenario=scenario)
    assert plan.total == 1


def test_a_mud_is_fitted_to_readings_or_plastic_viscosity(client: Client) -> None:
    report = client.import_mud({600: 62, 300: 38, 6: 7, 3: 6})
    # PV = 62 - 38 cP, YP = 2 * 38 - 62 and LSYP = 2 * 6 - 7 lbf/100 ft2.
    pascals = 4.4482216152605 / 9.290304
    law = client.import_mud(plastic_viscosity=0.024, yield_point=14 * pascals, low_shear_yield_point=5 * pascals)
    for member in ("yield_stress", "consistency", "flow_index"):
        assert law[member] == pytest.approx(report["rp_13d"][member], rel=1e-9)
    with pytest.raises(InvalidRequest, match="plastic_viscosity"):
        client.import_mud(plastic_viscosity=-1.0, yield_point=0.0)


def test_a_file_that_leaves_a_choice_open_names_the_argument(client: Client) -> None:
    with pytest.raises(Problem, match="assumed_units"):
        client.import_tally(b"Item,Length,OD,ID\nBit,1,8,3\n")
    with pytest.raises(FileNotFoundError):
        client.import_survey("missing.csv")
