"""Submitting, waiting, the table."""

from __future__ import annotations

import io
import re
import socket
import threading
import zipfile
from datetime import datetime, timedelta, timezone
from fractions import Fraction
from pathlib import Path
from typing import Any

import numpy as np
import pandas
import polars
import pytest
from matplotlib.colors import to_rgba_array

import drillsweep
from drillsweep import (
    Axis,
    Client,
    Conflict,
    IdempotencyKeyReused,
    InvalidRequest,
    NoResult,
    NotFound,
    PreconditionFailed,
    Problem,
    Range,
    Sweep,
    plot,
    quantity,
)
from drillsweep.progress import ProgressBar
from service import SHORT, Service


def test_table_has_a_row_a_point_in_every_form(sweep: Sweep, tmp_path: Path) -> None:
    assert sweep.state == "completed"
    assert (sweep.counts.total, sweep.counts.succeeded) == (4, 4)
    table = sweep.table()
    frame = table.to_pandas()
    assert frame["flow_rate"].tolist() == [0.01, 0.01, 0.04, 0.04], "the first axis varies slowest"
    assert frame["mud_density"].tolist() == [1200.0, 1800.0, 1200.0, 1800.0]
    assert frame.attrs["units"]["mud_density"] == "kg/m3"
    # The paper's section 4.4: C_f falls with flow rate.
    assert frame["friction_coefficient_max"][2] < frame["friction_coefficient_max"][0]
    # The service's own CSV and Parquet, read by others, hold the same numbers.
    csv = pandas.read_csv(sweep.save_table(tmp_path / "table.csv"))
    parquet = polars.read_parquet(sweep.save_table(tmp_path / "table.parquet"))
    for other in (csv["orbit_radius_rms_49"].tolist(), parquet["orbit_radius_rms_49"].to_list()):
        assert other == frame["orbit_radius_rms_49"].tolist() == table.to_polars()["orbit_radius_rms_49"].to_list()


def test_values_with_units_make_the_points_of_those_in_si(client: Client) -> None:
    # A US gallon is 231 cubic inches, a pound 0.45359237 kg.
    gallon, pound = 231 * Fraction("0.0254") ** 3, Fraction("0.45359237")
    flows, density = [float(number * gallon / 60) for number in (300, 500)], float(Fraction("10.5") * pound / gallon)
    si = client.plan("paper-200m", set={"mud.density": density}, axes={"flow_rate": flows})
    field = client.plan("paper-200m", set={"mud.density": "10.5 ppg"}, axes={"flow_rate": ["300 gpm", "500 gpm"]})
    ends = client.plan(
        "paper-200m", set={"mud": {"density": "10.5ppg"}}, axes={"flow_rate": Range("300gpm", "500gpm", 2)}
    )
    listed = client.plan("paper-200m", set={"mud.density": "10.5 ppg"}, points=[{"flow_rate": "300 gpm"}])
    assert [point.key for point in field.points] == [point.key for point in si.points]
    assert [point.parameters for point in ends.points] == [
        {"flow_rate": flow, "mud_density": density} for flow in flows
    ]
    assert listed.points[0].key == si.points[0].key
    with pytest.raises(
        InvalidRequest, match="kg/m3, g/cm3, ppg, lb/ft3; `gpm` is a unit of volume flow rate"
    ) as refused:
        client.plan("paper-200m", set={"mud.density": "500 gpm"})
    assert [error.pointer for error in refused.value.errors] == ["/set/mud.density"]
    with pytest.raises(Problem, match=r"m3/s, .* gpm") as malformed:
        client.plan("paper-200m", axes={"flow_rate": ["500 gpm", "0.02"]})
    assert [error.pointer for error in malformed.value.errors] == ["/axes/flow_rate/values/1"]


