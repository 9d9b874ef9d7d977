"""Helpers of the page's tests: they read views, drag, wait, and run the snippets that a view shows."""

from __future__ import annotations

import csv
import io
import json
import os
import re
import subprocess
import sys
import time
from collections.abc import Callable
from pathlib import Path
from typing import Any
from urllib.parse import parse_qs

from playwright.sync_api import Locator, Page, expect

NASTY = '<img src=x onerror="document.title=`taken`"><script>document.title="taken"</script>'
"""A name that would be markup where it was taken for it."""
GONE = re.compile(r"net::ERR_|502|Failed to load resource")
"""Message of a browser on its console if a server is gone."""
REFUSED = re.compile("status of 40[13]")
"""Its message for every answer that refuses."""
MINUS = "\N{MINUS SIGN}"
COMPARED = {
    "profiles": "Profiles",
    "orbit": "Orbits",
    "history": "Histories",
    "rotation": "Rotation and torque",
    "spectrum": "Full spectra",
    "energy": "Energy",
}
"""Views of a comparison that have one picture, and its name."""

RULES_OF_THEME: dict[str, dict[str, Any]] = {
    "light": {},
    # Themes differ by their colours alone.
    "dark": {"runOnly": {"type": "rule", "values": ["color-contrast", "link-in-text-block"]}},
}
"""Options of axe by the theme of the page: all rules in one, those of colours in both."""

Opens = Callable[..., Page]


def drawn(page: Page, name: str) -> Locator:
    """A picture, once it is drawn."""
    picture = page.get_by_role("figure", name=re.compile(name)).filter(has=page.locator("canvas.picture"))
    expect(picture.first).to_be_visible(timeout=30_000)
    return picture.first


def parallel(page: Page) -> Locator:
    """The picture of parallel coordinates, once it is drawn."""
    picture = page.get_by_role("figure", name="Parallel coordinates")
    expect(picture.locator(".axis-title").first).to_be_visible()
    # Late answers draw the picture anew.
    page.wait_for_load_state("networkidle")
    picture.scroll_into_view_if_needed()
    return picture


def until(page: Page, holds: Callable[[], bool]) -> None:
    """Waits until something holds; the page's policy forbids Playwright's own way, which evaluates a text."""
    deadline = time.monotonic() + 30.0
    while not holds():
        assert time.monotonic() < deadline, "it never came to hold"
        page.wait_for_timeout(50)


def taken(page: Page) -> None:
    """Waits until the page has taken the answers that have come: those of the server come in order."""
    page.evaluate("async () => { await (await fetch('/livez')).text(); await new Promise(requestAnimationFrame); }")


def drag(page: Page, over: Locator, start: tuple[float, float], end: tuple[float, float]) -> None:
    """Drags the mouse over a part of the page, between two places given as parts of its width and height."""
    box = over.bounding_box()
    assert box is not None
    page.mouse.move(box["x"] + start[0] * box["width"], box["y"] + start[1] * box["height"])
    page.mouse.down()
    page.mouse.move(box["x"] + end[0] * box["width"], box["y"] + end[1] * box["height"], steps=8)
    page.mouse.up()


def requested(page: Page) -> dict[str, Any]:
    """The request of a new sweep that the page's link holds."""
    query = parse_qs(page.url.partition("?")[2])
    return dict(json.loads(query.get("request", ["{}"])[0]))


def shown_lines(page: Page) -> dict[str, str]:
    """The lines that made a view, by language."""
    # Parts of a view have lines of their own before them.
    details = page.locator("details.lines").last
    if details.get_attribute("open") is None:
        details.locator("summary").click()
    expect(details.locator("pre").first).to_be_visible()
    return dict(zip(details.locator("h2").all_text_contents(), details.locator("pre").all_text_contents(), strict=True))


def run_curl(lines: str, directory: Path, token: str = "") -> dict[str, list[str]]:
    """The columns of each answer of the lines, run by a shell; those of a document are its keys."""
    directory.mkdir()
    environment = {**os.environ, "DRILLSWEEP_TOKEN": token}
    command = ["sh", "-e", "-c", lines]
    result = subprocess.run(command, cwd=directory, env=environment, capture_output=True, text=True, check=False)
    assert result.returncode == 0, f"{lines}\n{result.stderr}"
    answers = {path.stem: path.read_text() for path in directory.iterdir()} or {"": result.stdout}
    return {name: columns_of(text) for name, text in answers.items()}


def columns_of(text: str) -> list[str]:
    if text.startswith("{"):
        return list(json.loads(text))
    rows = list(csv.reader(io.StringIO("".join(line for line in text.splitlines(True) if not line.startswith("#")))))
    assert len(rows) > 1, text
    return rows[0]


def run_python(lines: str, token: str = "") -> dict[str, list[str]]:
    """The columns of each table that the lines make, in a process of their own."""
    tell = (
        "\nimport json, pandas"
        "\nfound = {name: value for name, value in globals().items()}"
        "\nfor name, value in list(found.items()):"
        "\n    if isinstance(value, list): found |= {f'{name}[{at}]': one for at, one in enumerate(value)}"
        "\nprint('\\n' + json.dumps({name: [str(column) for column in value.columns]"
        " for name, value in found.items() if isinstance(value, pandas.DataFrame)}))"
    )
    environment = {**os.environ, "MPLBACKEND": "Agg", "DRILLSWEEP_TOKEN": token}
    command = [sys.executable, "-c", lines + tell]
    result = subprocess.run(command, env=environment, capture_output=True, text=True, check=False)
    assert result.returncode == 0, f"{lines}\n{result.stderr}"
    return dict(json.loads(result.stdout.splitlines()[-1]))


def said(bias: float) -> str:
    """A relative bias as the page writes it."""
    sign = "+" if bias > 0 else MINUS
    return "below 0.01 %" if abs(bias) < 1e-4 else f"{sign}{float(f'{abs(100 * bias):.2g}'):g} %"


def scene(page: Page, name: str = "The string moving") -> Locator:
    """The first picture of a string, once it is drawn."""
    picture = page.get_by_role("application", name=re.compile(name)).first
    expect(picture).to_have_attribute("data-drawn", re.compile(r"\d+"), timeout=30_000)
    return picture


def pixels(picture: Locator) -> str:
    return str(picture.evaluate("canvas => canvas.toDataURL()"))


def clock(page: Page) -> float:
    return float(str(page.locator("output").text_content()).removesuffix(" s"))


def written(picture: Locator) -> list[dict[str, Any]]:
    """Words of a picture with their ends [pixels]: in a saved file they are where the picture has them."""
    read = """place => {
        const file = document.createElement("div");
        file.append(new DOMParser().parseFromString(place.picture.svg(), "image/svg+xml").documentElement);
        Object.assign(file.style, { position: "fixed", left: 0, top: 0 });
        document.body.append(file);
        const words = [...file.querySelectorAll("text")].map((text) => {
            const { left, right, top, bottom } = text.getBoundingClientRect();
            return { text: text.textContent, left, right, top, bottom };
        });
        file.remove();
        return words;
    }"""
    return list(picture.evaluate(read))


def trace(picture: Locator, number: int) -> dict[str, Any]:
    """Data that a picture shows."""
    read = "({ picture }, at) => { const { x, y, z } = picture.traces[at]; return { x: [...x], y: [...y], z }; }"
    return dict(picture.evaluate(read, number))
