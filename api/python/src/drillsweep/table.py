"""Tables: columns of equal length with units, and attributes that hold for the whole."""

from __future__ import annotations

from collections.abc import Iterator, Mapping
from dataclasses import dataclass, field
from typing import TYPE_CHECKING, Any

from drillsweep.optional import require
from drillsweep.quantity import quantity
from drillsweep.units import to_pint

if TYPE_CHECKING:
    import numpy
    import pandas
    import pint
    import polars


@dataclass(frozen=True)
class Table(Mapping[str, "numpy.ndarray[Any, Any]"]):
    """A table of the service.

    As a mapping it has the columns as numpy arrays (`orbit["u"]`); `columns` has them as plain lists, without numpy.
    """

    columns: dict[str, list[Any]]
    """The columns by name; a value that does not exist is None."""
    units: dict[str, str] = field(default_factory=dict)
    """Units of the columns that have one; ratios have `1`."""
    attributes: dict[str, Any] = field(default_factory=dict)
    """Attributes of the table as a whole, such as the node, its depth, or a spectrum's peaks."""

    @classmethod
    def from_json(cls, data: Mapping[str, Any]) -> Table:
        """Reads the service's JSON."""
        return cls(dict(data["columns"]), dict(data.get("units", {})), dict(data.get("attributes", {})))

    def __getitem__(self, name: str) -> numpy.ndarray[Any, Any]:
        """A column as an array: missing numbers are NaN, missing texts are empty."""
        np = require("numpy", "numpy")
        values = self.columns[name]
        array: numpy.ndarray[Any, Any]
        if any(isinstance(value, str) for value in values):
            array = np.array(["" if value is None else value for value in values])
        elif values and all(isinstance(value, int) for value in values):
            array = np.array(values, dtype=np.int64)
        else:
            array = np.array([np.nan if value is None else value for value in values], dtype=np.float64)
        return array

    def __iter__(self) -> Iterator[str]:
        """The names of the columns."""
        return iter(self.columns)

    def __len__(self) -> int:
        """The number of columns, as for any mapping; `rows` is the number of rows."""
        return len(self.columns)

    @property
    def rows(self) -> int:
        """The number of rows."""
        return len(next(iter(self.columns.values()), ()))

    @property
    def unsettled(self) -> numpy.ndarray[Any, Any]:
        """True for the rows of a sweep's table that have not settled or have a mode that still grows.

        Their statistics may be those of the start alone: leave them out of maps and fits.
        """
        np = require("numpy", "numpy")
        regimes = self.columns.get("motion_regime", [None] * self.rows)
        growing = self.columns.get("growing_mode_hz", [None] * self.rows)
        doubts = [regime == "not_settled" or hz is not None for regime, hz in zip(regimes, growing, strict=True)]
        array: numpy.ndarray[Any, Any] = np.array(doubts, dtype=bool)
        return array

    def to_pandas(self) -> pandas.DataFrame:
        """A pandas data frame; units and attributes are in its `attrs`."""
        pd = require("pandas", "pandas")
        frame: pandas.DataFrame = pd.DataFrame({name: self._series(name, pd) for name in self.columns})
        frame.attrs["units"] = self.units
        frame.attrs.update(self.attributes)
        return frame

    def _series(self, name: str, pd: Any) -> Any:
        values = self.columns[name]
        numbers = [value for value in values if value is not None]
        if numbers and len(numbers) < len(values) and all(isinstance(value, int) for value in numbers):
            return pd.Series(values, dtype="Int64")
        if all(isinstance(value, int | float) for value in numbers):
            return pd.Series(values, dtype=None if numbers and len(numbers) == len(values) else "float64")
        return pd.Series(values)

    def to_polars(self) -> polars.DataFrame:
        """A polars data frame."""
        # Whole and broken numbers may stand in one column of JSON.
        frame: polars.DataFrame = require("polars", "polars").DataFrame(self.columns, strict=False)
        return frame

    def to_pint(self, registry: pint.UnitRegistry[Any] | None = None) -> dict[str, Any]:
        """The columns by name, as quantities of pint: of the application's registry unless one is given.

        Columns without a unit are arrays; so are those in `Pa s^n`, whose exponent is a value.
        """
        columns: dict[str, Any] = {}
        for name, array in self.items():
            symbol, known = self.units.get(name), quantity(name)
            if symbol is None or "s^n" in symbol:
                columns[name] = array
            else:
                kept = known.unit if known is not None else None
                columns[name] = to_pint(array, symbol, kept or symbol, registry)
        return columns

    def __repr__(self) -> str:
        """Names, units and number of rows; not the values."""
        columns = ", ".join(f"{name} [{self.units[name]}]" if name in self.units else name for name in self)
        return f"Table({self.rows} rows: {columns})"
