"""A message with its block below it and a caret under the word, for terminals."""

from __future__ import annotations

import unicodedata

_INDENT = "    "
#: Characters of longer blocks that are shown before the word, and from its beginning on.
_BEFORE, _AFTER = 60, 60
#: Marks that reverse the direction of writing or end a line unseen, and halves of characters.
_UNSEEN = (0x061C, 0x200E, 0x200F, *range(0x2028, 0x202F), *range(0x2066, 0x206A), *range(0xD800, 0xE000))
#: Characters that would act on a terminal, and what is shown for them, one for one so that columns stay.
_HARMLESS = {
    **{code: chr(0x2400 + code) for code in range(0x20) if chr(code) not in "\t\n"},
    0x7F: "\u2421",
    **dict.fromkeys((*range(0x80, 0xA0), *_UNSEEN), "\ufffd"),
}
_ESCAPED = {code: f"\\u{code:04x}" for code in _HARMLESS}


def harmless(text: str) -> str:
    """A text without characters that control a terminal: names, cells and programs may hold any byte."""
    return text if text.isprintable() else text.translate(_HARMLESS)


def harmless_json(text: str) -> str:
    """JSON with these characters as escapes: it reads the same."""
    return text if text.isprintable() else text.translate(_ESCAPED)


def underlined(message: str, text: str, column: int) -> str:
    """A message, the block it is about, and a caret under the word at `column`, counted from 1.

    A tab before the word is a tab before the caret, and wide characters take two places. Of a long block only the
    text around the word is shown.
    """
    message, text = harmless(message), harmless(text)
    if not text.strip():
        return message
    index = min(column - 1, len(text))
    first, last = max(0, index - _BEFORE), index + _AFTER
    head = ("…" if first else "") + text[first:index]
    tail = text[index:last] + ("…" if last < len(text) else "")
    return f"{message}\n{_INDENT}{head}{tail}\n{_INDENT}{''.join(map(_blank, head))}^"


def _blank(character: str) -> str:
    """Blanks of the same width as a character."""
    if character == "\t":
        return character
    if unicodedata.category(character) in ("Mn", "Me", "Cf"):
        return ""
    return "  " if unicodedata.east_asian_width(character) in "WF" else " "
