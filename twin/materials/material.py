"""One row of the material table, and its part in a job's ``[cutting]``."""

from __future__ import annotations

from typing import Annotated, Any, Literal, TypeAlias

from pydantic import Field, Strict, model_validator

from twin.materials.oblique import Orthogonal
from twin.settings.table import Table

Interval: TypeAlias = Annotated[tuple[float, float], Strict(False)]
Text: TypeAlias = Annotated[str, Field(min_length=1, pattern=r"\S")]
Names: TypeAlias = Annotated[tuple[Text, ...], Strict(False)]
Law: TypeAlias = Literal["linear-edge", "kienzle"]
IsoGroup: TypeAlias = Literal["P", "M", "K", "N", "S", "H"]
Kind: TypeAlias = Literal["published test", "order of magnitude"]
#: Keys of a row that a job's ``[cutting]`` table has too.
CUTTING_KEYS = (
    *("law", "Ktc", "Kte", "Krc", "Kre", "Kac", "Kae", "mt", "mr", "ma"),
    *("source", "chip_range_mm", "speed_range_m_min", "caution"),
)


class Material(Table):
    """Cutting coefficients of one combination of work material and tool, from one source.

    Forces are those of a job's ``[cutting]`` table: positive coefficients give a tangential force that opposes the
    cutting motion, a radial force from the workpiece into the tool, and an axial force towards the tip.

    Attributes:
        name: its name in the table; case, blanks and hyphens do not matter where it is asked for.
        aliases: other names of it.
        family: what kind of material it is, e.g. ``aluminium alloy``.
        iso_group: application group of ISO 513: P steel, M stainless steel, K cast iron, N non-ferrous metals,
            plastics and wood, S superalloys and titanium, H hardened materials.
        kind: ``published test``, or ``order of magnitude`` for a catalogue value by material group.
        law: ``linear-edge`` or ``kienzle``.
        Ktc, Krc, Kac: tangential, radial, axial, per chip area, N/mm2; under Kienzle's law at a chip of 1 mm.
        Kte, Kre, Kae: the same per edge length, N/mm.
        mt, mr, ma: exponents of Kienzle's law.
        source: authors, year, title, and where the numbers are in it.
        chip_range_mm: lowest and highest uncut chip thickness of the tests, mm; None where the source has none.
        speed_range_m_min: lowest and highest cutting speed of the tests, m/min; None where the source has none.
        tool: diameter, teeth, helix, cutting material and coating, as far as the source states them.
        orthogonal: results of orthogonal tests, from which the coefficients per chip area were computed.
        uncertainty: as published.
        note: conversions, assumptions, and whatever else a user of the numbers should know.
        caution: printed with the warnings of every run that uses the row, empty for none.
    """

    name: Text
    aliases: Names = ()
    family: Text
    iso_group: IsoGroup
    kind: Kind = "published test"
    law: Law = "linear-edge"
    Ktc: float = Field(gt=0.0)
    Kte: float
    Krc: float
    Kre: float
    Kac: float
    Kae: float
    mt: float = Field(default=0.0, ge=0.0, lt=1.0)
    mr: float = Field(default=0.0, ge=0.0, lt=1.0)
    ma: float = Field(default=0.0, ge=0.0, lt=1.0)
    source: Text
    chip_range_mm: Interval | None = None
    speed_range_m_min: Interval | None = None
    tool: Text
    orthogonal: Orthogonal | None = None
    uncertainty: Text = "not published"
    note: str = ""
    caution: str = ""

    @model_validator(mode="after")
    def _sound(self) -> Material:
        for key in ("chip_range_mm", "speed_range_m_min"):
            interval = getattr(self, key)
            if interval is not None and not 0.0 <= interval[0] <= interval[1]:
                raise ValueError(f"{key} = {list(interval)}: expected [lowest, highest]")
            if interval is None and not self.caution:
                raise ValueError(f"caution: expected a text for a row without {key}")
        if self.law == "linear-edge" and any((self.mt, self.mr, self.ma)):
            raise ValueError('mt, mr, ma: expected only with law = "kienzle"')
        if self.kind == "order of magnitude" and not self.caution:
            raise ValueError("caution: expected a text for a row that is an order of magnitude")
        return self

    @property
    def names(self) -> tuple[str, ...]:
        """The name and the aliases."""
        return (self.name, *self.aliases)

    def cutting(self) -> dict[str, Any]:
        """The row as a job's ``[cutting]`` table, with ``material``."""
        values = {key: getattr(self, key) for key in CUTTING_KEYS}
        if self.law == "linear-edge":
            values = {key: value for key, value in values.items() if key not in ("law", "mt", "mr", "ma")}
        return {"material": self.name, **{key: value for key, value in values.items() if value not in (None, "")}}
