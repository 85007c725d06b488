"""The canned cycles of FANUC, Haas and LinuxCNC mills."""

from __future__ import annotations

from dataclasses import replace
from types import MappingProxyType

from gcode.cycles.rules import Act, Cycle, CycleRules, DwellUnit

_TURNING = (-1, 1)
_TAP_IN = (Act.TAP_START, Act.TAP_BOTTOM)
#: Strokes of a tap on FANUC: it dwells at the bottom and again at R before the spindle turns round.
_FANUC_TAP = (*_TAP_IN, Act.DWELL, Act.TAP_REVERSE, Act.TAP_R, Act.DWELL, Act.TAP_END, Act.RAPID_CLEAR)
_LINUXCNC_TAP = (*_TAP_IN, Act.TAP_REVERSE, Act.DWELL, Act.TAP_CLEAR, Act.TAP_END)
_PECK_TAP = {"Q": "peck tapping, whose retraction depends on a parameter of the machine"}
_BY_HAND = (Act.STOP, Act.OPERATOR, Act.RAPID_R, Act.RESTART, Act.RAPID_CLEAR)


def _table(*cycles: Cycle) -> MappingProxyType[str, Cycle]:
    return MappingProxyType({cycle.code: cycle for cycle in cycles})


_G73 = Cycle(
    code="G73",
    meaning="high-speed peck drilling (chip breaking)",
    acts=(Act.CHIP_BREAK, Act.RAPID_CLEAR),
    takes="Q",
    needs="Q",
)
_G74 = Cycle(
    code="G74",
    meaning="left-hand tapping",
    acts=_FANUC_TAP,
    takes="P",
    forward=-1,
    unsupported=MappingProxyType(_PECK_TAP),
)
_G76 = Cycle(
    code="G76",
    meaning="fine boring",
    acts=(
        *(Act.FEED_BOTTOM, Act.DWELL, Act.ORIENT, Act.SHIFT),
        *(Act.RAPID_CLEAR, Act.UNSHIFT, Act.RESTART),
    ),
    takes="PQ",
    needs="Q",
    shift=True,
)
_G81 = Cycle(code="G81", meaning="drilling", acts=(Act.FEED_BOTTOM, Act.RAPID_CLEAR))
_G82 = Cycle(code="G82", meaning="drilling with dwell", acts=(Act.FEED_BOTTOM, Act.DWELL, Act.RAPID_CLEAR), takes="P")
_G83 = Cycle(code="G83", meaning="peck drilling", acts=(Act.PECK, Act.RAPID_CLEAR), takes="Q", needs="Q")
_G84 = replace(_G74, code="G84", meaning="right-hand tapping", forward=1)
_G85 = Cycle(code="G85", meaning="boring, feed out", acts=(Act.FEED_BOTTOM, Act.FEED_R, Act.RAPID_CLEAR))
_G86 = Cycle(
    code="G86",
    meaning="boring, spindle stop, rapid out",
    acts=(Act.FEED_BOTTOM, Act.STOP, Act.RAPID_CLEAR, Act.RESTART),
)
_G87 = Cycle(
    code="G87",
    meaning="back boring",
    acts=(
        *(Act.ORIENT, Act.SHIFT, Act.RAPID_R, Act.UNSHIFT, Act.RESTART, Act.FEED_BOTTOM, Act.DWELL),
        *(Act.ORIENT, Act.SHIFT, Act.RAPID_CLEAR, Act.UNSHIFT, Act.RESTART),
    ),
    takes="PQ",
    needs="Q",
    shift=True,
    approach=False,
    returns_to_initial=True,
)
_G88 = Cycle(
    code="G88",
    meaning="boring, dwell, manual retraction",
    acts=(Act.FEED_BOTTOM, Act.DWELL, *_BY_HAND),
    takes="P",
)
_G89 = Cycle(
    code="G89",
    meaning="boring with dwell, feed out",
    acts=(Act.FEED_BOTTOM, Act.DWELL, Act.FEED_R, Act.RAPID_CLEAR),
    takes="P",
)

#: FANUC 16i/18i/0i/30i mills ("Canned cycle for drilling" of the operator's manual). The retraction of G73 and the
#: clearance of G83 are parameters 5114 and 5115 of the machine, without a value of the control's own: a millimetre is
#: what machine tool builders commonly set. The shift of G76 and G87 goes in the direction of a parameter too, of which
#: 0 is plus along the plane's first axis. K repeats; L does in the tape format of series 15.
FANUC_CYCLES = CycleRules(
    name="FANUC",
    cycles=_table(_G73, _G74, _G76, _G81, _G82, _G83, _G84, _G85, _G86, _G87, _G88, _G89),
    absent={},
    repeat_letters="KL",
    stores_zero_repeats=True,
    memory="mode",
    levels_keep_mode=True,
    sticky_in_program_unit=False,
    needs_r=False,
    needs_axis=False,
    refuses_r_below_bottom=False,
    ignores_sign_of_q=True,
    stored="PQ",
    lift_first=False,
    empty_moves=False,
    dwell=DwellUnit(seconds=0.001, whole=True),
    retract_mm=1.0,
    reentry_mm=1.0,
    reentry_within_r=True,
    peck_tolerance_mm=1e-6,
    restart=1,
)

