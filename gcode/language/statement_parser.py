"""Statements of the macro languages: assignments, IF, WHILE, GOTO of FANUC's custom macro; O-words of LinuxCNC."""

from __future__ import annotations

import re
from collections.abc import Callable

from gcode.language.blocks import Assignment, End, Goto, IfThen, OKeyword, Output, OWord, ParsedBlock, Statement, While
from gcode.language.expressions import Expression, Source, parse_operand, parse_sum, parse_variable

_OUTPUTS = ("POPEN", "PCLOS", "DPRNT", "BPRNT", "SETVN")
_NUMBER = re.compile(r"\d+")
#: How statements of custom macro B begin.
_BEGINNING = re.compile(r"IF\[|GO|WH|DO|EN|PO|PC|DP|BP|SE")
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
    if not _BEGINNING.match(source.text, position):
        return None
    column = source.column(position)
    if source.at(position, "IF["):
        return _if(source, position, then)
    behind = keyword_end(source, position, "GOTO")
    if behind:
        target, end = parse_operand(source, behind)
        return Goto(target=target, column=column), end
    behind = keyword_end(source, position, "WHILE")
    if behind and source.at(behind, "["):
        return _while(source, position, behind)
    for keyword, kind in (("DO", While), ("END", End)):
        label = _loop_label(source, position, keyword)
        if label:
            return kind(label=int(label[0]), column=column), label.end()
    for keyword in _OUTPUTS:
        behind = keyword_end(source, position, keyword)
        if behind:
            return Output(keyword=keyword, text=source.text[behind:], column=column), len(source.text)
    return None


def keyword_end(source: Source, position: int, keyword: str) -> int:
    """The position after a keyword, 0 where it is not there.

    A language that abbreviates takes its first two or more letters for it, where no other letter follows.
    """
    for length in range(len(keyword), 1 if source.language.abbreviates else len(keyword) - 1, -1):
        end = position + length
        if source.at(position, keyword[:length]):
            return 0 if length < len(keyword) and source.text[end : end + 1].isalpha() else end
    return 0


def _loop_label(source: Source, position: int, keyword: str) -> re.Match[str] | None:
    behind = keyword_end(source, position, keyword)
    return _NUMBER.match(source.text, behind) if behind else None


def _if(source: Source, position: int, then: Then) -> tuple[Statement, int]:
    column = source.column(position)
    condition, end = parse_operand(source, position + 2)
    behind = keyword_end(source, end, "GOTO")
    if behind:
        target, behind = parse_operand(source, behind)
        return Goto(target=target, condition=condition, column=column), behind
    behind = keyword_end(source, end, "THEN")
    if behind:
        return IfThen(condition=condition, then=then(behind), column=column), len(source.text)
    raise source.error(end, "bad-statement", "IF[...] without GOTO or THEN", "GOTO and a block number, or THEN")


def _while(source: Source, position: int, behind: int) -> tuple[Statement, int]:
    condition, end = parse_operand(source, behind)
    label = _loop_label(source, end, "DO")
    if not label:
        raise source.error(end, "bad-statement", "WHILE[...] without DO", "DO1, DO2 or DO3")
    return While(label=int(label[0]), condition=condition, column=source.column(position)), label.end()


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
    expression, end = parse_sum(source, position)
    if end < len(source.text):
        problem = f"unexpected {source.text[end]!r} after the value"
        raise source.error(end, "bad-expression", problem, "an operator, or the end of the block")
    return expression, end


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
