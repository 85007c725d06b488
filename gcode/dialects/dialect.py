"""The language of a control as a frozen table.

Differences between controls are fields and rows, each with its rule; the interpreter reads these and never the name
of a dialect.
"""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass, replace
from types import MappingProxyType
from typing import Literal

from gcode.cycles import CycleRules
from gcode.dialects.codes import Table
from gcode.dialects.macro_language import MacroLanguage


@dataclass(frozen=True, slots=True, kw_only=True)
class ArcTolerance:
    """How far the radii at the two ends of an arc with a programmed centre may differ.

    Attributes:
        absolute_mm: difference that is always accepted.
        absolute_inch_mm: the same in inch programs (G20), in mm; None for `absolute_mm`.
        relative: a larger difference is accepted up to this fraction of the larger radius...
        most: ...and up to this many times `absolute_mm`.
        of_start_radius: `relative` is a fraction of the radius at the arc's start instead.
    """

    absolute_mm: float
    absolute_inch_mm: float | None = None
    relative: float = 0.0
    most: float = 1.0
    of_start_radius: bool = False

    def in_unit(self, unit_mm: float) -> ArcTolerance:
        """The tolerance for a program in a unit of `unit_mm`."""
        if self.absolute_inch_mm is None or unit_mm == 1.0:
            return self
        return replace(self, absolute_mm=self.absolute_inch_mm)

    def accepts(self, start_radius_mm: float, end_radius_mm: float) -> bool:
        """True where an arc from one radius to the other is run."""
        difference = abs(start_radius_mm - end_radius_mm)
        radius = start_radius_mm if self.of_start_radius else max(start_radius_mm, end_radius_mm)
        return difference <= max(self.absolute_mm, min(self.relative * radius, self.most * self.absolute_mm))

    def __str__(self) -> str:
        """The rule in words, for messages and reference tables."""
        if not self.relative:
            return f"{self.absolute_mm:.6g} mm"
        share = f"{100.0 * self.relative:g} % of the radius{' at the start' if self.of_start_radius else ''}"
        return f"{self.absolute_mm:.6g} mm, or {share} up to {self.most * self.absolute_mm:.6g} mm"


@dataclass(frozen=True, slots=True, kw_only=True)
class DwellWord:
    """A word that gives the time of G4.

    Attributes:
        seconds: seconds for one unit of its number.
        pointed: seconds for one unit of a number written with a decimal point; None where a point is refused.
    """

    seconds: float
    pointed: float | None


