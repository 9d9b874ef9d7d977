"""Printable reports in a real browser: from the page to paper."""

from __future__ import annotations

import re

from playwright.sync_api import Page, expect

from browsing import NASTY, Opens
from drillsweep import Sweep


def pages_of(page: Page) -> int:
    """Number of pages A4 of a print."""
    printed = page.pdf(prefer_css_page_size=True, print_background=True)
    return len(re.findall(rb"/Type\s*/Page(?!s)", printed))


def test_reports_open_from_the_heads_and_fill_a_few_pages(opened: Opens, recorded: Sweep, named: Sweep) -> None:
    for sweep, view, heading in [
        (named, f"#/sweeps/{named.id}?view=window&limits=largest_side_force:1000", NASTY),
        (recorded, f"#/sweeps/{recorded.id}/points/1", "snapshots, point 1"),
    ]:
        page = opened(view)
        page.get_by_role("button", name="Units: SI. Switch").click()
        with page.context.expect_page() as opening:
            page.get_by_role("link", name="Report").click()
        report = opening.value
        expect(report.get_by_role("heading", level=1)).to_have_text(heading)
        expect(report.get_by_text("8.5\N{NO-BREAK SPACE}in")).to_have_count(1)
        if sweep is named:
            limit = (
                report.get_by_role("table")
                .filter(has_text="Limits in use")
                .get_by_role("row", name="largest side force")
            )
            expect(limit).to_contain_text("0.2248\N{NO-BREAK SPACE}klbf")
        assert 1 <= pages_of(report) <= 4
        assert report.locator("script").count() == 0
        report.close()
