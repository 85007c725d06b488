"""Options that all commands share: the control that the program is for, and the machine at its start."""

from __future__ import annotations

import inspect
import sys
from collections.abc import Callable
from dataclasses import dataclass, replace
from enum import StrEnum
from functools import wraps
from pathlib import Path
from typing import TYPE_CHECKING, Annotated, Any, TypeVar

import typer

from gcode.cli.console import UnusableFileError
from gcode.cli.streams import closed_pipe_ends
from gcode.errors import GcodeError

if TYPE_CHECKING:
    from gcode.dialects import Dialect
    from gcode.settings import MachineSettings

_T = TypeVar("_T")


class DialectName(StrEnum):
    """Controls by name."""

    FANUC = "fanuc"
    HAAS = "haas"
    LINUXCNC = "linuxcnc"
    GRBL = "grbl"


class MachineUnit(StrEnum):
    """Unit of length of a machine."""

    MM = "mm"
    INCH = "inch"


ProgramFile = Annotated[
    Path,
    typer.Argument(metavar="FILE", help="NC program.", show_default=False),
]
DialectOption = Annotated[DialectName, typer.Option("--dialect", "-d", help="Control that the program is written for.")]
ToolTableOption = Annotated[
    Path | None,
    typer.Option(
        metavar="FILE.tbl|.toml",
        help="Tool table: LinuxCNC (.tbl, machine's unit) or TOML (mm). Without one, lengths and radii are 0.",
        show_default=False,
    ),
]
ParametersOption = Annotated[
    Path | None,
    typer.Option(
        metavar="FILE.var",
        help="LinuxCNC parameter file, in the machine's unit: work offsets, reference points, variables.",
        show_default=False,
    ),
]
SettingsOption = Annotated[
    Path | None, typer.Option(metavar="FILE.toml", help="Machine settings, all lengths in mm.", show_default=False)
]
UnitOption = Annotated[
    MachineUnit | None,
    typer.Option(
        "--machine-units",
        help="Unit of .tbl and .var files; default: `units` of the settings, or mm.",
        show_default=False,
    ),
]
BlockDeleteOption = Annotated[
    bool, typer.Option("--block-delete", help="Skip blocks that start with a slash (block delete switch on).")
]
SearchPathOption = Annotated[
    list[Path] | None,
    typer.Option(
        metavar="DIR",
        help="Folder with subprogram files; may be repeated. The program's own folder is searched first.",
        exists=True,
        file_okay=False,
        show_default=False,
    ),
]


@dataclass(frozen=True, slots=True, kw_only=True)
class Setup:
    """Dialect and machine settings, from the options."""

    dialect: Dialect
    settings: MachineSettings


def with_machine(command: Callable[..., None]) -> Callable[..., None]:
    """A command whose parameter ``setup`` is made from the options that all commands share, those of `setup_of`.

    Typer reads options from a command's signature: there they replace ``setup``.
    """
    shared = inspect.signature(setup_of, eval_str=True).parameters
    own = inspect.signature(command, eval_str=True).parameters

    @wraps(command)
    def with_options(**values: Any) -> None:
        setup = setup_of(**{name: values.pop(name) for name in shared})
        with closed_pipe_ends():
            command(**values, setup=setup)
            sys.stdout.flush()

    options = {name: p for name, p in (own | shared).items() if name != "setup"}
    keyword_only = [p.replace(kind=inspect.Parameter.KEYWORD_ONLY) for p in options.values()]
    with_options.__signature__ = inspect.Signature(keyword_only)  # type: ignore[attr-defined]
    with_options.__annotations__ = {name: p.annotation for name, p in options.items()}
    return with_options


def setup_of(
    *,
    dialect: DialectOption = DialectName.FANUC,
    tool_table: ToolTableOption = None,
    parameters: ParametersOption = None,
    settings: SettingsOption = None,
    machine_units: UnitOption = None,
    block_delete: BlockDeleteOption = False,
    search_path: SearchPathOption = None,
) -> Setup:
    """Dialect and settings from the options; the tool table and the parameter file override the settings file.

    Raises:
        UnusableFileError: for a file with an error, naming it.
    """
    from gcode.dialects import dialect_named
    from gcode.settings import MachineSettings
    from gcode.tables import read_parameters, read_settings, read_tool_table

    made = _read(lambda: read_settings(settings)) if settings is not None else MachineSettings()
    units = machine_units.value if machine_units is not None else made.units
    if parameters is not None:
        made = _read(lambda: read_parameters(parameters, units)).applied_to(made)
    if tool_table is not None:
        made = replace(made, tools=_read(lambda: read_tool_table(tool_table, units)))
    made = replace(
        made,
        block_delete=made.block_delete or block_delete,
        search_path=(*made.search_path, *(search_path or ())),
    )
    return Setup(dialect=dialect_named(dialect.value), settings=made)


def _read(read: Callable[[], _T]) -> _T:
    try:
        return read()
    except GcodeError as error:
        raise UnusableFileError(error.underlined()) from None
