"""The documents: every link between them leads somewhere, and the book has every chapter."""

import re
from pathlib import Path

import pytest

REPOSITORY = Path(__file__).parent.parent
DOCUMENTS = [*REPOSITORY.glob("*.md"), *REPOSITORY.glob("docs/**/*.md"), REPOSITORY / "api" / "python" / "README.md"]
LINK = re.compile(r"\]\(([^)\s]+)\)")


@pytest.mark.parametrize("document", DOCUMENTS, ids=lambda path: str(path.relative_to(REPOSITORY)))
def test_links_lead_to_files(document: Path) -> None:
    for link in LINK.findall(document.read_text()):
        if "://" in link or link.startswith("#"):
            continue
        target = document.parent / link.split("#")[0]
        assert target.exists(), f"{document.name} links to {link}"


def test_every_chapter_is_in_the_book() -> None:
    summary = REPOSITORY / "docs" / "SUMMARY.md"
    listed = {summary.parent / link for link in LINK.findall(summary.read_text())}
    assert listed == set(summary.parent.glob("**/*.md")) - {summary}


def test_the_readme_stays_short() -> None:
    assert len((REPOSITORY / "README.md").read_text().splitlines()) <= 130
