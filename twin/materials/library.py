"""The table of materials: ``twin/data/materials.toml``, read once."""

from __future__ import annotations

import difflib
import re
import tomllib
from collections.abc import Iterable, Mapping
from functools import cache
from importlib.resources import files
from types import MappingProxyType

from twin.errors import MaterialError
from twin.materials.material import Material

_MOST_NEAR = 5


@cache
def load_materials() -> Mapping[str, Material]:
    """The materials whose cutting coefficients are known, by name, in the order of the table.

    Example:
        >>> for name, row in twin.load_materials().items():
        ...     print(name, row.Ktc, row.source)
    """
    rows = tomllib.loads(files("twin").joinpath("data/materials.toml").read_text("utf-8"))["materials"]
    return MappingProxyType({row.name: row for row in map(Material.model_validate, rows)})


def find_material(name: str) -> Material:
    """The material of a name or alias; case, blanks, hyphens and underscores do not matter.

    Raises:
        MaterialError: there is none; the message has the nearest names.

    Example:
        >>> twin.find_material("al 7075-t6").name
        'Al7075-T6'
    """
    found = _by_key().get(key_of(name))
    if found is None:
        raise MaterialError(f"material {name!r}: expected a name of the table (twin materials): {near_names(name)}")
    return found


def near_names(name: str) -> str:
    """Names of the table that are near to a wrong one, in one line."""
    key = key_of(name)
    keys = difflib.get_close_matches(key, _by_key(), n=2 * _MOST_NEAR, cutoff=0.5)
    inside = [k for k in _by_key() if key and (key in k or k in key)]
    near = _unique(_by_key()[k].name for k in [*inside, *keys])[:_MOST_NEAR]
    return f"did you mean {', '.join(near)}?" if near else f"e.g. {', '.join(list(load_materials())[:_MOST_NEAR])}"


def key_of(name: str) -> str:
    """A name as it is compared: without case, blanks, hyphens and underscores."""
    return re.sub(r"[\s_\-\u2010-\u2015]+", "", name).casefold()


@cache
def _by_key() -> Mapping[str, Material]:
    return {key_of(name): row for row in load_materials().values() for name in row.names}


def _unique(names: Iterable[str]) -> list[str]:
    return list(dict.fromkeys(names))
