"""Random mutations of NC programs, and the laws that hold whatever comes out of them.

Run by itself it mutates the programs of ``tests/gcode/programs`` for a while and prints figures as JSON:

    python tests/support/fuzz_gcode.py --seconds 300 --seed 1
"""

from __future__ import annotations

import argparse
import json
import math
import random
import resource
import signal
import sys
import time
import unicodedata
from collections import Counter
from collections.abc import Callable, Iterable, Iterator
from contextlib import contextmanager
from dataclasses import dataclass, field
from pathlib import Path

ROOT = Path(__file__).parents[2]
if __name__ == "__main__":
    sys.path.insert(0, str(ROOT))

from gcode.dialects import DIALECTS, Dialect  # noqa: E402
from gcode.errors import GcodeError  # noqa: E402
from gcode.events import ArcMotion, Block, Dwell, Event, LinearMotion  # noqa: E402
from gcode.flow.interpreter import check, interpret  # noqa: E402
from gcode.language.program import program_of  # noqa: E402
from gcode.report.motion_json import motion_objects  # noqa: E402
from gcode.report.stats import program_stats  # noqa: E402
from gcode.report.stats_json import stats_object  # noqa: E402
from gcode.settings import Limits, MachineSettings, ToolOffset  # noqa: E402

PROGRAMS = sorted((ROOT / "tests" / "gcode" / "programs").iterdir())
#: Texts of the seed programs by file name; the name begins with that of their dialect.
SEEDS = {path.name: path.read_text() for path in PROGRAMS}
#: A machine that runs all seeds, and stops what runs away.
SETTINGS = MachineSettings(
    tools={number: ToolOffset(length_mm=50.0 + number, radius_mm=1.0 + number) for number in (1, 2, 3)},
    home_mm=(0.0, 0.0, 400.0),
    reference_points_mm={2: (10.0, 10.0, 300.0)},
    start_mm=(5.0, 5.0, 300.0),
    limits=Limits(blocks=2000, nesting=8, errors=20),
)
#: One program may take so long, s.
LONGEST_S = 5.0
#: Characters that act on a terminal and may not be shown, but for the line ends and tabs between what is shown.
_ACTING = frozenset("\u202a\u202b\u202c\u202d\u202e\u2066\u2067\u2068\u2069")

NUMBERS = (
    *("1e308", "1e-320", "-0", "+.0", "0", "1" * 40, "0." + "0" * 39 + "1", "NaN", "inf", "-999999999.999", "1e9"),
    *("0.0000001", "1000000000", "1000000001", "-1", "--1", ".", "1.2.3", "#1", "[1/0]", "[0-1]", "[9**999]", "#0"),
    *("[#1]", "[SQRT[0-1]]", "9" * 400, "0x10", "1,5", "[1 MOD 0]", "#[1]", "[[[1]]]", "#<_x>", "2147483648"),
)
PIECES = (
    *("G0", "G1", "G2", "G3", "G4", "G10", "G28", "G41", "G43", "G51", "G52", "G53", "G65", "G66", "G68", "G81", "G83"),
    *("G92", "G91", "G93", "G95", "G18", "G20", "G33", "G5", "G16", "G76", "M98", "M99", "M97", "M6", "M30", "M70"),
    *("GOTO", "IF[", "THEN", "WHILE[", "DO1", "END1", "o1", "sub", "endsub", "call", "repeat", "while", "return"),
    *("%", "/", ";", "(", ")", "[", "]", "#", "=", "<", ">", ":", ",R", ",C", "$", "@", "^", "\t", " ", "\r", "\n"),
    *(
        "\x00",
        "\x1b[31m",
        "\x7f",
        "\u202e",
        "\u2028",
        "\ufeff",
        "ß",
        "ı",
        "ſ",
        "²",
        "٣",
        "İ",
        "Ä",
        "\U0001f600",
        "\x85",
    ),
)
_MOST_CHARACTERS = 20_000


def own_dialect(name: str) -> str:
    """The dialect that a seed program is written in."""
    return name.partition("_")[0]


def _spans(text: str, kind: str) -> list[tuple[int, int]]:
    """Where the characters, words or lines of a text are."""
    if kind == "character":
        return [(n, n + 1) for n in range(len(text))]
    separators, spans, begin = {"word": " \n", "line": "\n"}[kind], [], 0
    for position, character in enumerate(text):
        if character in separators:
            spans.append((begin, position + 1))
            begin = position + 1
    return [*spans, (begin, len(text))]


