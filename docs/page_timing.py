"""How fast the web page is, and what it transfers: `python docs/page_timing.py SERVER SWEEP`.

The sweep has complete points with histories; that of point 1 is shown and brushed. Prints a Markdown table of medians.
"""

from __future__ import annotations

import argparse
from statistics import median

from playwright.sync_api import BrowserContext, Page, sync_playwright

CHROMIUM = "/usr/bin/chromium"
OPTIONS = ["--no-sandbox", "--use-gl=swiftshader", "--enable-unsafe-swiftshader"]
MOVES = 100
"""Moves of the mouse while a window is brushed."""

# Milliseconds from a change of the link until something is there, as the page's own clock has it.
SHOWN = """([link, selector]) => new Promise((resolve) => {
    const start = performance.now();
    const end = () => resolve(performance.now() - start);
    const look = () => document.querySelector(selector) ? end() : requestAnimationFrame(look);
    if (link !== null) location.hash = link;
    requestAnimationFrame(look);
})"""
# Bytes that all requests so far have transferred; those from the browser's cache transfer none.
BYTES = """() => [...performance.getEntriesByType("navigation"), ...performance.getEntriesByType("resource")]
    .reduce((sum, entry) => sum + entry.transferSize, 0)"""
COUNT = """(selector) => {
    window.framesDrawn = 0;
    document.querySelector(selector).addEventListener("brushed", () => window.framesDrawn += 1);
}"""
PICTURE = ".js-plotly-plot .main-svg"


def views(sweep: str) -> list[tuple[str, str, str]]:
    """What is shown, by which link, and what is there once it is."""
    of_sweep, of_point = f"#/sweeps/{sweep}?view=", f"#/sweeps/{sweep}/points/1?view="
    return [
        ("sweeps", "#/sweeps", "main tbody tr"),
        ("map", f"{of_sweep}map", PICTURE),
        ("table of points", f"{of_sweep}table", ".rows tbody tr"),
        ("profiles of a point", f"{of_point}profiles", PICTURE),
        ("its history, orbit and spectrum", f"{of_point}motion", ".plot[aria-label^='Orbit of node'] .main-svg"),
        ("its well", f"{of_point}well", ".js-plotly-plot canvas"),
        ("new sweep", "#/new", PICTURE),
    ]


def opened(context: BrowserContext, server: str, link: str, selector: str) -> tuple[float, float]:
    """Milliseconds from the start of loading until something is there, and bytes transferred for it."""
    page = context.new_page()
    page.goto(f"{server}/{link}", wait_until="commit")
    page.evaluate(SHOWN, [None, selector])
    time, size = page.evaluate("() => performance.now()"), page.evaluate(BYTES)
    page.close()
    return time, size


def moved(page: Page, link: str, selector: str) -> tuple[float, float]:
    """Milliseconds from one view to another, and bytes transferred for it."""
    page.wait_for_load_state("networkidle")
    before = page.evaluate(BYTES)
    time = page.evaluate(SHOWN, [link, selector])
    return time, page.evaluate(BYTES) - before


def brushed(page: Page, server: str, sweep: str) -> tuple[float, float]:
    """While a window is brushed: orbits drawn in a second, and processor time of the page's thread for each [ms]."""
    page.goto(f"{server}/#/sweeps/{sweep}/points/1?view=motion")
    orbit = ".plot[aria-label^='Orbit of node']"
    page.locator(f"{orbit} .main-svg").first.wait_for()
    page.wait_for_load_state("networkidle")
    box = page.locator(".plot[aria-label^='History of node'] .nsewdrag").first.bounding_box()
    if box is None:
        raise SystemExit("the history has no place on the page")
    page.evaluate(COUNT, orbit)
    tools = page.context.new_cdp_session(page)
    tools.send("Performance.enable")

    def processor_time() -> float:
        metrics = tools.send("Performance.getMetrics")["metrics"]
        return float(next(metric["value"] for metric in metrics if metric["name"] == "ThreadTime"))

    page.mouse.move(box["x"] + 0.1 * box["width"], box["y"] + 20)
    page.mouse.down()
    page.mouse.move(box["x"] + 0.2 * box["width"], box["y"] + 20, steps=4)
    start, worked = page.evaluate("() => [performance.now(), window.framesDrawn = 0]")[0], processor_time()
    for step in range(MOVES):
        page.mouse.move(box["x"] + (0.2 + 0.6 * step / MOVES) * box["width"], box["y"] + 30)
    now, frames = page.evaluate("() => [performance.now(), window.framesDrawn]")
    worked = processor_time() - worked
    page.mouse.up()
    return 1000 * frames / (now - start), 1000 * worked / frames


def main() -> None:
    """Measures and prints."""
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("server")
    parser.add_argument("sweep")
    parser.add_argument("--times", type=int, default=5)
    arguments = parser.parse_args()
    print("| view | first load | after it | from another view | transferred at first | after it |")
    print("|---|---|---|---|---|---|")
    with sync_playwright() as playwright:
        browser = playwright.chromium.launch(executable_path=CHROMIUM, args=OPTIONS)
        for name, link, selector in views(arguments.sweep):
            cold, warm, inside = [], [], []
            for _ in range(arguments.times):
                context = browser.new_context(viewport={"width": 1400, "height": 900})
                cold.append(opened(context, arguments.server, link, selector))
                warm.append(opened(context, arguments.server, link, selector))
                page = context.new_page()
                # Pictures need the drawing library, which a first one has loaded.
                page.goto(f"{arguments.server}/#/sweeps/{arguments.sweep}?view=scatter")
                page.locator(PICTURE).first.wait_for()
                inside.append(moved(page, link, selector))
                context.close()
            times = [median(time for time, _ in of) for of in (cold, warm, inside)]
            sizes = [median(size for _, size in of) / 1000 for of in (cold, warm)]
            told = [f"{time:.0f} ms" for time in times] + [f"{size:.0f} kB" for size in sizes]
            print("| " + " | ".join([name, *told]) + " |")
        rates = []
        for _ in range(arguments.times):
            context = browser.new_context(viewport={"width": 1400, "height": 900})
            rates.append(brushed(context.new_page(), arguments.server, arguments.sweep))
            context.close()
        rate, worked = (median(values) for values in zip(*rates, strict=True))
        print(f"\nBrushing: {rate:.0f} orbits a second, {worked:.1f} ms of the page's thread for each.")
        browser.close()


if __name__ == "__main__":
    main()
