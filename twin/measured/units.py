"""Units in the headers of logs: ``Fx [N]``, ``Fx_N``, ``time (ms)``, ``Force X / kN``."""

from __future__ import annotations

import math
import re
from typing import Literal, TypeAlias

Quantity: TypeAlias = Literal["time", "force", "angle", "moment", "voltage", "charge", "rate", "other"]

#: Unit of columns of true and false.
LOGICAL = "true or false"
#: Unit in lower case, µ written as u: what it measures, and how many s, N, rad (N·m, V, pC, Hz) one of it is.
_UNITS: dict[str, tuple[Quantity, float]] = {
    **dict.fromkeys(("s", "sec", "secs", "second", "seconds", "sek"), ("time", 1.0)),
    **dict.fromkeys(("ms", "msec", "millisecond", "milliseconds"), ("time", 1e-3)),
    **dict.fromkeys(("us", "usec", "microseconds"), ("time", 1e-6)),
    **dict.fromkeys(("ns", "nsec", "nanoseconds"), ("time", 1e-9)),
    **dict.fromkeys(("min", "minutes"), ("time", 60.0)),
    **dict.fromkeys(("h", "hr", "hour", "hours"), ("time", 3600.0)),
    **dict.fromkeys(("n", "newton", "newtons"), ("force", 1.0)),
    "kn": ("force", 1e3),
    "un": ("force", 1e-6),
    "dan": ("force", 10.0),
    **dict.fromkeys(("lbf", "lbs", "lb"), ("force", 4.4482216152605)),
    **dict.fromkeys(("klbf", "kip", "kips"), ("force", 4448.2216152605)),
    "ozf": ("force", 0.27801385095378125),
    **dict.fromkeys(("kgf", "kp"), ("force", 9.80665)),
    "gf": ("force", 9.80665e-3),
    **dict.fromkeys(("rad", "radian", "radians"), ("angle", 1.0)),
    **dict.fromkeys(("deg", "°", "degree", "degrees", "grad"), ("angle", math.pi / 180.0)),
    **dict.fromkeys(("rev", "revs", "turns"), ("angle", 2.0 * math.pi)),
    **dict.fromkeys(("nm", "n.m", "n·m", "n*m", "n-m"), ("moment", 1.0)),
    **dict.fromkeys(("v", "volt", "volts"), ("voltage", 1.0)),
    "mv": ("voltage", 1e-3),
    "uv": ("voltage", 1e-6),
    "pc": ("charge", 1.0),
    **dict.fromkeys(("hz", "s/s", "1/s", "samples/s"), ("rate", 1.0)),
    "khz": ("rate", 1e3),
    "rpm": ("other", 1.0),
    LOGICAL: ("other", 1.0),
    **dict.fromkeys(
        ("digit", "digits", "count", "counts", "cnt", "cts", "adc", "bit", "bits", "lsb", "adu"), ("other", 1.0)
    ),
    **dict.fromkeys(
        ("g", "m/s2", "m/s^2", "m/s²", "mm", "um", "m", "w", "kw", "a", "c", "°c", "%", "bar"), ("other", 1.0)
    ),
}
#: Units that differ from another by case alone: mega and milli.
_CASE: dict[str, tuple[Quantity, float]] = {
    "mN": ("force", 1e-3),
    "MN": ("force", 1e6),
    "MV": ("voltage", 1e6),
    "Ms": ("other", 1.0),
}
#: Names of a column of time, without its unit.
TIME_NAME = re.compile(
    r"^(?:x[_ ]?values?|t|時間|時刻|"
    r"(?:.*[\s_.-])?(?:times?|zeit|temps|tiempo|timestamp|seconds|elapsed)(?:[\s_.-].*)?)$",
    re.IGNORECASE,
)
#: Names of a column of the spindle's angle.
ANGLE_NAME = re.compile(r"angle|\bphi\b|theta|winkel|encoder|rotat|spindle[\s_]*pos", re.IGNORECASE)
_BRACKETS = re.compile(r"^(?P<base>.*?)\s*[\[({<]\s*(?P<unit>[^\[\](){}<>]*?)\s*[\])}>]\s*:?$")
_WORDS = re.compile(r"^[A-Za-z]*\d*(?:[ _-][A-Za-z0-9]+)*$")
_SLASH = re.compile(r"^(?P<base>.+?)\s*(?:/|,|\bin\b)\s*(?P<unit>\S+)$")
_TAIL = re.compile(r"^(?P<base>.+?)[_ ](?P<unit>[^_ ]+)$")


def find_unit(text: str) -> tuple[Quantity, float] | None:
    """Quantity and size of a unit in s, N, rad, N·m, V, Hz; None for text that is not a known unit."""
    bare = text.strip().strip("[](){}<>").strip().replace("µ", "u").replace("μ", "u")
    return _CASE.get(bare) or _UNITS.get(bare.lower())


def split_unit(header: str) -> tuple[str, str]:
    """A header as name and unit: ``("Fx", "N")`` from ``Fx [N]``, ``Fx_N``, ``Fx (N)``, ``Fx / N``, ``Fx N``.

    Returns:
        the unit is ``""`` when the header holds none. Brackets with signs in them (``mV/V``) count as a unit, so
        that an unknown one can be refused by name; with words in them (``filtered``) they belong to the name.
    """
    text = header.strip().strip("\"'").strip()
    if (found := _BRACKETS.match(text)) and found["base"]:
        inside = found["unit"]
        return (text, "") if find_unit(inside) is None and _WORDS.match(inside) else (found["base"], inside)
    for pattern in (_SLASH, _TAIL):
        found = pattern.match(text)
        if found and _plausible(found["base"], found["unit"]):
            return found["base"], found["unit"]
    return text, ""


def _plausible(base: str, unit: str) -> bool:
    """Whether the end of a name is a unit: ``Fx_min`` is not a time, ``Motor_A`` not a current."""
    known = find_unit(unit)
    if known is None or known[0] == "other":
        return False
    return known[0] != "time" or TIME_NAME.match(base) is not None


def is_unit_text(text: str) -> bool:
    """Whether a field of a row below the names is a unit."""
    return find_unit(text) is not None