def test_the_request_is_read_whatever_its_length(client: Client) -> None:
    points = [{"flow_rate": 0.01 + 1e-6 * number} for number in range(4000)]
    sweep = client.submit("paper-200m", design="list", points=points)
    sweep.cancel()
    assert sweep.varied == ("flow_rate",)
    assert sweep.refresh().request["points"] == points


def test_a_sample_is_verified_by_the_reference(client: Client) -> None:
    # Node 49 comes to rest on the wall within this second; a coarse method gets its orbit wrong.
    coarse = {**SHORT, "accuracy": {"integrator": "generalized_alpha", "step": 0.002}, "recording.rate_hz": 500}
    sweep = client.submit("paper-200m", set=coarse, axes={"flow_rate": [0.01, 0.02, 0.04]}, verify=2)
    assert sweep.wait(timeout=120.0).counts.succeeded == 3
    assert sweep.verified is not None
    assert (sweep.verified.total, sweep.verified.succeeded) == (2, 2)
    verification = sweep.verification()
    found = verification.attributes["statistics"]["orbit_radius_rms_49"]
    assert found["verified"] == verification.rows == 2
    value, reference = verification["orbit_radius_rms_49"], verification["reference_orbit_radius_rms_49"]
    assert verification["bias_orbit_radius_rms_49"].tolist() == ((value - reference) / reference).tolist()
    assert verification.attributes["warnings"] == [], "a method in full promises nothing"
    assert sweep.table().to_pandas()["bias_orbit_radius_rms_49"].notna().sum() == 2
    with pytest.raises(InvalidRequest, match="verify"):
        client.submit("paper-200m", verify=1.5)
    assert client.run("paper-200m", set=SHORT, outputs="summary").verified is None


def test_outputs_select_the_kept_tables(client: Client) -> None:
    density = {**SHORT, "mud.density": 1350}
    run = client.run("paper-200m", set=density, outputs="summary").wait(timeout=120.0)
    summary = run.point(1).summary
    assert summary is not None
    assert summary["contact_count"] > 0
    with pytest.raises(Problem, match="keep the summary only"):
        run.point(1).profile()


def test_progress_is_reported_and_drawn(client: Client) -> None:
    seen: list[float] = []
    stream = io.StringIO()
    bar = ProgressBar(stream)

    def show(sweep: Sweep) -> None:
        seen.append(sweep.progress)
        bar.show(sweep)

    # Another density than that of the other tests, so that there is something to compute.
    run = client.run("paper-200m", set={**SHORT, "mud.density": 1313}).wait(timeout=120.0, progress=show)
    bar.close()
    assert seen == sorted(seen)
    assert seen[-1] == 1.0
    assert run.is_finished
    assert run.finished is not None
    assert run.finished > run.created
    # Blanks cover what is left of a line before that told the time left.
    assert re.search(r"\[#{30}\] 100% 1 of 1 points, 0 running, \d:\d\d *\n$", stream.getvalue())


def test_a_sweep_without_workers_reports_the_missing_version(tmp_path: Path) -> None:
    service = Service("serve", "--listen", "127.0.0.1:0", "--data", str(tmp_path))
    with Client(service.server) as client:
        run = client.run("paper-200m", set=SHORT)
        assert "no worker has sent a heartbeat" in (run.waiting_for or "")
        stream = io.StringIO()
        ProgressBar(stream).show(run)
        assert "0 running, waiting for a worker" in stream.getvalue()
        with pytest.raises(TimeoutError, match="no worker has sent a heartbeat"):
            run.wait(timeout=0.2, progress=False)
    service.stop()


def test_wait_gives_up_in_time_and_a_sweep_can_be_cancelled_and_retried(client: Client) -> None:
    long = client.run("paper-200m", set={"duration": 1800, "recording.spectrum_windows": []})
    with pytest.raises(TimeoutError, match=long.id):
        long.wait(timeout=0.3, progress=False)
    with pytest.raises(NoResult) as no_result:
        long.point(1).profile()
    assert no_result.value.point_state in ("queued", "running")
    assert long.cancel().state == "cancelled"
    assert long.wait(timeout=60.0).counts.cancelled == 1
    assert long.retry().counts.cancelled == 0
    long.cancel()


