"""Options of a command made from the fields of a settings table: name, type, help, default and unit are the field's."""

from __future__ import annotations

import functools
import inspect
from collections.abc import Callable, Collection, Iterator, Mapping
from pathlib import Path, PurePath
from typing import Any, Literal, TypeVar, get_args, get_origin

import typer
from pydantic import BaseModel
from pydantic.fields import FieldInfo
from rich.markup import escape

from twin.cli.metavars import type_metavar
from twin.errors import SettingsError
from twin.settings.check import checked
from twin.settings.keys import bare, default_text, key_of, option_names, without_unit
from twin.settings.toml_file import read_toml

Command = Callable[..., None]
_Model = TypeVar("_Model", bound=BaseModel)


def options_from(
    model: type[BaseModel], into: str, *, omit: Collection[str] = (), panel: str | None = None
) -> Callable[[Command], Command]:
    """Replace a command's parameter by one option for each field of a table.

    The command gets in that parameter the values of the options that were given, by key: an option that was not given
    is not in it, so that a file's value or the default holds. ``panel`` is the heading above the options in the help.
    Keys that are tables themselves have no option.

    Args:
        into: name of the command's parameter, a mapping.
        omit: keys without an option.

    Raises:
        ValueError: two keys with one option.
        TypeError: a key whose type no option can give.
    """
    fields = {name: field for name, field in _fields(model).items() if name not in omit}
    _refuse_double_names(fields)

    def decorate(function: Command) -> Command:
        parameters: list[inspect.Parameter] = []
        for parameter in inspect.signature(function, eval_str=True).parameters.values():
            if parameter.name == into:
                parameters += [_parameter(name, field, panel) for name, field in fields.items()]
            else:
                parameters.append(parameter.replace(kind=inspect.Parameter.KEYWORD_ONLY))

        @functools.wraps(function)
        def command(**values: Any) -> None:
            taken = {name: values.pop(name) for name in fields}
            function(**values, **{into: {name: value for name, value in taken.items() if value is not None}})

        command.__signature__ = inspect.Signature(parameters)  # type: ignore[attr-defined]
        command.__annotations__ = {p.name: p.annotation for p in parameters}
        return command

    return decorate


def _fields(model: type[BaseModel]) -> dict[str, FieldInfo]:
    """The fields that options can give: all but tables."""
    return {name: field for name, field in model.model_fields.items() if not _is_table(bare(field.annotation))}


def _is_table(annotation: Any) -> bool:
    return get_origin(annotation) is dict or (isinstance(annotation, type) and issubclass(annotation, BaseModel))


def _refuse_double_names(fields: Mapping[str, FieldInfo]) -> None:
    keys: dict[str, str] = {}
    for key, field in fields.items():
        for option in (o for names in option_names(key, field) for o in names.split("/")):
            if keys.setdefault(option, key) != key:
                raise ValueError(f"{option} is the option of {keys[option]} and of {key}")


def _parameter(name: str, field: FieldInfo, panel: str | None) -> inspect.Parameter:
    """A parameter as typer reads it; its own default is None: not given."""
    annotation = str if key_of(field).as_text else _typed(field.annotation)
    option = typer.Option(
        None,
        *option_names(name, field),
        help=_help(name, field, repeated=get_origin(annotation) is list),
        metavar=_metavar(name, field, annotation),
        rich_help_panel=panel,
        show_default=False,
    )
    return inspect.Parameter(name, inspect.Parameter.KEYWORD_ONLY, default=option, annotation=annotation | None)


def _typed(annotation: Any) -> Any:
    """A field's type as typer knows it: a list where an option may be repeated.

    Raises:
        TypeError: a type that one option cannot give.
    """
    annotation = bare(annotation)
    origin, arguments = get_origin(annotation), [bare(a) for a in get_args(annotation)]
    if origin is Literal or annotation in (bool, int, float, str):
        return annotation
    if isinstance(annotation, type) and issubclass(annotation, PurePath):
        return annotation
    if origin is list or (origin is tuple and arguments[-1] is Ellipsis):
        return list[_typed(arguments[0])]  # type: ignore[misc]
    if origin is tuple:
        return tuple.__class_getitem__(tuple(map(_typed, arguments)))
    raise TypeError(f"no option can give {annotation}")


