"""Coefficients of an oblique edge, against values of the published equations."""

from __future__ import annotations

import math

import pytest

from twin.materials.oblique import Orthogonal, oblique_coefficients


@pytest.mark.parametrize(
    ("angles", "expected"),
    [
        ((33.067, 19.1, 0.0, 30.0, 30.0), (1845.1, 661.4, 624.3)),
        ((33.067, 19.1, 0.0, 0.0, 0.0), (1730.9, 599.4, 0.0)),
        ((39.028, 22.58, 12.0, 30.0, 30.0), (1579.1, 301.3, 491.6)),
    ],
)
def test_titanium(angles: tuple[float, ...], expected: tuple[float, float, float]) -> None:
    assert oblique_coefficients(613.0, *angles) == pytest.approx(expected, abs=0.06)


def test_without_inclination_they_are_those_of_orthogonal_cutting() -> None:
    phi, beta, alpha = (math.radians(angle) for angle in (30.0, 25.0, 5.0))
    resultant = 500.0 / (math.sin(phi) * math.cos(phi + beta - alpha))
    found = oblique_coefficients(500.0, 30.0, 25.0, 5.0, 0.0, 0.0)
    assert found == pytest.approx((resultant * math.cos(beta - alpha), resultant * math.sin(beta - alpha), 0.0))


def test_the_friction_angle_is_projected_on_the_normal_plane() -> None:
    tests = Orthogonal(
        shear_stress_mpa=613.0, shear_angle_deg=39.03, friction_angle_deg=22.58, rake_deg=12.0, helix_deg=30.0
    )
    normal = math.degrees(math.atan(math.tan(math.radians(22.58)) * math.cos(math.radians(30.0))))
    assert tests.coefficients() == pytest.approx(oblique_coefficients(613.0, 39.03, normal, 12.0, 30.0, 30.0), abs=0.06)
