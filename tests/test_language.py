"""The word list of CONTRIBUTING.md, held where a text search can hold it: home-made words for terms of the trade."""

from __future__ import annotations

import re
from pathlib import Path

import pytest

ROOT = Path(__file__).parents[1]
SOURCES = ("gcode", "twin", "examples", "benchmarks", "tools")
KINDS = (".py", ".md", ".toml", ".j2", ".proto")
#: Pages about the words themselves, and history.
NOT_READ = ("CONTRIBUTING.md", "CHANGELOG.md")

#: What must not be written, and what is written instead. A word ends where letters end: `told` is also in `_told`.
FORBIDDEN = {
    r"(?<![a-z])(?:tell|tells|told|telling)(?![a-z])(?! apart)": "report, state, detect, determine",
    r"(?<![a-z])said(?![a-z])": "stated, printed",
    r"(?<!there )\b(?:is|are|was|were)\s+no\s+(?!(?:longer|more|less|fewer|greater|larger|better)\b)[a-z]": "not a(n)",
    r"\bto\s+and\s+fro\b": "zigzag, back and forth",
    r"\bbeside\b": "next to, alongside, in addition to",
    r"\bstanding\s+spindle\b": "spindle stopped",
    r"\b(?:un)?even(?:ly)?\s+(?:pitch|pitches|teeth|tooth)\b": "variable pitch, constant pitch",
    r"(?<![a-z])tip[ _-]?lines?(?![a-z])": "cutter-location (CL) line",
    r"\bconventional\s+chain\b": "raster baseline",
    r"(?<![a-z])leftovers?(?![a-z])": "rest material, uncut material",
    r"\bwhat\s+stays\b": "the rest material, the remainder",
    r"(?<![a-z])turnings(?![a-z])": "transforms",
    r"\bfor\s+people\b": "human-readable",
    r"\bnobody\b": "not given, no one",
    r"\bso\s+many\b": "this many, N",
    r"\bleaves?\s+out\b": "omit",
    r"\bas\s+(?:it|they)\s+stands?\b": "as is, unchanged",
    r"(?<![a-z])wish(?:es|ed)?(?![a-z])": "request",
    r"(?<!in )(?<!take the )(?<!takes the )(?<!took the )(?<!decimal )\bplaces?\s+(?:of|where)\b": "position, location",
    r"\b(?:whole\s+way|way\s+into\s+material)\b": "complete workflow, entry",
    r'"""what\s+': "a noun: the docstring names the thing",
}
_CASE_KEPT = {
    r"\b(?:Ground|Rooms?)\b": "PlanSetup, free area",
    # a bare Place is a file, a line and a column, as gcode's public interface names it
    r"\bclass \w*(?:Asked|Told|Way|Wish|(?<!Not)Found|\wPlace)\b": "a concrete noun",
}
PATTERNS = [(re.compile(p, re.IGNORECASE), instead) for p, instead in FORBIDDEN.items()] + [
    (re.compile(p), instead) for p, instead in _CASE_KEPT.items()
]


def part(path: Path) -> str:
    """A page of its own, or the folder that a file of code lies in."""
    name = path.relative_to(ROOT)
    return name.as_posix() if path.suffix == ".md" else "/".join(name.parts[:-1][:2]) or name.as_posix()


def texts() -> dict[str, list[Path]]:
    files = [p for folder in (*SOURCES, "docs") for p in (ROOT / folder).rglob("*") if p.suffix in KINDS]
    files += [p for p in ROOT.glob("*.md") if p.name not in NOT_READ]
    parts: dict[str, list[Path]] = {}
    for file in sorted(files):
        parts.setdefault(part(file), []).append(file)
    return parts


TEXTS = texts()


def findings(path: Path) -> list[str]:
    text = path.read_text(encoding="utf-8")
    return [
        f"{path.relative_to(ROOT).as_posix()}:{text.count(chr(10), 0, m.start()) + 1}: {m[0]!r}; write: {instead}"
        for pattern, instead in PATTERNS
        for m in pattern.finditer(text)
    ]


@pytest.mark.parametrize("name", TEXTS)
def test_terms_of_the_trade(name: str) -> None:
    found = [line for path in TEXTS[name] for line in findings(path)]
    assert not found, "\n" + "\n".join(found)


@pytest.mark.parametrize(
    "text",
    [
        "three decimal places of a number",
        "pass a list in place of a name",
        "they can be told apart",
        "there is no file",
        "the answer is no longer than this",
        "a teller, an untold number, the resaid",
    ],
)
def test_ordinary_english_is_left_alone(text: str) -> None:
    assert [p.pattern for p, _ in PATTERNS if p.search(text)] == []


@pytest.mark.parametrize(
    "text",
    ["it tells the zero", "a mesh that is no solid", "the place of the tool", "rows to and\nfro", "class LevelWay:"],
)
def test_words_of_the_list_are_found(text: str) -> None:
    assert [p.pattern for p, _ in PATTERNS if p.search(text)] != []
