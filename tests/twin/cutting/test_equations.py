"""Equations 2 to 4 of the tri-slice paper, one by one."""

from __future__ import annotations

import numpy as np
import pytest

from twin.cutting.equation_kernels import (
    Coefficients,
    EdgeForce,
    edge_force,
    normal_along_feed,
    to_machine_axes,
    uncut_chip_thickness,
)

ANGLES = [(theta, kappa) for theta in np.radians([0.0, 37.0, 90.0, 200.0]) for kappa in np.radians([0.0, 25.0, 90.0])]


def test_edge_force_has_a_part_per_chip_area_and_a_part_per_edge_length() -> None:
    k = Coefficients(Ktc=1000.0, Kte=10.0, Krc=300.0, Kre=20.0, Kac=50.0, Kae=1.0)
    assert edge_force(k, 0.1, 2.0) == pytest.approx((220.0, 100.0, 12.0))
    assert edge_force(k, 0.0, 2.0) == pytest.approx((20.0, 40.0, 2.0))


@pytest.mark.parametrize(("theta", "kappa"), ANGLES)
def test_chip_thickness_is_the_feed_along_the_normal(theta: float, kappa: float) -> None:
    normal = np.array([np.cos(theta) * np.sin(kappa), np.sin(theta) * np.sin(kappa), -np.cos(kappa)])
    feed = np.array([0.6, 0.48, -0.64])
    across = float(np.cos(theta) * feed[0] + np.sin(theta) * feed[1])
    n_dot_f = normal_along_feed(across, float(feed[2]), float(np.sin(kappa)), float(np.cos(kappa)))
    assert n_dot_f == pytest.approx(float(normal @ feed), abs=1e-15)
    assert uncut_chip_thickness(0.05, n_dot_f, 0.0) == pytest.approx(0.05 * float(normal @ feed))
    assert uncut_chip_thickness(0.05, n_dot_f, 0.01) == pytest.approx(0.05 * float(normal @ feed) + 0.01)


@pytest.mark.parametrize(("theta", "kappa"), ANGLES)
@pytest.mark.parametrize("sense", [1.0, -1.0])
def test_machine_axes_are_orthonormal_with_the_tangential_force_against_the_velocity(
    theta: float, kappa: float, sense: float
) -> None:
    angles = (float(np.cos(theta)), float(np.sin(theta)), float(np.cos(kappa)), float(np.sin(kappa)))
    columns = [to_machine_axes(EdgeForce(*row), sense, *angles) for row in np.eye(3).tolist()]
    matrix = np.array(columns).T
    assert matrix.T @ matrix == pytest.approx(np.eye(3), abs=1e-15)
    assert np.linalg.det(matrix) == pytest.approx(-sense)
    # the tool pushes the chip along its velocity, so the force on the tool is against it: M3 turns clockwise
    assert matrix[:, 0] == pytest.approx(sense * np.array([-np.sin(theta), np.cos(theta), 0.0]))
    # the radial force points inwards, against the outward normal
    assert matrix[:, 1] == pytest.approx(
        -np.array([np.cos(theta) * np.sin(kappa), np.sin(theta) * np.sin(kappa), -np.cos(kappa)])
    )
