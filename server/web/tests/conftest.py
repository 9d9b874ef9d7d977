"""A browser over a real server, and sweeps that most tests look at."""

from __future__ import annotations

from collections.abc import Iterator
from pathlib import Path
from typing import Any

import pytest
from playwright.sync_api import Browser, Page, expect, sync_playwright

from browsing import NASTY, Opens
from drillsweep import Axis, Client, Sweep
from fixtures import client, server, sweep
from service import SHORT

__all__ = ["client", "server", "sweep"]

CHROMIUM = "/usr/bin/chromium"
OPTIONS = ["--no-sandbox", "--use-gl=swiftshader", "--enable-unsafe-swiftshader"]


@pytest.fixture(scope="module")
def browser() -> Iterator[Browser]:
    assert Path(CHROMIUM).exists(), f"{CHROMIUM} is missing: apt install chromium"
    # A machine that does other work takes its time.
    expect.set_options(timeout=20_000)
    with sync_playwright() as playwright:
        browser = playwright.chromium.launch(executable_path=CHROMIUM, args=OPTIONS)
        yield browser
        browser.close()


@pytest.fixture
def troubles() -> list[str]:
    """Complaints of pages; a test fails by them at its end, and takes away those that it caused."""
    return []


@pytest.fixture
def opened(browser: Browser, server: str, troubles: list[str]) -> Iterator[Opens]:
    """Opens a view of the page. Errors on its console, violations of its policy among them, fail the test."""
    contexts = []

    def open_view(view: str = "", address: str = server, **options: Any) -> Page:
        context = browser.new_context(**options)
        contexts.append(context)
        page = context.new_page()
        page.on("console", lambda message: troubles.append(message.text) if message.type == "error" else None)
        page.on("pageerror", lambda error: troubles.append(str(error)))
        page.goto(f"{address}/{view}")
        return page

    yield open_view
    for context in contexts:
        context.close()
    assert troubles == []


@pytest.fixture(scope="module")
def named(client: Client) -> Sweep:
    """Six points of three parameters, complete, with a name and a tag of markup."""
    axes: dict[str, Axis] = {
        "flow_rate": [0.01, 0.04],
        "mud_density": [1200, 1800],
        "operation.rotation_speed_rpm": [90, 120],
    }
    return client.submit("paper-200m", set=SHORT, axes=axes, name=NASTY, tags=["<b>bold</b>"]).wait(timeout=120.0)


@pytest.fixture(scope="module")
def recorded(client: Client) -> Sweep:
    """One point with 50 snapshots, of 0.01 to 0.49 s."""
    snapshots = {"rate_hz": 100, "window": {"from": 0.01, "to": 0.5}}
    changes = SHORT | {"recording.snapshots": snapshots}
    return client.submit("paper-200m", set=changes, axes={"flow_rate": [0.01]}, name="snapshots").wait(timeout=120.0)
