"""Newton's restitution: balls fall one metre and bounce with restitution 0 to 1, at frame times from 1/30 to 1/1000 s.

Closed form: impact n at t1 (1 + 2 e (1 - e^(n-1)) / (1 - e)), t1 = sqrt(2 h / g); apex n at e^(2n) h. The same at any frame time.
"""

from avatarsim.scene.body import Body, ContactLaw, fixed, simulated, solid
from avatarsim.scene.scene import Scene
from avatarsim.scene.shape import Box, Piece, Sphere
from scenarios.building.cases import pair_table
from scenarios.building.promises import FINITE, NO_OVERLAP, RIGHT_SIDE
from scenarios.motion.untracked import untracked
from scenarios.scenario import INFINITE, Bound, Drop, Region, Scenario

RESTITUTIONS = (0.0, 0.1, 0.2, 0.3, 0.5, 0.75, 0.9, 1.0)
RADIUS, MASS, HEIGHT = 0.1, 1.0, 1.0
"""Radius [m] and mass [kg] of a ball, height of its lowest point at the start [m]."""
SECONDS, TELLING = 3.0, 0.7
"""Length of the full run, and of a quick one at the finest frame time [s]."""
RATES = (30, 60, 240, 1000)
"""Frames per second."""
DROPS = tuple(Drop(f"ball_{e:g}", "floor", e, HEIGHT) for e in RESTITUTIONS)


def build(name: str) -> Scene:
    """Eight balls in a row, each of a material of its own, over one floor."""
    bodies: list[Body] = [fixed("floor", (Piece(Box((10.0, 2.0, 0.2))),), "floor", (0.0, 0.0, -0.1))]
    pieces = (Piece(Sphere(RADIUS)),)
    for k, drop in enumerate(DROPS):
        at = (k - 3.5, 0.0, RADIUS + HEIGHT)
        bodies.append(simulated(drop.ball, pieces, f"e_{drop.restitution:g}", solid(pieces, MASS), at))
    stated = {(f"e_{e:g}", "floor"): ContactLaw(e, 0.3) for e in RESTITUTIONS}
    names = ["floor", *(f"e_{e:g}" for e in RESTITUTIONS)]
    return Scene(name, tuple(bodies), materials=pair_table(names, stated))


def at_rate(rate: int) -> Scenario:
    """The ladder at so many frames per second."""
    name = "bounce_ladder" if rate == 60 else f"bounce_ladder_{rate}"
    frames = round(SECONDS * rate)
    return Scenario(
        name=name,
        title=f"Eight balls fall one metre and bounce with restitution 0 to 1, at {rate} frames per second.",
        judged="Restitution, time and apex of every bounce.",
        build=lambda: build(name),
        motion=untracked(1.0 / rate),
        frames=frames,
        short=min(frames, max(90, round(TELLING * rate))),
        dt=1.0 / rate,
        bounds=(
            NO_OVERLAP, RIGHT_SIDE, FINITE,
            Bound("restitution_error_max", 1e-6, "eq. 8 fixes v+/v- at every impact"),
            Bound("bounce_time_error_max", 1e-6, "impacts happen when balls arrive, not when frames end; each is 2e-8 m early"),
            Bound("apex_error_max", 1e-6, "apex n is e^(2n) h; every bounce begins 2e-8 m above the floor"),
            Bound("energy_added_max", 1e-12, "no bounce adds energy; rounding of 40 J"),
        ),
        regions=(Region(("ball_*",), (-INFINITE, -INFINITE, 0.0), (INFINITE,) * 3, "no ball falls through the floor"),),
        metrics=("restitution_error_max", "bounce_time_error_max", "apex_error_max"),
        expects={"drops": DROPS, "alone": tuple((drop.ball,) for drop in DROPS)},
    )


SCENARIOS = tuple(at_rate(rate) for rate in RATES)
