"""Writes `scenario.md`, every field of a scenario, from the OpenAPI document and the base case.

Run: `python docs/scenario_reference.py`
"""

import json
from pathlib import Path
from typing import Any

import tomllib

DOCS = Path(__file__).parent
PREFIX = "#/components/schemas/"
Schema = dict[str, Any]


def reference() -> str:
    """The whole chapter."""
    schemas = json.loads((DOCS.parent / "api" / "openapi.json").read_text())["components"]["schemas"]
    base = tomllib.loads((DOCS.parent / "scenario" / "presets" / "paper-200m.toml").read_text())
    lines = [
        "# Scenario reference",
        "",
        "Every field of a scenario, in TOML and JSON alike; SI units unless the name says otherwise. A field is set by",
        "its path, as in `--set contact.static_friction=0.25`, and every numeric one can be an axis of a sweep.",
        "The last column is the base case, `paper-200m`; a field without a value there has its default or is absent.",
        "Fields that are required are marked *. Usual ranges are those of drilling practice; values outside the limits",
        "that are given with them are refused: `drillsweep plan` and every submission report all of them together.",
        "",
    ]
    waiting: list[tuple[str, str, Any]] = [("Scenario", "", base)]
    written: set[str] = set()
    while waiting:
        name, path, value = waiting.pop(0)
        if name in written:
            continue
        written.add(name)
        schema = schemas[name]
        lines += [f"## {name}" + (f" (`{path}`)" if path else ""), "", text(schema), ""]
        if "enum" in schema:
            lines += ["One of " + ", ".join(f"`{json.dumps(one)}`" for one in schema["enum"]) + ".", ""]
            continue
        alternatives = schema.get("oneOf", [])
        if alternatives:
            lines += [f"- {alternative(one)}" for one in alternatives] + [""]
        rows, inner = fields(schema, path, value)
        if rows:
            lines += ["| field | type | meaning | base case |", "|---|---|---|---|", *rows, ""]
        inner += [(of, path, value) for one in alternatives for of in references(one)]
        waiting = inner + waiting
    return "\n".join(lines).rstrip() + "\n"


def fields(schema: Schema, path: str, value: Any) -> tuple[list[str], list[tuple[str, str, Any]]]:
    """A row for each field, and the schemas that they lead to."""
    rows, inner = [], []
    values = value if isinstance(value, dict) else {}
    for name, field in schema.get("properties", {}).items():
        mark = "*" if name in schema.get("required", []) else ""
        rows.append(f"| `{name}`{mark} | {kind(field)} | {text(field)} | {example(values.get(name))} |")
        of = values.get(name)
        first = of[0] if isinstance(of, list) and of else of
        inner += [(to, f"{path}.{name}".strip("."), first) for to in references(field)]
    return rows, inner


def references(schema: Schema) -> list[str]:
    """Names of the schemas that one leads to at once."""
    if "$ref" in schema:
        return [schema["$ref"].removeprefix(PREFIX)]
    parts = [*schema.get("oneOf", []), *([schema["items"]] if "items" in schema else [])]
    return [name for part in parts for name in references(part)]


def kind(schema: Schema) -> str:
    """Type of a field."""
    if "$ref" in schema:
        return schema["$ref"].removeprefix(PREFIX)
    if "oneOf" in schema:
        return " or ".join(kind(part) for part in schema["oneOf"])
    of = schema.get("type", "any")
    if of == "array":
        return f"list of {kind(schema['items'])}"
    if isinstance(of, str):
        return of
    words = {"null": "absent", "string": "text with unit"} if "number" in of else {"null": "absent"}
    return " or ".join(words.get(part, part) for part in of)


def alternative(schema: Schema) -> str:
    """One of several forms."""
    if "enum" in schema:
        return ", ".join(f"`{json.dumps(value)}`" for value in schema["enum"]) + f": {text(schema)}"
    names = ", ".join(f"`{name}`" for name in schema.get("properties", {}))
    return f"{names or kind(schema)}: {text(schema)}".rstrip(": ")


def text(schema: Schema) -> str:
    """Meaning, on one line."""
    parts = [schema.get("description", "")] + [
        part.get("description", "")
        for part in schema.get("oneOf", [])
        if "$ref" in part and "description" not in schema
    ]
    return " ".join(" ".join(parts).split()).replace("|", "\\|")


def example(value: Any) -> str:
    """The base case's value, where it is short enough for a table."""
    if value is None or isinstance(value, dict | list):
        return ""
    return f"`{json.dumps(value)}`"


if __name__ == "__main__":
    (DOCS / "scenario.md").write_text(reference())
