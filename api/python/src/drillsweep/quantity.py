"""Meaning of the names of columns and of a scenario's fields: symbols, units, labels."""

from __future__ import annotations

import json
import re
from collections.abc import Mapping
from dataclasses import dataclass
from dataclasses import field as dataclass_field
from functools import cache
from importlib.resources import files
from typing import TYPE_CHECKING, Any

from drillsweep.units import to_pint

if TYPE_CHECKING:
    import pint

_VARIANT = re.compile(r"^(?:spread|ensemble_mean|confidence|reference|bias)_(.+)$")
# A node by its number, its depth or its distance above the bit in metres, and a spectrum window: `_49`, `_57_7m`,
# `_980m_w2`, `_12_5m_above_bit`.
_PLACE = re.compile(r"(?:_\d+(?:_\d+)?m(?:_above_bit)?|_\d+)?(?:_w\d+)?$")


@dataclass(frozen=True)
class Unit:
    """A unit other than the one in which a quantity is served."""

    symbol: str
    """Its notation, such as `mm`."""
    size: float
    """Size in the served unit: 0.0254 for an inch of a length in metres."""

    def of(self, value: Any) -> Any:
        """A value, or an array of values, in this unit."""
        return value / self.size


@dataclass(frozen=True)
class Quantity:
    """Meaning of a name."""

    name: str
    """The name of the column without node and spectrum window, or the path of the scenario's field without indices."""
    label: str
    """Its name in pictures and texts, in the words of the field."""
    unit: str | None
    """The unit in which it is served (`1` for ratios); None for names and numbers of things."""
    shown: Unit
    """The unit in which pictures show it."""
    field: Unit
    """The unit in which the oil field reads it, such as gpm, ppg, klbf or psi."""
    symbol: str = ""
    """Its symbol in the model's equations, if it has one."""
    meaning: str = ""
    """Its meaning, in a sentence."""
    words: Mapping[str, str] = dataclass_field(default_factory=dict)
    """Words of a column of texts that has few, with their colours: classes of points, the most severe first."""

    def to_pint(self, value: Any, registry: pint.UnitRegistry[Any] | None = None) -> pint.Quantity[Any]:
        """A served number, or an array, as a quantity of pint: of the application's registry unless one is given.

        Raises:
            ValueError: It has no unit, or none that pint has (`Pa s^n`).
        """
        if self.unit is None:
            raise ValueError(f"{self.name} has no unit")
        return to_pint(value, self.unit, self.unit, registry)


def quantity(name: str) -> Quantity | None:
    """Quantity of a column of a table, or of a path of a scenario; None if it is of no known quantity.

    >>> quantity("orbit_radius_rms_49").shown.symbol
    'mm'
    """
    known = _quantities()
    if "." in name:
        return known.get(re.sub(r"\[\d+\]", "", name))
    if name in known:
        return known[name]
    variant = _VARIANT.match(name)
    return known.get(_PLACE.sub("", variant[1] if variant else name))


@cache
def _quantities() -> dict[str, Quantity]:
    return read_quantities(json.loads(files("drillsweep").joinpath("quantities.json").read_text(encoding="utf-8")))


def read_quantities(entries: Mapping[str, dict[str, Any]]) -> dict[str, Quantity]:
    """The vocabulary from its JSON."""
    return {name: _read(name, entry) for name, entry in entries.items()}


def _read(name: str, entry: dict[str, Any]) -> Quantity:
    def unit(which: str) -> Unit:
        given = entry.get(which, {"unit": entry.get("unit", ""), "size": 1.0})
        return Unit(given["unit"], given["size"])

    return Quantity(
        name=name,
        label=entry["label"],
        unit=entry.get("unit"),
        shown=unit("shown"),
        field=unit("field"),
        symbol=entry.get("symbol", ""),
        meaning=entry.get("meaning", ""),
        words={word["word"]: word["colour"] for word in entry.get("words", [])},
    )
