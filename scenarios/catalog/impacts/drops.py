"""Balls fall onto a floor and bounce: with restitution 0 to 1 at four frame times, for twenty seconds, and until they lie.

Closed forms: impact n at t1 (1 + 2 e (1 - e^(n-1)) / (1 - e)), t1 = sqrt(2 h / g); apex n at e^(2n) h; infinitely many bounces
end at sqrt(2 h / g) (1 + e) / (1 - e).
"""

from collections.abc import Callable, Iterator

from avatarsim.scene.body import Body
from avatarsim.scene.shape import Sphere
from scenarios.building.cases import laws, loose, slab
from scenarios.building.expected import Rest
from scenarios.building.promises import SOUND
from scenarios.building.scenes import above, each_alone, undriven
from scenarios.scenario import Bound, Drop, Scenario

Drops = tuple[Drop, ...]
LADDER = tuple(Drop(f"ball_{e:g}", "floor", e, 1.0) for e in (0.0, 0.1, 0.2, 0.3, 0.5, 0.75, 0.9, 1.0))
RATES = (30, 60, 240, 1000)
"""Frames per second."""
SECONDS, SHORT = 3.0, 0.7
"""Length of a full run, and of a quick one at the finest frame time [s]."""
TO_REST = tuple(Drop(f"ball_{e:g}", "floor", e, 0.5) for e in (0.1, 0.3, 0.5))
"""They lie at 0.39, 0.59 and 0.96 s."""
ELASTIC = (Drop("ball", "floor", 1.0, 1.0),)
IMPACTS = Bound("restitution_error_max", 1e-6, "eq. 8 fixes v+/v- at every impact")


def over_floor(drops: Drops, width: float, depth: float, radius: float, mass: float) -> Callable[[], Iterator[Body]]:
    """Return the builder of a floor with a row of balls over it, each of a material of its own."""

    def bodies() -> Iterator[Body]:
        yield slab(width, depth)
        for k, drop in enumerate(drops):
            at = (k - 0.5 * (len(drops) - 1), 0.0, radius + drop.height)
            yield loose(drop.ball, Sphere(radius), material(drop), mass, at)

    return bodies


def material(drop: Drop) -> str:
    """Return the material of a ball."""
    return "ball" if drop in ELASTIC else f"e_{drop.restitution:g}"


def at_rate(rate: int) -> Scenario:
    """Return the ladder at so many frames per second."""
    frames = round(SECONDS * rate)
    return undriven(
        "bounce_ladder" if rate == 60 else f"bounce_ladder_{rate}",
        f"Eight balls fall one metre and bounce with restitution 0 to 1, at {rate} frames per second.",
        "Restitution, time and apex of every bounce.", over_floor(LADDER, 10.0, 2.0, 0.1, 1.0),
        laws({(material(drop), "floor"): (drop.restitution, 0.3) for drop in LADDER}), family="bounce_ladder",
        frames=frames, short=min(frames, max(90, round(SHORT * rate))), dt=1.0 / rate,
        bounds=(
            *SOUND, IMPACTS,
            Bound("bounce_time_error_max", 1e-6, "impacts happen when balls arrive, not when frames end; each is 2e-8 m early"),
            Bound("apex_error_max", 1e-6, "apex n is e^(2n) h; every bounce begins 2e-8 m above the floor"),
            Bound("energy_added_max", 1e-12, "no bounce adds energy; rounding of 40 J"),
        ),
        regions=(above(0.0, "ball_*"),), metrics=("restitution_error_max", "bounce_time_error_max", "apex_error_max"),
        expects={"drops": LADDER, "alone": each_alone(drop.ball for drop in LADDER)},
    )


SCENARIOS = (
    *map(at_rate, RATES),
    undriven(
        "elastic_20s", "An elastic ball bounces for twenty seconds.", "Energy, and the time and apex of every bounce.",
        over_floor(ELASTIC, 2.0, 2.0, 0.1, 1.0), laws({("ball", "floor"): (1.0, 0.0)}),
        frames=1200, short=300,
        bounds=(
            *SOUND, Bound("energy_drift_max", 1e-10, "nothing takes or gives energy; rounding of 44 impacts and 1200 frames"),
            Bound("bounce_time_error_max", 1e-6, "44 impacts, each 2e-8 m above the floor: 9e-9 s early each, 4e-7 s together"),
            Bound("apex_error_max", 1e-6, "the apex is h every time"), IMPACTS,
        ),
        regions=(above(0.0, "ball"),), expects={"drops": ELASTIC, "elastic": (("ball",),)},
    ),
    undriven(
        "zeno", "Three balls bounce until they have done so infinitely often, and lie still.",
        "When they lie still, and that they do.", over_floor(TO_REST, 4.0, 2.0, 0.05, 0.2),
        laws({(material(drop), "floor"): (drop.restitution, 0.3) for drop in TO_REST}), frames=90,
        bounds=(
            *SOUND, Bound("zeno_end_error_max", 1e-6, "the sum of all flights is finite and known; no engine may end it early"),
            IMPACTS, Bound("drift_max", 1e-9, "a ball that lies still stays where it is"),
            Bound("rest_energy_end", 1e-12, "a ball that lies still does not move"),
        ),
        regions=(above(0.0, "ball_*"),),
        expects={"drops": TO_REST, "zeno": True, "rests": (Rest(tuple(drop.ball for drop in TO_REST), 1.2),)},
    ),
)
