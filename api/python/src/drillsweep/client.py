"""The connection to a server."""

from __future__ import annotations

import logging
import os
import time
import uuid
from collections.abc import Iterable, Iterator, Mapping
from pathlib import Path
from types import TracebackType
from typing import Any, Literal
from urllib.parse import quote

import httpx
from httpx_sse import EventSource

from drillsweep.design import Axis, Design, design_to_json
from drillsweep.point import FailureClass, Point
from drillsweep.problem import PROBLEM_PREFIX, ConnectionError, Problem, UnsupportedServer, problem, warn
from drillsweep.quantity import Quantity, read_quantities
from drillsweep.request import Accuracy, Cache, Outputs, request_to_json
from drillsweep.sweep import Plan, Signs, Sweep
from drillsweep.values import Value, in_query, to_json

DEFAULT_SERVER = "http://127.0.0.1:7340"
API_VERSION = "1"
"""The version of the API that this client speaks, the `info.version` of the OpenAPI document."""

TallyOrder = Literal["from_bit", "from_top"]
"""Directions in which a tally lists its components."""

TallyLengths = Literal["each", "total"]
"""Meanings of a length next to a number of joints."""

UnitSystem = Literal["si", "field"]
"""Systems of units of columns that have none."""

_LOG = logging.getLogger("drillsweep")

_PAGE = 500
_FIRST_PAUSE = 0.2
_LONGEST_PAUSE = 5.0
_RETRYABLE = frozenset({429, 502, 503, 504})


