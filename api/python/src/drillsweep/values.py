"""Values of a request as plain JSON: every number finite, every problem named by the field, before anything is sent."""

from __future__ import annotations

import math
from collections.abc import Iterable, Mapping, Sequence
from typing import Any, SupportsFloat

from drillsweep.quantity import quantity
from drillsweep.units import from_pint, in_kept, is_pint

Value = SupportsFloat | str
"""A value of a parameter: a number in the unit of its field, a text with its unit (`"500 gpm"`), a quantity of pint."""

Limits = Mapping[str, Value | None]
"""Changes of limits, by column; None removes one."""

_QUERY = {"depth": "m", "from": "s", "to": "s", "window_s": "s", "step_s": "s", "range_hz": "Hz", "to_hz": "Hz"}
_QUERY |= {"travelling_weight": "N", "axial_speed": "m/s"}
"""Units of the numbers of a query that have one."""


def inside(pointer: str, name: str | int) -> str:
    """The JSON Pointer of a field or an element."""
    return f"{pointer}/{str(name).replace('~', '~0').replace('/', '~1')}"


def to_json(value: Any, pointer: str = "") -> Any:
    """A value as plain JSON; arrays and numbers of NumPy become lists and numbers of Python.

    A quantity of pint becomes a text with its unit, or a number in the unit of its field.

    Raises:
        ValueError: A number is NaN or infinite.
        TypeError: A value has no form in JSON, or a quantity is of another dimension than its field.
    """
    if is_pint(value):
        return _with_unit(value, pointer)
    if hasattr(value, "tolist"):
        value = value.tolist()
    if isinstance(value, Mapping):
        return {str(name): to_json(inner, inside(pointer, name)) for name, inner in value.items()}
    if isinstance(value, Sequence) and not isinstance(value, str | bytes):
        return [to_json(inner, inside(pointer, index)) for index, inner in enumerate(value)]
    if isinstance(value, float):
        return number(value, pointer)
    if value is None or isinstance(value, str | int):
        return value
    raise TypeError(f"{pointer}: {value!r} has no form in JSON")


def number(value: Any, pointer: str) -> float:
    """A finite number.

    Raises:
        ValueError: The number is NaN or infinite.
        TypeError: The value is no number.
    """
    try:
        if isinstance(value, str | bytes):
            raise TypeError
        converted = float(value)
    except (TypeError, ValueError):
        raise TypeError(f"{pointer}: must be a number (got {value!r})") from None
    if not math.isfinite(converted):
        raise ValueError(f"{pointer}: must be finite (got {value!r})")
    return converted


def entry(value: Any, pointer: str) -> float | str:
    """A finite number, or a text of a number with its unit, which the service reads.

    Raises:
        ValueError: The number is NaN or infinite.
        TypeError: The value is neither.
    """
    if is_pint(value):
        converted: float | str = _with_unit(value, pointer)
        return converted
    return value if isinstance(value, str) else number(value, pointer)


def in_query(name: str, value: Any) -> Any:
    """A value of a query; a quantity of pint becomes a number in the unit that the query has.

    Raises:
        TypeError: A quantity is of another dimension.
    """
    if not is_pint(value):
        return value
    try:
        return in_kept(value, _QUERY.get(name, "1"))
    except TypeError as error:
        raise TypeError(f"{name}: {error}") from None


def texts(values: Iterable[str], pointer: str) -> list[str]:
    """A list of texts; a single text is none.

    Raises:
        TypeError: The value is a single text.
    """
    if isinstance(values, str):
        raise TypeError(f"{pointer}: must be a list of texts (got {values!r})")
    return list(values)


def limits_text(limits: Limits | None) -> str | None:
    """Limits as a query has them, numbers or texts with their unit; None if there are none."""
    changes: dict[str, str] = {}
    for name, limit in (limits or {}).items():
        if limit is None:
            changes[name] = "off"
        elif is_pint(limit):
            changes[name] = str(_with_unit(limit, inside("/limits", name)))
        else:
            changes[name] = limit if isinstance(limit, str) else repr(float(limit))
    return ",".join(f"{name}:{limit}" for name, limit in changes.items()) or None


def _with_unit(value: Any, pointer: str) -> Any:
    """A quantity of pint as a request has it at a place: a number, a text with its unit, or lists of them."""
    found = quantity(_name(pointer))
    kept = None if found is None else found.unit or "1"
    try:
        magnitude, symbol = from_pint(value, kept)
    except TypeError as error:
        raise TypeError(f"{pointer}: {error}") from None

    def written(magnitude: Any, pointer: str) -> Any:
        if isinstance(magnitude, list):
            return [written(inner, inside(pointer, index)) for index, inner in enumerate(magnitude)]
        finite = number(magnitude, pointer)
        return finite if symbol in (kept, "1") else f"{finite!r} {symbol}"

    return written(magnitude.tolist() if hasattr(magnitude, "tolist") else magnitude, pointer)


def _name(pointer: str) -> str:
    """Name of the column, or path of the scenario's field, of a value at a place of a request."""
    kind, *names = pointer.removeprefix("/").split("/")
    if kind == "axes":
        return names[0]
    return ".".join(name for name in names if not name.isdigit())
