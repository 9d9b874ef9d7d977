"""The documents: every link between them leads somewhere, the book has every chapter, and commands print what is shown.

A transcript is a block of the language `console`: lines that begin with `$ ` are commands, what follows each is its
output. One that has the comment `<!-- checked -->` on the line before it is run and compared exactly, all commands in
one shell; after `<!-- checked with a service -->` there is a server with workers at `DRILLSWEEP_SERVER`. Examples leave
out by themselves what is not the same every time, such as times.

Blocks of `sh` and `python` are run as well, those of one document in order, in one shell and one directory, with a
service. One that cannot be has a comment on the line before it, `<!-- not run: REASON -->`, and must parse.

With DRILLSWEEP_WRITE_TRANSCRIPTS set, transcripts are not compared: the documents get what commands print now.
"""

from __future__ import annotations

import ast
import os
import re
import runpy
import subprocess
import sys
from collections.abc import Iterator
from pathlib import Path
from typing import NamedTuple

import pytest
import yaml

from service import REPOSITORY, Service, binary

DOCUMENTS = [*REPOSITORY.glob("*.md"), *REPOSITORY.glob("docs/**/*.md"), REPOSITORY / "api" / "python" / "README.md"]
LINK = re.compile(r"\]\(([^)\s]+)\)")
PICTURE = re.compile(r'src(?:set)?="([^"]+)"')


@pytest.mark.parametrize("document", DOCUMENTS, ids=lambda path: str(path.relative_to(REPOSITORY)))
def test_links_lead_to_files(document: Path) -> None:
    text = document.read_text()
    for link in LINK.findall(text) + PICTURE.findall(text):
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
    assert chapter.read_text() == script["reference"](), "python docs/scenario_reference.py rewrites it"


def test_the_chapter_of_columns_is_that_of_the_vocabulary() -> None:
    chapter = REPOSITORY / "docs" / "quantities.md"
    script = runpy.run_path(str(chapter.parent / "quantity_reference.py"))
    assert chapter.read_text() == script["reference"](), "python docs/quantity_reference.py writes it anew"


def test_the_glossary_is_in_alphabetical_order() -> None:
    text = (REPOSITORY / "docs" / "glossary.md").read_text()
    terms = re.findall(r"^\| ([a-z][^|]*?) \|", text, re.MULTILINE)[1:]
    assert len(terms) > 30
    assert terms == sorted(terms)


def test_the_readme_stays_short() -> None:
    assert len((REPOSITORY / "README.md").read_text().splitlines()) <= 120


class Transcript(NamedTuple):
    """A marked block of a document."""

    document: Path
    place: str
    needs_service: bool
    text: str

    def steps(self) -> list[tuple[str, str]]:
        """Each command with the output that is shown; a command goes on after a backslash."""
        steps = re.findall(r"^\$ ((?:.*\\\n)*.*)\n((?:(?!\$ ).*\n)*)", self.text, re.MULTILINE)
        assert "".join(f"$ {command}\n{output}" for command, output in steps) == self.text, "begins with a command"
        return steps

    def write(self, outputs: list[str]) -> None:
        """Replaces the output of each command."""
        commands = [command for command, _ in self.steps()]
        text = "".join(f"$ {command}\n{output}" for command, output in zip(commands, outputs, strict=True))
        self.document.write_text(self.document.read_text().replace(self.text, text))


def transcripts() -> Iterator[Transcript]:
    for document in DOCUMENTS:
        text = document.read_text()
        for mark in re.finditer(
            r"<!-- checked( with a service)? -->\n(?:```console\n(.*?)^```$)?", text, re.DOTALL | re.MULTILINE
        ):
            place = f"{document.relative_to(REPOSITORY)}:{text.count(chr(10), 0, mark.start()) + 1}"
            assert mark[2], f"{place}: a mark without a transcript"
            yield Transcript(document, place, bool(mark[1]), mark[2])


TRANSCRIPTS = list(transcripts())