def _span(source: random.Random, text: str) -> tuple[int, int]:
    kind = source.choice(("character", "word", "line"))
    spans = _spans(text, kind)
    return source.choice(spans) if spans else (0, 0)


def delete(source: random.Random, text: str) -> str:
    """Without a character, a word or a line."""
    begin, end = _span(source, text)
    return text[:begin] + text[end:]


def duplicate(source: random.Random, text: str) -> str:
    """With one of them twice or more."""
    begin, end = _span(source, text)
    return text[:begin] + text[begin:end] * source.choice((2, 2, 3, 40)) + text[end:]


def swap(source: random.Random, text: str) -> str:
    """With two of them exchanged."""
    (a, b), (c, d) = sorted((_span(source, text), _span(source, text)))
    return text if b > c else text[:a] + text[c:d] + text[b:c] + text[a:b] + text[d:]


def insert(source: random.Random, text: str) -> str:
    """With something of the language, or what is no part of any, put in."""
    at = source.randrange(len(text) + 1)
    return text[:at] + source.choice(PIECES) + text[at:]


def insert_unicode(source: random.Random, text: str) -> str:
    """With any character put in."""
    at = source.randrange(len(text) + 1)
    code = source.choice((source.randrange(0x100), source.randrange(0x110000)))
    return text[:at] + chr(code) + text[at:]


def change_number(source: random.Random, text: str) -> str:
    """With a number that is extreme, or none."""
    digits = [n for n, character in enumerate(text) if character.isdigit()]
    if not digits:
        return text
    begin = end = source.choice(digits)
    while begin and text[begin - 1] in "0123456789.+-":
        begin -= 1
    while end < len(text) and text[end] in "0123456789.":
        end += 1
    return text[:begin] + source.choice(NUMBERS) + text[end:]


def splice(source: random.Random, text: str) -> str:
    """Its beginning, and the rest of another program."""
    other = SEEDS[source.choice(sorted(SEEDS))]
    return text[: _span(source, text)[0]] + other[_span(source, other)[0] :]


def flip_bit(source: random.Random, text: str) -> str:
    """With one bit of its bytes the other way round."""
    data = bytearray(text.encode("utf-8", "surrogatepass"))
    if data:
        data[source.randrange(len(data))] ^= 1 << source.randrange(8)
    return data.decode("latin-1")


Mutation = Callable[[random.Random, str], str]
MUTATIONS: tuple[Mutation, ...] = (
    *(delete, duplicate, swap, insert, insert_unicode, change_number, change_number, splice, flip_bit),
)


def mutated(source: random.Random, text: str, most: int = 6) -> str:
    """The text after one to `most` random mutations."""
    for _ in range(source.randint(1, most)):
        text = source.choice(MUTATIONS)(source, text)[:_MOST_CHARACTERS]
    return text


@dataclass(frozen=True, slots=True)
class Outcome:
    """What became of a program: its events, and the error that ended it, None where it ran to its end."""

    events: list[Event]
    error: GcodeError | None


def outcome(text: str, dialect: Dialect, settings: MachineSettings = SETTINGS) -> Outcome:
    """Runs a program."""
    events: list[Event] = []
    try:
        events.extend(iter(interpret(text, dialect=dialect, settings=settings)))
    except GcodeError as error:
        return Outcome(events, error)
    return Outcome(events, None)


def assert_laws(text: str, dialect: Dialect, settings: MachineSettings = SETTINGS) -> Outcome:
    """Runs a program and checks everything that holds for any text.

    Raises:
        AssertionError: where a law is broken; whatever else comes out breaks one, too.
    """
    met, errors = outcome(text, dialect, settings), check(text, dialect=dialect, settings=settings)
    first = errors[0] if errors else None
    assert str(first) == str(met.error), f"check says {first}, interpret {met.error}"
    lines = list(program_of(text, "")) or [""]
    for error in errors:
        assert_well_told(error, lines)
    assert_finite(met.events)
    json.dumps(list(motion_objects(met.events)), allow_nan=False)
    json.dumps(stats_object(program_stats(met.events)), allow_nan=False)
    return met


