"""Put tables of keys and options into the pages, each after its mark ``<!-- keys of twin.job.job_file.Program -->``.

``<!-- keys of MODEL without BASE -->`` omits the keys of a base; ``<!-- options of MODEL -->`` lists options.

python tools/fill_tables.py
"""

from __future__ import annotations

import importlib
import re
from pathlib import Path

from pydantic import BaseModel

from twin.cli.options import options_table
from twin.settings.keys import keys_table

DOCS = Path(__file__).parents[1] / "docs"
_TABLE = re.compile(r"(<!-- (keys|options) of ([\w.]+)(?: without ([\w.]+))? -->\n\n)(?:\|.*\n)*")


def filled(page: str) -> str:
    """A page with the tables of the models that its marks name."""
    return _TABLE.sub(lambda m: f"{m[1]}{_table(m[2], [_model(name) for name in m.groups()[2:] if name])}\n", page)


def _table(kind: str, models: list[type[BaseModel]]) -> str:
    return keys_table(*models) if kind == "keys" else options_table(*models)


def _model(name: str) -> type[BaseModel]:
    module, _, own = name.rpartition(".")
    model: type[BaseModel] = getattr(importlib.import_module(module), own)
    return model


if __name__ == "__main__":
    for path in DOCS.glob("*.md"):
        path.write_text(filled(path.read_text("utf-8")), "utf-8")
