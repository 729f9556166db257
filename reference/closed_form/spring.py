"""The spring and damper of eq. 6, m x'' = -K x - R x', and the exponential return of coach and trainee."""

from math import cos, cosh, exp, inf, pi, sin, sinh, sqrt


def damping_ratio(mass: float, spring: float, damping: float) -> float:
    """R / (2 sqrt(K m)): below 1 it swings over, at 1 it is critical."""
    return damping / (2.0 * sqrt(spring * mass))


def spring_state(offset: float, velocity: float, mass: float, spring: float, damping: float, time: float) -> tuple[float, float]:
    """Offset [m] and velocity [m/s] after `time` [s], from their first values; K [N/m], R [N s/m].

    With a = R / 2m and b^2 = a^2 - K/m: e^(-a t) (x0 C + (v0 + a x0) S), C and S = cosh b t, sinh(b t) / b or their
    circular or linear twins.
    """
    decay = damping / (2.0 * mass)
    square = decay * decay - spring / mass
    rate = sqrt(abs(square))
    # below, sinh(b t) / b and t agree to all digits
    if rate * time < 1e-9:
        even, odd = 1.0, time
    elif square < 0.0:
        even, odd = cos(rate * time), sin(rate * time) / rate
    else:
        even, odd = cosh(rate * time), sinh(rate * time) / rate
    fade = exp(-decay * time)
    rise = velocity + decay * offset
    # C' = b^2 S and S' = C
    return (
        fade * (offset * even + rise * odd),
        fade * (offset * square * odd + rise * even) - decay * fade * (offset * even + rise * odd),
    )


def spring_overshoot(mass: float, spring: float, damping: float) -> float:
    """Largest swing beyond the goal relative to the first offset, released from rest; 0 from critical damping on."""
    ratio = damping_ratio(mass, spring, damping)
    return exp(-pi * ratio / sqrt(1.0 - ratio * ratio)) if ratio < 1.0 else 0.0


def spring_stable_step(mass: float, spring: float, damping: float) -> float:
    """Longest step [s] at which semi-implicit Euler does not grow: (sqrt(R^2 + 4 K m) - R) / K."""
    return (sqrt(damping * damping + 4.0 * spring * mass) - damping) / spring


def coach_offset(offset: float, time: float, time_constant: float) -> float:
    """Offset between trainee and a coach at rest after `time` [s], if its rate is -offset / time_constant."""
    return offset * exp(-time / time_constant)


def coach_steady_offset(speed: float, time_constant: float) -> float:
    """Offset that stays when the coach moves at a constant `speed`: what the trainee lags behind, speed * tau."""
    return speed * time_constant if time_constant < inf else inf