@dataclass(frozen=True, slots=True, kw_only=True)
class Dialect:
    """The language of a control: its codes, words, cycles, variables and rules.

    Attributes:
        name: name in options and job files.
        codes: its G and M codes.
        order: phases of one block in the order of execution.
        free_letters: letters that are allowed in any block.
        refused_letters: letters that are known but not supported, with their meaning.
        extra_axes: letters of further axes whose positions are tracked and reported.
        whole_block_numbers: block numbers (N) must be whole numbers.
        corner_letters: words that chamfer or round the corner between two feed motions.
        increment_letters: letters whose numbers count least input increments if they have no decimal point and the
            setting `decimal_point` is ``increment``; computed numbers are rounded to that increment.
        whole_letters: letters whose computed numbers are rounded to whole numbers.
        power_on_motion: motion code that is active at the start of a program; ``G80`` for none.
        macro: its variables, expressions and jumps.
        cycles: its canned cycles, None for none.
        compensation: method of cutter compensation.
        not_compensated: steps of a block whose codes are refused while cutter compensation is on.
        compensation_defaults_to_tool: G41 or G42 without D uses the radius of the tool in the spindle.
        data_kinds: what G10 writes for each L.
        additional_by_l20: G10 L20 sets additional work offsets; else it sets the work offset so that the present tool
            position gets the given coordinates.
        tool_defaults_to_present: M6 before any T keeps the tool in the spindle; else it is refused.
        file_end_returns: a subprogram file may end without M99; else this is refused.
        subprograms: O words start subprograms that M98 calls.
        packed_calls: M98 P31000 calls O1000 three times.
        explicit_code_moves: a motion code without axis words is a motion of length 0.
        power_on_return_to_r: G99 is active at the start of a program, else G98.
        tools_must_be_known: T must be in the tool table, if one is given.
        dwell: words of G4, and the time that one unit of each stands for.
        length_word_is_modal: H without G43 changes the active length offset, and G43 without H uses the last H.
        length_defaults_to_tool: G43 without H, or with H0, uses the offset of the tool in the spindle.
        length_moves_all_axes: a tool length offset also has x and y components.
        incremental_adds_length: with G91, the first Z word after a change of length offset also moves by that change.
        one_shot_with_motion: G0 to G3 in a block with G28 only sets the motion mode; else such a block is refused.
        machine_moves_rapid: G53 always moves at rapid; else it follows G0 or G1, one of which must be active.
        machine_move_incremental: G53 while G91 is active: ``absolute``, it takes machine coordinates all the same;
            ``ignored``, the block does not move; or ``refused``.
        reference_all_axes: G28 without axis words returns all axes; else it is refused.
        reference_cancels_length: G28 and G30 cancel the tool length offset.
        additional_offsets: number of additional work offsets.
        tool_variables: system variables of the columns of the tool offset table.
        second_variable_names: common variables that have a second number: its first, how many, and the first number
            of the common variables that they are.
        further_variables: numbers of further common variables.
        counters: system variables that count what a simulation does not, so that they are 0: first, how many, meaning.
        common_shift_variables: meaning of #5201 and following: ``external`` work offset, or ``local`` shift of G52.
        first_alarm: added to the value of #3000 to give the alarm number.
        helix_feed_along_arc: F of a helix is the feed along its arc in the plane; else along the helix.
        shift_is_rotated: G92 and G52 share one shift, which is rotated with the work offset.
        semicolon_ends_block: a semicolon is an end of block (EOB): words after it belong to the next block; else it
            starts a comment.
        leader: text before the first percent sign is a leader and is skipped.
        arc_tolerance: largest difference of the radii at the two ends of an arc with I, J, K.
        radius_tolerance_mm: largest amount by which R may be shorter than half the chord.
        centre_words_of_plane: a centre word (I, J, K) of another plane is refused in an arc; else it is ignored.
        needs_axis_words: an arc must name an axis of its plane, and G10 and G92 an axis.
        same_group: two G codes of one modal group in a block: ``refused``, or the ``last`` one counts.
        still_axes: letters of unsupported axes whose words are accepted while they stay at 0.
        tool_word_changes: T puts the tool into the spindle, without M6.
        senders_text: letters and signs that the control refuses and that the program which sends it lines takes out.
        dollar_commands: lines that begin with $ are commands to the controller, which no other control has.
        most_characters: characters that a block may have without blanks and comments, None for `MAX_LINE`.
        largest_tool: largest number of a T word, None for no limit.
        largest_block_number: largest number of an N word, None for no limit.
    """

    name: str
    codes: Table
    order: tuple[str, ...]
    free_letters: str
    refused_letters: Mapping[str, str]
    extra_axes: str
    whole_block_numbers: bool
    corner_letters: tuple[str, ...]
    increment_letters: frozenset[str]
    whole_letters: frozenset[str]
    power_on_motion: str
    macro: MacroLanguage
    cycles: CycleRules | None
    compensation: Literal["linuxcnc", "fanuc"]
    not_compensated: frozenset[str]
    compensation_defaults_to_tool: bool
    data_kinds: Mapping[int, str]
    additional_by_l20: bool
    tool_defaults_to_present: bool
    file_end_returns: bool
    subprograms: bool
    packed_calls: bool
    explicit_code_moves: bool
    power_on_return_to_r: bool
    tools_must_be_known: bool
    dwell: Mapping[str, DwellWord]
    length_word_is_modal: bool
    length_defaults_to_tool: bool
    length_moves_all_axes: bool
    incremental_adds_length: bool
    one_shot_with_motion: bool
    machine_moves_rapid: bool
    machine_move_incremental: Literal["absolute", "ignored", "refused"]
    reference_all_axes: bool
    reference_cancels_length: bool
    additional_offsets: int
    tool_variables: tuple[tuple[int, int, str], ...]
    second_variable_names: tuple[tuple[int, int, int], ...]
    further_variables: tuple[range, ...]
    counters: tuple[tuple[int, int, str], ...]
    common_shift_variables: Literal["external", "local"]
    first_alarm: int
    helix_feed_along_arc: bool
    shift_is_rotated: bool
    semicolon_ends_block: bool
    leader: bool
    arc_tolerance: ArcTolerance
    radius_tolerance_mm: float
    centre_words_of_plane: bool
    needs_axis_words: bool
    same_group: Literal["refused", "last"]
    still_axes: str
    tool_word_changes: bool
    senders_text: str
    dollar_commands: bool
    most_characters: int | None
    largest_tool: int | None
    largest_block_number: int | None

    def __post_init__(self) -> None:
        for name in ("codes", "refused_letters", "dwell", "data_kinds"):
            object.__setattr__(self, name, MappingProxyType(dict(getattr(self, name))))
