"""The tolerances of geometry and physics in one value, each with its reason."""

from __future__ import annotations

from dataclasses import dataclass


@dataclass(frozen=True, slots=True, kw_only=True)
class Tolerance:
    """Tolerances of geometry and physics; lengths scale with the slice pitch, so that scaled parts behave alike.

    Attributes:
        chord_mm: largest distance between a polygon's chord and the curve that it approximates. Tools are enlarged by
            this much, so that their polygons are circumscribed and no point of the tool's surface stays in material.
        depth_mm: depth inside a swept volume from which a point counts as removed; hides rounding on its surface.
        gate: least n.f (cosine between edge normal and feed) that counts as the front of the tool; hides rounding at 0.
        chip: least uncut chip thickness, relative to the feed per tooth, that makes a chip and an edge force.
        contact_mm3: volume of material that a body must sweep for a collision.
        clearance_mm: reduction of the radius of shank and holder, so that a shank of the cutter's own diameter may rub
            along the wall that the cutter made.

    """

    chord_mm: float
    depth_mm: float
    gate: float = 1e-6
    chip: float = 1e-12
    contact_mm3: float
    clearance_mm: float

    @classmethod
    def for_pitch(cls, pitch_mm: float) -> Tolerance:
        """The values used for slices at a pitch: 0.5 um chords at 0.1 mm."""
        return cls(
            chord_mm=0.005 * pitch_mm,
            depth_mm=1e-6 * pitch_mm,
            contact_mm3=pitch_mm**3,
            clearance_mm=0.1 * pitch_mm,
        )
