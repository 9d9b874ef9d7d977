"""How fast the web page is, and what it transfers: `python docs/page_timing.py SERVER SWEEP`.

The sweep has complete points with histories; that of point 1 is shown and brushed. Prints a Markdown table of medians,
each time of a browser that has just been started with an empty profile on disk. A reader's browser has a profile, too;
in a private window, which has none, pages take longer to load.

A view is there once it has its numbers and its picture is drawn. The first load and those that follow are each of a
page of its own, and so is the way from another view.
"""

from __future__ import annotations

import argparse
from collections.abc import Iterator
from contextlib import contextmanager
from dataclasses import dataclass, fields
from itertools import pairwise
from statistics import median
from tempfile import TemporaryDirectory

from playwright.sync_api import BrowserContext, Page, Playwright, sync_playwright

CHROMIUM = "/usr/bin/chromium"
OPTIONS = ["--no-sandbox", "--use-gl=swiftshader", "--enable-unsafe-swiftshader"]
PAUSE_MS = 1000
"""Pause between two loads of a page, and after the start of the browser [ms], in which it writes its cache."""
REPEATED = 5
"""Loads of a view that follow the first in each browser; what stands for them is their median."""
MOVES = 200
"""Moves of the mouse while a window is brushed; the browser takes one a frame."""

# When the link is changed, and when each of several things is there, one after the other [ms], by the page's own clock,
# which starts with its loading.
SHOWN = """([link, ...selectors]) => new Promise((resolve) => {
    const times = [performance.now()];
    const look = () => {
        while (times.length <= selectors.length && document.querySelector(selectors[times.length - 1]))
            times.push(performance.now());
        times.length > selectors.length ? resolve(times) : requestAnimationFrame(look);
    };
    if (link !== null) location.hash = link;
    requestAnimationFrame(look);
})"""
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


def views(sweep: str) -> list[View]:
    """Views that are measured."""
    of_sweep, of_point = f"#/sweeps/{sweep}?view=", f"#/sweeps/{sweep}/points/1?view="

    def pictured(name: str, link: str, place: str = ".plot") -> View:
        return View(name, link, f"{place} {DRAWN}")

    return [
        View("sweeps", "#/sweeps", "main tbody tr"),
        pictured("map", f"{of_sweep}map"),
        View("table of points", f"{of_sweep}table", ".rows tbody tr"),
        pictured("profiles of a point", f"{of_point}profiles"),
        pictured("its history, orbit and spectrum", f"{of_point}motion", ".plot[aria-label^='Orbit of node']"),
        View("its well", f"{of_point}well", "canvas.scene[data-drawn]"),
        pictured("new sweep", "#/new"),
    ]


@contextmanager
def started(playwright: Playwright) -> Iterator[BrowserContext]:
    """A browser with an empty profile on disk, at rest."""
    with TemporaryDirectory(ignore_cleanup_errors=True) as profile:
        context = playwright.chromium.launch_persistent_context(
            profile, executable_path=CHROMIUM, args=OPTIONS, viewport={"width": 1400, "height": 900}
        )
        context.pages[0].wait_for_timeout(PAUSE_MS)
        yield context
        context.close()


def opened(context: BrowserContext, server: str, view: View) -> tuple[float, float]:
    """Milliseconds from the start of loading until a view is drawn, and bytes transferred."""
    page = context.new_page()
    page.goto(f"{server}/{view.link}", wait_until="commit")
    _, drawn = page.evaluate(SHOWN, [None, view.drawn])
    size = page.evaluate(BYTES)
    page.wait_for_load_state("networkidle")
    page.wait_for_timeout(PAUSE_MS)
    page.close()
    return drawn, size


def moved(context: BrowserContext, server: str, sweep: str, view: View) -> float:
    """Milliseconds from another view until one is drawn; pictures were drawn before."""
    page = context.new_page()
    page.goto(f"{server}/#/sweeps/{sweep}?view=scatter")
    page.locator(f".plot {DRAWN}").first.wait_for()
    page.goto(f"{server}/#/nowhere")
    page.locator("main a").wait_for()
    page.wait_for_load_state("networkidle")
    page.wait_for_timeout(PAUSE_MS)
    start, drawn = page.evaluate(SHOWN, [view.link, view.drawn])
    page.close()
    return float(drawn - start)


def mapped(page: Page, server: str, sweep: str, view: str) -> tuple[dict[str, float], float]:
    """A map of a sweep: milliseconds of each answer that it needs of tables, and from the last to the picture."""
    page.goto(f"{server}/#/sweeps/{sweep}?view={view}", wait_until="commit")
    _, now = page.evaluate(SHOWN, [None, f".plot {DRAWN}"])
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
    parser.add_argument("--times", type=int, default=5)
    parser.add_argument("--brushing", action="store_true", help="measure nothing else")
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
            print("| view | first load | loads after it | from another view | transferred at first | after it |")
            print("|---|---|---|---|---|---|")
        for view in [] if arguments.brushing else views(arguments.sweep):
            first, after, inside = [], [], []
            for _ in range(arguments.times):
                with started(playwright) as context:
                    first.append(opened(context, arguments.server, view))
                    after += [opened(context, arguments.server, view) for _ in range(REPEATED)]
                    inside += [moved(context, arguments.server, arguments.sweep, view) for _ in range(2)]
            (drawn, size), (drawn_after, size_after) = [list(zip(*of, strict=True)) for of in (first, after)]
            times = [median(column) for column in (drawn, drawn_after, inside)]
            sizes = [median(column) / 1000 for column in (size, size_after)]
            told = [f"{time:.0f} ms" for time in times] + [f"{size:.0f} kB" for size in sizes]
            print("| " + " | ".join([view.name, *told]) + " |", flush=True)
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
