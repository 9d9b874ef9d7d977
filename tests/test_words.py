"""Words: documentation opens with a noun or a verb of the field, and lacks retired terms."""

from __future__ import annotations

import ast
import re
import subprocess
from collections.abc import Iterable, Iterator
from pathlib import PurePosixPath
from typing import NamedTuple

import pytest

from service import REPOSITORY

OPENING = re.compile(r"(What|Who|Whose|That of|Those of|So many|By whether)\b")
CLEAN = (
    "api",
    "chart",
    "cli",
    "quantity",
    "report",
    "scenario",
    "server",
    "sim",
    "store",
    "study",
    "table",
    "tests",
    "worker",
)
"""Folders whose doc comments in Rust open with no adverb or conjunction either."""
OPENING_OF_CLEAN = re.compile(r"(Where|When|How|Which|Whether|Why)\b")
RETIRED = {"falling friction": "velocity-weakening friction"}
"""Terms that no document and no doc comment has, with those in their place."""
RETIRED_IN_OPENINGS = {"contact sweep": "contact iteration"}
"""The same of headings and of the first lines of doc comments; the field `contact_sweeps` keeps its name."""
LISTS_RETIRED_TERMS = "CONTRIBUTING.md"
GENERATED = {"docs/quantities.md", "docs/scenario.md"}
"""Documents whose sources are checked."""


class Passage(NamedTuple):
    """A heading, or a paragraph of documentation without blocks of code."""

    line: int
    text: str
    is_heading: bool


def passages(lines: Iterable[tuple[int, str]]) -> Iterator[Passage]:
    gathered: list[tuple[int, str]] = []
    is_code = False
    for number, line in [*((number, line.strip()) for number, line in lines), (0, "")]:
        is_fence = line.startswith("```")
        heading = re.match(r"#+ (.*)", line) if not is_code else None
        if gathered and (is_fence or heading or not line):
            yield Passage(gathered[0][0], "\n".join(text for _, text in gathered), False)
            gathered = []
        if heading:
            yield Passage(number, heading[1], True)
        elif line and not is_fence and not is_code:
            gathered.append((number, line))
        is_code ^= is_fence


def rust(source: str) -> Iterator[Passage]:
    comment: list[tuple[int, str]] = []
    kind = ""
    for number, line in enumerate([*source.splitlines(), ""], 1):
        found = re.match(r"\s*(///|//!)(?!/)(.*)", line)
        if comment and (not found or found[1] != kind):
            yield from passages(comment)
            comment = []
        if found:
            kind = found[1]
            comment.append((number, found[2]))


def python(source: str) -> Iterator[Passage]:
    """Docstrings of modules, classes, functions and names."""
    for node in ast.walk(ast.parse(source)):
        match node:
            case ast.Expr(value=ast.Constant(value=str(text))):
                yield from passages(enumerate(text.splitlines(), node.lineno))


def script(source: str) -> Iterator[Passage]:
    """JSDoc."""
    for found in re.finditer(r"/\*\*(.*?)\*/", source, re.DOTALL):
        lines = [line.strip().removeprefix("*") for line in found[1].splitlines()]
        yield from passages(enumerate(lines, source.count("\n", 0, found.start()) + 1))


def markdown(source: str) -> Iterator[Passage]:
    yield from passages(enumerate(source.splitlines(), 1))


READERS = {".rs": rust, ".py": python, ".js": script, ".md": markdown}


def term(words: str) -> re.Pattern[str]:
    return re.compile(words.replace(" ", r"\s+"), re.IGNORECASE)


