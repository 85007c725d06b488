"""An HTML page that needs no other file: its template fills the blocks of ``page.html.j2``, its pictures are in it."""

from __future__ import annotations

import base64
from collections.abc import Callable, Mapping
from typing import Any

from jinja2 import Environment, FileSystemLoader, PackageLoader, PrefixLoader
from markupsafe import Markup, escape

from gcode.underline import harmless

#: Name of a picture and its caption, to the figure.
Figure = Callable[[str, str], Markup]


def page(
    package: str,
    template: str,
    pictures: Mapping[str, bytes],
    filters: Mapping[str, Callable[..., str]],
    **values: Any,
) -> str:
    """Fill a page's template.

    Args:
        package: package in whose folder the template is; it extends ``pages/page.html.j2``.
        template: its file name.
        pictures: PNG data by name; the template places them with ``figure(name, caption)``.
        filters: of the template.
        values: of the template. Texts may hold any character: those that act on a terminal or turn the direction of
            text are shown as their code.
    """
    loaders: dict[str, FileSystemLoader | PackageLoader] = {
        "pages": PackageLoader("twin.pages", ""),
        "own": PackageLoader(package, ""),
    }
    environment = Environment(loader=PrefixLoader(loaders), autoescape=True, finalize=_clean)
    environment.filters.update(filters)
    return environment.get_template(f"own/{template}").render(figure=_figures(pictures), **values)


def _figures(pictures: Mapping[str, bytes]) -> Figure:
    def figure(name: str, caption: str) -> Markup:
        data = base64.b64encode(pictures[name]).decode()
        text = escape(_clean(caption))
        return Markup(
            f'<figure><img alt="{text}" src="data:image/png;base64,{data}"><figcaption>{text}</figcaption></figure>'
        )

    return figure


def _clean(value: object) -> object:
    """A value of the template; names and notes may hold any character."""
    return harmless(value) if isinstance(value, str) and not isinstance(value, Markup) else value
