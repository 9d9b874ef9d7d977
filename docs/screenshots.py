"""Pictures of every view of the web page in both themes: `python docs/screenshots.py SERVER SWEEP FOLDER`.

The sweep has two points or more, complete, with their histories.
"""

from __future__ import annotations

import argparse
from pathlib import Path

from playwright.sync_api import sync_playwright

CHROMIUM = "/usr/bin/chromium"
OPTIONS = ["--no-sandbox", "--use-gl=swiftshader", "--enable-unsafe-swiftshader"]


def views(sweep: str) -> dict[str, str]:
    """The link of each view."""
    links = {"sweeps": "#/sweeps", "new": f"#/new?from={sweep}"}
    for view in ("map", "scatter", "parallel", "effects", "table", "failures"):
        links[f"sweep-{view}"] = f"#/sweeps/{sweep}?view={view}"
    for view in ("profiles", "motion", "well", "energy", "about"):
        links[f"point-{view}"] = f"#/sweeps/{sweep}/points/1?view={view}"
    for view in ("profiles", "orbit", "spectrum"):
        links[f"compare-{view}"] = f"#/compare?points={sweep}:1,{sweep}:2&view={view}"
    return links


def main() -> None:
    """Takes the pictures."""
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("server")
    parser.add_argument("sweep")
    parser.add_argument("folder", type=Path)
    arguments = parser.parse_args()
    arguments.folder.mkdir(parents=True, exist_ok=True)
    with sync_playwright() as playwright:
        browser = playwright.chromium.launch(executable_path=CHROMIUM, args=OPTIONS)
        for theme in ("light", "dark"):
            for name, link in views(arguments.sweep).items():
                page = browser.new_page(viewport={"width": 1400, "height": 900}, color_scheme=theme)
                page.goto(f"{arguments.server}/{link}")
                page.locator("main h1").wait_for()
                page.wait_for_load_state("networkidle")
                for picture in page.locator(".plot:visible").all():
                    picture.locator(".main-svg").first.wait_for()
                # WebGL draws a frame after the axes.
                page.wait_for_timeout(500)
                page.screenshot(path=arguments.folder / f"{name}-{theme}.png", full_page=True)
                page.close()
        browser.close()


if __name__ == "__main__":
    main()