def offences(path: str, source: str) -> list[str]:
    """Each as `file:line: words`."""
    found = []
    suffix = PurePosixPath(path).suffix
    for line, text, is_heading in READERS[suffix](source):
        matches = []
        is_opening = is_heading or suffix != ".md"
        if is_opening:
            matches.append(OPENING.match(text))
            if suffix == ".rs" and path.startswith(tuple(f"{folder}/" for folder in CLEAN)):
                matches.append(OPENING_OF_CLEAN.match(text))
        if path != LISTS_RETIRED_TERMS:
            matches += [term(words).search(text) for words in RETIRED]
            matches += [term(words).search(text.split("\n")[0]) for words in RETIRED_IN_OPENINGS if is_opening]
        for match in filter(None, matches):
            instead = (RETIRED | RETIRED_IN_OPENINGS).get(" ".join(match[0].lower().split()))
            hint = f", use {instead}" if instead else ""
            found.append(f"{path}:{line + text.count(chr(10), 0, match.start())}: {match[0]!r}{hint}")
    return found


def own_files() -> list[str]:
    command = ["git", "ls-files", "--cached", "--others", "--exclude-standard"]
    listed = subprocess.run(command, cwd=REPOSITORY, check=True, capture_output=True, text=True).stdout.splitlines()
    own = (path for path in sorted(set(listed)) if not path.startswith("server/web/vendor/") and path not in GENERATED)
    return [path for path in own if PurePosixPath(path).suffix in READERS and (REPOSITORY / path).exists()]


def offences_of(paths: Iterable[str]) -> list[str]:
    return [offence for path in paths for offence in offences(path, (REPOSITORY / path).read_text())]


CHECKED = own_files()


@pytest.mark.parametrize("part", sorted({path.split("/")[0] for path in CHECKED}))
def test_documentation_opens_with_terms_of_the_field(part: str) -> None:
    found = offences_of(path for path in CHECKED if path.split("/")[0] == part)
    assert not found, "\n".join(found)


OFFENDING = {
    "a.rs": [
        "/// What it is.\nfn a() {}",
        "//! Whose it is.",
        "    /// By whether it is.",
        "/// A.\n///\n/// Who it is.",
    ],
    "a.py": ['"""What it is."""', 'def a() -> None:\n    """So many."""', 'A = 1\n"""\nThose of A.\n"""'],
    "a.js": ["/** What it is. */", "/**\n * That of a.\n */"],
    "a.md": ["# What it is", "text\n## Who it is\n", "They feed on falling\nfriction."],
    "b.rs": ["/// The contact sweeps.", "/// Growth by\n/// falling friction."],
    "store/src/a.rs": ["/// Where it is.", "/// # Errors\n/// When it fails.", "//! How it works."],
}
INNOCENT = {
    "a.rs": [
        "/// Work that\n/// What follows.",
        "// What it is.",
        "/// Whatever.",
        "/// A.\n/// ```\n/// // falling friction\n/// ```",
    ],
    "a.py": ['A = "What it is."', "# What it is.", '"""Whole of `contact_sweeps`."""'],
    "a.js": ["// What it is.", "/* What it is. */"],
    "b.rs": ["/// Where it is."],
    "store/src/a.rs": ["/// Whenever.", "/// Place where it is.", "// When it fails."],
    "a.md": ["What it is.", "```sh\n# What it is\nfalling friction\n```", "Two contact sweeps."],
}


@pytest.mark.parametrize(("path", "source"), [(path, text) for path, texts in OFFENDING.items() for text in texts])
def test_offences_are_found(path: str, source: str) -> None:
    assert len(offences(path, source)) == 1


@pytest.mark.parametrize(("path", "source"), [(path, text) for path, texts in INNOCENT.items() for text in texts])
def test_other_words_are_not_offences(path: str, source: str) -> None:
    assert offences(path, source) == []


def test_an_offence_is_reported_with_its_line() -> None:
    assert offences("a/b.rs", "fn a() {}\n\n/// Falls by\n/// falling friction.\nfn b() {}\n") == [
        "a/b.rs:4: 'falling friction', use velocity-weakening friction"
    ]


def test_the_walk_reaches_all_parts() -> None:
    assert {"README.md", "docs/model/index.md", "store/src/lib.rs", "tests/test_words.py"} <= set(CHECKED)
    assert not any("vendor" in path for path in CHECKED)
