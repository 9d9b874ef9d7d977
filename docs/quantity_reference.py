"""Writes `quantities.md`, every column of a table with its units, from the vocabulary of quantities.

Run: `python docs/quantity_reference.py`
"""

import json
from pathlib import Path
from typing import Any

DOCS = Path(__file__).parent
Entry = dict[str, Any]

INTRODUCTION = """# Columns and units

What the columns of tables and the fields of a point's summary are, with the unit in which they are served, and
the oil field's. A node's number stands at the end of a name (`u_49`), or the depth in metres for which the node is
recorded (`orbit_radius_rms_57_7m` for 57.7 m), or its distance above the bit (`orbit_radius_rms_12_5m_above_bit`), that
of a spectrum window after it (`line_amplitude_57_7m_w1`).
`ensemble_mean_` and `spread_` before a name make it the mean and the standard deviation
over an ensemble, `confidence_` half the width of the interval of 95 % of irregular motion, `reference_` and `bias_`
what a reference run shows; biases are relative, but for frequencies.
Whole numbers and texts have no unit."""

CLOSING = """In Python, `drillsweep.quantity(name)` has all this of any column or field; sizes of units are those of
NIST Special Publication 811."""


def reference() -> str:
    """The whole chapter."""
    path = DOCS.parent / "api" / "python" / "src" / "drillsweep" / "quantities.json"
    entries: dict[str, Entry] = json.loads(path.read_text())
    lines = [*INTRODUCTION.splitlines(), ""]
    lines += ["| column | symbol | unit | oil field | meaning |", "|---|---|---|---|---|"]
    lines += [row(name, entry) for name, entry in entries.items() if "meaning" in entry]
    lines += [
        "",
        "Units of a scenario's fields, whose meaning the [scenario reference](scenario.md) has:",
        "",
        "| field | symbol | unit | oil field |",
        "|---|---|---|---|",
    ]
    lines += [row(name, entry) for name, entry in entries.items() if "meaning" not in entry and "unit" in entry]
    lines += ["", *CLOSING.splitlines()]
    return "\n".join(lines) + "\n"


def row(name: str, entry: Entry) -> str:
    """A line of a table."""
    symbol = entry.get("symbol", "")
    unit = entry.get("unit", "")
    field = entry.get("field", {"unit": unit, "size": 1.0})
    in_field = "" if field["unit"] == unit else f"{field['unit']} ({field['size']:.10g} {unit})"
    cells = [f"`{name}`", symbol, "" if unit == "1" else unit, in_field]
    return "| " + " | ".join([*cells, entry["meaning"]] if "meaning" in entry else cells) + " |"


if __name__ == "__main__":
    (DOCS / "quantities.md").write_text(reference())
