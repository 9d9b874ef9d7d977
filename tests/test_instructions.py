"""Instructions of a time step, counted: what times on shared machines cannot guard."""

from __future__ import annotations

import subprocess
from collections import Counter
from pathlib import Path

import pytest

from service import binary

STEPS = 10

STEP = {"esdirk4": 1_067_500, "generalized_alpha": 266_800, "rk4": 545_100}
"""Instructions of the simulation's own in one step of the paper's case (297 nodes, 150 in the wall) by method, with
Rust 1.95 and without incremental compilation; a third of the steps lie in the window whose loads are observed. A
change that lowers a count lowers it here too."""

MARGIN = 0.05
"""Share that another processor or C library may add, or incremental compilation save: it cuts the code into other
units."""


def counts(method: str, steps: int, folder: Path) -> Counter[str]:
    """Instructions of a whole run by function."""
    program = Path(binary()).parent / "examples" / "steps"
    assert program.exists(), f"{program} is missing: cargo build --workspace --examples"
    out = folder / f"{method}-{steps}"
    valgrind = ["valgrind", "--tool=cachegrind", "--cache-sim=no", f"--cachegrind-out-file={out}"]
    subprocess.run([*valgrind, str(program), method, str(steps)], check=True, capture_output=True)
    by_function: Counter[str] = Counter()
    function = ""
    for line in out.read_text().splitlines():
        if line.startswith("fn="):
            function = line.removeprefix("fn=")
        elif line[:1].isdigit():
            by_function[function] += int(line.split()[1])
    return by_function


@pytest.mark.parametrize("method", STEP)
def test_a_step_takes_no_more_instructions_than_it_did(method: str, tmp_path: Path) -> None:
    # What a run does before its first step is the same whatever its length.
    fewer, more = (counts(method, steps, tmp_path) for steps in (STEPS, 2 * STEPS))
    step = Counter({name: (more[name] - fewer[name]) // STEPS for name in more if "drillsweep_sim" in name})
    # The total only: which function an instruction stands in depends on what the compiler inlines.
    total = step.total()
    assert total <= (1 + MARGIN) * STEP[method], f"{total} of {STEP[method]}; most in {step.most_common(8)}"
    assert total >= (1 - MARGIN) * STEP[method], f"{total} of {STEP[method]}: the count to hold is lower"
