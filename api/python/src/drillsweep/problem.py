"""Errors as exceptions; the service describes them by RFC 9457 problem details."""

from __future__ import annotations

import warnings
from collections.abc import Iterable, Mapping
from dataclasses import dataclass
from typing import Any

PROBLEM_PREFIX = "urn:drillsweep:problem:"


class DrillsweepError(Exception):
    """Everything that this package raises of its own."""


class NoAnswer(DrillsweepError):
    """The server cannot be reached."""


class UnsupportedServer(DrillsweepError):
    """The server is no drillsweep server, or serves a version of the API that this client does not know."""


class DrillsweepWarning(UserWarning):
    """A request that can be simulated but is probably not meant, or an archive that is not complete."""


@dataclass(frozen=True)
class FieldProblem:
    """One thing that is wrong with a request."""

    detail: str
    """Explanation of the problem, and what would be valid."""
    pointer: str | None = None
    """JSON Pointer into the request, such as `/axes/flow_rate/values/2`."""
    parameter: str | None = None
    """Name of the query, path or header parameter."""
    got: Any = None
    """Value that was given; None if none was."""

    @classmethod
    def from_json(cls, data: Mapping[str, Any]) -> FieldProblem:
        """Reads one entry of a problem's `errors`."""
        return cls(
            detail=str(data.get("detail", "")),
            pointer=data.get("pointer"),
            parameter=data.get("parameter"),
            got=data.get("got"),
        )

    def __str__(self) -> str:
        """The place and what is wrong there."""
        place = self.pointer or self.parameter
        return f"{place}: {self.detail}" if place else self.detail


def warn(found: Iterable[FieldProblem], stacklevel: int) -> None:
    """Issues a Python warning for each warning of an answer; `stacklevel` is counted from the caller."""
    for warning in found:
        warnings.warn(str(warning), DrillsweepWarning, stacklevel=stacklevel + 1)


class Problem(DrillsweepError):
    """A request that the service refused, or that it failed at.

    The subclasses are the kinds that a program may want to tell apart; every other kind is a plain Problem.
    """

    def __init__(self, status: int, data: Mapping[str, Any], retry_after: float | None = None) -> None:
        """Makes the exception of a problem document."""
        self.status = status
        """The HTTP status."""
        self.kind = str(data.get("type", "about:blank")).removeprefix(PROBLEM_PREFIX)
        """Stable name of the kind of problem, such as `invalid-request`."""
        self.title = str(data.get("title", f"the server answered {status}"))
        """The kind in words."""
        self.detail = str(data.get("detail", ""))
        """Explanation of this occurrence."""
        self.errors = tuple(FieldProblem.from_json(error) for error in data.get("errors", ()))
        """Every single problem with the request, all at once."""
        self.instance: str | None = data.get("instance")
        """Identifies this occurrence in the service's log."""
        self.point_state: str | None = data.get("state")
        """The state of the point, when the problem is that it has no result."""
        self.retry_after = retry_after
        """Seconds after which another try may do, where the service says so."""
        super().__init__(self._text())

    def _text(self) -> str:
        lines = [f"{self.title}: {self.detail}" if self.detail else self.title]
        if len(self.errors) > 1:
            lines += [f"  {error}" for error in self.errors]
        return "\n".join(lines)


class InvalidRequest(Problem):
    """The request or a parameter of it is not valid; `errors` says which fields and what would be."""


class NotFound(Problem):
    """No such sweep, point, preset, or table of the run."""


class NoResult(Problem):
    """The point has no result, or not yet; `point_state` says where it stands."""


class Conflict(Problem):
    """The sweep's state does not allow the operation."""


class ChangedMeanwhile(Conflict):
    """Somebody else has changed the sweep since it was read."""


class IdempotencyKeyReused(Conflict):
    """The idempotency key belongs to another request."""


class Unauthorized(Problem):
    """The service wants a token, or the one that it got is not valid."""


class Forbidden(Problem):
    """The token does not allow this."""


class RateLimited(Problem):
    """Too much was asked for; `retry_after` says when to try again."""


class Unavailable(Problem):
    """The service is temporarily unavailable."""


_BY_KIND: dict[str, type[Problem]] = {
    "malformed-body": InvalidRequest,
    "invalid-request": InvalidRequest,
    "invalid-parameter": InvalidRequest,
    "body-too-large": InvalidRequest,
    "node-not-recorded": NotFound,
    "not-found": NotFound,
    "no-such-table": NotFound,
    "no-result": NoResult,
    "precondition-failed": ChangedMeanwhile,
    "idempotency-key-reused": IdempotencyKeyReused,
}

_BY_STATUS: dict[int, type[Problem]] = {
    401: Unauthorized,
    403: Forbidden,
    404: NotFound,
    409: Conflict,
    422: InvalidRequest,
    429: RateLimited,
    502: Unavailable,
    503: Unavailable,
    504: Unavailable,
}


def problem(status: int, data: Mapping[str, Any], retry_after: float | None = None) -> Problem:
    """The exception for a problem document: by its type, else by the status."""
    kind = str(data.get("type", "")).removeprefix(PROBLEM_PREFIX)
    by_kind = _BY_KIND.get(kind) or _BY_STATUS.get(status, Problem)
    return by_kind(status, data, retry_after)
