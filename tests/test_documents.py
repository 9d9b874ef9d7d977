"""The documents: every link between them leads somewhere, and the book has every chapter."""

import re
import runpy
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


def anchors(document: Path) -> set[str]:
    headings = re.findall(r"^#+ (.*)$", document.read_text(), re.MULTILINE)
    return {re.sub(r"[^a-z0-9 _-]", "", heading.lower()).replace(" ", "-") for heading in headings}


@pytest.mark.parametrize("document", DOCUMENTS, ids=lambda path: str(path.relative_to(REPOSITORY)))
def test_anchors_are_headings(document: Path) -> None:
    for link in LINK.findall(document.read_text()):
        path, _, anchor = link.partition("#")
        if "://" not in link and anchor:
            assert anchor in anchors(document.parent / path if path else document), f"{document.name} links to {link}"


def test_tests_that_the_model_names_exist() -> None:
    named = 0
    for chapter in (REPOSITORY / "docs" / "model").glob("*.md"):
        for block in re.findall(r"> Tests?:.*?(?=\n\n|\Z)", chapter.read_text(), re.DOTALL):
            text = block.replace("\n> ", " ").replace("\n>", " ")
            for files, tests in re.findall(r"((?:`[^`]+\.rs`(?: and )?)+)\s*\(([^)]*)\)", text):
                for file in re.findall(r"`([^`]+\.rs)`", files):
                    source = (REPOSITORY / file).read_text()
                    for test in re.findall(r"`([a-z_0-9]+)`", tests):
                        assert re.search(rf"fn {test}\b", source), f"{chapter.name} names {test} of {file}"
                        named += 1
    assert named > 100


def test_every_chapter_is_in_the_book() -> None:
    summary = REPOSITORY / "docs" / "SUMMARY.md"
    listed = {summary.parent / link for link in LINK.findall(summary.read_text())}
    assert listed == set(summary.parent.glob("**/*.md")) - {summary}


def test_the_scenario_reference_is_that_of_the_schema() -> None:
    chapter = REPOSITORY / "docs" / "scenario.md"
    script = runpy.run_path(str(chapter.parent / "scenario_reference.py"))
    assert chapter.read_text() == script["reference"](), "python docs/scenario_reference.py writes it anew"


def test_the_chapter_of_columns_is_that_of_the_vocabulary() -> None:
    chapter = REPOSITORY / "docs" / "quantities.md"
    script = runpy.run_path(str(chapter.parent / "quantity_reference.py"))
    assert chapter.read_text() == script["reference"](), "python docs/quantity_reference.py writes it anew"


def test_the_readme_stays_short() -> None:
    assert len((REPOSITORY / "README.md").read_text().splitlines()) <= 130
