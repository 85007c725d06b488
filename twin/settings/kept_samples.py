"""The force samples that an archive keeps."""

from __future__ import annotations

from typing import Literal, TypeAlias

#: All of them; only the lowest, highest and mean values of each spindle revolution; or those of steps that cut.
KeptSamples: TypeAlias = Literal["all", "revolution", "cutting"]
