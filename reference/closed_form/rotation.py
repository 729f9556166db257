"""Free rotation of a body with three different moments: Euler's equations solved by Jacobi's elliptic functions."""

from math import asin, sqrt

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
