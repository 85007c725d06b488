"""Cutting coefficients of an oblique edge from orthogonal cutting tests (Budak, Altintas, Armarego)."""

from __future__ import annotations

import math

from pydantic import Field

from twin.settings.table import Table


class Orthogonal(Table):
    """Results of orthogonal cutting tests, and the edge to which they are applied.

    Attributes:
        shear_stress_mpa: yield shear stress in the shear plane.
        shear_angle_deg: angle of the shear plane, equal to the normal shear angle of the oblique edge.
        friction_angle_deg: angle of friction on the rake face, measured in orthogonal cutting.
        rake_deg: normal rake angle.
        helix_deg: helix angle of the tool, the angle of inclination of its edge.
    """

    shear_stress_mpa: float = Field(gt=0.0)
    shear_angle_deg: float = Field(gt=0.0, lt=90.0)
    friction_angle_deg: float = Field(gt=0.0, lt=90.0)
    rake_deg: float = Field(gt=-45.0, lt=45.0)
    helix_deg: float = Field(ge=0.0, lt=90.0)

    def coefficients(self) -> tuple[float, float, float]:
        """Ktc, Krc, Kac in N/mm2, rounded to 0.1.

        The chip flows at the angle of inclination (Stabler); the coefficient of friction is that of orthogonal cutting,
        so that the normal friction angle is atan(tan(beta) cos(eta)).
        """
        inclination = math.radians(self.helix_deg)
        normal = math.degrees(math.atan(math.tan(math.radians(self.friction_angle_deg)) * math.cos(inclination)))
        found = oblique_coefficients(
            self.shear_stress_mpa, self.shear_angle_deg, normal, self.rake_deg, self.helix_deg, self.helix_deg
        )
        ktc, krc, kac = (round(value, 1) for value in found)
        return ktc, krc, kac


def oblique_coefficients(
    shear_stress_mpa: float,
    shear_deg: float,
    friction_deg: float,
    rake_deg: float,
    inclination_deg: float,
    chip_flow_deg: float,
) -> tuple[float, float, float]:
    """Coefficients of an oblique edge (E. Budak, Y. Altintas, E. J. A. Armarego 1996).

        Ktc = tau / sin(phi) (cos(beta - alpha) + tan(i) tan(eta) sin(beta)) / c
        Krc = tau / (sin(phi) cos(i)) sin(beta - alpha) / c
        Kac = tau / sin(phi) (cos(beta - alpha) tan(i) - tan(eta) sin(beta)) / c
        c   = sqrt(cos(phi + beta - alpha)^2 + tan(eta)^2 sin(beta)^2)

    Args:
        shear_stress_mpa: tau.
        shear_deg, friction_deg, rake_deg: phi, beta, alpha in the plane normal to the edge.
        inclination_deg, chip_flow_deg: i, eta.

    Returns:
        Ktc, Krc, Kac in N/mm2, positive as in a job's ``[cutting]`` table.
    """
    phi, beta, alpha = (math.radians(angle) for angle in (shear_deg, friction_deg, rake_deg))
    tan_i, tan_eta = math.tan(math.radians(inclination_deg)), math.tan(math.radians(chip_flow_deg))
    c = math.hypot(math.cos(phi + beta - alpha), tan_eta * math.sin(beta))
    stress = shear_stress_mpa / (math.sin(phi) * c)
    return (
        stress * (math.cos(beta - alpha) + tan_i * tan_eta * math.sin(beta)),
        stress * math.sin(beta - alpha) / math.cos(math.radians(inclination_deg)),
        stress * (math.cos(beta - alpha) * tan_i - tan_eta * math.sin(beta)),
    )
