"""How fast the web page is, and what it transfers: `python docs/page_timing.py SERVER SWEEP`.

The sweep has complete points with histories and snapshots over two parameters, some of them verified. Prints a Markdown
table of its views, and with `--large` of those of a sweep of many points. Each time is a median, and also given in
multiples of the time of a trivial page, the answer of `/livez`, which the same server sends and the same browser shows
next to it: such ratios hold on machines that are busy or slow.

A view is there once it has its numbers and its picture is drawn. Browsers start with an empty profile on disk. Each
load is of a new page; at the first one no file of the page is in the browser's cache.
"""

from __future__ import annotations

import argparse
from collections.abc import Iterator
from contextlib import contextmanager
from dataclasses import dataclass, fields
from itertools import pairwise
from statistics import median
from tempfile import TemporaryDirectory

from playwright.sync_api import BrowserContext, Error, Page, Playwright, sync_playwright

CHROMIUM = "/usr/bin/chromium"
OPTIONS = ["--no-sandbox", "--use-gl=swiftshader", "--enable-unsafe-swiftshader"]
PAUSE_MS = 500
"""Pause between two loads of a page, and after the start of the browser [ms], in which it writes its cache."""
REPEATED = 3
"""Loads of a view that follow the first in each browser."""
MOVES = 200
"""Moves of the mouse while a window is brushed; the browser takes one a frame."""

# When something is there [ms], by the page's own clock, which starts with its loading.
SHOWN = """([selector, limit]) => new Promise((resolve, reject) => {
    const look = () => {
        const now = performance.now();
        if (document.querySelector(selector)) resolve(now);
        else if (now > limit) reject(new Error(`${location.hash} has no ${selector}`));
        else requestAnimationFrame(look);
    };
    requestAnimationFrame(look);
})"""
LONGEST_MS = 120_000
"""Time after which a view that is not there ends the measurement [ms]."""
# Bytes that all requests so far have transferred; those from the browser's cache transfer none.
BYTES = """() => [...performance.getEntriesByType("navigation"), ...performance.getEntriesByType("resource")]
    .reduce((sum, entry) => sum + entry.transferSize, 0)"""
# Frames of the browser, orbits painted, and how long each came after the move of the mouse that it follows [ms].
OBSERVE = """(selector) => {
    const seen = window.brushing = { frames: [], delays: [] };
    let moved = 0;
    addEventListener("pointermove", () => moved = performance.now(), true);
    document.querySelector(selector).addEventListener("painted", () => seen.delays.push(performance.now() - moved));
    const tick = (time) => {
        seen.frames.push(time);
        requestAnimationFrame(tick);
    };
    requestAnimationFrame(tick);
}"""
FORGET = "() => { window.brushing.frames.length = window.brushing.delays.length = 0; }"
# The answers of tables of sweeps: what was asked of which sweep, how long it took, and when it had come [ms].
ANSWERS = """() => performance.getEntriesByType("resource")
    .filter(({ name }) => name.includes("/v1/sweeps/") && name.includes("/table"))
    .map(({ name, startTime, responseEnd }) =>
        [decodeURIComponent(name.slice(name.indexOf("/table") - 4)), responseEnd - startTime, responseEnd])"""
DRAWN = "canvas.picture"
"""A picture that is drawn."""


@dataclass
class View:
    """View to be measured."""

    name: str
    link: str
    drawn: str
    """Selects what is there once it is drawn."""


def views_of_sweep(sweep: str, prefix: str = "") -> list[View]:
    """Views of a sweep over two parameters."""
    of_sweep = f"#/sweeps/{sweep}?view="
    pictured = {"map": "map", "window": "window", "scatter": "scatter", "effects": "sensitivities"}
    return [
        *(View(prefix + name, of_sweep + view, f".plot {DRAWN}") for view, name in pictured.items()),
        View(f"{prefix}parallel coordinates", f"{of_sweep}parallel", ".parallel .axis-title"),
        View(f"{prefix}table of points", f"{of_sweep}table", ".rows tbody tr"),
    ]


