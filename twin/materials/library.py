"""The table of materials: ``materials.toml`` and ``material_groups.toml`` of ``twin/data``, read once."""

from __future__ import annotations

import difflib
import re
import tomllib
from collections.abc import Iterable, Iterator, Mapping
from functools import cache
from importlib.resources import files
from itertools import chain
from types import MappingProxyType
from typing import Any

from twin.errors import MaterialError
from twin.materials.material import Material
from twin.materials.oblique import Orthogonal

_MOST_NEAR = 5


@cache
def load_materials() -> Mapping[str, Material]:
    """The materials whose cutting coefficients are known, by name, in the order of the table.

    Example:
        >>> for name, row in twin.load_materials().items():
        ...     print(name, row.Ktc, row.source)
    """
    rows = [*map(published_row, _data("materials")["materials"]), *group_rows(_data("material_groups")["groups"])]
    return MappingProxyType({row.name: row for row in rows})


def _data(name: str) -> dict[str, Any]:
    return tomllib.loads(files("twin").joinpath(f"data/{name}.toml").read_text("utf-8"))


def published_row(values: Mapping[str, Any]) -> Material:
    """A row of the table; coefficients per chip area computed where it has orthogonal tests."""
    own = dict(values)
    if "orthogonal" in own:
        own |= zip(("Ktc", "Krc", "Kac"), Orthogonal.model_validate(own["orthogonal"]).coefficients(), strict=True)
    return Material.model_validate(own)


def group_rows(groups: Mapping[str, Any]) -> Iterator[Material]:
    """The material groups of VDI 3323 under Kienzle's law, with the ratios of the radial and axial force."""
    shared = {key: groups[key] for key in ("source", "tool", "chip_range_mm", "caution")}
    for number, iso_group, kc, mc, hardness, text, *grades in groups["rows"]:
        yield Material.model_validate(
            {
                "name": f"VDI 3323 group {number}",
                "aliases": (f"{iso_group}{number}", f"VDI {number}", *chain(*grades), text),
                "family": text,
                "iso_group": iso_group,
                "kind": "order of magnitude",
                "law": "kienzle",
                "Ktc": kc,
                "Krc": kc * groups["radial_ratio"],
                "Kac": kc * groups["axial_ratio"],
                **dict.fromkeys(("Kte", "Kre", "Kae"), 0.0),
                **dict.fromkeys(("mt", "mr", "ma"), mc),
                "note": f"{text}{f', {hardness} HB' if hardness else ''}. {groups['note']}",
                **shared,
            }
        )


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


def is_name(text: str) -> bool:
    """Whether a text is a name or alias of a material."""
    return key_of(text) in _by_key()


def matching(text: str) -> list[Material]:
    """Rows of an ISO group, by its letter; or rows with a text in a name, family, source, tool or kind."""
    key, rows = key_of(text), load_materials().values()
    if key in {row.iso_group.casefold() for row in rows}:
        return [row for row in rows if row.iso_group.casefold() == key]
    return [
        row
        for row in rows
        if any(key in key_of(held) for held in (*row.names, row.family, row.source, row.tool, row.kind))
    ]


def near_names(name: str) -> str:
    """Names of the table that are near to a wrong one, in one line."""
    key = key_of(name)
    keys = difflib.get_close_matches(key, _by_key(), n=2 * _MOST_NEAR, cutoff=0.5)
    inside = [k for k in _by_key() if key and (key in k or k in key)]
    near = _unique(_by_key()[k].name for k in [*inside, *keys])[:_MOST_NEAR]
    return f"did you mean {'; '.join(near)}?" if near else f"e.g. {'; '.join(list(load_materials())[:_MOST_NEAR])}"


def key_of(name: str) -> str:
    """A name as it is compared: without case, blanks, hyphens and underscores, and in one spelling of aluminium.

    The prefixes of aluminium alloys are one too: EN AW-7075, AA7075 and aluminium 7075 are Al7075.
    """
    key = re.sub(r"[\s_\-\u2010-\u2015]+", "", name).casefold().replace("aluminum", "aluminium")
    return re.sub(r"^(?:enaw|aw|aa|aluminium)(?=\d{4})", "al", key)


@cache
def _by_key() -> Mapping[str, Material]:
    return {key_of(name): row for row in load_materials().values() for name in row.names}


def _unique(names: Iterable[str]) -> list[str]:
    return list(dict.fromkeys(names))