@pytest.fixture(scope="module")
def server(tmp_path_factory: pytest.TempPathFactory) -> Iterator[str]:
    data = tmp_path_factory.mktemp("data")
    service = Service("up", "--workers", "2", "--listen", "127.0.0.1:0", "--data", str(data))
    yield service.server
    service.stop()


def test_transcripts_are_checked_with_and_without_a_service() -> None:
    assert {transcript.needs_service for transcript in TRANSCRIPTS} == {False, True}
    for what in ("<!-- checked", "```console"):
        found = sum(document.read_text().count(what) for document in DOCUMENTS)
        assert found == len(TRANSCRIPTS), "a mark is misspelt or missing"


@pytest.mark.parametrize("transcript", TRANSCRIPTS, ids=lambda transcript: transcript.place)
def test_commands_print_their_transcripts(
    transcript: Transcript, request: pytest.FixtureRequest, tmp_path: Path
) -> None:
    steps = transcript.steps()
    environment = {"NO_COLOR": "1", "PATH": f"{Path(binary()).parent}:{os.environ['PATH']}"}
    if transcript.needs_service:
        environment["DRILLSWEEP_SERVER"] = request.getfixturevalue("server")
    script = "".join(f"{command}\nprintf '\\0'\n" for command, _ in steps)
    done = subprocess.run(
        ["bash", "-c", script],
        cwd=tmp_path,
        env=environment,
        stdin=subprocess.DEVNULL,
        capture_output=True,
        text=True,
        timeout=600,
        check=False,
    )
    *printed, rest = done.stdout.split("\0")
    assert rest == "", done.stderr
    if "DRILLSWEEP_WRITE_TRANSCRIPTS" in os.environ:
        transcript.write(printed)
        return
    assert [*zip([command for command, _ in steps], printed, strict=True)] == steps, done.stderr


class Block(NamedTuple):
    """A block of code of a document."""

    document: Path
    line: int
    language: str
    reason: str | None
    """Why it is not run."""
    text: str

    @property
    def place(self) -> str:
        return f"{self.document.relative_to(REPOSITORY)}:{self.line}"


def blocks() -> Iterator[Block]:
    fence = re.compile(r"^(?:<!-- not run: ([^\n]+) -->\n)?```(sh|python)\n(.*?)^```$", re.DOTALL | re.MULTILINE)
    for document in DOCUMENTS:
        text = document.read_text()
        for found in fence.finditer(text):
            line = text.count("\n", 0, found.start(2)) + 1
            yield Block(document, line, found[2], found[1], found[3])


BLOCKS = list(blocks())
RUN = sorted({block.document for block in BLOCKS if block.reason is None})

SHORTER = {
    "paper-200m-damped --flow-rate 0.01,0.04,0.06 --mud-density 1200:2100:4": (
        "paper-200m-damped --flow-rate 0.01,0.04 --mud-density 1200 --accuracy draft"
    ),
    '"paper-200m-damped", axes={"flow_rate": [0.01, 0.04, 0.06], "mud_density": Range(1200, 2100, 4)}': (
        '"paper-200m-damped", accuracy="draft", axes={"flow_rate": [0.01, 0.04], "mud_density": [1200]}'
    ),
    '"paper-200m-damped",\n    axes={"flow_rate": [0.01, 0.04, 0.06], "mud_density": Range(1200, 2100, 4)}': (
        '"paper-200m-damped",\n    accuracy="draft",\n    axes={"flow_rate": [0.01, 0.04], "mud_density": [1200]}'
    ),
    "paper-200m-damped --flow-rate 0.01,0.04 --set recording.snapshots=": (
        "paper-200m-damped --flow-rate 0.01 --accuracy draft --set recording.snapshots="
    ),
    '"paper-200m-damped", set=recorded, axes={"flow_rate": [0.01, 0.04]}': (
        '"paper-200m-damped", accuracy="draft", set=recorded, axes={"flow_rate": [0.01]}'
    ),
    '    set={"duration": 60},\n    axes={"flow_rate": [0.01, 0.04, 0.06], "mud_density": Range(1200, 2100, 4)}': (
        '    set={"duration": 60},\n    accuracy="draft",\n    axes={"flow_rate": [0.01], "mud_density": [1200]}'
    ),
    "--flow-rate 0.01,0.06 --mud-density 1200:2100:4 --detach": (
        "--flow-rate 0.01,0.06 --mud-density 1200 --accuracy draft --detach"
    ),
    "append $finer --flow-rate 0.01:0.06:11 --mud-density 1200:2100:4": (
        "append $finer --flow-rate 0.01:0.06:2 --mud-density 1200:2100:2"
    ),
    "--samples 256": "--samples 2 --accuracy draft --set duration=1 --set recording.spectrum_windows=[] "
    "--set recording.orbit_window=null",
    "--flow-rate 0.01:0.06:20 --mud-density 1200:2100:20 --accuracy draft": (
        "--flow-rate 0.01,0.06 --mud-density 1200 --accuracy draft --set duration=1 "
        "--set recording.spectrum_windows=[] --set recording.orbit_window=null"
    ),
    '"members": 5, "presets": ["standard"]': '"duration": 0.1, "presets": ["draft"]',
}
"""Fewer and shorter runs of the same kind."""