def views(sweep: str) -> list[View]:
    """Views that are measured."""
    of_point = f"#/sweeps/{sweep}/points/1?view="
    compared = f"#/compare?points={sweep}:1,{sweep}:2&view="
    scene, orbit = "canvas.scene[data-drawn]", f".plot[aria-label^='Orbit of node'] {DRAWN}"
    return [
        View("sweeps", "#/sweeps", "main tbody tr"),
        *views_of_sweep(sweep),
        View("profiles of a point", f"{of_point}profiles", f".plot {DRAWN}"),
        View("its history, orbit and spectrum", f"{of_point}motion", orbit),
        View("its spectrogram", f"{of_point}spectrogram", f".plot {DRAWN}"),
        View("its string in motion", f"{of_point}string", scene),
        View("its well", f"{of_point}well", scene),
        View("its energy", f"{of_point}energy", f".plot {DRAWN}"),
        View("its effects, accuracy, downloads", f"{of_point}about", "section table"),
        View("profiles compared", f"{compared}profiles", f".plot {DRAWN}"),
        View("orbits compared", f"{compared}orbit", f".plot {DRAWN}"),
        View("spectra compared", f"{compared}spectrum", f".plot {DRAWN}"),
        View("strings in motion compared", f"{compared}string", scene),
        View("new sweep", "#/new", "main form"),
        View("its plan, which the service computes", "#/new", f".plot {DRAWN}"),
    ]


TRIVIAL = View("a trivial page", "livez", "body")


@contextmanager
def started(playwright: Playwright) -> Iterator[BrowserContext]:
    """A browser with an empty profile on disk, at rest."""
    with TemporaryDirectory(ignore_cleanup_errors=True) as profile:
        context = playwright.chromium.launch_persistent_context(
            profile, executable_path=CHROMIUM, args=OPTIONS, viewport={"width": 1400, "height": 900}
        )
        context.set_default_timeout(LONGEST_MS)
        context.pages[0].wait_for_timeout(PAUSE_MS)
        yield context
        context.close()


def opened(context: BrowserContext, server: str, view: View) -> tuple[float, float]:
    """Milliseconds from the start of loading until a view is drawn, and bytes transferred until then."""
    page = context.new_page()
    page.goto(f"{server}/{view.link}", wait_until="commit")
    drawn = page.evaluate(SHOWN, [view.drawn, LONGEST_MS])
    size = page.evaluate(BYTES)
    page.wait_for_load_state("networkidle")
    page.wait_for_timeout(PAUSE_MS)
    page.close()
    return drawn, size


@dataclass
class Loaded:
    """Medians of the loads of a view."""

    trivial: float
    """Time of the trivial page next to it [ms]."""
    first: float
    """Time of the first load [ms]."""
    after: float
    """Time of those after it [ms]."""
    first_bytes: float
    """Bytes until the first load was seen."""
    after_bytes: float
    """Bytes until those after it were seen."""

    def row(self, name: str) -> str:
        """Row of the table."""
        times = [f"{time:.0f} ms | {time / self.trivial:.1f}" for time in (self.first, self.after)]
        sizes = [f"{size / 1000:.0f} kB" for size in (self.first_bytes, self.after_bytes)]
        return "| " + " | ".join([name, *times, *sizes]) + " |"


def loaded(playwright: Playwright, server: str, view: View, times: int) -> Loaded:
    """Loads a view in browsers that have just been started, in turn with the trivial page."""
    trivial, first, after = [], [], []
    for _ in range(times):
        with started(playwright) as context:
            # The first page of a browser takes longer than others.
            opened(context, server, TRIVIAL)
            first.append(opened(context, server, view))
            for _ in range(REPEATED):
                trivial.append(opened(context, server, TRIVIAL))
                after.append(opened(context, server, view))

    def middle(loads: list[tuple[float, float]], column: int) -> float:
        return median(load[column] for load in loads)

    return Loaded(middle(trivial, 0), middle(first, 0), middle(after, 0), middle(first, 1), middle(after, 1))


def mapped(page: Page, server: str, sweep: str, view: str) -> tuple[dict[str, float], float]:
    """A map of a sweep: milliseconds of each answer that it needs of tables, and from the last to the picture."""
    page.goto(f"{server}/#/sweeps/{sweep}?view={view}", wait_until="commit")
    now = page.evaluate(SHOWN, [f".plot {DRAWN}", LONGEST_MS])
    answers = page.evaluate(ANSWERS)
    return {name: duration for name, duration, _ in answers}, now - max(end for *_, end in answers)


@dataclass
class Brushed:
    """Measurements of a drag across a history."""

    frames: float
    """Frames of the browser in a second."""
    longest_frame: float
    """Longest time between two of them [ms]."""
    orbits: float
    """Orbits painted in a second."""
    delay: float
    """Time from a move of the mouse to the orbit that follows it [ms], the median."""
    longest_delay: float
    """The longest such time [ms]."""
    worked: float
    """Processor time of the page's thread for an orbit, with everything else that it did meanwhile [ms]."""


