"""Help texts name values by what they are (``MM``, ``FILE``, ``N``), not by Python's types, and flags by nothing."""

from __future__ import annotations

from enum import Enum
from typing import Any, TypeVar

from typer.core import TyperCommand, TyperGroup, TyperOption

from gcode.cli.signals import stop_reported
from gcode.cli.streams import closed_pipe_ends
from twin.cli.metavars import type_metavar

_Parameter = TypeVar("_Parameter")


class HelpCommand(TyperCommand):
    """A command with such a help text."""

    def get_params(self, ctx: Any) -> Any:
        """Its parameters, ``--help`` among them."""
        return _named(super().get_params(ctx))


class HelpGroup(TyperGroup):
    """The program itself, with such a help text."""

    def get_params(self, ctx: Any) -> Any:
        """Its parameters, ``--help`` among them."""
        return _named(super().get_params(ctx))

    def invoke(self, ctx: Any) -> Any:
        """Carry out a command; a closed pipe of standard output ends it without a message, Ctrl-C with a word."""
        with stop_reported(), closed_pipe_ends():
            return super().invoke(ctx)


def _named(parameters: list[_Parameter]) -> list[_Parameter]:
    for parameter in parameters:
        if isinstance(parameter, TyperOption) and parameter.metavar is None:
            annotation = parameter.type_descriptor.annotation
            if not (isinstance(annotation, type) and issubclass(annotation, Enum)):
                parameter.metavar = type_metavar(annotation)
    return parameters