class Client:
    """A connection to one server, for one thread at a time."""

    def __init__(
        self,
        server: str | None = None,
        *,
        token: str | None = None,
        timeout: float = 60.0,
        retry_timeout: float = 60.0,
    ) -> None:
        """Connects to nothing yet; the first request does.

        Args:
            server: Address, such as `https://drillsweep.example` or `HOST:PORT` for `http://HOST:PORT`;
                `DRILLSWEEP_SERVER` unless given, or else port 7340 of this machine.
            token: Token of the server; `DRILLSWEEP_TOKEN` unless given.
            timeout: Longest wait for one answer [s].
            retry_timeout: Time [s] over which a request is retried, with backoff, if a server that has answered before
                does not answer (restart) or refuses for a while (rate limit). Every request of this client is
                idempotent.

        Raises:
            ValueError: The address is not an HTTP address.
        """
        self.server = _base_url(server or os.environ.get("DRILLSWEEP_SERVER") or DEFAULT_SERVER)
        self.retry_timeout = retry_timeout
        token = token or os.environ.get("DRILLSWEEP_TOKEN")
        headers = {"authorization": f"Bearer {token}"} if token else {}
        self._timeout = timeout
        self._http = httpx.Client(base_url=self.server, headers=headers, timeout=timeout)
        self._has_answered = False
        self._is_supported = False

    def submit(
        self,
        preset: str | None = None,
        *,
        scenario: Mapping[str, Any] | None = None,
        set: Mapping[str, Any] | None = None,
        accuracy: Accuracy | None = None,
        axes: Mapping[str, Axis] | None = None,
        design: Design | None = None,
        samples: int | None = None,
        seed: int | None = None,
        skip: int | None = None,
        points: Iterable[Mapping[str, Value]] | None = None,
        outputs: Outputs | None = None,
        verify: float | None = None,
        name: str | None = None,
        owner: str | None = None,
        priority: int | None = None,
        signs: Signs | None = None,
        tags: Iterable[str] | None = None,
        cache: Cache | None = None,
        idempotency_key: str | None = None,
    ) -> Sweep:
        """Submits a sweep: the scenario at the points that the axes make.

        Each warning of the service is issued as a `DrillsweepWarning`, too.

        Args:
            preset: Name of a preset scenario; either this or `scenario`.
            scenario: A scenario in full.
            set: Changes to the scenario by path, such as `{"duration": 60, "operation.rotation_speed_rpm": 120}`.
            accuracy: The scenario's accuracy: `draft`, `standard`, `reference`, a bound on the error such as
                `{"statistics": 0.01}`, or `{"integrator": "rk4", "step": 2e-5}`.
            axes: The swept parameters, each an `Axis`: a list or an array of values, or a `Range`. Names are
                `flow_rate`, `mud_density`, or the path of any numeric field of the scenario.
            design: How points are made from the axes: `grid` (the default), `zip`, `latin_hypercube` or `sobol`; or
                `list`, with `points`.
            samples: Number of points of a design that draws.
            seed: Seed of such a design; the same seed always draws the same points.
            skip: Points at the start of the Sobol sequence to skip, to continue another sweep of the same seed.
            points: The points of the design `list`, each with a value for every parameter; rows of a data frame do
                (`frame.to_dict("records")`).
            outputs: Outputs that are kept of each point: `"summary"` (its row of the table alone), `"spectra"`,
                `{"orbits": {"nodes": [{"node": 49}], "window": {"from": 40, "to": 60}, "decimation": 4}}` or `"full"`.
            verify: Fraction of the points, such as 0.05, or number of points that run again at the accuracy
                `reference`, to measure the bias of the requested accuracy; `Sweep.verification` has the results.
            name: A name for people.
            owner: Owner, whose share of the workers it counts against.
            priority: Higher goes first among the sweeps of one owner, -10 to 10.
            signs: `"driller"` takes compression in `operation.weight_on_bit`, and opposition to clockwise rotation in
                `operation.torque_on_bit`, as positive; `"model"` as negative (the default).
            tags: Words to find it by.
            cache: Policy for points that were computed before: `reuse` takes their results (the default),
                `refresh` computes them anew, `only` takes them and computes nothing.
            idempotency_key: The same request under the same key is one sweep, however often and from wherever it is
                sent; absent means a new sweep each call.

        Raises:
            ValueError: A number is NaN or infinite; nothing has been sent.
            TypeError: An axis is no list of numbers, or another value cannot be that of its field; nothing has been
                sent.
            InvalidRequest: The request is not valid; `errors` lists every problem, by field.
            NoResult: Points have not been computed, and `cache` is `only`; the text names them.
        """
        fields = design_to_json(design, samples, seed, skip, points)
        fields |= {
            "outputs": outputs,
            "verify": verify,
            "name": name,
            "owner": owner,
            "priority": priority,
            "signs": signs,
        }
        body = request_to_json(preset, scenario, set, accuracy, axes, tags, **fields)
        sweep = self._submit("/v1/sweeps", body, idempotency_key, cache)
        warn(sweep.warnings, stacklevel=2)
        return sweep

    def run(
        self,
        preset: str | None = None,
        *,
        scenario: Mapping[str, Any] | None = None,
        set: Mapping[str, Any] | None = None,
        accuracy: Accuracy | None = None,
        outputs: Outputs | None = None,
        name: str | None = None,
        owner: str | None = None,
        priority: int | None = None,
        signs: Signs | None = None,
        tags: Iterable[str] | None = None,
        cache: Cache | None = None,
        idempotency_key: str | None = None,
    ) -> Sweep:
        """Submits a single run: a sweep whose only point is 1. Arguments are those of `submit`."""
        fields = {"outputs": outputs, "name": name, "owner": owner, "priority": priority, "signs": signs}
        body = request_to_json(preset, scenario, set, accuracy, None, tags, **fields)
        sweep = self._submit("/v1/runs", body, idempotency_key, cache)
        warn(sweep.warnings, stacklevel=2)
        return sweep

    def plan(
        self,
        preset: str | None = None,
        *,
        scenario: Mapping[str, Any] | None = None,
        set: Mapping[str, Any] | None = None,
        accuracy: Accuracy | None = None,
        axes: Mapping[str, Axis] | None = None,
        design: Design | None = None,
        samples: int | None = None,
        seed: int | None = None,
        skip: int | None = None,
        points: Iterable[Mapping[str, Value]] | None = None,
        outputs: Outputs | None = None,
        verify: float | None = None,
    ) -> Plan:
        """Plans a sweep without storing anything. Arguments and warnings are those of `submit`."""
        fields = design_to_json(design, samples, seed, skip, points) | {"outputs": outputs, "verify": verify}
        body = request_to_json(preset, scenario, set, accuracy, axes, None, **fields)
        plan = Plan.from_json(self.post_json("/v1/sweeps", body, {"dry_run": "true"}))
        warn(plan.warnings, stacklevel=2)
        return plan

    def sweep(self, id: str) -> Sweep:
        """An existing sweep."""
        return Sweep(self, self.get_json(f"/v1/sweeps/{_segment(id)}"))

    def sweeps(self, *, owner: str | None = None, tag: str | None = None, **filters: Any) -> Iterator[Sweep]:
        """All sweeps, newest first; those of one owner, with a tag, or that pass the service's other filters."""
        for data in self.pages("/v1/sweeps", "sweeps", {"owner": owner, "tag": tag, **filters}):
            yield Sweep(self, data)

    def failures(self, *, owner: str | None = None, kind: FailureClass | None = None) -> Iterator[Point]:
        """Failed points of all sweeps, the latest first; of one owner, or of one `PointError.kind`."""
        for data in self.pages("/v1/failures", "failures", {"owner": owner, "class": kind}):
            yield Point(self, data)

    def scenarios(self) -> dict[str, str]:
        """Names and descriptions of the preset scenarios."""
        entries = self.get_json("/v1/scenarios")["scenarios"]
        return {entry["name"]: entry["description"] for entry in entries}

    def scenario(self, name: str) -> dict[str, Any]:
        """A preset scenario in full."""
        return dict(self.get_json(f"/v1/scenarios/{_segment(name)}")["scenario"])

    def pipes(self) -> list[dict[str, Any]]:
        """The catalogue of pipes: sections without a length, in SI units, by the names that `pipe` of a section has."""
        return list(self.get_json("/v1/pipes")["pipes"])

    def import_survey(
        self, source: str | Path | bytes, *, depth_unit: str | None = None, sheet: str | None = None
    ) -> dict[str, Any]:
        """Reads a directional survey of another program: CSV, Excel, LAS or a WITSML trajectory.

        The answer has `stations` for `well.survey`, the meaning of each column (`columns`), `remarks`, and the cells
        that were left out (`problems`), by row and column. The service stores nothing.

        Args:
            source: File, or its bytes.
            depth_unit: Unit of measured depth if the file has none, such as `"ft"`.
            sheet: Sheet of a workbook; the first one unless given.

        Raises:
            Problem: The service cannot read it, or it leaves open what an argument decides; the text names it.
        """
        return self._import("survey", source, {"depth_unit": depth_unit, "sheet": sheet})

    def import_tally(
        self,
        source: str | Path | bytes,
        *,
        order: TallyOrder | None = None,
        lengths: TallyLengths | None = None,
        assumed_units: UnitSystem | None = None,
        sheet: str | None = None,
    ) -> dict[str, Any]:
        """Reads the components of a string of another program: CSV, Excel or a WITSML tubular.

        The answer has `sections` from the top down for `string.sections`, their `length` [m] and `mass` in air [kg],
        the meaning of each row (`components`) and column (`columns`), `remarks` and `problems`. The service stores
        nothing.

        Args:
            source: File, or its bytes.
            order: Direction of the list; the bit decides unless given.
            lengths: Meaning of a length next to a number of joints; cumulative lengths decide unless given.
            assumed_units: Units of columns that have none: `"si"` (m, mm, kg/m) or `"field"` (ft, in, lb/ft).
            sheet: Sheet of a workbook, the first one unless given; or name of a WITSML tubular.

        Raises:
            Problem: The service cannot read it, or it leaves open what an argument decides; the text names it.
        """
        query = {"order": order, "lengths": lengths, "assumed_units": assumed_units, "sheet": sheet}
        return self._import("tally", source, query)

    def import_hole(
        self, source: str | Path | bytes, *, assumed_units: UnitSystem | None = None, sheet: str | None = None
    ) -> dict[str, Any]:
        """Reads casings and open hole of another program: CSV, Excel or a WITSML geometry of a wellbore.

        The answer has `sections` for `well.section`, `columns`, `remarks` and `problems`. The service stores nothing.

        Args:
            source: File, or its bytes.
            assumed_units: Units of columns that have none: `"si"` (m, mm) or `"field"` (ft, in).
            sheet: Sheet of a workbook, the first one unless given; or name of a WITSML geometry.

        Raises:
            Problem: The service cannot read it, or it leaves open what an argument decides; the text names it.
        """
        return self._import("hole", source, {"assumed_units": assumed_units, "sheet": sheet})

    def import_mud(
        self,
        readings: Mapping[float, float] | None = None,
        *,
        plastic_viscosity: float | None = None,
        yield_point: float | None = None,
        low_shear_yield_point: float | None = None,
    ) -> dict[str, Any]:
        """Fits a yield power law to viscometer readings, or to plastic viscosity and yield point.

        The answer to readings has `least_squares` with `yield_stress`, `consistency` and `flow_index` for `mud`, and
        the laws of other conventions; that to viscosity and yield point has these three itself.

        Args:
            readings: Readings of the dial [deg], by speed [rev/min].
            plastic_viscosity: Plastic viscosity [Pa s], in place of readings.
            yield_point: Yield point [Pa].
            low_shear_yield_point: Low-shear yield point [Pa]; 0 unless given.

        Raises:
            InvalidRequest: No viscous fluid has these values, or both forms are given.
        """
        body = {
            "readings": None if readings is None else [{"rpm": rpm, "dial": dial} for rpm, dial in readings.items()],
            "plastic_viscosity": plastic_viscosity,
            "yield_point": yield_point,
            "low_shear_yield_point": low_shear_yield_point,
        }
        given = {name: value for name, value in body.items() if value is not None}
        return self.post_json("/v1/imports/mud", to_json(given))

    def quantities(self) -> dict[str, Quantity]:
        """The service's vocabulary, by name; `drillsweep.quantity` has the client's own, without a request."""
        return read_quantities(self.get_json("/v1/quantities"))

    def workers(self) -> list[dict[str, Any]]:
        """The worker processes."""
        return list(self.get_json("/v1/workers")["workers"])

    def queue(self) -> dict[str, int]:
        """Numbers of queued and running work items."""
        return dict(self.get_json("/v1/queue"))

    def limits(self) -> dict[str, int]:
        """Limits of the service."""
        return dict(self.get_json("/v1/limits"))

    def get_json(
        self, path: str, query: Mapping[str, Any] | None = None, *, read_timeout: float | None = None
    ) -> dict[str, Any]:
        """Gets JSON; entries of the query that are None are left out."""
        return dict(self._send("GET", path, query=query, read_timeout=read_timeout).json())

    def get_text(self, path: str, query: Mapping[str, Any] | None = None) -> str:
        """Gets a text; entries of the query that are None are left out."""
        return self._send("GET", path, query=query).text

    def post_json(
        self,
        path: str,
        body: Mapping[str, Any],
        query: Mapping[str, Any] | None = None,
        headers: Mapping[str, str] | None = None,
    ) -> dict[str, Any]:
        """Posts JSON and reads JSON."""
        return dict(self._send("POST", path, query=query, body=body, headers=headers).json())

    def patch_json(
        self, path: str, body: Mapping[str, Any], headers: Mapping[str, str] | None = None
    ) -> dict[str, Any]:
        """Sends a change as JSON and reads JSON."""
        return dict(self._send("PATCH", path, body=body, headers=headers).json())

    def delete_json(self, path: str, query: Mapping[str, Any]) -> dict[str, Any]:
        """Deletes a resource and reads JSON."""
        return dict(self._send("DELETE", path, query=query).json())

    def pages(self, path: str, entries: str, query: Mapping[str, Any]) -> Iterator[dict[str, Any]]:
        """The entries of a list that is served in pages."""
        cursor: str | None = None
        while True:
            page = self.get_json(path, {**query, "limit": _PAGE, "cursor": cursor})
            yield from page[entries]
            cursor = page.get("next")
            if cursor is None:
                return

    def save(self, path: str, file: str | Path, query: Mapping[str, Any]) -> Path:
        """Writes an answer of the service to a file, in the format of the file's ending."""
        file = Path(file)
        response = self._send("GET", path, query={**query, "format": file.suffix.removeprefix(".")})
        file.write_bytes(response.content)
        return file

    def download(self, path: str, file: str | Path, query: Mapping[str, Any]) -> Path:
        """Streams an answer of the service to a file; an interrupted transfer leaves no file."""
        self._handshake()
        file = Path(file)
        part = file.with_name(file.name + ".part")
        parameters = {name: value for name, value in query.items() if value is not None}
        # Files are compressed as they are.
        headers = {"accept-encoding": "identity"}
        try:
            with (
                self._http.stream("GET", path, params=parameters, headers=headers) as response,
                part.open("wb") as sink,
            ):
                if not response.is_success:
                    response.read()
                    raise _problem(response)
                for piece in response.iter_bytes():
                    sink.write(piece)
            part.replace(file)
        except httpx.TransportError as error:
            raise ConnectionError(f"the transfer from {self.server} was interrupted: {error}") from error
        finally:
            part.unlink(missing_ok=True)
        return file

    def events(self, path: str, query: Mapping[str, Any] | None = None) -> Iterator[tuple[str, dict[str, Any]]]:
        """Names and data of a stream of server-sent events, until the server has no further events.

        After an interruption, such as a restart of the server, the stream resumes after the last event received.
        """
        self._handshake()
        last: str | None = None
        parameters = {name: value for name, value in (query or {}).items() if value is not None}
        deadline = time.monotonic() + self.retry_timeout
        while True:
            headers = {"accept": "text/event-stream", **({} if last is None else {"last-event-id": last})}
            try:
                with self._http.stream("GET", path, params=parameters, headers=headers) as response:
                    if response.status_code == 204:
                        return
                    if not response.is_success:
                        response.read()
                        raise _problem(response)
                    for event in EventSource(response).iter_sse():
                        last = event.id or last
                        deadline = time.monotonic() + self.retry_timeout
                        # A comment that keeps the connection alive comes as an event without data.
                        if event.data:
                            yield event.event, event.json()
            except httpx.TransportError as error:
                if time.monotonic() > deadline:
                    raise ConnectionError(f"the events of {self.server} were interrupted: {error}") from error
                _LOG.info("the events of %s were interrupted, and are resumed: %s", path, error)
            time.sleep(_FIRST_PAUSE)

    def close(self) -> None:
        """Closes the connections."""
        self._http.close()

    def __enter__(self) -> Client:
        """The client itself."""
        return self

    def __exit__(
        self, kind: type[BaseException] | None, error: BaseException | None, trace: TracebackType | None
    ) -> None:
        """Closes the connections."""
        self.close()

    def _import(self, part: str, source: str | Path | bytes, query: Mapping[str, Any]) -> dict[str, Any]:
        content = source if isinstance(source, bytes) else Path(source).read_bytes()
        headers = {"content-type": "application/octet-stream"}
        return dict(self._send("POST", f"/v1/imports/{part}", query=query, content=content, headers=headers).json())

    def _submit(self, path: str, body: Mapping[str, Any], key: str | None, cache: Cache | None) -> Sweep:
        # With a key every submission can be sent again when the answer got lost.
        headers = {"idempotency-key": key or str(uuid.uuid4())}
        sweep = Sweep(self, self.post_json(path, body, {"cache": cache}, headers))
        _LOG.info("submitted sweep %s of %d points to %s", sweep.id, sweep.counts.total, self.server)
        return sweep

    def _send(
        self,
        method: str,
        path: str,
        *,
        query: Mapping[str, Any] | None = None,
        body: Mapping[str, Any] | None = None,
        content: bytes | None = None,
        headers: Mapping[str, str] | None = None,
        read_timeout: float | None = None,
    ) -> httpx.Response:
        parameters = {name: in_query(name, value) for name, value in (query or {}).items() if value is not None}
        self._handshake()
        timeout = httpx.Timeout(self._timeout, read=max(read_timeout or 0.0, self._timeout))
        sent = {"json": body} if content is None else {"content": content}
        response = self._answer(method, path, params=parameters, **sent, headers=headers, timeout=timeout)
        if not response.is_success:
            raise _problem(response)
        return response

    def _handshake(self) -> None:
        """Checks, until it has succeeded once, that a drillsweep server of this version of the API answers.

        Raises:
            UnsupportedServer: Another server does.
        """
        if self._is_supported:
            return
        response = self._answer("GET", "/v1/limits")
        document = _json_object(response)
        if response.is_success:
            self._is_supported = "points_per_sweep" in document
        elif response.status_code in _RETRYABLE:
            raise _problem(response)
        else:
            # A server that requires a token answers by a problem, which the request itself will meet again.
            kind = str(document.get("type", ""))
            self._is_supported = kind.startswith(PROBLEM_PREFIX) and response.status_code != 404
        if not self._is_supported:
            raise UnsupportedServer(self._other_server(response))
        _LOG.debug("%s serves version %s of the API", self.server, API_VERSION)

    def _other_server(self, response: httpx.Response) -> str:
        info = _json_object(self._answer("GET", "/openapi.json")).get("info")
        if isinstance(info, dict) and info.get("title") == "drillsweep":
            version = info.get("version")
            return f"{self.server} serves version {version} of the API; this client needs version {API_VERSION}"
        location = response.headers.get("location")
        found = f"a redirection to {location}" if location else response.headers.get("content-type", "no content type")
        return (
            f"{self.server} is not a drillsweep server: GET {response.request.url.path} was answered by "
            f"{response.status_code} with {found}"
        )

    def _answer(self, method: str, path: str, **request: Any) -> httpx.Response:
        """The answer to a request, retried with backoff while the server is unavailable."""
        deadline = time.monotonic() + self.retry_timeout
        pause = _FIRST_PAUSE
        while True:
            wait = pause
            try:
                response = self._http.request(method, path, **request)
            except httpx.TransportError as error:
                if not self._has_answered or time.monotonic() + wait > deadline:
                    raise ConnectionError(f"no answer from {self.server}: {error}; is the server up?") from error
                reason = f"no answer: {error}"
            else:
                self._has_answered = True
                retry_after = _seconds(response.headers.get("retry-after"))
                wait = wait if retry_after is None else retry_after
                if response.status_code not in _RETRYABLE or time.monotonic() + wait > deadline:
                    return response
                reason = f"answered {response.status_code}"
            _LOG.info("%s %s of %s: %s; sent again in %.1f s", method, path, self.server, reason, wait)
            time.sleep(wait)
            pause = min(2.0 * pause, _LONGEST_PAUSE)


def _base_url(server: str) -> str:
    """The address of a server with its scheme, HTTP unless given."""
    address = (server if "://" in server else f"http://{server}").rstrip("/")
    try:
        url = httpx.URL(address)
    except httpx.InvalidURL as error:
        raise ValueError(f"server: {error} (got {server!r})") from error
    if url.scheme not in ("http", "https") or not url.host:
        raise ValueError(f"server: must be an address such as http://127.0.0.1:7340 (got {server!r})")
    return address


def _problem(response: httpx.Response) -> Problem:
    return problem(response.status_code, _json_object(response), _seconds(response.headers.get("retry-after")))


def _json_object(response: httpx.Response) -> dict[str, Any]:
    """The object that an answer holds; empty if it holds anything else."""
    try:
        data = response.json()
    except ValueError:
        return {}
    return data if isinstance(data, dict) else {}


def _seconds(text: str | None) -> float | None:
    try:
        return None if text is None else max(float(text), 0.0)
    except ValueError:
        return None


def _segment(text: str) -> str:
    """A text as one segment of a path."""
    return quote(text, safe="")
