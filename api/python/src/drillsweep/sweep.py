"""A sweep: following it, its points, its table."""

from __future__ import annotations

import json
import logging
import sys
import time
import warnings
import zipfile
from collections.abc import Callable, Iterable, Iterator, Mapping, Sequence
from dataclasses import dataclass
from datetime import datetime, timedelta, timezone
from enum import Enum
from pathlib import Path
from typing import TYPE_CHECKING, Any, Literal

from drillsweep.design import Axis, Design, axes_to_json, design_to_json
from drillsweep.point import Point, PointState
from drillsweep.problem import DrillsweepWarning, FieldProblem, warn
from drillsweep.progress import ProgressBar, is_interactive
from drillsweep.report import Reported
from drillsweep.table import Table
from drillsweep.values import Limits, Value, limits_text, texts, to_json

if TYPE_CHECKING:
    from drillsweep.client import Client

_LOG = logging.getLogger("drillsweep")

_LONG_POLL = 30.0
"""Seconds for which the service holds an answer back until something changes."""


Signs = Literal["model", "driller"]
"""Signs of weight and torque on bit: those of the model, or compression and opposing torque as positive."""


class Unchanged(Enum):
    """The kind of `UNCHANGED`."""

    UNCHANGED = "unchanged"


UNCHANGED = Unchanged.UNCHANGED
"""Value of fields that a change leaves as they are, because None is a value of its own."""


@dataclass(frozen=True)
class Counts:
    """Numbers of a sweep's points, or of the reference runs that verify some, by state."""

    total: int
    queued: int
    running: int
    succeeded: int
    failed: int
    cancelled: int


@dataclass(frozen=True)
class PlannedPoint:
    """A point that a request would become."""

    ordinal: int
    parameters: dict[str, float]
    key: str


@dataclass(frozen=True)
class Plan:
    """Preview of a request; nothing is stored."""

    total: int
    """Number of points."""
    known: int
    """Points whose result is already there."""
    points: tuple[PlannedPoint, ...]
    """The points, in order."""
    warnings: tuple[FieldProblem, ...]
    """Warnings about probable mistakes in a valid request."""
    data: dict[str, Any]
    """The service's whole answer."""

    @classmethod
    def from_json(cls, data: Mapping[str, Any]) -> Plan:
        """Reads the answer to a dry run."""
        points = (PlannedPoint(p["ordinal"], dict(p["parameters"]), p["key"]) for p in data.get("points", ()))
        warnings = (FieldProblem.from_json(warning) for warning in data.get("warnings", ()))
        return cls(int(data["total"]), int(data["known"]), tuple(points), tuple(warnings), dict(data))


