"""Values of a draft that the program does not state, and contradictions in what it does."""

from __future__ import annotations

from dataclasses import dataclass, field

#: Order of subjects; tools come after these, the resolution last.
_ORDER = {"program": 0, "machine": 1, "stock": 2, "simulation": 4}
_TOOLS = 3


@dataclass(frozen=True, slots=True, kw_only=True)
class Assumption:
    """A value that was not stated and had to be taken.

    Attributes:
        subject: what it is about: ``T3``, ``stock``, ``program``, ``simulation``, ``machine``.
        value: the value in words: ``2 flutes``.
        reason: why this one, or what does not state it.
    """

    subject: str
    value: str
    reason: str

    def __str__(self) -> str:
        return f"{self.value} ({self.subject}: {self.reason})"


@dataclass(slots=True)
class Notes:
    """Assumptions, warnings and open values of one draft, in order.

    Attributes:
        stated: values that comments of the program state, in words, with their lines.
    """

    stated: list[str] = field(default_factory=list)
    assumptions: list[Assumption] = field(default_factory=list)
    warnings: list[str] = field(default_factory=list)
    open: list[str] = field(default_factory=list)

    def assume(self, subject: str, value: str, reason: str) -> None:
        """Note a value that was taken."""
        self.assumptions.append(Assumption(subject=subject, value=value, reason=reason))

    def lines(self) -> list[str]:
        """The assumptions, one line for each subject and reason."""
        groups: dict[tuple[str, str], list[str]] = {}
        for one in sorted(self.assumptions, key=lambda one: _ORDER.get(one.subject, _TOOLS)):
            groups.setdefault((one.subject, one.reason), []).append(one.value)
        return [_line(subject, reason, values) for (subject, reason), values in groups.items()]


def _line(subject: str, reason: str, values: list[str]) -> str:
    reason = reason.removesuffix(" it") + " them" if len(values) > 1 and reason.endswith("state it") else reason
    return f"{', '.join(values)} ({subject}: {reason})"
