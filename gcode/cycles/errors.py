"""The error of a canned cycle. It names words; the interpreter adds their positions."""

from __future__ import annotations


class CycleError(Exception):
    """A cycle that its control does not run, or that has no meaning.

    Attributes:
        code: short stable name: ``cycle-missing-word``, ``cycle-word`` (one that the cycle does not take),
            ``cycle-level``, ``cycle-peck``, ``cycle-repeat``, ``cycle-dwell``, ``cycle-spindle``,
            ``cycle-unsupported`` or ``missing-feed``.
        problem: the problem, naming the word and its value.
        expected: a correct alternative.
        letter: letter of the wrong or missing word, None where it is not a single word.
    """

    def __init__(self, code: str, problem: str, expected: str = "", letter: str | None = None) -> None:
        self.code = code
        self.problem = problem
        self.expected = expected
        self.letter = letter
        super().__init__(f"{problem}; expected {expected} [{code}]" if expected else f"{problem} [{code}]")
