"""Dates and times of day in text, as seconds from the first one."""

from __future__ import annotations

import re
import unicodedata
from collections.abc import Iterator, Sequence
from dataclasses import dataclass
from datetime import date
from functools import lru_cache
from typing import Literal, TypeAlias

import numpy as np

from twin.arrays import FloatArray

DAY_S, HOUR_S = 86400.0, 3600.0
_MONTHS = {
    name: number
    for number, names in enumerate(
        (
            *("jan ene gen", "feb fev", "mar mrz maa", "apr abr avr", "may mai mei maj mag", "jun juin giu"),
            *("jul juil lug", "aug ago aou", "sep set", "oct okt ott out", "nov", "dec dez dic des"),
        ),
        start=1,
    )
    for name in names.split()
}
_TIME = (
    r"(?P<h>\d{1,5}):(?P<m>\d{2}):(?P<s>\d{2})(?:[.,](?P<f>\d+)|:(?P<ms>\d{3}))?"
    r"\s*(?P<half>[AaPp]\.?[Mm]\.?)?(?:\s*(?:Z|UTC|[+-]\d{2}:?\d{2}))?"
)
_WORD = r"[^\W\d_]{3,9}"
_DATE = (
    r"(?:[A-Za-z]{2,3}[.,]?\s+)?(?P<date>\d{4}[-/.]\d{1,2}[-/.]\d{1,2}|\d{1,2}(?P<mark>[-/.])\d{1,2}(?P=mark)(?:\d{4}|\d{2})|"
    r"\d{4}\.\s?\d{1,2}\.\s?\d{1,2}\.|\d{4}年\s?\d{1,2}月\s?\d{1,2}日|"
    rf"\d{{1,2}}[-\s./]+{_WORD}[-\s./,]+\d{{4}}|{_WORD}[-\s.]+\d{{1,2}}[-\s,]+\d{{4}}|\d{{4}}[-\s]+{_WORD}[-\s]+\d{{1,2}})"
)
_TIME_ONLY = re.compile(rf"{_TIME}$")
_SHORT = re.compile(r"(?P<m>\d{1,3}):(?P<s>\d{2})(?:[.,](?P<f>\d+))?$")
_DATE_ONLY = re.compile(rf"{_DATE}$")
_STAMP = re.compile(rf"{_DATE}(?:T|[\s,_]+){_TIME}$")
#: ``20240301T235959.9`` as in ISO 8601, and ``Fri Mar 01 23:59:59 2024`` as C's ctime writes it.
_COMPACT = re.compile(r"(?P<day>(?:19|20)\d{6})[T\s_-](?P<h>\d{2}):?(?P<m>\d{2}):?(?P<s>\d{2}(?:[.,]\d+)?)Z?$")
_YEAR_LAST = re.compile(r"(?:[A-Za-z]{3}\s+)?(?P<day>[A-Za-z]{3}\s+\d{1,2})\s+(?P<time>\S+)\s+(?P<year>\d{4})$")
_TIME_FIRST = re.compile(rf"{_TIME}[\s,]+{_DATE}$")
#: The zone, or ``Uhr``, after a time; the day of the week before a date.
_ZONE = re.compile(r"(?<=\d)\s*(?:[A-Z]{3,4}|Uhr)$")
_WEEKDAY = re.compile(r"[^\W\d_]{2,12}[.,]?\s+(?!\d{1,3}:)")
#: AM or PM before the time; a date with the time in points, or after a dash; a number of days before the time.
_HALF_FIRST = re.compile(r"(?P<before>.*?)(?P<half>[AaPp]\.?[Mm]\.?)\s+(?P<time>\d{1,2}:\S+)$")
_POINTS = re.compile(rf"{_DATE}[\sT]+(?P<h>\d{{1,2}})\.(?P<m>\d{{2}})\.(?P<s>\d{{2}}(?:[.,]\d+)?)$")
_DASH = re.compile(rf"{_DATE}-(?P<time>\d{{1,2}}:\S+)$")
_DAYS = re.compile(r"(?P<days>\d{1,3})\s*d(?:ays?)?,?\s+(?P<h>\d{1,2})(?P<rest>:\S+)$", re.IGNORECASE)

#: A date, a time of day, both, or minutes and seconds.
ClockKind: TypeAlias = Literal["date", "time", "stamp", "minutes"]


@dataclass(frozen=True, slots=True)
class Moment:
    """A field that is a date, a time, or both: the date as written, and the seconds of the day or hour.

    Attributes:
        clear: False for two numbers that may be minutes and seconds or hours and minutes, ``10:30``.
    """

    kind: ClockKind
    date: str
    seconds: float
    clear: bool = True


def moment(text: str) -> Moment | None:
    """A field as a moment, None where it is not one: ``12:30:01.25``, ``1/2/2020 10:00:00 AM``, ``02.01.2020``."""
    found = _common(text)
    if found is None and any(mark in text for mark in ":.-/"):
        found = next((m for other in _rewritten(text) if (m := _common(other)) is not None), None)
    return found


