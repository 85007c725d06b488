"""The body that a force acts on."""

from __future__ import annotations

from typing import Literal, TypeAlias

ForceOn: TypeAlias = Literal["tool", "workpiece"]