def test_a_sweep_is_paused_changed_found_extended_and_resumed(client: Client) -> None:
    # A density of its own, so that there is something to compute.
    long = {"duration": 1800, "recording.spectrum_windows": [], "mud.density": 1234}
    sweep = client.submit("paper-200m", set=long, axes={"flow_rate": [0.01, 0.03]}, tags={"campaign-7"})
    assert sweep.pause().state == "paused"
    assert [found.id for found in client.sweeps(tag="campaign-7", state="paused")] == [sweep.id]
    sweep.change(name="finer", tags=["x", "y"], priority=-3, is_pinned=True, expires=timedelta(days=90))
    assert (sweep.name, sweep.tags, sweep.priority, sweep.is_pinned) == ("finer", ("x", "y"), -3, True)
    assert sweep.expires is not None
    assert timedelta(days=89) < sweep.expires - datetime.now(timezone.utc) <= timedelta(days=90)
    sweep.change(expires=datetime(2100, 1, 2, 3, 4, tzinfo=timezone.utc))
    assert sweep.expires == datetime(2100, 1, 2, 3, 4, tzinfo=timezone.utc)
    plain = sweep.change(name=None, expires=None)
    assert (plain.name, plain.expires, plain.tags) == (None, None, ("x", "y"))
    assert sweep.append({"flow_rate": Range(0.01, 0.03, 3)}).counts.total == 3
    assert sweep.append(points=[{"flow_rate": 0.015}]).counts.total == 4
    assert sweep.point(4).parameters["flow_rate"] == 0.015
    with pytest.raises(InvalidRequest, match="must be the sweep's parameters"):
        sweep.append({"mud_density": [1300]})
    assert sweep.resume().state == "running"
    other = client.sweep(sweep.id)
    other.change(priority=5)
    with pytest.raises(PreconditionFailed, match="revision"):
        sweep.change(priority=6, if_unchanged=True)
    assert other.change(name="ours", if_unchanged=True).priority == 5
    with pytest.raises(InvalidRequest, match="in the future"):
        sweep.change(expires=timedelta(days=-1))
    with pytest.raises(Conflict, match="pinned"):
        sweep.delete()
    other.change(is_pinned=False)
    sweep.cancel().wait()
    assert sweep.delete(dry_run=True)["points"] == 4
    sweep.delete()
    with pytest.raises(NotFound):
        client.sweep(sweep.id)


def test_known_results_are_reused_or_recomputed(client: Client, sweep: Sweep) -> None:
    with pytest.raises(NoResult, match=r"1 of 2 points .*: 2$"):
        client.submit("paper-200m", set=SHORT, axes={"flow_rate": [0.01, 0.07]}, cache="only")
    known = client.run("paper-200m", set={**SHORT, "mud.density": 1200}, cache="only")
    assert known.state == "completed"
    before = known.point(1).provenance
    anew = client.run("paper-200m", set={**SHORT, "mud.density": 1200}, cache="refresh").wait(timeout=120.0)
    after = anew.point(1)
    assert after.provenance != before
    assert after.summary == sweep.point(1).summary, "the same numbers, bit for bit"


def test_all_problems_of_a_request_are_reported_by_field(client: Client) -> None:
    with pytest.raises(InvalidRequest) as invalid:
        client.submit("paper-200m", axes={"flow_rate": [0.01, -1], "mud_density": Range(1200, 2100, 1)})
    problem = invalid.value
    assert problem.status == 422
    assert {error.pointer for error in problem.errors} >= {"/axes/mud_density/count"}
    with pytest.raises(InvalidRequest) as invalid:
        client.submit("paper-200m", axes={"flow_rate": [0.01, -1]}, set={"operation.bit_weight": 3})
    assert invalid.value.errors
    assert all(error.pointer and error.detail for error in invalid.value.errors)
    assert str(invalid.value.errors[0]) in str(invalid.value) or len(invalid.value.errors) == 1
    with pytest.raises(InvalidRequest) as parameter:
        list(client.sweeps(colour="red"))
    assert parameter.value.errors[0].parameter == "colour"


