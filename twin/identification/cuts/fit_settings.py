"""Settings of the fit of coefficients: the table ``[fit]`` of a file of test cuts, and the options of its command."""

from __future__ import annotations

from typing import Annotated, Literal, TypeAlias

from pydantic import Field, Strict

from twin.settings.table import Key, Table

Name: TypeAlias = Literal["Ktc", "Kte", "Krc", "Kre", "Kac", "Kae"]
Method: TypeAlias = Literal["mean", "iterative", "waveform"]
Texts: TypeAlias = Annotated[tuple[str, ...], Strict(False)]


class Fit(Table):
    """Method and weights of the fit."""

    method: Method = Field(
        default="mean",
        description="method: mean (least squares on mean forces), iterative (search by simulation), or waveform",
    )
    holdout: Annotated[Texts, Key(metavar="NAME", unset="none")] = Field(
        default=(), description="name of a cut to keep out of the fit; its errors are reported"
    )
    weights: Literal["errors", "equal"] = Field(
        default="errors", description="weight the means by their standard errors, or equally"
    )
    fixed: dict[Name, float] = Field(default_factory=dict, description="coefficients to hold at given values")
    start: dict[Name, float] = Field(default_factory=dict, description="starting values of the iterative search")
    lower: dict[Name, float] = Field(default_factory=dict, description="lower bounds of the iterative search")
    upper: dict[Name, float] = Field(default_factory=dict, description="upper bounds of the iterative search")
    runout: bool = Field(default=False, description="find the runout too (waveform)")
    harmonics: Annotated[int | None, Key(unset="12 per tooth, at most 60")] = Field(
        default=None,
        ge=1,
        le=400,
        description="number of harmonics of the spindle frequency (waveform)",
    )
    lowpass_hz: Annotated[float | None, Key(unset="none")] = Field(
        default=None, gt=0.0, description="highest frequency to compare, Hz (waveform)"
    )
    speed: Literal["found", "given"] = Field(
        default="found",
        description="spindle speed of a log: found in the log within 1 % of the given speed, or as given",
    )
    source: Annotated[str | None, Key(unset="none")] = Field(
        default=None, min_length=1, pattern=r"\S", description="source to write with the coefficients"
    )
