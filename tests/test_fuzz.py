"""Mutated input files of every kind: read or refused with a message, in bounded time and memory.

A few of each kind in every run of the tests; ``pytest tests/test_fuzz.py --fuzz-seconds 300`` does so for minutes. What
was found is in ``tests/corpus``, with its right value.
"""

from __future__ import annotations

import json
import re
import subprocess
import sys
import tomllib
from pathlib import Path
from typing import Any

import pytest
from support.fuzz.targets import TARGETS
from support.fuzz.worker import try_one

WORKER = Path(__file__).parent / "support" / "fuzz" / "worker.py"
CORPUS = Path(__file__).parent / "corpus"
#: Inputs of each kind in a run without the option.
COUNT = 20
#: The process loads its libraries in this time, at most, s.
LOADING_S = 120.0


def pytest_generate_tests(metafunc: pytest.Metafunc) -> None:
    """All kinds in one process, which loads its libraries once; with the option, a process for each kind."""
    if "kinds" not in metafunc.fixturenames:
        return
    seconds = metafunc.config.getoption("--fuzz-seconds")
    each = seconds / len(TARGETS)
    limit = pytest.mark.timeout(each + 2 * LOADING_S)
    cases = [pytest.param([name], each, marks=limit, id=name) for name in TARGETS] if seconds else [([], 0.0)]
    metafunc.parametrize(("kinds", "seconds"), cases)


def test_mutated_inputs_are_read_or_refused(
    kinds: list[str], seconds: float, request: pytest.FixtureRequest, tmp_path: Path
) -> None:
    seed = request.config.getoption("--fuzz-seed")
    length = ["--seconds", f"{seconds}"] if seconds else ["--count", f"{COUNT}"]
    command = [sys.executable, str(WORKER), *kinds, *length, "--seed", f"{seed}", "--folder", str(tmp_path)]
    done = subprocess.run(command, capture_output=True, text=True, timeout=seconds + 2 * LOADING_S, check=False)
    assert done.returncode == 0, f"{sorted(tmp_path.glob('current*'))}: {done.stderr[-2000:]}"
    results = [json.loads(line) for line in done.stdout.splitlines()]
    assert [r["target"] for r in results] == (kinds or list(TARGETS))
    print(done.stdout)
    assert [(r["target"], r["failures"]) for r in results if r["failures"]] == []


FOUND: list[dict[str, Any]] = tomllib.loads((CORPUS / "expected.toml").read_text(encoding="utf-8"))["found"]


@pytest.mark.parametrize("found", FOUND, ids=lambda found: found["file"])
def test_what_was_found_has_its_right_value(found: dict[str, Any]) -> None:
    message = try_one(TARGETS[found["kind"]], CORPUS / found["file"])
    assert re.search(found["message"], message) if found["message"] else not message, message


def test_every_file_of_the_corpus_has_a_value() -> None:
    assert sorted(f["file"] for f in FOUND) == sorted(p.name for p in CORPUS.iterdir() if p.name != "expected.toml")