def test_missing_resources_are_reported(client: Client, sweep: Sweep) -> None:
    with pytest.raises(NotFound):
        client.sweep("../../etc/passwd")
    with pytest.raises(NotFound):
        sweep.point(5)
    with pytest.raises(NotFound):
        sweep.point(1).cost()


def test_failed_point_says_why(client: Client) -> None:
    # Without its wall the string is buckled by the weight on bit. A density that no other test takes, as a failure
    # that is known already is no new one: the latest would be another's.
    buckled = {**SHORT, "effects.contact": "off", "mud.density": 1333.0}
    run = client.run("paper-200m", set=buckled).wait(timeout=120.0)
    (point,) = run.failures()
    assert point.error is not None
    assert point.error.kind == "physical"
    assert "no equilibrium" in point.error.reason
    assert point.error.node is not None
    assert point.summary is None
    latest = next(client.failures(kind="physical"))
    assert (latest.path, latest.error) == (point.path, point.error)
    assert list(client.failures(kind="physical", owner="nobody")) == []


def test_a_plan_stores_nothing(client: Client, sweep: Sweep) -> None:
    before = len(list(client.sweeps()))
    plan = client.plan("paper-200m", set=SHORT, axes={"flow_rate": [0.01, 0.02], "mud_density": [1200]})
    assert (plan.total, plan.known) == (2, 1)
    assert plan.points[0].key == sweep.point(1).key
    assert len(list(client.sweeps())) == before


def test_designs_make_the_points_that_they_should(client: Client) -> None:
    rotation = "operation.rotation_speed_rpm"
    zipped = client.plan("paper-200m", design="zip", axes={"flow_rate": [0.01, 0.02], rotation: [90, 120]})
    assert [point.parameters[rotation] for point in zipped.points] == [90, 120]
    frame = pandas.DataFrame({"flow_rate": [0.01, 0.05], "mud_density": [1200, 1900]})
    listed = client.plan("paper-200m", points=frame.to_dict("records"))
    assert [point.parameters["mud_density"] for point in listed.points] == [1200, 1900]
    axes = {"flow_rate": Range(0.01, 0.05), "mud_density": Range(1000, 2000)}
    drawn = client.plan("paper-200m", design="latin_hypercube", samples=8, seed=3, axes=axes)
    # One point in each eighth of every axis: what makes it a Latin hypercube.
    for name, start, width in (("flow_rate", 0.01, 0.04), ("mud_density", 1000.0, 1000.0)):
        parts = sorted(int(8 * (point.parameters[name] - start) / width) for point in drawn.points)
        assert parts == list(range(8))
    sobol = client.plan("paper-200m", design="sobol", samples=8, seed=3, axes=axes)
    assert sobol.points == client.plan("paper-200m", design="sobol", samples=8, seed=3, axes=axes).points


def test_events_report_every_point_until_the_last_is_final(client: Client) -> None:
    axes: dict[str, Axis] = {"flow_rate": [0.015, 0.025], "mud_density": [1250, 1350]}
    succeeded: list[int] = []
    last: dict[str, Any] = {}
    for name, data in client.submit("paper-200m", set=SHORT, axes=axes).events():
        if name == "point" and data["state"] == "succeeded":
            succeeded += data["ordinals"]
        elif name == "sweep":
            last = data
    assert sorted(succeeded) == [1, 2, 3, 4]
    assert last["state"] == "completed"


