"""The blocks of README.md: commands, Python, and samples of what is printed.

``python tests/support/readme.py FILE`` checks that the sample of a replay is in FILE.
"""

from __future__ import annotations

import re
import sys
from dataclasses import dataclass
from pathlib import Path

ROOT = Path(__file__).parents[2]
README = ROOT / "README.md"
_BLOCK = re.compile(r"^```(?P<language>\w*)\n(?P<fenced>[\s\S]*?)^```$|(?P<indented>(?:^ {4}.*\n)+)", re.M)
#: What differs from run to run.
_TIMES = re.compile(r"computed in +\S+ +\(\S+ real time\)")


@dataclass(frozen=True, slots=True, kw_only=True)
class Block:
    """A block of the page.

    Attributes:
        kind: ``commands``, ``python``, or ``output``.
    """

    kind: str
    text: str

    @property
    def commands(self) -> tuple[str, ...]:
        """Lines without comments."""
        lines = (re.sub(r"(^|\s)#.*", "", line).strip() for line in self.text.splitlines())
        return tuple(line for line in lines if line)


def blocks() -> list[Block]:
    """All blocks, in order."""
    return [_block(found) for found in _BLOCK.finditer(README.read_text("utf-8"))]


def _block(found: re.Match[str]) -> Block:
    if found["indented"]:
        return Block(kind="commands", text=re.sub(r"^ {4}", "", found["indented"], flags=re.M))
    return Block(kind=found["language"] or "output", text=found["fenced"])


def lines_of(text: str) -> list[str]:
    """Lines without blanks at their ends, and without times."""
    return [_TIMES.sub("", line).rstrip() for line in text.strip("\n").splitlines()]


def contains(printed: str, sample: str) -> bool:
    """Whether the lines of a sample follow each other in what was printed."""
    lines, wanted = lines_of(printed), lines_of(sample)
    return any(lines[i : i + len(wanted)] == wanted for i in range(len(lines) - len(wanted) + 1))


def main() -> None:
    """Check the sample of the page's first command, which takes too long for a test."""
    sample = next(block.text for block in blocks() if block.kind == "output")
    if not contains(Path(sys.argv[1]).read_text("utf-8"), sample):
        sys.exit(f"README.md shows what is not in {sys.argv[1]}:\n{sample}")


if __name__ == "__main__":
    main()
