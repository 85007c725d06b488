"""A console for tables and messages that hold text of files."""

from __future__ import annotations

from collections.abc import Iterable
from typing import IO

from rich.console import Console, ConsoleOptions, RenderableType
from rich.segment import Segment
from rich.text import Text

from gcode.cli.name_lines import on_one_line
from gcode.underline import harmless


class CleanConsole(Console):
    """Prints no control character but its own, and takes no brackets of a text as markup.

    Args:
        width: None for the terminal's.
        soft_wrap: never break lines.
    """

    def __init__(
        self, *, stderr: bool = False, width: int | None = None, soft_wrap: bool = False, file: IO[str] | None = None
    ) -> None:
        super().__init__(
            stderr=stderr, width=width, soft_wrap=soft_wrap, file=file, highlight=False, markup=False, emoji=False
        )

    def render(self, renderable: RenderableType, options: ConsoleOptions | None = None) -> Iterable[Segment]:
        """The parts of what is printed; control codes of the console itself are marked as such and stay."""
        if isinstance(renderable, Text):
            plain = on_one_line(renderable.plain)
            if plain != renderable.plain:
                renderable = renderable.copy()
                renderable.plain = plain
        elif isinstance(renderable, str):
            renderable = on_one_line(renderable)
        for segment in super().render(renderable, options):
            yield segment if segment.control else segment._replace(text=harmless(segment.text))

    def on_broken_pipe(self) -> None:
        """Without this, rich ends the program with code 1."""
        raise BrokenPipeError
