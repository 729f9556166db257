"""Work-precision diagrams of the sweep: error against frame time per scene, a curve per engine and preset, and all fronts."""

import math
from collections.abc import Mapping, Sequence
from dataclasses import dataclass

from reports.deciding.alike import Basis, time_by
from reports.deciding.conclusions import FRAME_60_HZ
from reports.drawing.log_log import LogLog, decades
from reports.drawing.palette import MUTED, Stroke, strokes
from reports.reading.load import Results
from reports.sections.page_paths import path_of
from reports.sections.sweep import beaten, ladders, planned
from reports.sections.sweep.cheapest import BASE, PROFILED, Table, asleep, astray, at_level, silence, table
from reports.sections.sweep.cheapest import sentence as cheapest_sentence
from reports.sections.sweep.elsewhere import elsewhere
from reports.sections.sweep.performance_profile import Steps, profiles
from reports.sections.sweep.performance_profile import sentence as profile_sentence
from reports.sections.sweep.points import OURS, SEEN_GAP, WHICH, Point, Rivalry, Sweep, alone_heading, conclusion
from reports.words.metric_words import words
from reports.words.wording import count, limit, listed, quantity
from runfiles.accuracy import LEVELS, counts
from runfiles.accuracy import length as as_length

LEAST = 0.3
"""Where an error of exactly nothing is drawn, as a share of the smallest one that counts, in units that count whole things."""
FRAME_90_HZ = 1e6 / 90.0
"""What a display of 90 Hz allows for a whole frame [us]."""
PROFILE_HEIGHT = 104
"""Height of a performance profile [px]."""


@dataclass(frozen=True)
class SweepPanel:
    """One diagram: its `title`, the scene and error, an SVG with its text alternative, what it says at 1 mm, and all that is
    drawn as text: for each point its run, error and time."""

    scenario: str
    title: str
    svg: str
    conclusion: str
    points: tuple[tuple[str, str, str], ...] = ()


def inks(sweep: Sweep) -> dict[str, Stroke]:
    """A stroke per engine and preset beneath, the engine's own default solid."""
    return strokes(point.family for point in sweep.points)


def panels(sweep: Sweep, found: Table | None = None) -> tuple[list[SweepPanel], list[SweepPanel]]:
    """The first error of every scene, and its other errors; scenes in the order of the file."""
    found = found or table(sweep)
    times = [time for r in sweep.rivalries for p in r.points if (time := r.time(p)) > 0.0]
    if not times:
        return [], []
    span = 10.0 ** math.floor(math.log10(min(times))), max(2.0 * FRAME_60_HZ, 1.2 * max(times))
    ink, firsts, others = inks(sweep), list[SweepPanel](), list[SweepPanel]()
    told = {block.scenario: at_level(block, 1e-3, found.engines) for block in found.blocks}
    by_place = {(r.scenario, r.metric): r for r in sweep.rivalries}
    # the file names the error first that says most about its scene
    for place in dict.fromkeys((p.scenario, p.metric) for p in sweep.points):
        rivalry = by_place[place]
        if _usable(rivalry):
            title = f"{rivalry.scenario}: {words(rivalry.metric)}"
            first = all(panel.scenario != rivalry.scenario for panel in firsts)
            said = told.get(rivalry.scenario, "") if first else f"Outcome: {rivalry.said}."
            made = SweepPanel(rivalry.scenario, title, _drawn(rivalry, ink, span), said + _spoilt(rivalry), _as_text(rivalry))
            (firsts if first else others).append(made)
    return firsts, others


def _usable(rivalry: Rivalry) -> list[Point]:
    """Points with a time, the one by which the scene compares, and an error."""
    return [point for point in rivalry.points if rivalry.time(point) > 0.0 and point.floored == point.floored]


def _spoilt(rivalry: Rivalry) -> str:
    crossed = tuple(f"{p.run} ({p.state})" for p in rivalry.spoilt if p.state != "not-measured")
    return f" Crosses: {listed(crossed, 3)}." if crossed else ""


def _as_text(rivalry: Rivalry) -> tuple[tuple[str, str, str], ...]:
    """What the marks of a diagram stand for, fastest first, for readers without a pointer."""
    shown = sorted(_usable(rivalry), key=rivalry.time)
    return tuple((p.run, quantity(p.error, p.unit), quantity(rivalry.time(p), "us")) for p in shown)


