"""Hook of mkdocs: links from pages to files outside docs/ become names of files, for the site has pages only."""

from __future__ import annotations

import posixpath
import re
from typing import Any

_OUTSIDE = re.compile(r"(?<!!)\[([^\]]+)\]\((\.\./[^)\s]+)\)")


def on_page_markdown(markdown: str, *, page: Any, **_: Any) -> str:
    """A page's text without links that lead out of the site.

    Args:
        markdown: the page as written.
        page: mkdocs' page; links are relative to its file.

    Returns:
        The text; ``[text](../x)`` is ``text (`x`)``, or `x` alone where the text is a part of it.
    """
    folder = posixpath.join("docs", posixpath.dirname(page.file.src_uri))

    def named(match: re.Match[str]) -> str:
        text, target = match.groups()
        path = posixpath.normpath(posixpath.join(folder, target.partition("#")[0]))
        if path.startswith("docs/"):
            return match[0]
        return f"`{path}`" if text.strip("`") in path else f"{text} (`{path}`)"

    return _OUTSIDE.sub(named, markdown)
