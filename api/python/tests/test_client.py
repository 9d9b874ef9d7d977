"""The client's handling of requests and answers, apart from any service unless a test takes one."""

from __future__ import annotations

import importlib.metadata
import json
import logging
import os
import subprocess
import sys
import threading
from collections.abc import Iterator
from http.server import BaseHTTPRequestHandler, HTTPServer
from pathlib import Path
from typing import Any, get_args

import httpx
import numpy as np
import pytest

import drillsweep
from drillsweep import Client, DrillsweepWarning, NotFound, Range, Sweep, UnsupportedServer
from drillsweep.client import API_VERSION
from drillsweep.design import Design, Scale
from drillsweep.point import Decimation, FailureClass, PointState, SpectrumWindow
from drillsweep.request import AccuracyPreset, Cache
from service import REPOSITORY, SHORT

DOCUMENT = json.loads((REPOSITORY / "api" / "openapi.json").read_text())


def client_of(answer: Any) -> Client:
    """A client whose requests a function answers, but for the handshake."""

    def all_of(request: httpx.Request) -> httpx.Response:
        if request.url.path == "/v1/limits":
            return httpx.Response(200, json={"points_per_sweep": 1})
        answered: httpx.Response = answer(request)
        return answered

    client = Client("service")
    client._http = httpx.Client(base_url=client.server, transport=httpx.MockTransport(all_of))
    return client


def test_a_stream_goes_on_after_its_last_event_and_comments_are_no_events() -> None:
    asked = []

    def answer(request: httpx.Request) -> httpx.Response:
        asked.append(request.headers.get("last-event-id"))
        if len(asked) == 3:
            return httpx.Response(204)
        stream = f': alive\n\nid: {len(asked)}\nevent: point\ndata: {{"number": {len(asked)}}}\n\n: alive\n\n'
        return httpx.Response(200, headers={"content-type": "text/event-stream"}, text=stream)

    with client_of(answer) as client:
        assert list(client.events("/v1/sweeps/1/events")) == [("point", {"number": 1}), ("point", {"number": 2})]
    assert asked == [None, "1", "2"]


def test_an_interval_is_a_range_without_a_count() -> None:
    assert Range(1.0, 2.0, 3).to_json() == {"from": 1.0, "to": 2.0, "count": 3, "scale": "linear"}
    assert Range(1.0, 2.0, scale="log").to_json() == {"from": 1.0, "to": 2.0, "scale": "log"}


def test_downloads_are_whole_or_absent(client: Client, sweep: Sweep, tmp_path: Path) -> None:
    file = client.download(f"{sweep.path}/table", tmp_path / "table.csv", {"format": "csv"})
    assert len(file.read_text().splitlines()) == 5
    with pytest.raises(NotFound):
        client.download("/v1/sweeps/none/table", tmp_path / "none.csv", {"format": "csv"})
    assert list(tmp_path.iterdir()) == [file]


def test_warnings_of_the_service_are_warnings_at_the_callers_line(client: Client) -> None:
    # 10.5 ppg are 1258 kg/m3.
    ppg: dict[str, drillsweep.Axis] = {"mud_density": [10.5]}
    set_of: dict[str, Any] = {**SHORT, "effects.transient": "off"}
    unit = r"^/axes/mud_density/values/0: is outside the usual range, 800 to 2600 kg/m3"
    with pytest.warns(DrillsweepWarning, match=unit) as submitted:
        sweep = client.submit("paper-200m", set=set_of, axes=ppg)
    assert [warning.filename for warning in submitted] == [__file__]
    assert [str(warning.message) for warning in submitted] == [str(warning) for warning in sweep.warnings]
    with pytest.warns(DrillsweepWarning, match=unit) as planned:
        client.plan("paper-200m", set=set_of, axes=ppg)
    with pytest.warns(DrillsweepWarning, match=r"is outside the usual range, 800 to 2600 kg/m3") as appended:
        sweep.append({"mud_density": [10.25]})
    with pytest.warns(DrillsweepWarning, match=r"is outside the usual range, 800 to 2600 kg/m3") as run:
        client.run("paper-200m", set=set_of | {"mud.density": 10.5})
    assert {warning.filename for warned in (planned, appended, run) for warning in warned} == {__file__}


