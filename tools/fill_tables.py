"""Put tables of keys into the pages, each after its mark ``<!-- keys of twin.job.model.Program -->``.

``<!-- keys of MODEL without BASE -->`` omits the keys of a base of the model.

python tools/fill_tables.py
"""

from __future__ import annotations

import importlib
import re
from pathlib import Path

from pydantic import BaseModel

from twin.settings.keys import keys_table

DOCS = Path(__file__).parents[1] / "docs"
_TABLE = re.compile(r"(<!-- keys of ([\w.]+)(?: without ([\w.]+))? -->\n\n)(?:\|.*\n)*")


def filled(page: str) -> str:
    """A page with the tables of the models that its marks name."""
    return _TABLE.sub(lambda m: m[1] + keys_table(*(_model(name) for name in m.groups()[1:] if name)) + "\n", page)


def _model(name: str) -> type[BaseModel]:
    module, _, own = name.rpartition(".")
    model: type[BaseModel] = getattr(importlib.import_module(module), own)
    return model


if __name__ == "__main__":
    for path in DOCS.glob("*.md"):
        path.write_text(filled(path.read_text("utf-8")), "utf-8")
