"""Help texts without Python's type names: a flag has no value, and every value is named by its option."""

from __future__ import annotations

from typing import Any

from typer.core import TyperCommand, TyperGroup


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


def _without_type_names(parameters: list[Any]) -> list[Any]:
    for parameter in parameters:
        if getattr(parameter, "is_flag", False):
            parameter.metavar = ""
    return parameters
