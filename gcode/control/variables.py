"""The variables of both macro languages: locals of every level of calls, common ones, and those of the control."""

from __future__ import annotations

from collections.abc import Callable, Mapping
from typing import Protocol

from gcode.dialects import Dialect
from gcode.language.expressions import EvaluationError, Scope, Variable, variable_number

#: Common variables of FANUC: volatile and kept ones.
_COMMON = (range(100, 200), range(500, 1000))
#: Variables of LinuxCNC that are the user's.
_GLOBALS = range(31, 5001)
#: Names of the control's that calls set.
_SETTABLE = frozenset({"_value", "_value_returned"})
#: Names of variables that a program may have.
_MOST_NAMES = 10_000


class ControlVariables(Protocol):
    """Access to the variables that belong to the control and not to the program."""

    def read(self, index: int) -> float | None:
        """Value of #index; raises `EvaluationError` for a variable that does not exist."""

    def write(self, index: int, value: float | None) -> None:
        """Sets #index; raises `EvaluationError` for a variable that cannot be set."""

    def named(self, name: str) -> float | None:
        """Value of #<name>, None where the control has none of that name."""


class Variables:
    """Values of variables while a program runs; implements `Scope`.

    Args:
        dialect: whose rules hold.
        control: the variables that are not the program's own.
        initial: values at the start.
        steps: least input increments of an address that make one unit, 0 where its numbers are not rounded.
    """

    def __init__(
        self,
        dialect: Dialect,
        *,
        control: ControlVariables,
        initial: Mapping[int, float],
        steps: Callable[[str], int],
    ) -> None:
        language = dialect.macro
        self._language = language
        self._second_names = dialect.second_variable_names
        self._control = control
        self._steps = steps
        self._own = (*_COMMON, *dialect.further_variables) if language.vacant else (_GLOBALS,)
        named = {self._first_name(n): v for n, v in initial.items()}
        self._common: dict[int, float] = {n: v for n, v in named.items() if self._is_common(n)}
        self._locals: list[dict[int, float]] = [{n: v for n, v in initial.items() if 0 < n <= language.locals}]
        self._names: list[dict[str, float]] = [{}]
        self._global_names: dict[str, float] = {}

    def _is_common(self, index: int) -> bool:
        return any(index in numbers for numbers in self._own)

    def _first_name(self, index: int) -> int:
        """The number of a variable that has two of them."""
        for first, count, same in self._second_names:
            if first <= index < first + count:
                return same + index - first
        return index

    def push(self, arguments: Mapping[int, float]) -> None:
        """Begins a level with locals of its own."""
        self._locals.append(dict(arguments))
        self._names.append({})

    def pop(self) -> None:
        """Ends it."""
        self._locals.pop()
        self._names.pop()

    def scope(self) -> Scope:
        """Where expressions look variables up."""
        return self

    def number(self, index: int) -> float | None:
        """Value of #index; vacant is None, and 0 in a language without it.

        Raises:
            EvaluationError: for a variable that is not there.
        """
        missing = None if self._language.vacant else 0.0
        if 0 < index <= self._language.locals:
            return self._locals[-1].get(index, missing)
        if self._second_names:
            index = self._first_name(index)
        if self._is_common(index):
            return self._common.get(index, missing)
        if index == 0 and self._language.vacant:
            return None
        return self._control.read(index)

    def named(self, name: str) -> float | None:
        """Value of #<name>.

        Raises:
            EvaluationError: where it was never set.
        """
        table = self._table(name)
        if name in table:
            return table[name]
        value = self._control.named(name)
        if value is None:
            raise EvaluationError("unknown-variable", f"#<{name}> was not set", "a value for it before")
        return value

    def exists(self, name: str) -> bool:
        """True where #<name> was set, or is the control's."""
        return name in self._table(name) or self._control.named(name) is not None

    def has(self, index: int) -> bool:
        """True where there is a variable #index."""
        try:
            self.number(index)
        except EvaluationError:
            return False
        return index > 0

    def steps(self, letter: str) -> int:
        """Least input increments of an address that make one unit, 0 where its numbers are not rounded."""
        return self._steps(letter)

    def _table(self, name: str) -> dict[str, float]:
        return self._global_names if name.startswith("_") else self._names[-1]

    def assign(self, target: Variable, value: float | None, scope: Scope) -> None:
        """Sets a variable.

        Raises:
            EvaluationError: for one that is not there or cannot be set.
        """
        try:
            if target.name is not None:
                self.set_named(target.name, value or 0.0)
            elif target.index is not None:
                self.set_number(variable_number(target.index, scope), value)
        except EvaluationError as error:
            error.column = error.column or target.column
            raise

    def set_named(self, name: str, value: float) -> None:
        """Sets #<name>; one with a leading underscore holds in all levels."""
        table = self._table(name)
        if self._control.named(name) is not None and name not in _SETTABLE:
            raise EvaluationError("read-only-variable", f"#<{name}> is the control's", "a name of the program's own")
        if len(table) >= _MOST_NAMES and name not in table:
            raise EvaluationError("too-many-variables", f"#<{name}> is one too many", f"at most {_MOST_NAMES} names")
        table[name] = value

    def set_number(self, index: int, value: float | None) -> None:
        """Sets #index; None makes it vacant."""
        if self._second_names:
            index = self._first_name(index)
        if 0 < index <= self._language.locals:
            table = self._locals[-1]
        elif self._is_common(index):
            table = self._common
        elif index == 0:
            raise EvaluationError("read-only-variable", "#0 cannot be set", "a variable that can be written")
        else:
            self._control.write(index, value)
            return
        if value is None:
            table.pop(index, None)
        else:
            table[index] = value
