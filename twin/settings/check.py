"""Values to a settings table, with every mistake in one error."""

from __future__ import annotations

from collections.abc import Callable, Iterator, Mapping
from typing import Any, TypeVar

from pydantic import BaseModel, ValidationError

from twin.errors import SettingsError
from twin.settings.extremes import extremes, numbers_in
from twin.settings.problems import Problem, problems_of

_Model = TypeVar("_Model", bound=BaseModel)


def checked(
    model: type[_Model],
    values: Mapping[str, Any],
    source: str,
    refuse: type[SettingsError] = SettingsError,
    *,
    strict: bool | None = None,
    name: Callable[[str], str] = str,
) -> _Model:
    """A table's values as its model.

    Args:
        source: file, or what else holds the values, for the message.
        refuse: the error for wrong values.
        strict: False takes numbers and truth values written as text, as the cells of a CSV file are.
        name: what a key is called in the message.

    Raises:
        SettingsError: ``refuse``, with every mistake.
    """
    try:
        made = model.model_validate(values, strict=strict)
    except ValidationError as error:
        found = error.errors(include_url=False)
        problems = [*problems_of([e for e in found if e["loc"]], model)]
        texts = [str(Problem((name(str(p.location[0])), *p.location[1:]), p.text)) for p in problems]
        texts += [e["msg"].removeprefix("Value error, ") for e in found if not e["loc"]]
        raise refuse(source, texts) from None
    extreme = [str(Problem((name(str(p.location[0])), *p.location[1:]), p.text)) for p in _extremes(made)]
    if extreme:
        raise refuse(source, extreme)
    return made


def _extremes(made: BaseModel) -> Iterator[Problem]:
    return extremes(numbers_in(made.model_dump()), type(made))


def changed(model: type[_Model], given: _Model | None, values: Mapping[str, Any], source: str) -> _Model:
    """Settings with some values replaced; settings from the values alone without ``given``.

    Args:
        source: name for the message.

    Raises:
        SettingsError: with every mistake.
    """
    if given is not None and not values:
        return given
    own = {} if given is None else {name: getattr(given, name) for name in given.model_fields_set}
    return checked(model, {**own, **values}, source)
