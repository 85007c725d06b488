"""Statements of the macro languages: assignments, IF, WHILE, GOTO of FANUC's custom macro; O-words of LinuxCNC."""

from __future__ import annotations

import re
from collections.abc import Callable

from gcode.language.blocks import Assignment, End, Goto, IfThen, OKeyword, Output, OWord, ParsedBlock, Statement, While
from gcode.language.expressions import Expression, Source, parse_operand, parse_variable

_OUTPUT = re.compile(r"POPEN|PCLOS|DPRNT|BPRNT|SETVN")
_LOOP = re.compile(r"(DO|END)(\d+)")
_O_KEYWORD = re.compile("|".join(sorted((k.value.upper() for k in OKeyword), key=len, reverse=True)))
_O_NUMBER = re.compile(r"\d+")
#: Keywords that take no bracketed expression, and those that take as many as come.
_BARE = frozenset({OKeyword.SUB, OKeyword.ELSE, OKeyword.ENDIF, OKeyword.ENDWHILE, OKeyword.DO})

Then = Callable[[int], ParsedBlock]


def parse_statement(source: Source, position: int, then: Then) -> tuple[Statement, int] | None:
    """Reads the statement at a position, None where there is none.

    Args:
        then: reads the block after THEN.

    Returns:
        The statement, and the position after it.

    Raises:
        EvaluationError: for a statement that is broken.
    """
    if source.language.name == "none" or position >= len(source.text):
        return None
    if source.language.named:
        return _o_word(source, position)
    return _fanuc(source, position, then)


def _fanuc(source: Source, position: int, then: Then) -> tuple[Statement, int] | None:
    column = source.column(position)
    if source.at(position, "IF["):
        return _if(source, position, then)
    if source.at(position, "GOTO"):
        target, end = parse_operand(source, position + 4)
        return Goto(target=target, column=column), end
    if source.at(position, "WHILE["):
        return _while(source, position)
    loop = _LOOP.match(source.text, position)
    if loop:
        kind = While if loop[1] == "DO" else End
        return kind(label=int(loop[2]), column=column), loop.end()
    output = _OUTPUT.match(source.text, position)
    if output:
        return Output(keyword=output[0], text=source.text[output.end() :], column=column), len(source.text)
    return None


def _if(source: Source, position: int, then: Then) -> tuple[Statement, int]:
    column = source.column(position)
    condition, end = parse_operand(source, position + 2)
    if source.at(end, "GOTO"):
        target, behind = parse_operand(source, end + 4)
        return Goto(target=target, condition=condition, column=column), behind
    if source.at(end, "THEN"):
        return IfThen(condition=condition, then=then(end + 4), column=column), len(source.text)
    raise source.error(end, "bad-statement", "IF[...] without GOTO or THEN", "GOTO and a block number, or THEN")


def _while(source: Source, position: int) -> tuple[Statement, int]:
    condition, end = parse_operand(source, position + 5)
    loop = _LOOP.match(source.text, end)
    if not loop or loop[1] != "DO":
        raise source.error(end, "bad-statement", "WHILE[...] without DO", "DO1, DO2 or DO3")
    return While(label=int(loop[2]), condition=condition, column=source.column(position)), loop.end()


def parse_assignment(source: Source, position: int) -> tuple[Assignment, int]:
    """Reads ``#i = expression``; the expression of FANUC needs no brackets around it."""
    target, end = parse_variable(source, position)
    if not source.at(end, "="):
        shown = source.text[end : end + 1] or "the end of the block"
        raise source.error(end, "bad-statement", f"{shown} after a variable", "= and its value")
    if source.language.named:
        value, behind = parse_operand(source, end + 1)
    else:
        value, behind = parse_whole(source, end + 1)
    return Assignment(target=target, value=value), behind


def parse_whole(source: Source, position: int) -> tuple[Expression, int]:
    """Reads an expression that no bracket encloses, up to the end of the block."""
    bracketed = Source(
        f"[{source.text[position:]}]",
        (source.column(position), *source.columns[position:], source.column(len(source.text))),
        source.language,
    )
    expression, end = parse_operand(bracketed, 0)
    inside = Expression(source.text[position:], source.column(position), expression.function)
    if end < len(bracketed.text):
        raise source.error(position + end - 2, "bad-expression", "more text after the value", "the end of the block")
    return inside, len(source.text)


def _o_word(source: Source, position: int) -> tuple[Statement, int] | None:
    if not source.at(position, "O"):
        return None
    column, label, value = source.column(position), None, None
    number = _O_NUMBER.match(source.text, position + 1)
    if source.at(position + 1, "<"):
        end = source.text.find(">", position)
        if end < 0:
            raise source.error(position, "o-word", "O< without its >", "O<name>")
        label, end = source.text[position + 2 : end].lower(), end + 1
    elif number:
        label, end = number[0], number.end()
    elif source.at(position + 1, "#") or source.at(position + 1, "["):
        value, end = parse_operand(source, position + 1)
    else:
        raise source.error(position, "o-word", "O without a label", "O and a number or <name>")
    keyword = _O_KEYWORD.match(source.text, end)
    if not keyword:
        if end == len(source.text) and value is None:
            return None
        shown = source.text[end : end + 12] or "the end of the block"
        raise source.error(position, "o-word", f"{shown} after O<{label}>", "sub, call, if, while, do, repeat...")
    return _with_arguments(source, keyword, label, value, column)


def _with_arguments(
    source: Source, keyword: re.Match[str], label: str | None, value: Expression | None, column: int
) -> tuple[Statement, int]:
    word_keyword, end = OKeyword(keyword[0].lower()), keyword.end()
    arguments: list[Expression] = []
    while source.at(end, "[") and word_keyword not in _BARE:
        argument, end = parse_operand(source, end)
        arguments.append(argument)
    word = OWord(label=label, label_value=value, keyword=word_keyword, arguments=tuple(arguments), column=column)
    return word, end
