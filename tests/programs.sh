#!/usr/bin/env bash
# Names the programs that tests need and that are missing (.config/nextest.toml runs it before them). Only all tests together need them: the other profiles leave out
# the tests that do.
set -euo pipefail
[ "${NEXTEST_PROFILE:-default}" = default ] || exit 0

missing=()
needs() {
    command -v "$1" >/dev/null || missing+=("$1 (Debian: apt install $2)")
}
needs cc gcc
needs python3 'python3 python3-venv'
needs sqlite3 sqlite3
if ! command -v initdb >/dev/null && ! compgen -G '/usr/lib/postgresql/*/bin/initdb' >/dev/null; then
    missing+=('initdb (Debian: apt install postgresql)')
fi
if [ ${#missing[@]} -gt 0 ]; then
    echo "The tests need programs that are missing here:" >&2
    printf '  %s\n' "${missing[@]}" >&2
    echo "Tests without them: cargo nextest run --workspace --profile fast" >&2
    exit 1
fi
