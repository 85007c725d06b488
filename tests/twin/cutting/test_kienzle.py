"""Kienzle's law in a full slot of a straight-fluted end mill, against the closed form."""

from __future__ import annotations

import math

import numpy as np
import pytest

from twin.cutting.coefficients import CuttingCoefficients
from twin.cutting.engagement import Engager
from twin.cutting.equation_kernels import Coefficients, kienzle_force
from twin.cutting.forces import ForceModel
from twin.motion.sweep import SweptVolume
from twin.tolerance import Tolerance
from twin.tools.edges import cutting_edges
from twin.tools.shape import tool_shape
from twin.workpiece.stock import box_slices
from twin.workpiece.trislice import CellSlices

KC, MC, DEPTH_MM, CHIP_MM = 1775.0, 0.24, 2.0, 0.1
TOLERANCE = Tolerance.for_pitch(0.2)


def test_peak_and_mean_torque_of_a_slot() -> None:
    edges = cutting_edges(tool_shape("flat", 10.0, 10.0), teeth=2, helix_deg=0.0, axial_step_mm=0.2)
    stock = CellSlices(box_slices(np.array((0.0, -8.0, -4.0)), np.array((24.0, 8.0, 0.0)), 0.2))
    engager = Engager(tool_shape("flat", 10.0, 10.0), edges, 360, "majority", TOLERANCE)
    feed = np.array([1.0, 0.0, 0.0])
    engaged = engager.engage(np.array([12.0, 0.0, -DEPTH_MM]), feed, 10.0, CHIP_MM, stock, SweptVolume([]))
    assert engaged is not None
    group = CuttingCoefficients(Ktc=KC, Krc=0.0, Kac=0.0, Kte=0.0, Kre=0.0, Kae=0.0, mt=MC, source="test")
    model = ForceModel(edges, group, 360, TOLERANCE)
    found = model.forces(np.radians(np.arange(360.0) + 0.5), 1, feed, 2.0 * CHIP_MM, engaged)
    torque_nm = found[:, 3] / 1000.0
    # of one tooth at the middle of the slot
    assert torque_nm.max() == pytest.approx(616.919 * 0.005, rel=2e-3)
    integral = math.sqrt(math.pi) * math.gamma(1.0 - MC / 2.0) / math.gamma((3.0 - MC) / 2.0)
    mean = 2 * 0.005 / (2.0 * math.pi) * KC * DEPTH_MM * CHIP_MM ** (1.0 - MC) * integral
    assert mean == pytest.approx(2.12569, rel=1e-5)
    assert torque_nm.mean() == pytest.approx(mean, rel=3e-3)


def test_each_direction_has_its_exponent_and_edges_add() -> None:
    k = Coefficients(Ktc=1000.0, Kte=5.0, Krc=400.0, Kre=4.0, Kac=300.0, Kae=3.0, mt=0.5, mr=0.0, ma=0.25)
    expected = (2.0 * (1000.0 * 0.2 + 5.0), 2.0 * (400.0 * 0.04 + 4.0), 2.0 * (300.0 * 0.04**0.75 + 3.0))
    assert kienzle_force(k, 0.04, 2.0) == pytest.approx(expected)


def test_an_exponent_of_one_is_refused() -> None:
    with pytest.raises(ValueError, match="mt = 1"):
        CuttingCoefficients(Ktc=1.0, Kte=0.0, Krc=0.0, Kre=0.0, Kac=0.0, Kae=0.0, mt=1.0, source="test")
