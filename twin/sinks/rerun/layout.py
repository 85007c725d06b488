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
        name: what the legend says.
        unit: of its values.
        archive_field: its field in a ``twin.RevolutionForce`` message of an archive; of samples, with ``{}`` for
            ``lowest``, ``highest`` or ``mean``.
    """

    name: str
    unit: str
    color: Rgb
    archive_field: str

    @property
    def label(self) -> str:
        """Name and unit."""
        return f"{self.name} [{self.unit}]"

    def of(self, which: str, color: Rgb | None = None, *, label: str | None = None) -> Series:
        """The lowest, highest or mean values of this one.

        Args:
            label: what the legend calls them.
        """
        field = self.archive_field.format(which)
        return Series(f"{self.name} {label or which}", self.unit, self.color if color is None else color, field)


#: Red, green and blue as the axes of the 3D view, in hues that colour-blind people can distinguish.
FORCES = (
    Series("Fx", "N", (240, 96, 56), "fx_{}_n"),
    Series("Fy", "N", (38, 186, 138), "fy_{}_n"),
    Series("Fz", "N", (92, 172, 250), "fz_{}_n"),
)
RESULTANT = Series("resultant", "N", (176, 128, 244), "resultant_{}_n")
TORQUE = Series("torque", "N·m", (224, 176, 46), "torque_{}_nm")
_DARK: tuple[Rgb, ...] = ((178, 72, 46), (28, 132, 100), (66, 118, 178))


@dataclass(frozen=True, slots=True)
class Curves:
    """Curves of one entity, one value of each in a row.

    Attributes:
        entity: where they are logged.
        series: the curves.
        hidden: how many of the last ones a viewer shows on request only.
    """

    entity: str
    series: tuple[Series, ...]
    hidden: int = 0


#: Every sample: force components and their resultant; the torque is shown on request.
SAMPLES = Curves("force/samples", (*FORCES, RESULTANT, TORQUE), hidden=1)
#: Of each spindle revolution: lowest and highest, of one name, and mean.
ENVELOPE = Curves(
    "force/envelope",
    tuple(
        curve
        for force, dark in zip(FORCES, _DARK, strict=True)
        for curve in (force.of("lowest", label="range"), force.of("highest", label="range"), force.of("mean", dark))
    ),
)
RESULTANT_CURVES = Curves("force/resultant", (RESULTANT.of("highest"), RESULTANT.of("mean", (122, 90, 172))))
TORQUE_CURVES = Curves("torque", (TORQUE.of("highest"), TORQUE.of("mean", (158, 124, 36))))
CURVES = (SAMPLES, ENVELOPE, RESULTANT_CURVES, TORQUE_CURVES)

#: Curves of an archive that the viewer reads itself, in the view of each of these.
ARCHIVED: dict[str, tuple[Series, ...]] = {
    SAMPLES.entity: ENVELOPE.series,
    ENVELOPE.entity: ENVELOPE.series,
    RESULTANT_CURVES.entity: RESULTANT_CURVES.series,
    TORQUE_CURVES.entity: TORQUE_CURVES.series,
}

#: Marks on the time axis of the resultant.
COLLISION_MARK, WARNING_MARK = "marks/collision", "marks/warning"

#: Topic of the archive that has the same data (docs/archive-format.md), and what the viewer calls its messages.
ARCHIVE_FORCE = "force/revolution"
ARCHIVE_FORCE_COMPONENT = "twin.RevolutionForce:message"

#: Direction from what the camera looks at to the eye, in half diagonals of its box.
EYE = (-0.95, -1.45, 1.15)

PART_COLOR: Rgb = (168, 178, 192)
TOOL_COLOR = (226, 188, 106, 150)
STOCK_COLOR: Rgb = (120, 128, 140)
RAPID_COLOR: Rgb = (130, 130, 136)
TEXT_COLOR: Rgb = (220, 224, 230)
AIR_COLOR: Rgb = (176, 176, 182)
COLLISION_COLOR: Rgb = (255, 92, 112)
WARNING_COLOR: Rgb = (255, 170, 60)

#: Level and colour of a line of the log by kind of event; the viewer filters by level. Colours are legible on dark and
#: light backgrounds.
EVENT_STYLE: dict[str, tuple[str, Rgb]] = {
    "block": ("INFO", (144, 152, 164)),
    "tool": ("INFO", (214, 150, 24)),
    "spindle": ("DEBUG", (84, 148, 232)),
    "coolant": ("DEBUG", (84, 148, 232)),
    "stop": ("INFO", (214, 150, 24)),
    "dwell": ("DEBUG", (84, 148, 232)),
    "notice": ("WARN", WARNING_COLOR),
}