def _front_words(rivalry: Rivalry) -> str:
    said = tuple(f"{p.run} {quantity(p.error, p.unit)} in {quantity(rivalry.time(p), 'us')}" for p in rivalry.front)
    return f"On the front: {listed(said, 9)}."


def tooltip(point: Point, basis: Basis = Basis.MEDIAN) -> str:
    """Everything about one point: run, error, time and what it stands on, options; first the time at which it is drawn."""
    stands = f", {point.repeats} × {point.frames} frames" if point.repeats else ""
    tail = f"; {point.tail_said} {quantity(point.tail, 'us')}" if point.has_tail else ""
    time = f"{quantity(point.p50, 'us')} per frame (median{stands}{tail})" if point.p50 > 0.0 else "not timed"
    if basis is not Basis.MEDIAN and time_by(point, basis) > 0.0:
        time = f"{quantity(time_by(point, basis), 'us')} ({WHICH[basis]}), {time}"
    error = quantity(point.error, point.unit) if point.error == point.error else "no error measured"
    state = "" if point.state == "measured" else f"; {point.state}{': ' + point.note if point.note else ''}"
    copied = [text for text in (point.options, point.settable) if text]
    hovers = f"; {point.hovers}" if point.hovers else ""
    return "\n".join([f"{point.run}: {error}{hovers}, {time}{state}", *copied])


def short_name(point: Point) -> str:
    """What a setting changes against the preset beneath, or the preset: the colour says the engine, the dash the preset."""
    changed = point.setting.removeprefix(f"{point.base} ") if point.base else point.setting
    return changed.replace("dt=", "").replace("motors DISCRETE", "motors")


