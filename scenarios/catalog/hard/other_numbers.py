"""Invariance of frame time, origin and units: one little world at 1 us to 0.2 s, a hundred kilometres away, in mm and in km.

Motion depends on none of these numbers. The frame time is how often states are shown, the origin a choice of coordinates; a
world in millimetres has lengths and a gravity a thousand times as large in numbers, one in kilometres a thousandth.
"""

from collections.abc import Mapping

from scenarios.building.promises import FINITE, NO_OVERLAP, RIGHT_SIDE
from scenarios.building.small_world import Place, expects, regions, small_world
from scenarios.motion.untracked import untracked
from scenarios.scenario import RENDERED, Bound, Scenario

FRAMES = 120
FAR = (6e4, -8e4, 1e3)
"""[m]: a hundred kilometres from the origin; numbers of that size are 1.5e-11 m apart."""
TIMES: Mapping[str, float] = {"dt_torture": 0.2, "dt_torture_30ms": 0.03, "dt_torture_1ms": 1e-3, "dt_torture_1us": 1e-6}
"""Frame times [s]: 120 of them are 24 seconds, or an eighth of a millisecond."""
EARLY = 1e-7
"""[m] off the closed form: a body that turns at a gap of 2e-8 m is twice that off; the rest is what gravity does meanwhile."""


def scenario(name: str, title: str, place: Place, dt: float = RENDERED) -> Scenario:
    """The little world at a place, of a size, looked at every `dt` [s]."""
    return Scenario(
        name=name,
        title=title,
        judged="Where everything is at any time; what stands, stands.",
        build=lambda: small_world(name, place),
        motion=untracked(dt),
        frames=FRAMES,
        dt=dt,
        bounds=(
            NO_OVERLAP, RIGHT_SIDE, FINITE,
            Bound("course_error_max", EARLY, "closed forms hold at any time, anywhere, in any unit; a gap of 2e-8 m is contact"),
            Bound("drift_max", 1e-6, "what rests stays where it is"),
            Bound("energy_gain_max", 1e-9, "nothing here adds energy"),
        ),
        regions=regions(place),
        expects=expects(place, FRAMES * dt),
        scale=place.scale,
    )


SCENARIOS = (
    *(scenario(name, f"A little world, looked at every {dt:g} s.", Place(), dt) for name, dt in TIMES.items()),
    scenario("far_from_origin", "A little world a hundred kilometres from the origin.", Place(origin=FAR)),
    scenario("scale_mm", "A little world a thousandth as large.", Place(scale=1e-3)),
    scenario("scale_km", "A little world a thousand times as large.", Place(scale=1e3)),
)