@pytest.mark.parametrize(
    ("arguments", "error", "message"),
    [
        ({"axes": {"flow_rate": 0.01}}, TypeError, "/axes/flow_rate: must be a Range, or a list"),
        ({"axes": {"flow_rate": "0.01:0.06:3"}}, TypeError, "/axes/flow_rate: must be a Range, or a list"),
        ({"axes": {"flow_rate": [0.01, None]}}, TypeError, "/axes/flow_rate/values/1: must be a number"),
        ({"axes": {"flow_rate": np.array([0.01, np.nan])}}, ValueError, "/axes/flow_rate/values/1: must be finite"),
        ({"axes": {"flow_rate": Range(0.01, float("inf"), 3)}}, ValueError, "/axes/flow_rate/to: must be finite"),
        ({"axes": {"flow_rate": {"values": [-np.inf]}}}, ValueError, "/axes/flow_rate/values/0: must be finite"),
        ({"points": [{"flow_rate": np.nan}]}, ValueError, "/points/0/flow_rate: must be finite"),
        ({"set": {"mud": {"density": np.float64("nan")}}}, ValueError, "/set/mud/density: must be finite"),
        ({"set": {"mud.density": {1200}}}, TypeError, "/set/mud.density: .* has no form in JSON"),
        ({"set": {"accuracy": "draft"}, "accuracy": "draft"}, ValueError, "/set/accuracy"),
        ({"verify": np.nan}, ValueError, "/verify: must be finite"),
        ({"tags": "campaign-7"}, TypeError, "/tags: must be a list of texts"),
        ({"desing": "grid"}, TypeError, "desing"),
    ],
)
def test_values_that_no_field_can_have_are_refused_before_they_are_sent(
    arguments: dict[str, Any], error: type[Exception], message: str
) -> None:
    def answer(request: httpx.Request) -> httpx.Response:
        raise AssertionError(request)

    with client_of(answer) as client, pytest.raises(error, match=message):
        client.submit("paper-200m", **arguments)


def test_the_accuracy_is_set_in_the_scenario(client: Client) -> None:
    changes = {name: value for name, value in SHORT.items() if name != "accuracy"}
    draft = client.plan("paper-200m", set=changes, accuracy="draft")
    assert draft.points == client.plan("paper-200m", set=SHORT).points
    assert draft.points != client.plan("paper-200m", set=changes, accuracy={"statistics": 0.01}).points


def test_names_that_are_typed_are_those_of_the_api() -> None:
    schemas = DOCUMENT["components"]["schemas"]

    def parameter(path: str, method: str, name: str) -> list[str]:
        parameters = DOCUMENT["paths"][path][method]["parameters"]
        (found,) = (one["schema"]["enum"] for one in parameters if one["name"] == name)
        return list(found)

    point = "/v1/sweeps/{id}/points/{n}"
    for typed, names in (
        (Design, schemas["Design"]["enum"]),
        (Scale, schemas["Scale"]["enum"]),
        (AccuracyPreset, schemas["AccuracyPreset"]["enum"]),
        (PointState, schemas["PointState"]["enum"]),
        (FailureClass, schemas["FailureClass"]["enum"]),
        (Cache, parameter("/v1/sweeps", "post", "cache")),
        (Decimation, parameter(f"{point}/history", "get", "decimation")),
        (SpectrumWindow, parameter(f"{point}/spectrum", "get", "window")),
    ):
        assert sorted(get_args(typed)) == sorted(names)


def test_mypy_refuses_names_that_no_argument_has(tmp_path: Path) -> None:
    good = """
import numpy as np

from drillsweep import Axis, Client, Range

client = Client()
axes: dict[str, Axis] = {"flow_rate": np.linspace(0.01, 0.06, 3), "mud_density": [1200]}
client.submit("paper-200m", axes=axes, design="grid", cache="only", accuracy="draft", outputs="summary")
client.plan("paper-200m", axes={"flow_rate": Range(0.01, 0.06), "mud_density": {"from": 1200, "to": 2100}})
client.run("paper-200m", outputs={"orbits": {"nodes": [{"depth": 57.7}]}}, accuracy={"statistics": 0.01})
"""
    bad = [
        'client.submit("paper-200m", axes=axes, design="gird")',
        'client.submit("paper-200m", cache="never")',
        'client.run("paper-200m", accuracy="fine")',
        'client.run("paper-200m", outputs="sumary")',
        'client.run("paper-200m", outputs={"orbits": {"node": [49]}})',
        'client.plan("paper-200m", axes={"flow_rate": "0.01:0.06:3"})',
        'client.plan("paper-200m", axes={"flow_rate": 0.01})',
        'client.plan("paper-200m", axes={"flow_rate": {"start": 0.01, "stop": 0.06}})',
        'client.sweep("ID").append(axes, design="gird")',
        'client.sweep("ID").points("finished")',
    ]
    snippet = tmp_path / "snippet.py"
    snippet.write_text(good + "\n".join(bad) + "\n")
    command = [sys.executable, "-m", "mypy", "--strict", "--no-error-summary", "--cache-dir", str(tmp_path)]
    environment = {**os.environ, "MYPYPATH": str(Path(drillsweep.__file__).parents[1])}
    run = subprocess.run([*command, str(snippet)], capture_output=True, text=True, env=environment, cwd=tmp_path)
    first = good.count("\n") + 1
    errors = [line.split(":") for line in run.stdout.splitlines() if ": error: " in line]
    assert sorted({int(line[1]) for line in errors}) == list(range(first, first + len(bad))), run.stdout + run.stderr


