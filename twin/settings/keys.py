"""Fields of a settings table as its users see them: option names, units, defaults, and the table of a page."""

from __future__ import annotations

import re
from collections.abc import Iterator, Mapping
from types import NoneType, UnionType
from typing import Annotated, Any, Literal, Union, get_args, get_origin

from pydantic import BaseModel
from pydantic.fields import FieldInfo

from twin.settings.table import Key
from twin.settings.toml_text import toml_value

#: Ends of a key's name, longest first, and how help texts write the unit.
_UNITS = {"_mm_min": "MM/MIN", "_rpm": "RPM", "_deg": "DEG", "_hz": "HZ", "_mm": "MM", "_s": "SECONDS", "_n": "N"}


def key_of(field: FieldInfo) -> Key:
    """The field's `Key`."""
    return next((note for note in field.metadata if isinstance(note, Key)), Key())


def fields_of(model: type[BaseModel]) -> dict[str, FieldInfo]:
    """The fields of a table by key; a field's alias is its key where Python cannot have the name."""
    return {field.alias or name: field for name, field in model.model_fields.items()}


def bare(annotation: Any) -> Any:
    """A type without ``None`` as an alternative and without annotations."""
    while True:
        origin = get_origin(annotation)
        if origin is Annotated:
            annotation = get_args(annotation)[0]
        elif origin in (Union, UnionType):
            annotation = next(a for a in get_args(annotation) if a is not NoneType)
        else:
            return annotation


def without_unit(name: str) -> tuple[str, str | None]:
    """A key's name less its unit, and the unit as help texts write it: ``feed_mm_min`` is ``feed`` in ``MM/MIN``."""
    for end, unit in _UNITS.items():
        if name.endswith(end) and name != end.lstrip("_"):
            return name.removesuffix(end), unit
    return name, None


def option_names(name: str, field: FieldInfo) -> tuple[str, ...]:
    """Names of a field's option: ``--feed`` for ``feed_mm_min``, ``--zigzag/--no-zigzag`` for true or false."""
    if given := key_of(field).options:
        return given
    plain = without_unit(name)[0].replace("_", "-")
    return (f"--{plain}/--no-{plain}" if bare(field.annotation) is bool else f"--{plain}",)


def default_text(field: FieldInfo) -> str | None:
    """A field's default as TOML writes it, or its ``unset`` text; None for neither."""
    if field.is_required():
        return None
    value = field.get_default(call_default_factory=True)
    if value is None or isinstance(value, BaseModel) or (value in ((), [], {}, "") and key_of(field).unset):
        return key_of(field).unset
    return toml_value(_short(value))


def keys_table(model: type[BaseModel], without: type[BaseModel] = BaseModel) -> str:
    """A page's table of a model's keys, in Markdown.

    Args:
        model: the model.
        without: a base of the model whose keys are omitted.
    """
    rows = [row for row in _rows(model) if row not in set(_rows(without))]
    return "\n".join(["| key | default | meaning |", "| --- | --- | --- |", *rows])


def _rows(model: type[BaseModel]) -> Iterator[str]:
    for name, field in fields_of(model).items():
        default = key_of(field).unset or "required" if field.is_required() else default_text(field) or ""
        if default and not field.is_required() and default != key_of(field).unset:
            default = f"`{default}`"
        yield f"| `{name}` | {default} | {_meaning(field)} |".replace("|  |", "| |")


def _meaning(field: FieldInfo) -> str:
    """The description, and the choices where it does not name them."""
    text, annotation = field.description or "", bare(field.annotation)
    choices = [str(choice) for choice in get_args(annotation)] if get_origin(annotation) is Literal else []
    if all(re.search(rf"\b{re.escape(choice)}\b", text) for choice in choices):
        return text
    return f"{text}: {', '.join(f'`{choice}`' for choice in choices)}"


def _short(value: Any) -> Any:
    """Whole numbers without a decimal point."""
    if isinstance(value, float) and value.is_integer():
        return int(value)
    if isinstance(value, Mapping):
        return {key: _short(inner) for key, inner in value.items()}
    return [_short(v) for v in value] if isinstance(value, list | tuple) else value
