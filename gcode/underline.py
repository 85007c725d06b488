"""A message with its block below it and a caret under the word, as it stands on a terminal."""

from __future__ import annotations

import unicodedata

_INDENT = "    "
#: Of longer blocks only so many characters are shown before the word, and behind its beginning.
_BEFORE, _BEHIND = 60, 60
#: Characters that would act on a terminal, and what is shown for them, one for one so that columns stay.
_HARMLESS = {
    **{code: chr(0x2400 + code) for code in range(0x20) if chr(code) not in "\t\n"},
    0x7F: "\u2421",
    **dict.fromkeys((*range(0x80, 0xA0), *range(0x202A, 0x202F), *range(0x2066, 0x206A)), "\ufffd"),
}


def harmless(text: str) -> str:
    """A text that does nothing to a terminal but be shown: a program may hold any byte."""
    return text.translate(_HARMLESS)


def underlined(message: str, text: str, column: int) -> str:
    """A message, the block it is about, and a caret that stands under the word at `column`, counted from 1.

    A tab before the word is a tab before the caret, and wide characters take two places. Of a long block only what is
    around the word is shown.
    """
    message, text = harmless(message), harmless(text)
    if not text.strip():
        return message
    index = min(column - 1, len(text))
    first, last = max(0, index - _BEFORE), index + _BEHIND
    head = ("…" if first else "") + text[first:index]
    tail = text[index:last] + ("…" if last < len(text) else "")
    return f"{message}\n{_INDENT}{head}{tail}\n{_INDENT}{''.join(map(_blank, head))}^"


def _blank(character: str) -> str:
    """What takes as much room as a character."""
    if character == "\t":
        return character
    if unicodedata.category(character) in ("Mn", "Me", "Cf"):
        return ""
    return "  " if unicodedata.east_asian_width(character) in "WF" else " "
