"""Random impacts, frictional ones included: none adds energy, and momentum passes from one body to the other.

`python -m tests.rigid.random_impacts [--impacts N] [--seed S]` runs a million of them, and exits with 1 if one does.
"""

import argparse
import sys
from collections.abc import Sequence
from math import cos, pi, sin, sqrt
from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from avatarsim.jit.kernel import kernel
from avatarsim.rigid.contacts import Contacts, Masses, add_contact, make_contacts, weigh
from avatarsim.rigid.impacts import fastest_approach, resolve_impact
from avatarsim.spatial.vec3 import Vec3, add, cross, row, unit
from tests.progress_bar import bar

Array = NDArray[np.float64]

ROUNDING = 1e-12
"""Gain or drift of one impact, relative to the total before it, that counts as rounding."""
AT_A_TIME = 5_000
"""Meetings of two bodies whose random numbers are drawn together."""
DRAWN = 52
"""Random numbers from 0 to 1 of a meeting."""
MOST = 8
"""Impacts of one meeting; several points answer each other."""
APPROACHES = -1e-9
"""Normal velocity [m/s] below which a point still has an impact; bodies meet at about 1."""
POINTS = 4


class Meeting(NamedTuple):
    """Two bodies: linear, angular (2, 3) and the same before; places (2, 3); inertia (2, 3, 3); members (2); `sums` old, new (9).

    Working memory of the solver: before, direction (POINTS, 3), received (2, 3).
    """

    linear: Array
    angular: Array
    linear_before: Array
    angular_before: Array
    places: Array
    inertia: Array
    members: NDArray[np.int64]
    old: Array
    new: Array
    before: Array
    direction: Array
    received: Array


def a_meeting() -> Meeting:
    """Return room for one."""
    a, b, c, d, e = (np.zeros((2, 3)) for _ in range(5))
    rest = np.zeros(9), np.zeros(9), np.zeros((POINTS, 3)), np.zeros((POINTS, 3)), np.zeros((2, 3))
    return Meeting(a, b, c, d, e, np.zeros((2, 3, 3)), np.arange(2), *rest)


@kernel
def normals(u: Array, first: int) -> Vec3:
    """Return three independent normal numbers from four uniform ones (Box and Muller)."""
    near, far = sqrt(-2.0 * np.log(1.0 - u[first])), sqrt(-2.0 * np.log(1.0 - u[first + 2]))
    return near * cos(2.0 * pi * u[first + 1]), near * sin(2.0 * pi * u[first + 1]), far * cos(2.0 * pi * u[first + 3])


@kernel
def weigh_box(u: Array, first: int, b: int, mass: float, masses: Masses, inertia_out: Array) -> None:
    """A box of random edges, turned anyhow: its inertia (3, 3) [kg m^2] and the inverse of it."""
    square = (0.01 + u[first], 0.01 + u[first + 1], 0.01 + u[first + 2])
    x = unit(normals(u, first + 3))
    y = unit(cross(x, normals(u, first + 7)))
    axes = (x, y, cross(x, y))
    masses.inverse_mass[b] = 1.0 / mass
    for i in range(3):
        for k in range(3):
            inertia_out[i, k] = masses.inverse_inertia[b, i, k] = 0.0
    for j in range(3):
        moment = mass * (square[(j + 1) % 3] + square[(j + 2) % 3]) / 12.0
        for i in range(3):
            for k in range(3):
                inertia_out[i, k] += moment * axes[j][i] * axes[j][k]
                masses.inverse_inertia[b, i, k] += axes[j][i] * axes[j][k] / moment


@kernel
def sums(masses: Masses, inertia: Array, places: Array, linear: Array, angular: Array, out: Array) -> None:
    """Kinetic energy, momentum, angular momentum about the origin, and the sizes of the last two: out (9)."""
    out[:] = 0.0
    for b in range(2):
        if masses.inverse_mass[b] == 0.0:
            continue
        m = 1.0 / masses.inverse_mass[b]
        v, w = row(linear, b), row(angular, b)
        spin = (
            inertia[b, 0, 0] * w[0] + inertia[b, 0, 1] * w[1] + inertia[b, 0, 2] * w[2],
            inertia[b, 1, 0] * w[0] + inertia[b, 1, 1] * w[1] + inertia[b, 1, 2] * w[2],
            inertia[b, 2, 0] * w[0] + inertia[b, 2, 1] * w[1] + inertia[b, 2, 2] * w[2],
        )
        orbit = cross(row(places, b), (m * v[0], m * v[1], m * v[2]))
        for i in range(3):
            out[0] += 0.5 * (m * v[i] * v[i] + w[i] * spin[i])
            out[1 + i] += m * v[i]
            out[4 + i] += orbit[i] + spin[i]
            out[7] += m * abs(v[i])
            out[8] += abs(orbit[i]) + abs(spin[i])


