"""Values of a request as plain JSON: every number finite, every problem named by the field, before anything is sent."""

from __future__ import annotations

import math
from collections.abc import Iterable, Mapping, Sequence
from typing import Any


def inside(pointer: str, name: str | int) -> str:
    """The JSON Pointer of a field or an element."""
    return f"{pointer}/{str(name).replace('~', '~0').replace('/', '~1')}"


def to_json(value: Any, pointer: str = "") -> Any:
    """A value as plain JSON; arrays and numbers of NumPy become lists and numbers of Python.

    Raises:
        ValueError: A number is NaN or infinite.
        TypeError: A value has no form in JSON.
    """
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
    return value if isinstance(value, str) else number(value, pointer)


def texts(values: Iterable[str], pointer: str) -> list[str]:
    """A list of texts; a single text is none.

    Raises:
        TypeError: The value is a single text.
    """
    if isinstance(values, str):
        raise TypeError(f"{pointer}: must be a list of texts (got {values!r})")
    return list(values)


def limits_text(limits: Mapping[str, float | str | None] | None) -> str | None:
    """Limits as a request has them, numbers or texts with their unit; None if there are none."""
    changes: dict[str, str] = {}
    for name, limit in (limits or {}).items():
        if limit is None:
            changes[name] = "off"
        else:
            changes[name] = limit if isinstance(limit, str) else repr(float(limit))
    return ",".join(f"{name}:{limit}" for name, limit in changes.items()) or None
