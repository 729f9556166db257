"""The protocol of the timing pass in words, made from the constants that the pass itself reads."""

from scenarios.glance import EACH_ROUND, LEAST, MOST, WARM_GLANCE
from scenarios.measure.timing import ENOUGH_FRAMES, REPEATS
from scenarios.timing import ENOUGH, MOST_FRAMES, WARM_FRAMES

ALWAYS = (
    "Times are taken in a pass of their own: serial, on one thread, with nothing recorded, the engines of a scene taking turns "
    "repeat by repeat over the same frames; a time is the least of a frame's repeats, engine only unless it says otherwise. "
    "Sub-steps count, because time is per rendered frame; compilation is reported beside it, never inside."
)


def protocol_said(at_a_glance: bool, full: bool) -> str:
    """What ran: `at_a_glance` with one process for many scenes, else each scene in fresh processes; `full` without a limit of
    time."""
    limit = "" if full else f", fewer repeats once an engine has taken {ENOUGH:g} s"
    length = f"{REPEATS} repeats of at most {MOST_FRAMES} frames{limit}"
    if at_a_glance:
        ran = (
            f"Each process serves many scenes and first runs {WARM_GLANCE} frames of each untimed, on a load of its own. The "
            f"everyday scenes have {length}; the others have 1 to {REPEATS} repeats of {LEAST} to {MOST} frames, as many as fit "
            f"into {EACH_ROUND:g} s of all engines together."
        )
    else:
        ran = (
            f"Each engine of each scene has a fresh process, which first runs {WARM_FRAMES} frames untimed, on a load of its "
            f"own; then there are {length}."
        )
    return f"{ALWAYS} {ran} Every row says its own; without {REPEATS} repeats of {ENOUGH_FRAMES} frames it has no p99."