@kernel
def meet(drawn: Array, contacts: Contacts, masses: Masses, meeting: Meeting, worst_out: Array) -> tuple[int, int, int]:
    """Two bodies per row of `drawn`, touching at up to POINTS points; impacts, those that were guarded, those with friction.

    worst_out (3): largest gain of energy relative to that before, of momentum and of angular momentum over their sizes.
    """
    linear, angular, linear_before, angular_before, places, inertia, members, old, new, before, direction, received = meeting
    impacts = guarded = rough = 0
    for case in range(drawn.shape[0]):
        u = drawn[case]
        fixed = u[0] < 0.25
        weigh_box(u, 2, 0, 10.0 ** (6.0 * u[1] - 3.0), masses, inertia[0])
        weigh_box(u, 13, 1, 1.0, masses, inertia[1])
        if fixed:
            masses.inverse_mass[1] = 0.0
            masses.inverse_inertia[1, :, :] = 0.0
        n = unit(normals(u, 24))
        apart, velocity = normals(u, 28), normals(u, 32)
        for i in range(3):
            places[0, i], places[1, i] = 0.0, apart[i]
            linear[0, i], linear[1, i] = velocity[i], 0.0
        spin_a, spin_b = normals(u, 36), normals(u, 40)
        for i in range(3):
            angular[0, i], angular[1, i] = 3.0 * spin_a[i], 0.0 if fixed else 3.0 * spin_b[i]
        contacts.used[0] = 0
        restitution, friction = max(0.0, 1.4 * u[44] - 0.2), max(0.0, 2.0 * u[45] - 0.5)
        for k in range(1 + int(POINTS * u[46] * 0.999)):
            arm = (u[47] - 0.5 + 0.3 * (k % 2), u[48] - 0.5 + 0.3 * (k // 2), u[49] - 0.5 + 0.1 * k * u[50])
            add_contact(contacts, 0, 1, 0, n, arm, add(arm, (-apart[0], -apart[1], -apart[2])), 0.0)
            contacts.restitution[k], contacts.friction[k] = min(1.0, restitution), friction
        weigh(contacts, masses)
        sums(masses, inertia, places, linear, angular, old)
        for _ in range(MOST):
            head, fastest = fastest_approach(contacts, linear, angular)
            if fastest >= APPROACHES:
                break
            shortened, _, _ = resolve_impact(
                contacts, masses, members, head, fastest, False, True, linear, angular, linear_before, angular_before, before,
                direction, received,
            )
            impacts += 1
            guarded += int(shortened)
            rough += int(friction > 0.0)
            sums(masses, inertia, places, linear, angular, new)
            worst_out[0] = max(worst_out[0], (new[0] - old[0]) / old[0])
            for i in range(3):
                if not fixed:
                    worst_out[1] = max(worst_out[1], abs(new[1 + i] - old[1 + i]) / (old[7] + new[7]))
                    worst_out[2] = max(worst_out[2], abs(new[4 + i] - old[4 + i]) / (old[8] + new[8]))
            for i in range(9):
                old[i] = new[i]
    return impacts, guarded, rough


def run(impacts: int, seed: int) -> tuple[list[int], Array]:
    """At least so many impacts: (how many, those shortened by the energy guard, those with friction), and the worst of `meet`."""
    rng, worst = np.random.default_rng(seed), np.zeros(3)
    contacts, masses, meeting = make_contacts(POINTS), Masses(np.zeros(2), np.zeros((2, 3, 3))), a_meeting()
    total = [0, 0, 0]
    with bar(impacts, "impact") as shown:
        while total[0] < impacts:
            found = meet(rng.random((AT_A_TIME, DRAWN)), contacts, masses, meeting, worst)
            total = [a + b for a, b in zip(total, found, strict=True)]
            shown.update(found[0])
    return total, worst


def main(argv: Sequence[str] | None = None) -> int:
    """Run, print, and return 1 if any impact added energy or lost momentum."""
    parser = argparse.ArgumentParser(prog="python -m tests.rigid.random_impacts", description=str(__doc__).splitlines()[0])
    parser.add_argument("--impacts", type=int, default=1_000_000, metavar="N", help="how many (default: a million)")
    parser.add_argument("--seed", type=int, default=1, metavar="N", help="of the random numbers (default: 1)")
    asked = parser.parse_args(argv)
    (impacts, guarded, rough), worst = run(asked.impacts, asked.seed)
    print(f"{impacts} impacts, {rough} with friction, {guarded} shortened because Newton's law would have added energy;")
    print("largest gain of energy {:.1e} of what there was, drift of momentum {:.1e}, of angular momentum {:.1e}".format(*worst))
    return 0 if (worst <= ROUNDING).all() else 1


if __name__ == "__main__":
    sys.exit(main())
