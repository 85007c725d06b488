"""Help texts without Python's type names: a flag has no value, and other values are named by their options."""

from __future__ import annotations

from typing import Any

from typer.core import TyperCommand, TyperGroup

from gcode.cli.signals import stop_reported


class HelpCommand(TyperCommand):
    """A command with such a help text."""

    def get_params(self, ctx: Any) -> Any:
        """Its parameters, ``--help`` among them."""
        return _without_type_names(super().get_params(ctx))


class HelpGroup(TyperGroup):
    """The program itself, with such a help text."""

    def get_params(self, ctx: Any) -> Any:
        """Its parameters, ``--help`` among them."""
        return _without_type_names(super().get_params(ctx))

    def invoke(self, ctx: Any) -> Any:
        """Carry out a command; Ctrl-C ends it with a word."""
        with stop_reported():
            return super().invoke(ctx)


def _without_type_names(parameters: list[Any]) -> list[Any]:
    for parameter in parameters:
        if getattr(parameter, "is_flag", False):
            parameter.metavar = ""
        elif parameter.param_type_name == "argument":
            parameter.display_type_rich = _no_type
    return parameters


def _no_type(**_context: Any) -> None:
    """The type of an argument, whose name is enough."""