_HAAS_TAP_WORDS = MappingProxyType({**_PECK_TAP, "J": "a faster retraction of the tap"})

#: Haas mills: as FANUC but for repeats by L only, pecks that shrink (I, J, K), a chip-breaking cycle that clears the
#: hole after every K, dwells in seconds where P has a point, rigid tapping that starts the spindle itself, and manual
#: retraction in G87 (back boring is G77 there). Setting 22 is the retraction of pecks: 0.05 inch is a usual value.
HAAS_CYCLES = replace(
    FANUC_CYCLES,
    name="Haas",
    cycles=_table(
        replace(_G73, acts=(Act.CHIP_BREAK, Act.DWELL, Act.RAPID_CLEAR), takes="QIJKP", needs=""),
        replace(_G74, unsupported=_HAAS_TAP_WORDS),
        replace(_G76, takes="PQIJ", needs=""),
        *(_G81, _G82),
        replace(_G83, acts=(Act.PECK, Act.DWELL, Act.RAPID_CLEAR), takes="QIJKP", needs=""),
        replace(_G84, unsupported=_HAAS_TAP_WORDS),
        *(_G85, _G86),
        Cycle(code="G87", meaning="boring, manual retraction", acts=(Act.FEED_BOTTOM, *_BY_HAND)),
        *(_G88, _G89),
    ),
    repeat_letters="L",
    dwell=DwellUnit(seconds=0.001, pointed_seconds=1.0),
    retract_mm=1.27,
    reentry_mm=1.27,
    always_rigid=True,
)

#: LinuxCNC 2.9. Its pecks go back 0.010 inch; a dwell is in seconds. In G18 and G19 its tapping strokes put the
#: plane's coordinates into the wrong axes, and so do these: a replay shows what the machine would do.
LINUXCNC_CYCLES = CycleRules(
    name="LinuxCNC",
    tap_follows_spindle=False,
    cycles=_table(
        _G73,
        replace(_G74, acts=_LINUXCNC_TAP, inherits="P", repeats=False, spindle=(-1,), unsupported=MappingProxyType({})),
        _G81,
        replace(_G82, needs="P"),
        _G83,
        replace(_G84, acts=_LINUXCNC_TAP, inherits="P", spindle=(1,), unsupported=MappingProxyType({})),
        _G85,
        replace(
            _G86,
            acts=(Act.FEED_BOTTOM, Act.DWELL, Act.STOP, Act.RAPID_CLEAR, Act.RESTART),
            takes="P",
            needs="P",
            spindle=_TURNING,
        ),
        replace(
            _G87,
            acts=(
                *(Act.SHIFT, Act.ORIENT, Act.RAPID_BOTTOM, Act.UNSHIFT, Act.RESTART, Act.FEED_TOP, Act.FEED_BOTTOM),
                *(Act.ORIENT, Act.SHIFT, Act.RAPID_CLEAR, Act.UNSHIFT, Act.RESTART),
            ),
            takes="IJK",
            needs="IJK",
            approach=True,
            returns_to_initial=False,
            spindle=_TURNING,
        ),
        replace(
            _G88,
            acts=(Act.FEED_BOTTOM, Act.DWELL, Act.STOP, Act.OPERATOR, Act.RESTART),
            needs="P",
            spindle=_TURNING,
        ),
        replace(_G89, acts=(Act.FEED_BOTTOM, Act.DWELL, Act.FEED_CLEAR), needs="P"),
    ),
    absent={"G76": "multi-pass lathe threading"},
    repeat_letters="L",
    stores_zero_repeats=False,
    memory="code",
    levels_keep_mode=False,
    sticky_in_program_unit=True,
    needs_r=True,
    needs_axis=True,
    refuses_r_below_bottom=True,
    ignores_sign_of_q=False,
    stored="",
    lift_first=True,
    empty_moves=True,
    dwell=DwellUnit(seconds=1.0),
    retract_mm=0.254,
    reentry_mm=0.254,
    reentry_within_r=False,
    tap_order={"X": (2, 0, 1), "Y": (1, 2, 0)},
)
