"""Free rotation of a body with three different moments by Jacobi's elliptic functions; precession of a spinning top."""

from math import asin, cos, pi, sqrt

from scipy.integrate import quad
from scipy.special import ellipk, ellipkinc

Triple = tuple[float, float, float]


def flip_times(moments: Triple, spin: Triple, until: float) -> tuple[float, ...]:
    """Times [s] up to `until` at which the spin about the middle axis of a free body is zero.

    `moments` [kg m^2] are principal and all different, `spin` [rad/s] is the first angular velocity about the body's own axes.
    With the axis K that keeps its sign (the one of largest moment if L^2 > 2 E I_mid, else of the smallest) and C the third,
    w_mid = B sn(p t + phase, m), B^2 = (L^2 - 2 E I_K) / (I_mid (I_mid - I_K)), and D^2 = B^2 / m the same with C for K.
    """
    low, mid, high = sorted(range(3), key=lambda axis: moments[axis])
    energy_twice = sum(i * w * w for i, w in zip(moments, spin, strict=True))
    square = sum((i * w) ** 2 for i, w in zip(moments, spin, strict=True))
    keeps, other = (high, low) if square > energy_twice * moments[mid] else (low, high)

    def most(axis: int, without: int) -> float:
        """Spin about `axis` at which that about `without`'s partner vanishes."""
        part = square - energy_twice * moments[without]
        return sqrt(part / (moments[axis] * (moments[axis] - moments[without])))

    swing, beyond = most(mid, keeps), most(mid, other)
    rate = (moments[high] - moments[low]) / moments[mid] * most(keeps, other) * most(other, keeps) / swing
    parameter = (swing / beyond) ** 2
    quarter = float(ellipk(parameter))
    phase = float(ellipkinc(asin(max(-1.0, min(1.0, spin[mid] / swing))), parameter))
    ahead, behind = (mid + 1) % 3, (mid + 2) % 3
    if (moments[ahead] - moments[behind]) * spin[ahead] * spin[behind] < 0.0:
        phase = 2.0 * quarter - phase
    found, n = [], 0
    while (time := (2.0 * n * quarter - phase) / rate) <= until:
        if time >= 0.0:
            found.append(time)
        n += 1
    return tuple(found)


def top_precession(across: float, along: float, mass: float, reach: float, spin: float, lean: float, gravity: float) -> float:
    """Mean rate [rad/s] at which the axis of a top on a smooth plane goes round the vertical.

    The top is let go at `lean` [rad] with `spin` [rad/s] about its own axis and no other turn. `across` and `along` are its
    moments [kg m^2] about its centre of mass, at right angles to the axis and about it; `reach` [m] from the tip to that centre.
    Its spin C w3, its angular momentum about the vertical and its energy stay: with u the cosine of the lean and u0 the first,
    A (1 - u^2) phi' = C w3 (u0 - u) and (A + m l^2 (1 - u^2)) theta'^2 = 2 m g l (u0 - u) - (C w3 (u0 - u))^2 / (A (1 - u^2)).
    It nods between u0 and the root of the latter, and the mean is over one nod.
    """
    first, weight, turn = cos(lean), mass * gravity * reach, along * spin
    stiff = turn * turn / (2.0 * across * weight)
    lowest = 0.5 * (stiff - sqrt(stiff * stiff - 4.0 * (stiff * first - 1.0)))
    middle, half = 0.5 * (first + lowest), 0.5 * (first - lowest)

    def per_swing(s: float, rate: bool) -> float:
        """Time, or angle of precession, by the phase s of the nod, u = middle + half cos s, with both its ends divided out:
        (u0 - u) (u - lowest) is (half sin s)^2, and so is (du/ds)^2."""
        u = middle + half * cos(s)
        square = 1.0 - u * u
        inertia = across + mass * reach * reach * square
        time = sqrt(inertia / (2.0 * weight * (stiff - lowest - u)))
        return time * turn * (first - u) / (across * square) if rate else time

    return float(quad(per_swing, 0.0, pi, args=(True,))[0] / quad(per_swing, 0.0, pi, args=(False,))[0])
