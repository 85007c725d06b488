"""Put tables of keys and options into the pages, each after its mark ``<!-- keys of twin.job.job_file.Program -->``.

``<!-- keys of MODEL without BASE -->`` omits the keys of a base; ``<!-- options of MODEL -->`` lists options;
``<!-- comments about tools -->`` lists the forms in which posts write them.

python tools/fill_tables.py
"""

from __future__ import annotations

import importlib
import re
from pathlib import Path

from pydantic import BaseModel

from twin.cli.options import options_table
from twin.drafting.comments.tool_posts import TOOL_POSTS
from twin.settings.keys import keys_table

_POSTS = re.compile(r"(<!-- comments about tools -->\n\n)(?:\|.*\n)*")
DOCS = Path(__file__).parents[1] / "docs"
_TABLE = re.compile(r"(<!-- (keys|options) of ([\w.]+)(?: without ([\w.]+))? -->\n\n)(?:\|.*\n)*")


def filled(page: str) -> str:
    """A page with the tables of the models that its marks name."""
    page = _POSTS.sub(lambda m: f"{m[1]}{_posts()}\n", page)
    return _TABLE.sub(lambda m: f"{m[1]}{_table(m[2], [_model(name) for name in m.groups()[2:] if name])}\n", page)


def _posts() -> str:
    """The forms of comments about tools, with an example of each."""
    rows = [f"| {post.post} | `({post.example.replace('|', chr(92) + '|')})` |" for post in TOOL_POSTS]
    return "\n".join(["| post | example |", "| --- | --- |", *rows])


def _table(kind: str, models: list[type[BaseModel]]) -> str:
    return keys_table(*models) if kind == "keys" else options_table(*models)


def _model(name: str) -> type[BaseModel]:
    module, _, own = name.rpartition(".")
    model: type[BaseModel] = getattr(importlib.import_module(module), own)
    return model


if __name__ == "__main__":
    for path in DOCS.glob("*.md"):
        path.write_text(filled(path.read_text("utf-8")), "utf-8")
