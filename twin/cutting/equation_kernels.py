"""Equations 2 to 4 of the tri-slice paper (Kaneko et al.), corrected; compiled.

theta is the angle of an edge point counter-clockwise from +x, kappa the angle between the edge's outward normal and the
tool axis: 0 at a ball's tip, 90 degrees on a cylinder.
"""

from __future__ import annotations

from typing import NamedTuple

from twin.jit import njit


class Coefficients(NamedTuple):
    """Cutting coefficients: per chip area (c), N/mm2, and per edge length (e), N/mm.

    The exponents mt, mr, ma are 0 in the linear law; under Kienzle's law the coefficients per chip area are those of a
    chip of 1 mm.
    """

    Ktc: float
    Kte: float
    Krc: float
    Kre: float
    Kac: float
    Kae: float
    mt: float = 0.0
    mr: float = 0.0
    ma: float = 0.0


class EdgeForce(NamedTuple):
    """Force of a short piece of edge, N: along the cutting velocity, inwards along the normal, and along the edge."""

    tangential: float
    radial: float
    axial: float


@njit
def edge_force(k: Coefficients, chip: float, db: float) -> EdgeForce:
    """Force of a piece of edge (tri-slice paper, eq. 2, which prints Kre for Kte).

        dF_t = (Ktc h + Kte) db    dF_r = (Krc h + Kre) db    dF_a = (Kac h + Kae) db

    Args:
        chip: uncut chip thickness h, mm.
        db: length of the piece along the meridian, mm: dz / sin(kappa) where that is finite.
    """
    return EdgeForce((k.Ktc * chip + k.Kte) * db, (k.Krc * chip + k.Kre) * db, (k.Kac * chip + k.Kae) * db)


@njit
def kienzle_force(k: Coefficients, chip: float, db: float) -> EdgeForce:
    """Force of a piece of edge under Kienzle's law, kc = kc1.1 h^-m, with edge terms.

        dF_t = (Ktc h^(1 - mt) + Kte) db    dF_r = (Krc h^(1 - mr) + Kre) db    dF_a = (Kac h^(1 - ma) + Kae) db

    Args:
        chip: uncut chip thickness h, above 0, mm.
        db: as in `edge_force`.
    """
    return EdgeForce(
        (k.Ktc * chip ** (1.0 - k.mt) + k.Kte) * db,
        (k.Krc * chip ** (1.0 - k.mr) + k.Kre) * db,
        (k.Kac * chip ** (1.0 - k.ma) + k.Kae) * db,
    )


@njit
def normal_along_feed(across: float, along: float, sin_k: float, cos_k: float) -> float:
    """N . f of an edge point, n = (cos(theta) sin(kappa), sin(theta) sin(kappa), -cos(kappa)).

    Args:
        across: cos(theta) f_x + sin(theta) f_y.
        along: f_z, of the unit feed direction f.
    """
    return across * sin_k - along * cos_k


@njit
def uncut_chip_thickness(feed_per_tooth: float, n_dot_f: float, runout_step_mm: float) -> float:
    """Uncut chip thickness h = s_t (n . f) in mm (tri-slice paper, eq. 3); not above 0 where there is no chip.

    Args:
        feed_per_tooth: s_t, mm.
        n_dot_f: see `normal_along_feed`; plunges and ramps included.
        runout_step_mm: how much farther out along the normal than the earlier tooth this one is, by runout, mm.
    """
    return feed_per_tooth * n_dot_f + runout_step_mm


@njit
def to_machine_axes(
    force: EdgeForce, sense: float, cos_t: float, sin_t: float, cos_k: float, sin_k: float
) -> tuple[float, float, float]:
    """Force on the tool in machine axes x, y, z (tri-slice paper, eq. 4, whose printed matrix is not orthonormal).

        x:  -sin(theta)   -cos(theta) sin(kappa)   -cos(theta) cos(kappa)
        y:   cos(theta)   -sin(theta) sin(kappa)   -sin(theta) cos(kappa)
        z:   0             cos(kappa)              -sin(kappa)

    Args:
        sense: +1 for M3; -1 for M4, which reverses the first column.
    """
    inward = force.radial * sin_k + force.axial * cos_k
    x = -(sense * force.tangential * sin_t + inward * cos_t)
    y = sense * force.tangential * cos_t - inward * sin_t
    return x, y, force.radial * cos_k - force.axial * sin_k