def test_an_interrupted_wait_says_how_to_return(caplog: pytest.LogCaptureFixture) -> None:
    counts = dict.fromkeys(("total", "queued", "running", "succeeded", "failed", "cancelled"), 1)
    data = {"id": "42", "links": {"self": "/v1/sweeps/42"}, "state": "running", "counts": counts, "progress": 0.5}

    def interrupt(_: Sweep) -> None:
        raise KeyboardInterrupt

    with client_of(lambda _: httpx.Response(200, json=data)) as client, pytest.raises(KeyboardInterrupt):
        client.sweep("42").wait(progress=interrupt)
    (record,) = (record for record in caplog.records if record.name == "drillsweep")
    assert record.levelno == logging.WARNING, "shown without any configuration of logging"
    assert "sweep 42 continues at http://service: client.sweep('42') returns to it" in record.getMessage()


def test_retries_are_logged(caplog: pytest.LogCaptureFixture) -> None:
    answers = iter([httpx.Response(503, headers={"retry-after": "0"}), httpx.Response(200, json={"queued": 0})])
    with caplog.at_level(logging.INFO, "drillsweep"), client_of(lambda _: next(answers)) as client:
        assert client.queue() == {"queued": 0}
    (record,) = (record for record in caplog.records if record.name == "drillsweep")
    assert "GET /v1/queue of http://service: answered 503; sent again in 0.0 s" in record.getMessage()


@pytest.mark.parametrize(
    ("given", "address"),
    [
        ("127.0.0.1:7340", "http://127.0.0.1:7340"),
        ("localhost", "http://localhost"),
        ("https://sweeps.example/drillsweep/", "https://sweeps.example/drillsweep"),
    ],
)
def test_an_address_without_a_scheme_is_one_of_http(given: str, address: str) -> None:
    with Client(given) as client:
        assert client.server == address


@pytest.mark.parametrize("given", ["ftp://host", "http://", "host:port", "unix:///run/drillsweep"])
def test_an_address_that_is_none_is_refused(given: str) -> None:
    with pytest.raises(ValueError, match=r"^server: "):
        Client(given)


def test_versions_are_those_of_the_package_and_of_the_api() -> None:
    assert drillsweep.__version__ == importlib.metadata.version("drillsweep")
    assert DOCUMENT["info"]["version"] == API_VERSION


class Other(BaseHTTPRequestHandler):
    """A web server that has one document, and a page for all else."""

    document: bytes | None = None
    asked: list[str]

    def do_GET(self) -> None:
        """Answers with the document or the page."""
        self.asked.append(self.path)
        is_document = self.path == "/openapi.json" and self.document is not None
        body = self.document if is_document and self.document else b"<html>It works!</html>"
        self.send_response(200)
        self.send_header("content-type", "application/json" if is_document else "text/html")
        self.send_header("content-length", str(len(body)))
        self.end_headers()
        self.wfile.write(body)

    def do_POST(self) -> None:
        """Answers as to GET."""
        self.do_GET()

    def log_message(self, *_: object) -> None:
        """Logs nothing."""


@pytest.fixture(params=[None, b'{"info": {"title": "drillsweep", "version": "2"}}'], ids=["foreign", "newer"])
def other(request: pytest.FixtureRequest) -> Iterator[tuple[str, list[str], bytes | None]]:
    """The address of another server, its requests, and its document."""
    handler = type("Handler", (Other,), {"document": request.param, "asked": []})
    server = HTTPServer(("127.0.0.1", 0), handler)
    thread = threading.Thread(target=server.serve_forever)
    thread.start()
    yield f"127.0.0.1:{server.server_port}", handler.asked, request.param  # type: ignore[attr-defined]
    server.shutdown()
    thread.join()
    server.server_close()


def test_another_server_is_refused_before_anything_is_posted(other: tuple[str, list[str], bytes | None]) -> None:
    address, asked, document = other
    expected = "answered by 200 with text/html" if document is None else "serves version 2 of the API"
    with Client(address) as client:
        for use in (
            lambda: client.run("paper-200m"),
            lambda: next(client.events("/v1/sweeps/1/events")),
            lambda: client.download("/v1/sweeps/1/export", "sweep.zip", {}),
        ):
            with pytest.raises(UnsupportedServer, match=expected):
                use()
    assert set(asked) == {"/v1/limits", "/openapi.json"}


def test_the_handshake_is_made_once() -> None:
    asked = []

    def answer(request: httpx.Request) -> httpx.Response:
        asked.append(request.url.path)
        return httpx.Response(200, json={"points_per_sweep": 1, "queued": 0})

    with Client("service") as client:
        client._http = httpx.Client(base_url=client.server, transport=httpx.MockTransport(answer))
        client.queue()
        client.queue()
    assert asked == ["/v1/limits", "/v1/queue", "/v1/queue"]
