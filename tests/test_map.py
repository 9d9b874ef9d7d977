"""Map, index and instructions: every path that they name exists, and the first documents of a newcomer stay short."""

from __future__ import annotations

import re
import subprocess
from pathlib import Path

import pytest
import yaml

from service import REPOSITORY

DOCUMENTS = [
    REPOSITORY / "ARCHITECTURE.md",
    REPOSITORY / "CONTRIBUTING.md",
    *(REPOSITORY / "docs" / name for name in ("where.md", "store.md", "numerics.md", "failures.md")),
    *sorted((REPOSITORY / "docs" / "decisions").glob("*.md")),
]
ROOTS = {path.name for path in REPOSITORY.iterdir()} - {"target"}
SOURCE = re.compile(r"\.(rs|py|js|sql|md|toml|json|ya?ml|sh|html|css)$")
PLACEHOLDER = re.compile(r"[A-Z]{3,}")
LARGEST = {"ARCHITECTURE.md": 18_000, "CHANGELOG.md": 6_000}
"""Bytes of a document at most."""


def named(text: str) -> list[str]:
    """Paths in inline code and in blocks of commands; `A/{b,c}` stands for two."""
    blocks = re.findall(r"^```(?:sh|console)?\n(.*?)^```", text, re.DOTALL | re.MULTILINE)
    code = re.findall(r"`([^`\n]+)`", re.sub(r"^```.*?^```", "", text, flags=re.DOTALL | re.MULTILINE))
    words = [word.strip("\"'(),;:[]") for part in [*code, *blocks] for word in part.split()]
    return [path for word in words if is_path(word) for path in unfolded(word)]


def is_path(word: str) -> bool:
    """Whether a word begins with an entry of the repository, or ends as a source does."""
    if re.search(r"://|[=<>$|]|^[/~-]|\.{2,}", word):
        return False
    first, slash, _ = word.partition("/")
    return bool((slash and first in ROOTS) or SOURCE.search(word))


def unfolded(path: str) -> list[str]:
    found = re.search(r"\{([^{}]*,[^{}]*)\}", path)
    if not found:
        return [path]
    return [each for part in found[1].split(",") for each in unfolded(path.replace(found[0], part, 1))]


def exists(path: str) -> bool:
    """Whether there is such a file or folder; a word of capitals, such as NAME, stands for anything."""
    return (REPOSITORY / path).exists() or any(REPOSITORY.glob(PLACEHOLDER.sub("*", path)))


@pytest.mark.parametrize("document", DOCUMENTS, ids=lambda path: str(path.relative_to(REPOSITORY)))
def test_named_paths_exist(document: Path) -> None:
    paths = named(document.read_text())
    assert [path for path in paths if not exists(path)] == []


def test_paths_are_recognised() -> None:
    text = "`sim/src/lib.rs`, `python docs/{a,b}.py`, `GET /v1/sweeps`, `text/csv`, `law.rs`\n```sh\n.ci/run\n```\n"
    assert named(text) == ["sim/src/lib.rs", "docs/a.py", "docs/b.py", "law.rs", ".ci/run"]
    assert not exists("law.rs")
    assert exists("store/sql/ENGINE/MODULE.sql")
    assert not exists("store/sql/ENGINE/MODULE.rs")


def test_every_crate_is_on_the_map_and_in_the_index() -> None:
    crates = {path.parent.name for path in REPOSITORY.glob("*/Cargo.toml")}
    assert len(crates) > 5
    index = (REPOSITORY / "docs" / "where.md").read_text()
    architecture = (REPOSITORY / "ARCHITECTURE.md").read_text()
    for crate in crates:
        assert f"| `{crate}/` |" in architecture, f"the map lacks {crate}"
        assert f"`{crate}/src/" in index or crate == "fft", f"no topic leads to {crate}"


@pytest.mark.parametrize("name", LARGEST)
def test_documents_stay_short(name: str) -> None:
    assert len((REPOSITORY / name).read_bytes()) <= LARGEST[name]


def test_every_decision_is_in_the_list() -> None:
    folder = REPOSITORY / "docs" / "decisions"
    records = sorted(path.name for path in folder.glob("[0-9]*.md"))
    assert records == re.findall(r"\]\((\d{4}-[^)]+\.md)\)", (folder / "index.md").read_text())
    assert [int(name[:4]) for name in records] == list(range(1, len(records) + 1))
    for name in records:
        headings = re.findall(r"^## (.*)$", (folder / name).read_text(), re.MULTILINE)
        assert headings == ["Context", "Decision", "Consequences", "Alternatives"], name


def value(manifest: Path, key: str) -> str:
    """A string of a TOML file, by a key that only one table has."""
    (found,) = re.findall(rf'^{key} = "(.*)"$', manifest.read_text(), re.MULTILINE)
    return str(found)


def test_the_version_is_the_same_everywhere() -> None:
    """`just release` sets all of them."""
    manifest = REPOSITORY / "Cargo.toml"
    version = value(manifest, "version")
    assert value(REPOSITORY / "api" / "python" / "pyproject.toml", "version") == version
    kustomization = yaml.safe_load((REPOSITORY / "deploy" / "kubernetes" / "kustomization.yaml").read_text())
    assert [image["newTag"] for image in kustomization["images"]] == [version]
    assert set(re.findall(r"image: drillsweep:(\S+)", (REPOSITORY / "docker-compose.yml").read_text())) == {version}
    # The compiler, too.
    compiler = value(manifest, "rust-version")
    assert value(REPOSITORY / "rust-toolchain.toml", "channel").startswith(f"{compiler}.")
    assert f"FROM rust:{compiler}-" in (REPOSITORY / "Dockerfile").read_text()


def test_the_physics_version_of_the_changelog_is_that_of_the_program() -> None:
    source = (REPOSITORY / "sim" / "src" / "lib.rs").read_text()
    version = re.search(r"PHYSICS_VERSION: u32 = (\d+)", source)
    assert version
    latest = re.search(r"Physics version (\d+)", (REPOSITORY / "CHANGELOG.md").read_text())
    assert latest
    assert latest[1] == version[1]


def test_recipes_of_the_instructions_exist() -> None:
    recipes = set(re.findall(r"^([a-z-]+)(?: [a-z*]+)*:", (REPOSITORY / "justfile").read_text(), re.MULTILINE))
    named = re.findall(r"`just ([a-z-]+)", (REPOSITORY / "CONTRIBUTING.md").read_text())
    assert named
    assert set(named) <= recipes


def test_generated_files_are_those_of_the_script() -> None:
    script = (REPOSITORY / "docs" / "regen").read_text()
    generated = re.findall(r"^# \| (\S+/\S+) +\|", script, re.MULTILINE)
    assert len(generated) == 4
    assert all((REPOSITORY / path).exists() for path in generated)
    subprocess.run(["bash", "-n", str(REPOSITORY / "docs" / "regen")], check=True)