def assert_well_told(error: GcodeError, lines: list[str]) -> None:
    """An error stands inside the file, and its message does nothing to a terminal."""
    place = error.place
    assert 1 <= place.line <= len(lines), f"line {place.line} of {len(lines)}"
    assert 1 <= place.column <= len(lines[place.line - 1]) + 1, f"column {place.column}"
    assert error.code, str(error)
    assert error.problem, str(error)
    shown = error.underlined()
    acting = {c for c in shown if (unicodedata.category(c) == "Cc" and c not in "\n\t") or c in _ACTING}
    assert not acting, f"shows {acting}"


def assert_finite(events: Iterable[Event]) -> None:
    """All lengths, feeds and times are finite, and times and feeds are not negative."""
    for event in events:
        if isinstance(event, LinearMotion | ArcMotion):
            numbers = [*event.start_mm, *event.end_mm, *event.extra, event.feed_mm_min]
            numbers += event.centre_mm if isinstance(event, ArcMotion) else ()
            assert all(map(math.isfinite, numbers)), event
            assert event.feed_mm_min >= 0.0, event
        elif isinstance(event, Dwell):
            assert 0.0 <= event.seconds < math.inf, event


class TooSlowError(BaseException):
    """A program that took longer than it may; no law of the interpreter may catch it."""


@contextmanager
def time_bound(seconds: float) -> Iterator[None]:
    """Ends what runs inside after `seconds` of wall time (main thread only).

    Raises:
        TooSlowError: then.
    """

    def end(_signal: int, _frame: object) -> None:
        raise TooSlowError(f"more than {seconds:g} s")

    before = signal.signal(signal.SIGALRM, end)
    signal.setitimer(signal.ITIMER_REAL, seconds)
    try:
        yield
    finally:
        signal.setitimer(signal.ITIMER_REAL, 0.0)
        signal.signal(signal.SIGALRM, before)


@dataclass(slots=True)
class Figures:
    """What a run of the fuzzer found."""

    programs: int = 0
    blocks: int = 0
    ran: int = 0
    refused: int = 0
    codes: Counter[str] = field(default_factory=Counter)
    slowest_s: float = 0.0
    failures: list[dict[str, str]] = field(default_factory=list)

    def add(self, met: Outcome, seconds: float) -> None:
        """Counts one program."""
        self.blocks += sum(isinstance(event, Block) for event in met.events)
        self.slowest_s = max(self.slowest_s, seconds)
        if met.error is None:
            self.ran += 1
        else:
            self.refused += 1
            self.codes[met.error.code] += 1

    def told(self) -> dict[str, object]:
        """The figures as a JSON object; memory is the largest the process ever had."""
        peak_kib = resource.getrusage(resource.RUSAGE_SELF).ru_maxrss
        return {
            "programs": self.programs,
            "blocks": self.blocks,
            "ran": self.ran,
            "refused": self.refused,
            "distinct_error_codes": len(self.codes),
            "error_codes": dict(self.codes.most_common()),
            "slowest_program_s": round(self.slowest_s, 3),
            "peak_memory_mib": round(peak_kib / 1024.0, 1),
            "failures": len(self.failures),
            "failed": self.failures[:20],
        }


def fuzz(seconds: float, seed: int) -> Figures:
    """Mutates the seeds for a while; the same seed tries the same programs in the same order."""
    source, figures, names = random.Random(seed), Figures(), sorted(SEEDS)
    end = time.monotonic() + seconds
    while time.monotonic() < end:
        name = source.choice(names)
        dialect = source.choice((own_dialect(name), source.choice(sorted(DIALECTS))))
        text = mutated(source, SEEDS[name], most=source.choice((1, 3, 8)))
        figures.programs += 1
        begun = time.monotonic()
        try:
            with time_bound(LONGEST_S):
                met = assert_laws(text, DIALECTS[dialect])
        except KeyboardInterrupt:
            break
        except BaseException as failure:  # whatever it is, it is a finding
            figures.failures.append({"dialect": dialect, "failure": repr(failure)[:400], "program": text[:4000]})
        else:
            figures.add(met, time.monotonic() - begun)
    return figures


def main() -> None:
    """The command line."""
    parser = argparse.ArgumentParser(description="Random mutations of NC programs against the interpreter's laws.")
    parser.add_argument("--seconds", type=float, default=60.0, help="how long")
    parser.add_argument("--seed", type=int, default=1, help="of the random choices")
    arguments = parser.parse_args()
    figures = fuzz(arguments.seconds, arguments.seed)
    print(json.dumps(figures.told(), indent=1))
    sys.exit(1 if figures.failures else 0)


if __name__ == "__main__":
    main()
