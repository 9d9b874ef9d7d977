"""Errors as exceptions; the service describes them by RFC 9457 problem details."""

from __future__ import annotations

import builtins
import warnings
from collections.abc import Iterable, Mapping
from dataclasses import dataclass
from typing import Any

PROBLEM_PREFIX = "urn:drillsweep:problem:"


class DrillsweepError(Exception):
    """Base class of this package's exceptions."""


class ConnectionError(DrillsweepError, builtins.ConnectionError):
    """The server cannot be reached, or a transfer was interrupted; the builtin `ConnectionError` catches it, too."""


class UnsupportedServer(DrillsweepError):
    """The server is no drillsweep server, or serves a version of the API that this client does not know."""


class DrillsweepWarning(UserWarning):
    """A valid request with a probable mistake, such as a wrong unit, or an incomplete archive."""


@dataclass(frozen=True)
class FieldProblem:
    """One problem of a request."""

    detail: str
    """Explanation of the problem, and the valid values."""
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
        """The place and its problem."""
        place = self.pointer or self.parameter
        return f"{place}: {self.detail}" if place else self.detail


def warn(found: Iterable[FieldProblem], stacklevel: int) -> None:
    """Issues a Python warning for each warning of an answer; `stacklevel` is counted from the caller."""
    for warning in found:
        warnings.warn(str(warning), DrillsweepWarning, stacklevel=stacklevel + 1)


class Problem(DrillsweepError):
    """An error that the service reported.

    Subclasses are the kinds that a program may handle differently; every other kind is a plain `Problem`.
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
        """Time [s] after which a retry may succeed, if the service reports one."""
        super().__init__(self._text())

    def _text(self) -> str:
        lines = [f"{self.title}: {self.detail}" if self.detail else self.title]
        if len(self.errors) > 1:
            lines += [f"  {error}" for error in self.errors]
        return "\n".join(lines)


class InvalidRequest(Problem):
    """The request or one of its parameters is not valid; `errors` has the fields, with valid values."""


class NotFound(Problem):
    """No such sweep, point, preset, or table of the run."""


class NoResult(Problem):
    """The point has no result, or not yet; `point_state` is its state."""


class Conflict(Problem):
    """The sweep's state does not allow the operation."""


class PreconditionFailed(Conflict):
    """The sweep has changed since it was read (HTTP 412)."""


class IdempotencyKeyReused(Conflict):
    """The idempotency key belongs to another request."""


class Unauthorized(Problem):
    """The service requires a token, or the token is not valid."""


class Forbidden(Problem):
    """The token lacks the right to the request."""


class RateLimited(Problem):
    """Too many requests; `retry_after` is the time until a retry may succeed."""


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
    "precondition-failed": PreconditionFailed,
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
