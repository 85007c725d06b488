"""Options that all commands share: the control that the program is for, and the machine at its start."""

from __future__ import annotations

import inspect
import sys
from collections.abc import Callable
from dataclasses import replace
from enum import StrEnum
from functools import wraps
from pathlib import Path
from typing import Annotated, Any, TypeVar

import typer

from gcode.cli.console import UnusableFileError
from gcode.cli.setup import Setup
from gcode.cli.streams import closed_pipe_ends
from gcode.errors import GcodeError

_T = TypeVar("_T")

#: Of a tool or an M code, in any control.
_LARGEST_NUMBER = 99_999_999


class DialectName(StrEnum):
    """Controls by name."""

    FANUC = "fanuc"
    HAAS = "haas"
    LINUXCNC = "linuxcnc"
    GRBL = "grbl"


class ProgramDialect(StrEnum):
    """Controls that a program is written for: one of `DialectName`, or the likeliest of them."""

    FANUC = "fanuc"
    HAAS = "haas"
    LINUXCNC = "linuxcnc"
    GRBL = "grbl"
    AUTO = "auto"


class MachineUnit(StrEnum):
    """Unit of length of a machine."""

    MM = "mm"
    INCH = "inch"


ProgramFile = Annotated[
    Path,
    typer.Argument(metavar="FILE", help="NC program.", show_default=False),
]
DialectOption = Annotated[
    ProgramDialect,
    typer.Option("--dialect", "-d", help="Control that the program is written for; auto takes the likeliest."),
]
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
        help="Unit of .tbl and .var files, and of the machine's offset variables; default: `machine_units` of the "
        "settings, or mm.",
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

ToolOption = Annotated[
    int | None,
    typer.Option(
        metavar="N",
        min=0,
        max=_LARGEST_NUMBER,
        help="Tool in the spindle when the program starts, 0 for none; as in the settings or the job if not given.",
        show_default=False,
    ),
]
MCodeOption = Annotated[
    list[int] | None,
    typer.Option(
        metavar="N",
        min=0,
        max=_LARGEST_NUMBER,
        help="Number of an M code of the machine builder that moves nothing; may be repeated. Each use is a notice.",
        show_default=False,
    ),
]


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
            command(**values, setup=setup.for_program(values.get("file")))
            sys.stdout.flush()

    options = {name: p for name, p in (own | shared).items() if name != "setup"}
    keyword_only = [p.replace(kind=inspect.Parameter.KEYWORD_ONLY) for p in options.values()]
    with_options.__signature__ = inspect.Signature(keyword_only)  # type: ignore[attr-defined]
    with_options.__annotations__ = {name: p.annotation for name, p in options.items()}
    return with_options


def setup_of(
    *,
    dialect: DialectOption = ProgramDialect.FANUC,
    tool_table: ToolTableOption = None,
    parameters: ParametersOption = None,
    settings: SettingsOption = None,
    machine_units: UnitOption = None,
    block_delete: BlockDeleteOption = False,
    search_path: SearchPathOption = None,
    tool: ToolOption = None,
    m_code: MCodeOption = None,
) -> Setup:
    """Dialect and settings from the options; the tool table and the parameter file override the settings file.

    Raises:
        UnusableFileError: for a file with an error, naming it.
    """
    from gcode.dialects import AUTO, dialect_named
    from gcode.settings import MachineSettings
    from gcode.tables import read_parameters, read_settings, read_tool_table

    made = _read(lambda: read_settings(settings)) if settings is not None else MachineSettings()
    units = machine_units.value if machine_units is not None else made.machine_units
    if parameters is not None:
        made = _read(lambda: read_parameters(parameters, units)).applied_to(made)
    if tool_table is not None:
        made = replace(made, tools=_read(lambda: read_tool_table(tool_table, units)))
    made = replace(
        made,
        machine_units=units,
        tool=made.tool if tool is None else tool,
        m_codes={**made.m_codes, **dict.fromkeys(m_code or (), "none")},
        block_delete=made.block_delete or block_delete,
        search_path=(*made.search_path, *(search_path or ())),
    )
    taken = AUTO if dialect is ProgramDialect.AUTO else dialect_named(dialect.value)
    return Setup(dialect=taken, settings=made)


def _read(read: Callable[[], _T]) -> _T:
    try:
        return read()
    except GcodeError as error:
        raise UnusableFileError(error.underlined()) from None
