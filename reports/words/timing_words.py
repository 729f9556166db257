"""How the frames of a run were timed and what the machine did meanwhile, in sentences made from the run's own record."""

import math
from collections.abc import Mapping

from reports.words.wording import count, figures

BUSY = 0.25
"""Processors that other work may keep busy, on the mean, while frames are timed. One more busy process makes it 1; above a
quarter of that a reader is warned."""
UNSAID = "The run has no record of how its frames were timed."
"""Stands in for the protocol of a run that timed nothing, or was made before runs kept that record."""


def record(provenance: Mapping[str, object]) -> Mapping[str, object]:
    """What a run says of its timing pass; empty where it says nothing."""
    found = provenance.get("timing")
    return found if isinstance(found, Mapping) else {}


def protocol(provenance: Mapping[str, object]) -> str:
    """The protocol that ran, in the run's own numbers."""
    found = record(provenance)
    numbers = [_number(found.get(name)) for name in ("repeats", "warm_frames", "tail_frames", "phase_frames")]
    if any(math.isnan(number) for number in numbers):
        return UNSAID
    repeats, warm, tail, phase = map(int, numbers)
    return (
        "Frames are timed one engine at a time, on one thread, with nothing recorded; the engines of a scene take turns. Each "
        f"first runs up to {count(warm, 'frame')} on a load that is thrown away, then the same frames up to "
        f"{count(repeats, 'time')}, each time on a new load; a frame counts with the least of its repeats. Beside each median "
        "stands how many repeats and frames there were. Medians and 95th percentiles are over the repeats and frames that every "
        f"engine of the scene had; a 99th percentile and a slowest frame are over all that an engine had, from {repeats} x "
        f"{tail} frames on, and not given where they would lie below a 95th percentile that is over fewer. Where at "
        f"least {count(phase, 'frame')} rest and as many move, each kind has its own median beside the common one. The engine "
        "that the gate covers is timed over whole scenes (of long ones the first quarter of a minute): its slowest frame is that "
        "of the scene, however short the window is by which engines are compared. Of a scene of the short sweep the window is "
        "all of it, run as often as the sweep runs it, so that both have one time."
    )


CLOCK = (
    "What the clock covers: engine only is read round the engine's own calls and nothing else. In ours these are the stages of "
    "a frame (posture, motion, coupling); in MuJoCo one call of mj_step for all steps of a frame where nothing is led, else, and "
    "in PyBullet (stepSimulation), one call per step of the preset, the clock read before and after each call and the readings "
    "of a frame added up: what a pair of readings costs itself stands under Provenance, times the steps of a frame. Not in it: "
    "in ours checking and copying the tracker's sample and handing out the result; in MuJoCo and PyBullet checking, limiting "
    "and interpolating the target, writing mocap poses or controls, reading poses. As called from Python is the whole call of "
    "a frame with all of that; in two of three engines it is our adapter's time, so it is shown and not ranked.",
    "At home: make bench measures your machine, python -m scenarios bench --filter NAME one scene. What comes before the first "
    "frame (import, load) is in no frame time: bench has it as warmup in its results.csv, python -m scenarios.first_frame has "
    "load and first frame of every scene.",
)
"""What is timed, exactly as `scenarios.running.seat` and the adapters read the clock, and how to have it on another machine."""


def machine(provenance: Mapping[str, object]) -> str:
    """Clock and load during the timing pass, as far as they are known; "" where nothing is."""
    found, said = record(provenance), []
    now, most, others = (_number(found.get(name)) for name in ("mhz", "mhz_max", "busy_elsewhere"))
    if now > 0.0:
        highest = f"{most:.0f} MHz at most" if most > 0.0 else "its highest is not told"
        said.append(f"the clock was {now:.0f} MHz ({highest})")
    if others >= 0.0:
        said.append(f"other work kept {figures(others)} processors busy")
    reading = _number(found.get("reading_ns"))
    if reading >= 0.0:
        said.append(f"a pair of clock readings with nothing between them came to {reading:.0f} ns, once a frame and stage in "
                    f"ours, once a frame in MuJoCo where nothing is led, else once a step, 16 to 64 in tuned presets")
    means = {when: found.get(f"load_{when}") for when in ("before", "after")}
    loads = [f"{mean[0]:g} {when}" for when, mean in means.items() if isinstance(mean, list) and mean]
    said += [f"the load average of a minute was {' and '.join(loads)} (it counts this run's own processes too: those that "
             "measured accuracy before, and those that are timed and wait)"] if loads else []
    return f"While frames were timed, {'; '.join(said)}." if said else ""


def warning(provenance: Mapping[str, object]) -> str:
    """What to think of the times where other work ran beside them; "" where none did, or nothing is known."""
    others = _number(record(provenance).get("busy_elsewhere"))
    if not others > BUSY:
        return ""
    return (f"Other work kept {figures(others)} processors busy while frames were timed: times may be too long, those of some "
            "engines more than those of others. Measure again on a machine that does nothing else.")


def _number(value: object) -> float:
    return float(value) if isinstance(value, int | float) and not isinstance(value, bool) else math.nan
