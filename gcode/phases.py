"""All phases of a block by name: what `Dialect.order` puts in order."""

from __future__ import annotations

from collections.abc import Mapping
from types import MappingProxyType

from gcode.actions import ACTIONS, Action
from gcode.motion import MOTION_ACTIONS

PHASES: Mapping[str, Action] = MappingProxyType({**ACTIONS, **MOTION_ACTIONS})
