"""Normal impulse of a collision with restitution (eq. 9; Newton's law of restitution)."""

from avatarsim.jit.kernel import kernel
from avatarsim.spatial.tangent import Columns, turned
from avatarsim.spatial.vec3 import Vec3, cross, dot


@kernel
def turning_term(inverse_inertia: Columns, arm: Vec3, n: Vec3) -> float:
    """A or B of eq. 9 [1/kg]: n . ((I^-1 (r x n)) x r), the rotational part of the inverse effective mass.

    ``inverse_inertia`` is in world axes; all zero for a body that cannot turn.
    """
    return dot(n, cross(turned(inverse_inertia, cross(arm, n)), arm))


@kernel
def collision_impulse(
    restitution: float, before: float, inverse_mass_a: float, inverse_mass_b: float, turning_a: float, turning_b: float
) -> float:
    """Eq. 9: j = -(1 + e) v- / (1/m_b + 1/m_a + A + B) [N s]; j n acts on A and -j n on B.

    Not finite if neither body can yield; such pairs are never tested.
    """
    return -(1.0 + restitution) * before / (inverse_mass_b + inverse_mass_a + turning_a + turning_b)