def brushed(page: Page, server: str, sweep: str) -> Brushed:
    """Drags a window across the history of point 1 by the mouse."""
    page.goto(f"{server}/#/sweeps/{sweep}/points/1?view=motion")
    orbit = ".plot[aria-label^='Orbit of node']"
    page.locator(f"{orbit} {DRAWN}").first.wait_for()
    page.wait_for_load_state("networkidle")
    box = page.locator(".plot[aria-label^='History of node'] .area").first.bounding_box()
    if box is None:
        raise SystemExit("the history has no place on the page")
    page.evaluate(OBSERVE, orbit)
    tools = page.context.new_cdp_session(page)
    tools.send("Performance.enable")

    def processor_time() -> float:
        metrics = tools.send("Performance.getMetrics")["metrics"]
        return 1000 * float(next(metric["value"] for metric in metrics if metric["name"] == "ThreadTime"))

    page.mouse.move(box["x"] + 0.1 * box["width"], box["y"] + 20)
    page.mouse.down()
    page.mouse.move(box["x"] + 0.2 * box["width"], box["y"] + 20, steps=4)
    page.evaluate(FORGET)
    worked = processor_time()
    for step in range(MOVES):
        page.mouse.move(box["x"] + (0.2 + 0.7 * step / MOVES) * box["width"], box["y"] + 30)
    seen = page.evaluate("() => window.brushing")
    worked = processor_time() - worked
    page.mouse.up()
    frames, delays = seen["frames"], seen["delays"]
    duration = (frames[-1] - frames[0]) / 1000
    return Brushed(
        frames=(len(frames) - 1) / duration,
        longest_frame=max(later - earlier for earlier, later in pairwise(frames)),
        orbits=len(delays) / duration,
        delay=median(delays),
        longest_delay=max(delays),
        worked=worked / len(delays),
    )


def main() -> None:
    """Measures and prints."""
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("server")
    parser.add_argument("sweep")
    parser.add_argument("--times", type=int, default=3, help="browsers that are started for each view")
    parser.add_argument("--large", metavar="SWEEP", help="measure views of a sweep of many points, too")
    parser.add_argument("--only", nargs="*", help="names of the views to be measured; all unless given")
    parser.add_argument("--brushing", action="store_true", help="measure the orbit that follows a dragged window alone")
    parser.add_argument("--map", action="store_true", help="measure the map of the sweep alone, which is a grid")
    parser.add_argument("--difference", metavar="OTHER", help="measure the map of another sweep's differences alone")
    arguments = parser.parse_args()
    with sync_playwright() as playwright:
        if arguments.map or arguments.difference:
            view = f"difference&with={arguments.difference}" if arguments.difference else "map"
            maps = []
            for _ in range(arguments.times):
                with started(playwright) as context:
                    maps.append(mapped(context.new_page(), arguments.server, arguments.sweep, view))
            for name in maps[0][0]:
                print(f"{name}: {median(answers[name] for answers, _ in maps):.0f} ms")
            print(f"from the last of them to the map: {median(time for _, time in maps):.0f} ms")
            return
        if not arguments.brushing:
            measured = views(arguments.sweep)
            if arguments.large:
                measured += views_of_sweep(arguments.large, "large sweep: ")
            measured = [view for view in measured if arguments.only is None or view.name in arguments.only]
            print("| view | first load | ratio | loads after it | ratio | transferred at first | after it |")
            print("|---|---|---|---|---|---|---|")
            trivial = []
            for view in measured:
                try:
                    found = loaded(playwright, arguments.server, view, arguments.times)
                except Error as error:
                    print(f"| {view.name} | {error.message.splitlines()[0]} | | | | | |", flush=True)
                    continue
                trivial.append(found.trivial)
                print(found.row(view.name), flush=True)
            print(f"\nThe trivial page took {min(trivial):.0f} to {max(trivial):.0f} ms.")
            return
        drags = []
        for _ in range(arguments.times):
            with started(playwright) as context:
                drags.append(brushed(context.new_page(), arguments.server, arguments.sweep))
        drag = {field.name: median(getattr(drag, field.name) for drag in drags) for field in fields(Brushed)}
        print(
            "\nBrushing: {frames:.0f} frames a second, at most {longest_frame:.0f} ms apart; {orbits:.0f} orbits a "
            "second, each {delay:.1f} ms after the mouse, at most {longest_delay:.0f} ms; {worked:.1f} ms of the "
            "page's thread for each.".format(**drag)
        )


if __name__ == "__main__":
    main()
