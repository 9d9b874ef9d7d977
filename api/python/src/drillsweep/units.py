"""Units of the service as units of pint, which is imported only if a caller uses it."""

from __future__ import annotations

import sys
from typing import TYPE_CHECKING, Any

from drillsweep.optional import require

if TYPE_CHECKING:
    import pint

FAMILIES: tuple[dict[str, str], ...] = (
    {"1": "", "%": "percent"},
    {"s": "s", "ms": "ms", "min": "min", "h": "h"},
    {"Hz": "Hz", "kHz": "kHz"},
    {"1/s": "1/s", "1/min": "1/min", "1/h": "1/h"},
    {"m": "m", "mm": "mm", "cm": "cm", "km": "km", "in": "inch", "ft": "ft"},
    {"m2": "m**2", "mm2": "mm**2", "cm2": "cm**2", "in2": "inch**2"},
    {"1/m": "1/m", "1/mm": "1/mm", "1/in": "1/inch", "1/ft": "1/ft"},
    {"m/s": "m/s", "mm/s": "mm/s", "m/min": "m/min", "m/h": "m/h", "ft/s": "ft/s", "ft/min": "ft/min", "ft/h": "ft/h"},
    {"m/s2": "m/s**2", "g": "standard_gravity", "ft/s2": "ft/s**2"},
    {"deg": "degree", "rad": "radian"},
    {"rpm": "rpm", "rev/min": "turn/min", "rad/s": "radian/s", "deg/s": "degree/s", "rev/s": "turn/s"},
    {"kg": "kg", "g": "gram", "t": "metric_ton", "lb": "pound"},
    {"kg/m": "kg/m", "lb/ft": "pound/ft"},
    {"kg m2": "kg*m**2", "lb ft2": "pound*ft**2"},
    {"kg/m3": "kg/m**3", "g/cm3": "g/cm**3", "kg/l": "kg/liter", "ppg": "pound/gallon", "lb/ft3": "pound/ft**3"},
    {"m3/s": "m**3/s", "m3/min": "m**3/min", "m3/h": "m**3/h", "l/s": "liter/s", "l/min": "liter/min"}
    | {"gpm": "gallon/min", "bbl/min": "oil_barrel/min"},
    {"N": "N", "daN": "daN", "kN": "kN", "MN": "MN", "lbf": "lbf", "klbf": "klbf", "kip": "kip"}
    | {"kgf": "kgf", "tf": "force_metric_ton"},
    {"N m": "N*m", "daN m": "daN*m", "kN m": "kN*m"}
    | {"ft lbf": "ft*lbf", "ft-lbf": "foot_pound", "kft lbf": "ft*klbf", "in lbf": "inch*lbf"},
    {"J": "J", "kJ": "kJ", "MJ": "MJ", "ft lbf": "ft*lbf", "ft-lbf": "foot_pound"},
    {"W": "W", "kW": "kW", "hp": "horsepower", "ft lbf/min": "ft*lbf/min"},
    {"m2/s": "m**2/s", "mm2/s": "mm**2/s", "cSt": "cSt"},
    {"Pa": "Pa", "kPa": "kPa", "MPa": "MPa", "GPa": "GPa", "bar": "bar"}
    | {"psi": "psi", "lbf/in2": "lbf/inch**2", "ksi": "ksi", "Mpsi": "megapsi"},
    {"Pa/m": "Pa/m", "kPa/m": "kPa/m", "bar/m": "bar/m", "psi/ft": "psi/ft"},
    {"N/m": "N/m", "kN/m": "kN/m", "MN/m": "MN/m", "lbf/in": "lbf/inch", "lbf/ft": "lbf/ft"},
    {"N/m2": "N/m**2", "kN/m2": "kN/m**2", "MN/m2": "MN/m**2", "lbf/in2": "lbf/inch**2"},
    {"N s/m": "N*s/m", "kN s/m": "kN*s/m", "lbf s/in": "lbf*s/inch"},
    {"N s/m2": "N*s/m**2", "kN s/m2": "kN*s/m**2", "lbf s/in2": "lbf*s/inch**2"},
)
"""The service's units by dimension: symbols with the units of pint that are equal to them.

`lbf/100 ft2` is none of pint's, whose units have no factor; neither is `Pa s^n`, whose exponent is a value.
"""

_PER_HUNDRED = ("lbf/100 ft2", "lbf/100ft2")


def is_pint(value: Any) -> bool:
    """True for a quantity of pint, of any registry."""
    pint = sys.modules.get("pint")
    return pint is not None and isinstance(value, pint.Quantity)


def to_pint(value: Any, symbol: str, kept: str, registry: pint.UnitRegistry[Any] | None = None) -> pint.Quantity[Any]:
    """A number or an array in a unit of the service, of a quantity that is kept in the unit `kept`.

    Raises:
        ValueError: Pint has no such unit.
    """
    known = require("pint", "pint").get_application_registry() if registry is None else registry
    if symbol in _PER_HUNDRED:
        return known.Quantity(value / 100.0, "lbf/ft**2")
    # A symbol of another dimension is that of a bias, which is a ratio.
    unit = next((family[symbol] for family in (_family(kept), *FAMILIES) if symbol in family), None)
    if unit is None:
        raise ValueError(f"pint has no unit {symbol}")
    return known.Quantity(value, unit)


def from_pint(value: pint.Quantity[Any], kept: str | None) -> tuple[Any, str]:
    """Magnitude and symbol of a quantity of pint, in its own unit if the service has that, else in the unit `kept`.

    Without `kept` the dimension is free. Rates and ratios are not converted: to pint a hertz is a radian per second,
    and a radian is 1.

    Raises:
        TypeError: The quantity is of another dimension.
    """
    family = _family(kept)
    units = [*family.items()] if kept is not None else [pair for other in FAMILIES for pair in other.items()]
    for symbol, unit in units:
        if _is_in(value, unit):
            return value.magnitude, symbol
    is_ambiguous = dict(value.dimensionality) in ({}, {"[time]": -1})
    if kept in family and not is_ambiguous and value.is_compatible_with(family[kept]):
        return value.m_as(family[kept]), kept
    fits = "a unit of the service" if kept is None else f"one of the units {', '.join(family) or kept}"
    raise TypeError(f"must have {fits} (got {value!r})")


def in_kept(value: pint.Quantity[Any], kept: str) -> float:
    """Number of a quantity of pint in a unit in which the service keeps quantities.

    Raises:
        TypeError: The quantity is of another dimension.
    """
    magnitude, symbol = from_pint(value, kept)
    return float(magnitude if symbol == kept else value.m_as(_family(kept)[kept]))


def _family(kept: str | None) -> dict[str, str]:
    return next((family for family in FAMILIES if kept in family), {})


def _is_in(value: pint.Quantity[Any], unit: str) -> bool:
    # A registry of a caller's own definitions may lack the unit, which is an AttributeError.
    try:
        return bool(value.units == type(value.units)(unit))
    except AttributeError:
        return False