def _common(text: str) -> Moment | None:
    """A field in one of the usual forms as a moment."""
    if found := _COMPACT.match(text):
        day = "-".join((found["day"][:4], found["day"][4:6], found["day"][6:]))
        return _common(f"{day} {found['h']}:{found['m']}:{found['s']}")
    if ":" in text:
        if found := _YEAR_LAST.match(text):
            return _common(f"{found['day']} {found['year']} {found['time']}")
        if found := _TIME_ONLY.match(text):
            return _moment("time", "", found)
        if found := _STAMP.match(text) or _TIME_FIRST.match(text):
            return _moment("stamp", found["date"], found)
        if (found := _SHORT.match(text)) and int(found["s"]) < 60:
            return Moment(
                "minutes", "", 60.0 * int(found["m"]) + float(f"{found['s']}.{found['f'] or 0}"), bool(found["f"])
            )
        return None
    found = _DATE_ONLY.match(text)
    return Moment("date", found["date"], 0.0) if found is not None and any(_readings(found["date"])) else None


def _rewritten(text: str) -> Iterator[str]:
    """A field in a rarer form, written in the usual ones that it may mean."""
    bare = _ZONE.sub("", text.strip("[](){}<> "))
    for plain in dict.fromkeys((bare, _WEEKDAY.sub("", bare, count=1))):
        yield plain
        if found := _HALF_FIRST.match(plain):
            yield f"{found['before']}{found['time']} {found['half']}"
        if found := _POINTS.match(plain):
            yield f"{found['date']} {found['h']}:{found['m']}:{found['s']}"
        if found := _DASH.match(plain):
            yield f"{found['date']} {found['time']}"
        if found := _DAYS.match(plain):
            yield f"{24 * int(found['days']) + int(found['h'])}{found['rest']}"


def _moment(kind: ClockKind, day: str, found: re.Match[str]) -> Moment | None:
    hours = int(found["h"])
    if found["half"]:
        if not 1 <= hours <= 12:
            return None
        hours = hours % 12 + (12 if found["half"][0] in "pP" else 0)
    if int(found["m"]) > 59 or int(found["s"]) > 60 or (day and not any(_readings(day))):
        return None
    seconds = float(f"{found['s']}.{found['f'] or found['ms'] or 0}")
    return Moment(kind, day, HOUR_S * hours + 60.0 * int(found["m"]) + seconds)


@lru_cache(maxsize=1024)
def _readings(text: str) -> tuple[date | None, date | None]:
    """A date with month and day in their likelier order, and in the other one where both occur."""
    pieces = [p for p in re.split(r"[-/.,\s年月日]+", text) if p]
    words = [p for p in pieces if not p.isdigit()]
    if words:
        letters = unicodedata.normalize("NFKD", words[0].lower())
        name = "".join(c for c in letters if not unicodedata.combining(c))
        month = _MONTHS.get(name[:4]) or _MONTHS.get(name[:3])
        day, year = sorted(int(p) for p in pieces if p.isdigit())
        only = None if month is None else _date(year, month, day)
        return only, only
    a, b, c = map(int, pieces)
    if len(pieces[0]) == 4:
        return _date(a, b, c), _date(a, b, c)
    year = c if c >= 100 else 2000 + c
    day_first, month_first = _date(year, b, a), _date(year, a, b)
    if "." in text:
        return day_first, day_first
    return (month_first, day_first) if "/" in text else (day_first, month_first)


def day_of(text: str) -> date | None:
    """A date in the likelier order of day and month."""
    return next((d for d in _readings(text) if d is not None), None)


def _date(year: int, month: int, day: int) -> date | None:
    try:
        return date(year, month, day)
    except ValueError:
        return None


def seconds_of(dates: Sequence[str], seconds: FloatArray, kind: ClockKind) -> tuple[FloatArray, list[str]]:
    """Seconds from the first moment, and notes.

    Where a time of day without dates, or with the same date throughout, falls by more than half a day, a midnight
    lies between; with minutes and seconds it is a full hour.

    Args:
        dates: of each row as written, ``""`` without.
        seconds: shape (n,), of the day, or of the hour; NaN where there is none.

    Raises:
        ValueError: dates that no order of day and month fits.
    """
    days, notes = _days(dates)
    t_s = seconds + DAY_S * days
    good = np.flatnonzero(np.isfinite(t_s))
    if len(good) and not np.any(days):
        period = HOUR_S if kind == "minutes" else DAY_S
        turns = np.cumsum(np.diff(t_s[good]) < -0.5 * period)
        if len(turns) and turns[-1]:
            t_s[good[1:]] += period * turns
            notes.append(f"time passes {'a full hour' if kind == 'minutes' else 'midnight'}: counted on")
    return (t_s - t_s[good[0]] if len(good) else t_s), notes


def _days(dates: Sequence[str]) -> tuple[FloatArray, list[str]]:
    """Days from the first date; of two orders of day and month the one that spans fewer days.

    Raises:
        ValueError: no order fits all dates.
    """
    distinct = [d for d in dict.fromkeys(dates) if d]
    if not distinct:
        return np.zeros(len(dates)), []
    orders = [[d.toordinal() for each in distinct if (d := _readings(each)[k]) is not None] for k in (0, 1)]
    orders = [o for o in orders if len(o) == len(distinct)]
    if not orders:
        raise ValueError(f"no order of day and month fits {distinct[0]} to {distinct[-1]}")
    chosen = min(orders, key=lambda o: max(o) - min(o))
    known = {d: float(o - chosen[0]) for d, o in zip(distinct, chosen, strict=True)}
    unclear = len(distinct) > 1 and orders[0] != orders[-1]
    notes = [f"date {distinct[0]} read as {date.fromordinal(chosen[0]).isoformat()}"] if unclear else []
    return np.array([known.get(d, 0.0) for d in dates]), notes