def test_blocks_are_run_or_say_why_not() -> None:
    marks = sum(document.read_text().count("<!-- not run") for document in DOCUMENTS)
    assert marks == sum(block.reason is not None for block in BLOCKS), "a mark is misspelt"
    for document in DOCUMENTS:
        languages = set(re.findall(r"^ *```(\S+)$", document.read_text(), re.MULTILINE))
        assert languages <= {"sh", "python", "console", "text", "mermaid", "yaml"}, (
            f"{document.name}: a block that is not run"
        )
        for block in re.findall(r"^```yaml\n(.*?)^```", document.read_text(), re.MULTILINE | re.DOTALL):
            assert yaml.safe_load(block), f"{document.name}: {block}"
    for block in BLOCKS:
        for named in re.findall(r"tests/\w+\.\w+", block.reason or ""):
            assert (REPOSITORY / named).exists(), f"{block.place} names {named}"
    text = "".join(block.text for block in BLOCKS if block.reason is None)
    assert [long for long in SHORTER if long not in text] == []


@pytest.mark.parametrize("block", [block for block in BLOCKS if block.reason], ids=lambda block: block.place)
def test_blocks_that_are_not_run_parse(block: Block) -> None:
    if block.language == "python":
        ast.parse(block.text)
    else:
        subprocess.run(["bash", "-n", "-c", block.text], check=True)


@pytest.mark.parametrize("document", RUN, ids=lambda path: str(path.relative_to(REPOSITORY)))
def test_blocks_run(document: Path, server: str, tmp_path: Path) -> None:
    script = "set -euo pipefail\n"
    for number, block in enumerate(block for block in BLOCKS if block.document == document and block.reason is None):
        text = block.text
        for long, short in SHORTER.items():
            text = text.replace(long, short)
        for address in ("http://127.0.0.1:7340", "localhost:7340"):
            text = text.replace(address, server)
        if block.language == "python":
            (tmp_path / f"{number}.py").write_text(text)
            text = f"python ../{number}.py\n"
        script += f"echo {block.place} >&2\n{text}"
    directory = tmp_path / "work"
    directory.mkdir()
    environment = {
        **os.environ,
        "DRILLSWEEP_SERVER": server,
        "MPLBACKEND": "Agg",
        "NO_COLOR": "1",
        "PATH": f"{Path(binary()).parent}:{Path(sys.executable).parent}:{os.environ['PATH']}",
    }
    done = subprocess.run(
        ["bash", "-c", script],
        cwd=directory,
        env=environment,
        stdin=subprocess.DEVNULL,
        capture_output=True,
        timeout=1800,
        check=False,
    )
    assert done.returncode == 0, done.stderr.decode() + done.stdout.decode(errors="replace")[-2000:]
