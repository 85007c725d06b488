"""The tolerances of geometry and physics in one value, each with its reason."""

from __future__ import annotations

from dataclasses import dataclass

#: Clearance of bodies that must not touch the stock, at slice pitches from 0.05 to 0.55 mm.
_CLEARANCE_MM = 0.005


@dataclass(frozen=True, slots=True, kw_only=True)
class Tolerance:
    """Tolerances of geometry and physics; lengths scale with the slice pitch, so that scaled parts behave alike.

    Attributes:
        chord_mm: largest distance between a polygon's chord and the curve that it approximates. Tools are enlarged by
            this much, so that their polygons are circumscribed and no point of the tool's surface stays in material.
        depth_mm: depth inside a swept volume from which a point counts as removed; hides rounding on its surface.
        gate: least n.f (cosine between edge normal and feed) that counts as the front of the tool; hides rounding at 0.
        chip: least uncut chip thickness, relative to the feed per tooth, that makes a chip and an edge force.
        contact_mm3: volume of material that a body less its clearance must sweep for a collision; hides what the chords
            of a section leave at its kinks.
        clearance_mm: how deep a shank, a holder, or a cutting part that must not cut may be in the material without a
            collision, so that a tool may go along a surface that it made, whatever the chords of that surface.
        join_mm: how far the ends of short feed motions may be off the line that replaces them; less than the clearance,
            and more than the rounding of coordinates to 0.001 mm at usual pitches.
    """

    chord_mm: float
    depth_mm: float
    gate: float = 1e-6
    chip: float = 1e-12
    contact_mm3: float
    clearance_mm: float
    join_mm: float

    @classmethod
    def for_pitch(cls, pitch_mm: float) -> Tolerance:
        """The values used for slices at a pitch: 0.5 um chords at 0.1 mm."""
        return cls(
            chord_mm=0.005 * pitch_mm,
            depth_mm=1e-6 * pitch_mm,
            contact_mm3=0.1 * pitch_mm**3,
            join_mm=0.02 * min(pitch_mm, 0.1),
            clearance_mm=max(min(_CLEARANCE_MM, 0.1 * pitch_mm), 0.009 * pitch_mm),
        )
