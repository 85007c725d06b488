"""Names of files that hold line ends or tabs, printed on one line: text that follows one could pass for a message."""

from __future__ import annotations

from collections.abc import Iterable, Iterator
from pathlib import PurePath

#: Characters that messages of several lines hold themselves, and what is shown for them in a name.
_SHOWN = {ord("\t"): "\u2409", ord("\n"): "\u240a"}
#: Names on the process's command line, the longest first; also for threads that draw progress.
_names: list[str] = []


def set_names(arguments: Iterable[str]) -> None:
    """From now on `on_one_line` knows the names in these arguments, and no others."""
    _names[:] = sorted({name for argument in arguments for name in _parts(argument)}, key=len, reverse=True)


def _parts(argument: str) -> Iterator[str]:
    """Parts of a path with such characters, also without their suffix, as names of outputs are made from them."""
    if not _is_shown(argument):
        return
    for part in argument.split("/"):
        for name in (part, PurePath(part).stem):
            if _is_shown(name) and not name.isspace():
                yield name


def _is_shown(text: str) -> bool:
    return "\n" in text or "\t" in text


def on_one_line(text: str) -> str:
    """A message of as many characters, with each known name on one line."""
    for name in _names:
        text = text.replace(name, name.translate(_SHOWN))
    return text
