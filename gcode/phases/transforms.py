"""Rotation, scaling, mirror image and polar coordinates: G68/G69, G51/G50, G51.1/G50.1, G16/G15."""

from __future__ import annotations

from collections.abc import Callable, Mapping
from types import MappingProxyType

from gcode.control.command import Command, Use
from gcode.control.coordinates import Transform, rotation, scaling
from gcode.control.state import AXES, TRANSFORM_ORDER, State
from gcode.events import PLANE_AXES, Point
from gcode.phases.modes import Action, Result

#: G51 P and I, J, K count thousandths where they have no decimal point.
_SCALE_UNIT = 0.001
_NAME_OF_CODE: Mapping[str, str] = {"G50": "scaling", "G50.1": "mirror", "G69": "rotation"}


def set_transform(state: State, command: Command) -> Result:
    """Codes that rotate, scale or mirror program coordinates, or make them polar."""
    for use in command.of_phase("transform"):
        state = _SETTERS[use.rule.code](state, command, use)
    return state, ()


def clear_transform(state: State, command: Command) -> Result:
    """Codes that cancel them."""
    for use in command.of_phase("transform_off"):
        if use.rule.code == "G15":
            state = state.with_modes(polar=False, polar_centre_mm=None)
            continue
        name = _NAME_OF_CODE[use.rule.code]
        if name == "mirror" and any(axis in command.words for axis in AXES):
            state = _with_mirror(state, _mirrored(state) - {axis for axis in AXES if axis in command.words}, None)
        else:
            state = _with(state, name, None)
    return state, ()


def _with(state: State, name: str, transform: Transform | None) -> State:
    transforms = {key: value for key, value in state.modes.transforms.items() if key != name}
    if transform is not None:
        transforms[name] = transform
    if transforms == state.modes.transforms:
        return state
    return state.with_modes(transforms=MappingProxyType(transforms)).reframed()


def _centre(state: State, command: Command, name: str) -> Point:
    """The centre of the map `name`: axis words are coordinates even with G91; where an axis has none, the tool's.

    The maps that act on a point before this one act on its centre, too.
    """
    here, words, modes = state.program_mm, command.words, state.modes
    x, y, z = (
        words[axis].value * modes.unit_mm if axis in words else old for axis, old in zip(AXES, here, strict=True)
    )
    centre = (x, y, z)
    for before in TRANSFORM_ORDER[: TRANSFORM_ORDER.index(name)]:
        if before in modes.transforms:
            centre = modes.transforms[before].of(centre)
    return centre


def _rotate(state: State, command: Command, use: Use) -> State:
    """G68: about the given point of the plane, by R degrees counter-clockwise; replaces an active rotation.

    Under a mirror image of one of the plane's axes it rotates in the opposite direction.
    """
    word = command.words.get("R")
    if word is None:
        raise command.block.error(use.word, "missing-word", f"{use.word.text} without R", "R and an angle in degrees")
    plane = state.machine.plane
    third = AXES[PLANE_AXES[plane][2]]
    if third in command.words:
        problem = f"{command.words[third].text} in a rotation of G{plane}"
        raise command.block.error(command.words[third], "unused-word", problem, "the centre in the plane alone")
    bare = _with(state, "rotation", None)
    seen = {AXES[index] for index in PLANE_AXES[plane][:2]} & _mirrored(state)
    angle = -word.value if len(seen) == 1 else word.value
    return _with(state, "rotation", rotation(plane, angle, _centre(bare, command, "rotation")))


def _scale(state: State, command: Command, use: Use) -> State:
    """G51: by P along all axes, or by I, J, K along X, Y, Z, about the given point."""
    words = command.words
    given = [letter for letter in "IJK" if letter in words]
    if "P" in words and given:
        problem = f"{words['P'].text} together with {words[given[0]].text}"
        raise command.block.error(words["P"], "scaling-two", problem, "P for all axes, or I, J, K")
    if "P" not in words and not given:
        raise command.block.error(use.word, "missing-word", f"{use.word.text} without a factor", "P, or I, J, K")
    letters = ("P", "P", "P") if "P" in words else ("I", "J", "K")
    x, y, z = (_factor(command, letter) for letter in letters)
    bare = _with(state, "scaling", None)
    return _with(state, "scaling", scaling((x, y, z), _centre(bare, command, "scaling")))


def _factor(command: Command, letter: str) -> float:
    word = command.words.get(letter)
    if word is None:
        return 1.0
    value = word.value if word.has_point else word.value * _SCALE_UNIT
    if value == 0.0:
        raise command.block.error(word, "bad-value", f"{word.text} is not a scale factor", "a factor that is not 0")
    return value


def _mirrored(state: State) -> set[str]:
    transform = state.modes.transforms.get("mirror")
    if transform is None:
        return set()
    return {axis for index, axis in enumerate(AXES) if transform.matrix[index][index] < 0.0}


def _mirror(state: State, command: Command, use: Use) -> State:
    """G51.1: a mirror at the given coordinate of each named axis."""
    named = {axis for axis in AXES if axis in command.words}
    if not named:
        raise command.block.error(use.word, "missing-axis", f"{use.word.text} names no axis", "at least one of X, Y, Z")
    centre = _centre(_with(state, "mirror", None), command, "mirror")
    return _with_mirror(state, _mirrored(state) | named, centre, named)


def _with_mirror(state: State, axes: set[str], centre: Point | None, named: set[str] | None = None) -> State:
    if not axes:
        return _with(state, "mirror", None)
    old = state.modes.transforms.get("mirror")
    x, y, z = (
        centre[i] if centre is not None and named is not None and axis in named else old.centre_mm[i] if old else 0.0
        for i, axis in enumerate(AXES)
    )
    factors = tuple(-1.0 if axis in axes else 1.0 for axis in AXES)
    return _with(state, "mirror", scaling((factors[0], factors[1], factors[2]), (x, y, z)))


def _polar(state: State, _command: Command, _use: Use) -> State:
    """G16: the plane's first axis is a radius, its second an angle; with G91 about where the tool is."""
    centre = None if state.modes.absolute else state.program_mm
    return state.with_modes(polar=True, polar_centre_mm=centre)


_SETTERS: Mapping[str, Callable[[State, Command, Use], State]] = {
    "G68": _rotate,
    "G51": _scale,
    "G51.1": _mirror,
    "G16": _polar,
}
TRANSFORM_ACTIONS: Mapping[str, Action] = {"transform": set_transform, "transform_off": clear_transform}
