"""Names, colours and widths of the timeline, shared by recording and blueprint."""

from __future__ import annotations

from dataclasses import dataclass
from typing import TypeAlias

Rgb: TypeAlias = tuple[int, int, int]

#: Application id of recordings and blueprints; a viewer applies a blueprint to recordings of the same id.
APPLICATION_ID = "twin"

#: Machine time from program start (duration), index of the step, line of the NC program.
TIME, STEP, NC_LINE = "machine_time", "step", "nc_line"
TIMELINES = (TIME, STEP, NC_LINE)
#: Machine time as the viewer names it when it reads an archive itself.
ARCHIVE_TIME = "message_log_time"

TOOL = "machine/tool"
PATH = "machine/path"
CUT_PATH = "machine/path/cut"
RAPID_PATH = "machine/path/rapid"
COLLISIONS = "machine/collisions"
SCALE = "machine/force_scale"
STOCK = "stock"
WORKPIECE = "workpiece"
BLOCKS = "nc/block"
COLLISION_LOG = "nc/collision"
SUMMARY = "run/summary"


@dataclass(frozen=True, slots=True)
class Series:
    """One curve.

    Attributes:
        entity: where it is logged.
        name: what the legend says, unit included.
        archive_field: name of the field of a ``twin.CuttingForce`` message.
    """

    entity: str
    name: str
    color: Rgb
    archive_field: str


#: Red, green and blue as the axes of the 3D view, in hues that colour-blind people can distinguish.
FORCES = (
    Series("force/x", "Fx [N]", (240, 96, 56), "fx_n"),
    Series("force/y", "Fy [N]", (38, 186, 138), "fy_n"),
    Series("force/z", "Fz [N]", (92, 172, 250), "fz_n"),
)
TORQUE = Series("torque", "torque [N·m]", (236, 200, 84), "torque_nm")
SERIES = (*FORCES, TORQUE)

#: Topics of the archive that have the same data (docs/archive-format.md).
ARCHIVE_FORCE = "force"
ARCHIVE_FORCE_COMPONENT = "twin.CuttingForce:message"

#: Direction from the stock to the eye, in half diagonals of the stock.
EYE = (-0.95, -1.45, 1.1)

PART_COLOR: Rgb = (168, 178, 192)
TOOL_COLOR = (226, 188, 106, 150)
STOCK_COLOR: Rgb = (120, 128, 140)
RAPID_COLOR: Rgb = (130, 130, 136)
TEXT_COLOR: Rgb = (220, 224, 230)
AIR_COLOR: Rgb = (176, 176, 182)
COLLISION_COLOR: Rgb = (255, 92, 112)

#: Level and colour of a line of the log by kind of event; the viewer filters by level.
EVENT_STYLE: dict[str, tuple[str, Rgb]] = {
    "block": ("INFO", (214, 218, 224)),
    "tool": ("INFO", (236, 200, 84)),
    "spindle": ("DEBUG", (140, 190, 250)),
    "coolant": ("DEBUG", (140, 190, 250)),
    "stop": ("INFO", (236, 200, 84)),
    "dwell": ("DEBUG", (140, 190, 250)),
    "notice": ("WARN", (255, 170, 60)),
}
