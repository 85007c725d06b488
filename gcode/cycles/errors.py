"""The refusal of a canned cycle: it knows words, not places, so the interpreter adds where they stand."""

from __future__ import annotations


class CycleError(Exception):
    """A cycle that its control would not run, or that nobody can mean.

    Attributes:
        code: short stable name: ``cycle-missing-word``, ``cycle-word`` (one that the cycle does not take),
            ``cycle-level``, ``cycle-peck``, ``cycle-repeat``, ``cycle-dwell``, ``cycle-spindle``,
            ``cycle-unsupported`` or ``missing-feed``.
        problem: what is wrong, naming the word and its value.
        expected: what would have been right.
        letter: letter of the word that is wrong or missing, None where no single word is.
    """

    def __init__(self, code: str, problem: str, expected: str = "", letter: str | None = None) -> None:
        self.code = code
        self.problem = problem
        self.expected = expected
        self.letter = letter
        super().__init__(f"{problem}; expected {expected} [{code}]" if expected else f"{problem} [{code}]")
