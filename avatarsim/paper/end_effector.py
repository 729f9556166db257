"""End effector and goal of a link that overlaps (Schmidl and Lin 2004, eqs 2 and 3)."""

from avatarsim.jit.kernel import kernel
from avatarsim.spatial.vec3 import Rows, Vec3, along, row, scale


@kernel
def end_effector(contacts: Rows, count: int) -> Vec3:
    """Eq. (2): ee_i = sum_l c_il / k, the mean of the first ``count`` >= 1 contacts (n, 3) on link i [m]."""
    total = (0.0, 0.0, 0.0)
    for k in range(count):
        total = along(total, 1.0, row(contacts, k))
    return scale(total, 1.0 / count)


@kernel
def goal_of(effector: Vec3, depth: Vec3, link_is_a: bool) -> Vec3:
    """Eq. (3): goal_i = ee_i + PD_gi if link i is A of its pair, ee_i - PD_gi if it is B [m]: PD_g points out of B into A."""
    return along(effector, 1.0 if link_is_a else -1.0, depth)