def _drawn(rivalry: Rivalry, ink: Mapping[str, Stroke], span: tuple[float, float]) -> str:
    """Logarithmic both ways; time on one scale for all panels, error on the scene's own, the floor being what counts as none."""
    usable, time, basis = _usable(rivalry), rivalry.time, rivalry.basis
    floor = rivalry.points[0].reached or LEAST
    low = 10.0 ** math.floor(math.log10(floor) + 1e-9)
    high = 10.0 ** max(math.ceil(math.log10(max(max(p.floored, floor) for p in usable)) + 1e-9), round(math.log10(low)) + 1)
    def rank(point: Point) -> tuple[int, float]:
        return _rank(point), time(point)

    chart = LogLog(span, (low, high))
    for k, value in enumerate(decades(*span)):
        chart.x_tick(value, limit(value, "us") if k % 2 == 0 else "")
    ticks = decades(low, high)
    for k, value in enumerate(ticks):
        every = max(1, (len(ticks) + 3) // 5)
        if k % every == 0:
            chart.y_tick(value, f"{'≤ ' if k == 0 else ''}{limit(value, rivalry.unit)}")
    # the two stand close together: one name ends at its line, the other starts at its own
    chart.x_limit(FRAME_90_HZ, "90", "end")
    chart.x_limit(FRAME_60_HZ, "60 Hz", "start")
    best = [(time(p), max(p.floored, floor)) for p in rivalry.front]
    chart.line(best + _end(rivalry.front, floor, span[1]), MUTED[0], width=5.0, opacity=0.25, steps=True)
    for family, stroke in ink.items():
        own = family_front([p for p in usable if p.family == family], basis)
        dash = "" if stroke.dash[1] == 0 else " ".join(map(str, stroke.dash))
        chart.line([(time(p), max(p.floored, floor)) for p in own], stroke.light, dash)
    for point in sorted(usable, key=rank, reverse=True):
        preset = point.is_preset
        ours = (point.engine, point.setting) == OURS
        radius = 4.5 if ours else 3.3 if preset else 2.3
        filled = bool(point.front) or preset or not is_beaten(point, usable, basis)
        chart.dot(time(point), max(point.floored, floor), ink[point.family].light, tooltip(point, basis), radius, filled)
    for point in rivalry.spoilt:
        if point.state != "not-measured":
            chart.cross(time(point) if time(point) > 0.0 else span[1], high, ink[point.family].light, tooltip(point, basis))
    for point in sorted(usable, key=rank):
        chart.label(time(point), max(point.floored, floor), short_name(point), ink[point.family].light)
    return chart.svg(f"{rivalry.scenario}. {words(rivalry.metric)} against frame time ({rivalry.which}). {_front_words(rivalry)}")


def is_beaten(point: Point, others: Sequence[Point], basis: Basis = Basis.MEDIAN) -> bool:
    """Whether a setting of its own engine is as fast and as accurate and hovers no farther off: a gap is no error, but neither
    is what stays off by one better than what touches."""
    return any(other is not point and other.engine == point.engine and time_by(other, basis) <= time_by(point, basis)
               and other.floored <= point.floored and not other.gap > max(point.gap, SEEN_GAP) for other in others)


def _end(front: Sequence[Point], floor: float, right: float) -> list[tuple[float, float]]:
    """The staircase of a front goes on to the right end of the chart."""
    return [(right, max(front[-1].floored, floor))] if front else []


def _rank(point: Point) -> int:
    """Which points are labelled first: those on the front of all, presets, those on their engine's front."""
    return {"all": 0, "own": 2}.get(point.front, 3) - (1 if point.is_preset and point.front != "all" else 0)


def family_front(points: Sequence[Point], basis: Basis = Basis.MEDIAN) -> list[Point]:
    """The points of one family that no other of it beats in both time and error, fastest first."""
    found, least = list[Point](), math.inf
    for point in sorted(points, key=lambda p: (time_by(p, basis), p.floored)):
        if point.floored < least:
            found.append(point)
            least = point.floored
    return found


@dataclass(frozen=True)
class ProfilePanel:
    """The performance profile at one accuracy."""

    title: str
    svg: str
    conclusion: str


def profile_panels(found: Table) -> list[ProfilePanel]:
    """One chart per accuracy in PROFILED."""
    ink = {run.split("/")[0]: stroke for run, stroke in strokes(f"{engine}/default" for engine in found.engines).items()}
    made = []
    for level in PROFILED:
        steps = profiles(found, level)
        said = profile_sentence(steps, level, len(found.compared), found.unsaid(level))
        made.append(ProfilePanel(f"At most {limit(level, 'm')}", _profile(steps, ink, said), said))
    return made


def _profile(found: Mapping[str, Steps], ink: Mapping[str, Stroke], said: str) -> str:
    most = max([10.0, *(factor for steps in found.values() for factor, _ in steps)])
    right = 10.0 ** math.ceil(math.log10(most) + 1e-9)
    chart = LogLog((1.0, right), (0.0, 1.0), PROFILE_HEIGHT, linear_y=True)
    for value in decades(1.0, right):
        chart.x_tick(value, f"×{value:,.0f}")
    for share in (0.0, 0.5, 1.0):
        chart.y_tick(share, f"{share:.0%}")
    for engine, steps in found.items():
        chart.line([*steps, (right, steps[-1][1])], ink[engine].light, width=2.0, steps=True)
    for engine, steps in sorted(found.items(), key=lambda entry: -entry[1][-1][1]):
        chart.end_label(steps[-1][1], engine, ink[engine].light)
    return chart.svg(f"Share of scenes solved within a factor of the fastest engine. {said}")


def protocol(sweep: Sweep) -> str:
    """How the points were found, from what the sweep said of itself."""
    about, form = sweep.about, sweep.about.get("form")
    if form == "short":
        left, late = about.get("left"), about.get("late")
        said = [
            f"Measured in this run by a short sweep of {about.get('seconds')} s: {about.get('settings')} cells, each a setting "
            f"in a scene; {about.get('reused')} of them are presets whose times are those of the timing pass."
        ]
        if "repeats" in about and "once" in about:
            said.append(f"A time is the median over frames, each the least of its repeats: {about['repeats']} of them, in the "
                        f"sweep 1 where a scene has {about['once']} frames or more; each tooltip says which.")
        if isinstance(left, list) and left:
            said.append(f"{count(len(left), 'further cell')} did not fit into the {figure(about.get('budget'))} s that were "
                        "planned; they are listed below, and make sweep measures them.")
        if isinstance(late, list) and late:
            said.append(f"Not timed, because time had run out: {listed(tuple(map(str, late)))}.")
        return " ".join(said)
    if form == "long":
        return (f"Measured by the long sweep (make sweep): {about.get('settings')} cells, of which {about.get('kept')} were kept "
                "from earlier sweeps with the same code on the same processor.")
    return "The file does not say which sweep these points come from."


def budget_sentence(sweep: Sweep) -> str:
    """Whether every setting on a front leaves the frame of 90 Hz its time, and which does not; "" where nothing was timed."""
    fronts = [p for p in sweep.points if p.front and p.p50 > 0.0]
    if not fronts:
        return ""
    slow = tuple(dict.fromkeys(f"{p.scenario} {p.run}" for p in fronts if not p.p50 <= FRAME_90_HZ))
    most = max(fronts, key=lambda p: p.p50)
    if slow:
        return f"On a front and slower in the median than 11.1 ms, a frame at 90 Hz: {listed(slow)}."
    tail = max((p for p in fronts if p.has_tail), key=lambda p: p.tail, default=None)
    said = (f"; of those that ran more than once the dearest tail has {quantity(tail.tail, 'us')} ({tail.tail_said}), "
            f"{tail.scenario} {tail.run}" if tail is not None else "")
    return (f"In the median all settings on a front take less than 11.1 ms, a whole frame at 90 Hz: the slowest "
            f"{quantity(most.p50, 'us')}, {most.scenario} {most.run}{said}.")


def figure(value: object) -> str:
    """A number of the file without idle digits."""
    return f"{value:g}" if isinstance(value, int | float) else str(value)


def left_out(sweep: Sweep) -> list[tuple[str, str]]:
    """(scene, settings) of what did not fit."""
    left = sweep.about.get("left")
    found: dict[str, list[str]] = {}
    for entry in left if isinstance(left, list) else ():
        scene, _, run = str(entry).partition(": ")
        found.setdefault(scene, []).append(run)
    return [(scene, ", ".join(runs)) for scene, runs in found.items()]


def at_other_rates(results: Results | None, point: Point, metrics: Sequence[str]) -> str:
    """Where a setting, or the preset beneath it, errs more in a variant of its scene, such as at another frame rate: the largest
    of its errors that count there; of other settings only their own scene is measured. "" where no variant is worse."""
    if results is None:
        return ""
    family = results.family(point.scenario)
    found = [(as_length(row.metric, row.value), row) for row in results.rows
             if results.family(row.scenario) == family and row.run == point.family and row.metric in metrics
             and row.value is not None and counts(row.metric, row.unit)]
    own = max((value for value, row in found if row.scenario == point.scenario), default=math.nan)
    worst = max((one for one in found if one[1].scenario != point.scenario), key=lambda one: one[0], default=None)
    if worst is None or not worst[0] > max(own, LEVELS[-1]):
        return ""
    return f"{'' if point.is_preset else f'{point.base}: '}{quantity(worst[0], 'm')} in {worst[1].scenario}"


def section(sweep: Sweep, results: Results | None = None) -> dict[str, object]:
    """What the section is made of; `results`: the run's own figures, for those of a scene's variants and of
    presets that the sweep has not."""
    lost, found = sum(r.lost for r in sweep.rivalries), table(sweep)
    first, other = panels(sweep, found)
    return {
        "sweep_said": cheapest_sentence(found), "alone_said": conclusion(sweep), "alone_head": alone_heading(sweep),
        "sweep_panels": first, "sweep_others": other, "sweep_inks": inks(sweep),
        "sweep_lost": f"{lost} of {count(len(sweep.rivalries), 'row')} lost", "cheapest": found, "cheapest_levels": LEVELS,
        "profile_panels": profile_panels(found) if found.compared else [],
        "planned_said": planned.sentence(sweep),
        "sweep_protocol": protocol(sweep), "sweep_left": left_out(sweep), "cheapest_base": BASE,
        "cheapest_notes": [*asleep(found), *silence(found), *filter(None, (ladders.sentence(sweep), budget_sentence(sweep)))],
        "astray_said": astray(found)[0], "astray": astray(found)[1],
        "beaten": (worn := beaten.beaten(sweep)), "beaten_said": beaten.sentence(worn),
        "rates_of": lambda block, point: at_other_rates(results, point, block.metrics),
        "elsewhere_of": lambda block: elsewhere(results, sweep, block), "model_of": sweep.model, "path_of": path_of,
    }