def test_whole_sweep_comes_as_one_archive(client: Client, sweep: Sweep, tmp_path: Path) -> None:
    with zipfile.ZipFile(sweep.export(tmp_path / "sweep.zip", tables=["profile", "history"])) as archive:
        assert archive.testzip() is None
        table = pandas.read_csv(archive.open("table.csv"))
        assert table["orbit_radius_rms_49"].tolist() == sweep.table()["orbit_radius_rms_49"].tolist()
        history = polars.read_parquet(archive.open("points/1/history.parquet").read())
    assert history["u_49"].to_list() == pytest.approx(sweep.point(1).history(node=49).columns["u_49"])
    with pytest.raises(NotFound):
        client.download("/v1/sweeps/none/export", tmp_path / "none.zip", {})
    assert list(tmp_path.iterdir()) == [tmp_path / "sweep.zip"]


def test_same_request_under_one_key_is_one_sweep(client: Client) -> None:
    def submit(density: float) -> Sweep:
        return client.run("paper-200m", set={**SHORT, "mud.density": density}, idempotency_key="once")

    assert submit(1200).id == submit(1200).id
    with pytest.raises(IdempotencyKeyReused):
        submit(1201)
    assert client.run("paper-200m", set=SHORT).id != client.run("paper-200m", set=SHORT).id


def test_service_describes_itself(client: Client) -> None:
    assert "paper-200m" in client.scenarios()
    assert client.scenario("paper-200m")["mud"]["flow_rate"] == 0.01
    assert client.limits()["points_per_sweep"] >= 10_000
    assert set(client.queue()) >= {"queued", "running"}
    assert len(client.workers()) == 2


def test_waiting_outlives_a_server_that_is_killed_and_started_anew(tmp_path: Path) -> None:
    with socket.socket() as probe:
        probe.bind(("127.0.0.1", 0))
        address = f"127.0.0.1:{probe.getsockname()[1]}"
    serve = ["serve", "--listen", address, "--data", str(tmp_path)]
    first = Service(*serve)
    with Client(first.server, retry_timeout=60.0) as client:
        sweep = client.run("paper-200m", set=SHORT)
        states: list[str] = []
        waiting = threading.Thread(target=lambda: states.append(sweep.wait(timeout=120.0, progress=False).state))
        waiting.start()
        first.kill()
        up = Service("up", "--workers", "1", *serve[1:])
        waiting.join(120.0)
        assert states == ["completed"]
        up.stop()


def test_absent_server_is_reported_at_once() -> None:
    with socket.socket() as probe:
        probe.bind(("127.0.0.1", 0))
        port = probe.getsockname()[1]
        with Client(f"http://127.0.0.1:{port}") as client:
            with pytest.raises(drillsweep.ConnectionError, match="is the server up") as raised:
                client.queue()
            assert isinstance(raised.value, ConnectionError), "the builtin catches it, too"


def test_reports_are_texts_and_files(sweep: Sweep, tmp_path: Path) -> None:
    text = sweep.report(limits={"largest_side_force": None}, units="field")
    assert text.startswith("<!DOCTYPE html>")
    assert "8.5\N{NO-BREAK SPACE}in" in text
    assert sweep.save_report(tmp_path / "sweep.html").read_text() == sweep.report()
    point = sweep.point(2)
    assert point.key in point.report()
    assert point.save_report(tmp_path / "point.html").read_text() == point.report()


def test_classes_are_drawn_in_their_colours(sweep: Sweep) -> None:
    axes = plot.window(sweep)
    classes = sweep.window().columns["class"]
    known = quantity("class")
    assert known is not None
    drawn = {to_rgba_array(points.get_edgecolor()).tobytes() for points in axes.collections}
    assert drawn == {to_rgba_array(known.words[name]).tobytes() for name in classes}
    assert sum(np.shape(points.get_offsets())[0] for points in axes.collections) == len(classes)
    assert (axes.get_xlabel(), axes.get_ylabel()) == ("flow rate [m\u00b3/s]", "mud density [kg/m\u00b3]")
