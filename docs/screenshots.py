"""Pictures of every view of the web page in both themes, for the book: `python docs/screenshots.py SERVER SWEEP OTHER`.

Both sweeps are complete, of the same parameters, with points that have histories and snapshots; the first one verifies
some. Pictures go to `docs/page/`, or to the folder that is given, as WebP.
"""

from __future__ import annotations

import argparse
import io
from pathlib import Path

from PIL import Image
from playwright.sync_api import Page, sync_playwright

CHROMIUM = "/usr/bin/chromium"
OPTIONS = ["--no-sandbox", "--use-gl=swiftshader", "--enable-unsafe-swiftshader"]
WIDTH, LARGEST_HEIGHT = 1200, 1150
TALLER = {
    "sweep-map": 1400,
    "sweep-window": 1500,
    "sweep-parallel": 1400,
    "sweep-effects": 1300,
    "point-profiles": 1560,
    "point-motion": 1500,
    "point-string": 1500,
    "compare-string": 1500,
}
"""Pictures whose lower part is what they are taken for."""
POINT = [
    *("profiles", "motion", "spectrogram", "string", "well", "energy", "hydraulics", "drag", "forced", "about"),
]
"""Views of a point."""
COMPARED = [
    *("profiles", "orbit", "history", "rotation", "spectrum", "statistics", "spectrogram", "bit", "string", "contacts"),
    *("well", "energy", "modes", "effects", "accuracy", "cost"),
]
"""Views of a comparison."""
QUALITY = 40
SLOWEST_MS = 90_000
"""How long the slowest part of a view may take on a machine with other work [ms]."""
STRING_TIME = "50"
"""Time at which the string is shown [s]."""
LIMITS = "bit_stick_slip_severity:1.14"
"""Limits of the window, by which the classes of the paper's string differ."""


def views(sweep: str, other: str, failed: str) -> dict[str, str]:
    """The link of each view."""
    links = {"sweeps": "#/sweeps", "new": f"#/new?from={sweep}"}
    for view in ("map", "window", "scatter", "parallel", "effects", "table"):
        links[f"sweep-{view}"] = f"#/sweeps/{sweep}?view={view}&colour=orbit_radius_rms_57_7m"
    links["sweep-window"] += f"&limits={LIMITS}"
    links["sweep-failures"] = f"#/sweeps/{failed}?view=failures"
    links["sweep-difference"] = f"#/sweeps/{sweep}?view=difference&with={other}&colour=orbit_radius_rms_57_7m"
    for view in POINT:
        links[f"point-{view}"] = f"#/sweeps/{sweep}/points/1?view={view}&node=57.7m"
    links["point-profiles"] += "&cursor=123.5"
    points = f"{sweep}:1,{sweep}:4,{other}:4"
    for view in COMPARED:
        links[f"compare-{view}"] = f"#/compare?points={points}&view={view}&node=57.7m&from=40&to=60"
    links["compare-well"] += "&colour=friction_coefficient"
    links["compare-string"] += "&colour=orbit_radius_rms"
    links["compare-bit"] += "&end=top"
    return links


def unfold(page: Page, name: str) -> None:
    """Opens what is folded at first and worth a picture, and folds what another picture shows."""
    if name.startswith("point-") and name != "point-profiles":
        # The overview is in the picture of profiles.
        page.locator("details.overview > summary").click()
    if name == "new":
        page.get_by_text("All fields, with units").click()
        page.locator("summary", has_text="operation").first.click()
    if name == "point-motion":
        page.get_by_text("modes were found up to").wait_for(timeout=SLOWEST_MS)
    if name == "sweep-parallel":
        page.get_by_text("Keep points by numbers").click()
        said = page.get_by_role("status", name="The point that is read")
        box = page.locator(".plot").bounding_box()
        # Down between two axes, until there is a line.
        for step in range(100):
            if box is not None and not said.text_content():
                page.mouse.move(box["x"] + 0.3 * box["width"], box["y"] + (0.3 + 0.006 * step) * box["height"])
                page.wait_for_timeout(20)
    if name == "point-string":
        # A time at which the string whirls.
        page.get_by_label("Time", exact=True).fill(STRING_TIME)
    if name == "sweep-map":
        page.get_by_role("button", name="Finer grid").click()
        page.get_by_text("are known and not computed again").wait_for()


def save(picture: bytes, path: Path, height: int) -> None:
    """A picture as a small file."""
    image = Image.open(io.BytesIO(picture)).convert("RGB")
    image.crop((0, 0, image.width, min(image.height, height))).save(path, quality=QUALITY, method=6)


def main() -> None:
    """Takes the pictures."""
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("server")
    parser.add_argument("sweep")
    parser.add_argument("other")
    parser.add_argument("--failed", help="a sweep whose failures are shown, in place of those of the first one")
    parser.add_argument("--only", nargs="*", help="names of the pictures to be taken; all unless given")
    parser.add_argument("--themes", nargs="*", default=["light", "dark"], help="themes of the pictures")
    parser.add_argument("folder", type=Path, nargs="?", default=Path(__file__).parent / "page")
    arguments = parser.parse_args()
    links = views(arguments.sweep, arguments.other, arguments.failed or arguments.sweep)
    arguments.folder.mkdir(parents=True, exist_ok=True)
    with sync_playwright() as playwright:
        browser = playwright.chromium.launch(executable_path=CHROMIUM, args=OPTIONS)
        for theme in arguments.themes:
            context = browser.new_context(viewport={"width": WIDTH, "height": 800}, color_scheme=theme)
            context.set_default_timeout(SLOWEST_MS)
            for name, link in links.items():
                if arguments.only is not None and name not in arguments.only:
                    continue
                page = context.new_page()
                page.goto(f"{arguments.server}/{link}")
                page.locator("main h1").wait_for()
                page.wait_for_load_state("networkidle")
                unfold(page, name)
                page.wait_for_load_state("networkidle")
                for picture in page.locator(".plot:visible:not(.parallel)").all():
                    picture.locator("canvas.picture").first.wait_for()
                # Canvases are painted a frame after the axes.
                page.wait_for_timeout(500)
                height = TALLER.get(name, LARGEST_HEIGHT)
                save(page.screenshot(full_page=True), arguments.folder / f"{name}-{theme}.webp", height)
                page.close()
            context.close()
        browser.close()


if __name__ == "__main__":
    main()
