"""The dumb twin of a projected Gauss-Seidel sweep: one contact after the other."""

import numpy as np

from avatarsim.rigid.solver import change, wanted_friction, wanted_normal


def one_by_one(contacts, masses, order, grip: bool, linear, angular) -> float:
    """Sweep over contacts in that order, normal first, friction if `grip`; returns the largest change of velocity."""
    worst = 0.0
    for k in order:
        if contacts.target[k] == -np.inf:
            continue
        dn = wanted_normal(contacts, k, linear, angular) - contacts.impulse[k, 0]
        change(contacts, masses, k, (dn, 0.0, 0.0), linear, angular)
        worst = max(worst, abs(dn) * contacts.inverse_effective_mass[k, 0])
        if grip and contacts.friction[k] > 0.0:
            x, y = wanted_friction(contacts, k, contacts.impulse[k, 0], linear, angular)
            dx, dy = x - contacts.impulse[k, 1], y - contacts.impulse[k, 2]
            change(contacts, masses, k, (0.0, dx, dy), linear, angular)
            worst = max(worst, (abs(dx) + abs(dy)) * contacts.inverse_effective_mass[k, 1])
    return worst