def _help(name: str, field: FieldInfo, *, repeated: bool) -> str:
    """The description as a sentence, with the default after it."""
    text = _meaning(field, repeated=repeated)
    text = f"{text[:1].upper()}{text[1:]}."
    default = _shown_default(name, field)
    return escape(text) + (f" [dim]{escape(f'[default: {default}]')}[/dim]" if default else "")


def _meaning(field: FieldInfo, *, repeated: bool) -> str:
    return f"{field.description or ''}{'; may be repeated' if repeated else ''}"


def _shown_default(name: str, field: FieldInfo) -> str | None:
    """A default as the command line writes it: the name of a pair's option, text without quotes."""
    value = None if field.is_required() else field.get_default(call_default_factory=True)
    if isinstance(value, bool):
        pair = option_names(name, field)[0].split("/")
        return pair[not value].lstrip("-") if len(pair) == 2 else None
    return str(value) if isinstance(value, str) else default_text(field)


def _metavar(name: str, field: FieldInfo, annotation: Any) -> str | None:
    """Placeholder of the value in the help: its unit if it has one; typer lists choices itself."""
    given = key_of(field).metavar
    if given is not None or get_origin(annotation) is Literal:
        return given
    items = get_args(annotation) or (annotation,)
    unit = without_unit(name)[1]
    return " ".join(unit or type_metavar(item) or "TEXT" for item in items) if items != (bool,) else ""


def options_table(model: type[BaseModel]) -> str:
    """A page's table of a model's options, in Markdown."""
    return "\n".join(["| option | default | meaning |", "| --- | --- | --- |", *_rows(model)])


def _rows(model: type[BaseModel]) -> Iterator[str]:
    for name, field in _fields(model).items():
        annotation = str if key_of(field).as_text else _typed(field.annotation)
        value = _metavar(name, field, annotation) or "|".join(map(str, get_args(annotation)))
        names = [n for pair in option_names(name, field) for n in pair.split("/")]
        default = _shown_default(name, field) or ""
        if default and annotation is bool:
            default = f"`--{default}`"
        meaning = _meaning(field, repeated=get_origin(annotation) is list)
        cells = (", ".join(f"`{f'{n} {value}'.strip()}`" for n in names), default, meaning)
        yield f"| {' | '.join(cell.replace('|', chr(92) + '|') for cell in cells)} |".replace("|  |", "| |")


def option_of(model: type[BaseModel], key: str) -> str:
    """The option that gives a key: ``--feed`` for ``feed_mm_min``."""
    return option_names(key, model.model_fields[key])[0].split("/")[0]


def settings_from(
    model: type[_Model], options: Mapping[str, Any], base: Mapping[str, Any], source: str, command: str
) -> _Model:
    """Settings from a command's options and, where these are not given, from a file.

    Args:
        options: values by key, as `options_from` gives them.
        base: values of a file, by key.
        source: the file, for the message.
        command: the command, for the message where only options are wrong.

    Raises:
        SettingsError: every mistake, with the option or the file's key.
    """
    try:
        named = functools.partial(_named, model, options)
        return checked(model, {**base, **options}, source, name=named)
    except SettingsError as error:
        own = all(problem.startswith("--") for problem in error.problems)
        raise SettingsError(command if own else source, error.problems) from None


def settings_from_file(model: type[_Model], options: Mapping[str, Any], file: Path | None, command: str) -> _Model:
    """Settings from a command's options and, where these are not given, from a TOML file of settings.

    Raises:
        SettingsError: the file cannot be read, or every mistake, with the option or the file's key.
    """
    base = {} if file is None else read_toml(file)[0]
    return settings_from(model, options, base, command if file is None else str(file), command)


def _named(model: type[BaseModel], options: Mapping[str, Any], key: str) -> str:
    return option_of(model, key) if key in options else key