class Sweep(Reported):
    """A sweep on the server, in the state of the last answer; `refresh` and `wait` update it."""

    def __init__(self, client: Client, data: Mapping[str, Any]) -> None:
        """A sweep as the service returned it."""
        self._client = client
        self._data = dict(data)

    @property
    def id(self) -> str:
        """Identifier."""
        return str(self._data["id"])

    @property
    def name(self) -> str | None:
        """The name given to it."""
        return self._data.get("name")

    @property
    def owner(self) -> str:
        """Owner, whose share of the workers it counts against."""
        return str(self._data["owner"])

    @property
    def tags(self) -> tuple[str, ...]:
        """Words to find it by."""
        return tuple(self._data.get("tags", ()))

    @property
    def varied(self) -> tuple[str, ...]:
        """Names of the parameters that it varies, in the order of its request."""
        return tuple(self._data.get("varied", ()))

    @property
    def priority(self) -> int:
        """Higher goes first among the sweeps of one owner."""
        return int(self._data["priority"])

    @property
    def is_pinned(self) -> bool:
        """True if the sweep and its data are kept regardless of age."""
        return bool(self._data["pinned"])

    @property
    def expires(self) -> datetime | None:
        """When it is to be deleted; None is never."""
        text = self._data.get("expires")
        return None if text is None else _time(text)

    @property
    def state(self) -> str:
        """Its state as a whole: `running`, `paused`, `completed` or `cancelled`."""
        return str(self._data["state"])

    @property
    def counts(self) -> Counts:
        """Its points by state."""
        return _counts(self._data["counts"])

    @property
    def verified(self) -> Counts | None:
        """The reference runs that verify some of its points, by state; None if none was requested."""
        verification = self._data.get("verification")
        return None if verification is None else _counts(verification["counts"])

    @property
    def progress(self) -> float:
        """Fraction of the work that is done, reference runs included, 0 to 1."""
        return float(self._data["progress"])

    @property
    def waiting_for(self) -> str | None:
        """The reason if its queued points cannot start, such as no worker of their physics version; else None."""
        waiting = self._data.get("waiting_for")
        return None if waiting is None else str(waiting["reason"])

    @property
    def created(self) -> datetime:
        """When it was submitted."""
        return _time(self._data["created"])

    @property
    def finished(self) -> datetime | None:
        """When its last point became final; None while there are others."""
        text = self._data.get("finished")
        return None if text is None else _time(text)

    @property
    def is_finished(self) -> bool:
        """Whether every point is final, and every reference run that verifies one."""
        return self._data.get("finished") is not None

    @property
    def warnings(self) -> tuple[FieldProblem, ...]:
        """Warnings about probable mistakes in a valid request; in the answer to a submission only."""
        return tuple(FieldProblem.from_json(warning) for warning in self._data.get("warnings", ()))

    @property
    def request(self) -> dict[str, Any]:
        """Request of the sweep."""
        if "request" not in self._data:
            self._data["request"] = self._client.get_json(f"{self.path}/request")
        return dict(self._data["request"])

    @property
    def path(self) -> str:
        """Its path on the server."""
        return str(self._data["links"]["self"])

    def refresh(self) -> Sweep:
        """Updates it from the server."""
        self._data = self._client.get_json(self.path)
        return self

    def wait(
        self,
        timeout: float | None = None,
        progress: bool | Callable[[Sweep], None] | None = None,
    ) -> Sweep:
        """Waits until every point is final, and every reference run that verifies one, and returns the sweep.

        Requests to a server that is unavailable, for example during a restart, are retried (`Client.retry_timeout`).
        Failed points do not raise: see `counts.failed` and `failures`. An interrupt (Ctrl-C) ends only the wait: the
        sweep continues on the server, and a warning in the log `drillsweep` shows how to return to it.

        Args:
            timeout: Longest wait [s]; None is without end.
            progress: True shows a bar, False none, a function is called after every change; None shows a bar
                on a terminal or in a notebook.

        Raises:
            TimeoutError: When `timeout` is over.
        """
        deadline = None if timeout is None else time.monotonic() + timeout
        bar = ProgressBar() if progress is True or (progress is None and is_interactive(sys.stderr)) else None
        show = bar.show if bar else progress if callable(progress) else _nothing
        try:
            _LOG.info("waiting for sweep %s", self.id)
            self.refresh()
            show(self)
            while not self.is_finished:
                wait = _LONG_POLL if deadline is None else min(_LONG_POLL, deadline - time.monotonic())
                if wait <= 0.0:
                    reason = f": {self.waiting_for}" if self.waiting_for else ""
                    raise TimeoutError(f"sweep {self.id} is not complete after {timeout:g} s{reason}")
                self._data = self._client.get_json(self.path, {"wait": f"{wait:.3f}s"}, read_timeout=wait + 30.0)
                _LOG.debug("%r", self)
                show(self)
        except KeyboardInterrupt:
            if bar:
                bar.close()
            if not self.is_finished:
                text = "sweep %s continues at %s: client.sweep(%r) returns to it, its cancel() ends it"
                _LOG.warning(text, self.id, self._client.server, self.id)
            raise
        finally:
            if bar:
                bar.close()
        return self

    def events(self) -> Iterator[tuple[str, dict[str, Any]]]:
        """Events from now on, as they happen, until every point is final.

        Pairs of a name and data: `sweep` with the sweep in its present state, `point` with the `ordinals` of points
        that came to a new `state` at a time `at`.
        """
        return self._client.events(f"{self.path}/events")

    def point(self, ordinal: int) -> Point:
        """One point, in full; the first is 1."""
        return Point(self._client, self._client.get_json(f"{self.path}/points/{ordinal}"))

    def points(self, state: PointState | None = None) -> Iterator[Point]:
        """Its points in order, those in one state or all."""
        for data in self._client.pages(f"{self.path}/points", "points", {"state": state}):
            yield Point(self._client, data)

    def failures(self) -> list[Point]:
        """The points that failed; `Point.error` has the reason."""
        return list(self.points("failed"))

    def table(self, *, units: str | None = None, signs: Signs | None = None) -> Table:
        """One row a point: its parameters and the scalars of its result.

        Args:
            units: Units of the columns: `"si"`, `"field"`, or `"field,mud_density:kg/m3"`; None means the kept units.
            signs: `"driller"` has compression of the bit, and torque that opposes clockwise rotation, as positive.
        """
        return Table.from_json(self._client.get_json(f"{self.path}/table", {"units": units, "signs": signs}))

    def window(
        self,
        limits: Limits | None = None,
        *,
        units: str | None = None,
        signs: Signs | None = None,
    ) -> Table:
        """Operating window: parameters, class and finding of each point.

        Args:
            limits: Changes of the service's limits, by column, as numbers in the column's unit or
                with a unit; None removes one.
            units: Units of the columns, as of `table`.
            signs: Signs at the bit, as of `table`.
        """
        query = {"limits": limits_text(limits), "units": units, "signs": signs}
        return Table.from_json(self._client.get_json(f"{self.path}/window", query))

    def verification(self) -> Table:
        """Results of verifying some of its points by the reference (`Client.submit(verify=...)`).

        One row a verified point: for each statistic, such as `orbit_radius_rms_49`, its value, that of the reference
        (`reference_orbit_radius_rms_49`) and the bias (`bias_orbit_radius_rms_49`), relative to the reference or, of
        frequencies, in Hz. `attributes["statistics"]` has mean and largest bias of each, and the promise of the
        accuracy; `attributes["warnings"]` lists the statistics that exceed it.
        """
        return Table.from_json(self._client.get_json(f"{self.path}/verification"))

    def save_table(self, file: str | Path, *, units: str | None = None, signs: Signs | None = None) -> Path:
        """Writes the table to a file, in the format of its ending: .csv, .json, .parquet; the rest as of `table`."""
        query = {"units": units, "signs": signs}
        given = {name: value for name, value in query.items() if value is not None}
        return self._client.save(f"{self.path}/table", file, given)

    def export(self, file: str | Path, tables: Sequence[str] | None = None) -> Path:
        """Writes the whole sweep to one zip archive: request, table, and the tables of every point as Parquet.

        Args:
            file: The archive.
            tables: Names of the tables of each point, such as `["profile", "history"]`; None means all.

        The archive lacks tables that the service has lost or that have expired. A warning reports them, and
        `manifest.json` in the archive lists them with the reason.
        """
        names = None if tables is None else ",".join(tables)
        archive = self._client.download(f"{self.path}/export", file, {"artifacts": names})
        with zipfile.ZipFile(archive) as opened:
            missing = json.loads(opened.read("manifest.json"))["missing"]
        if missing:
            first = missing[0]
            place = f"{first['table']} of point {first['point']}"
            text = f"{len(missing)} tables are not in {archive}; the first is {place}: {first['reason']}"
            warnings.warn(text, DrillsweepWarning, stacklevel=2)
        return archive

    def cancel(self) -> Sweep:
        """Cancels it: queued points at once, running ones within a heartbeat of their worker."""
        return self._act("cancel")

    def retry(self) -> Sweep:
        """Queues its failed and cancelled points again."""
        return self._act("retry")

    def pause(self) -> Sweep:
        """Pauses it: queued points start only if another sweep has them, too; running ones continue."""
        return self._act("pause")

    def resume(self) -> Sweep:
        """Resumes it after a pause: its queued points may be started again."""
        return self._act("resume")

    def change(
        self,
        *,
        name: str | Unchanged | None = UNCHANGED,
        tags: Iterable[str] | Unchanged = UNCHANGED,
        priority: int | Unchanged = UNCHANGED,
        is_pinned: bool | Unchanged = UNCHANGED,
        expires: datetime | timedelta | Unchanged | None = UNCHANGED,
        if_unchanged: bool = False,
    ) -> Sweep:
        """Changes the given fields, and leaves the rest.

        Args:
            name: A name for people; None takes it away.
            tags: Words to find it by, in place of those that it has.
            priority: Higher goes first among the sweeps of one owner, -10 to 10.
            is_pinned: True if the sweep and its data are kept regardless of age.
            expires: When it is to be deleted, once all its points are final and unless it is pinned: a time, a span
                from now, or None for never. A time without a zone is this machine's.
            if_unchanged: Raise `PreconditionFailed`, and change nothing, if the sweep has changed since this object
                read it (`If-Match` with its ETag). Progress of its points is not a change.
        """
        if isinstance(expires, timedelta):
            expires = datetime.now(timezone.utc) + expires
        if isinstance(expires, datetime):
            moment: Any = expires.astimezone(timezone.utc).isoformat()
        else:
            moment = expires
        changes = {
            "name": name,
            "tags": tags if isinstance(tags, Unchanged) else texts(tags, "/tags"),
            "priority": priority,
            "pinned": is_pinned,
            "expires": moment,
        }
        body = {field: value for field, value in changes.items() if not isinstance(value, Unchanged)}
        headers = {"if-match": f'"{self._data["revision"]}"'} if if_unchanged else None
        self._data = self._client.patch_json(self.path, body, headers)
        return self

    def delete(self, *, dry_run: bool = False) -> dict[str, Any]:
        """Deletes it, and returns how many points and results were deleted; a dry run only counts them.

        Raises:
            Conflict: It is pinned, or has points that are not final.
        """
        return self._client.delete_json(self.path, {"dry_run": "true" if dry_run else None})

    def append(
        self,
        axes: Mapping[str, Axis] | None = None,
        *,
        design: Design | None = None,
        samples: int | None = None,
        seed: int | None = None,
        skip: int | None = None,
        points: Iterable[Mapping[str, Value]] | None = None,
    ) -> Sweep:
        """Adds points over its own parameters, by any design; those that it has already are skipped.

        Arguments and warnings are those of `Client.submit`. Numbers of points go on from the last.
        """
        fields = {"axes": axes_to_json(axes), **design_to_json(design, samples, seed, skip, points)}
        body = to_json({field: value for field, value in fields.items() if value is not None})
        self._data = self._client.post_json(f"{self.path}/points", body)
        warn(self.warnings, stacklevel=2)
        return self

    def refine(
        self,
        by: str = "class",
        *,
        over: Sequence[str] = (),
        resolution: float = 0.02,
        difference: float | None = None,
        limits: Limits | None = None,
        budget: int = 100,
        timeout: float | None = None,
    ) -> Sweep:
        """Adds points between neighbours whose classes or values differ, round by round, and waits for their results.

        It ends when every edge is located to the resolution, or the budget is spent: see `refinement`.

        Args:
            by: `"class"`, or a column of numbers.
            over: One or two of the sweep's parameters, over which points are neighbours; all of them unless given.
            resolution: Longest edge that is not divided, as a part of the range of a parameter.
            difference: For a column: smallest difference that is divided, as a part of the range of all values.
            limits: For classes: changes of the service's limits, by column, as numbers in the column's unit or
                with a unit; None removes one.
            budget: Largest number of points to add.
            timeout: Longest wait for the points of one round [s]; None is without end.

        Raises:
            InvalidRequest: An argument is not valid, or no point has a class or a value yet.
            TimeoutError: When `timeout` is over.
        """
        first = self.wait(timeout).counts.total
        while (left := budget - (before := self.counts.total) + first) > 0:
            fields = {"by": by, "over": list(over), "resolution": resolution, "difference": difference}
            fields |= {"limits": limits_text(limits), "budget": left}
            refine = {field: value for field, value in fields.items() if value is not None}
            self._data = self._client.post_json(f"{self.path}/points", to_json({"refine": refine}))
            warn(self.warnings, stacklevel=2)
            if self.counts.total == before:
                break
            state = self.refinement
            self.wait(timeout)
            self._data["refinement"] = state
        return self

    @property
    def refinement(self) -> dict[str, Any] | None:
        """State before the last round of `refine`: open edges, longest edge, proposed points; else None."""
        state = self._data.get("refinement")
        return None if state is None else dict(state)

    def _act(self, verb: str) -> Sweep:
        self._data = self._client.post_json(f"{self.path}/{verb}", {})
        return self

    def __repr__(self) -> str:
        """Identifier, state and counts."""
        counts = self.counts
        return f"Sweep({self.id}, {self.state}, {counts.succeeded} of {counts.total} points)"


def _counts(counts: Mapping[str, Any]) -> Counts:
    return Counts(**{name: int(counts[name]) for name in Counts.__dataclass_fields__})


def _nothing(_: Sweep) -> None:
    pass


def _time(text: str) -> datetime:
    # Python 3.10 reads neither `Z` nor other than 3 or 6 digits of a second.
    moment, _, fraction = text.removesuffix("Z").partition(".")
    return datetime.fromisoformat(f"{moment}.{(fraction or '0')[:6].ljust(6, '0')}+00:00")
