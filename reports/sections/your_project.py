"""Support matrix: what a project that would use the engine asks first, each answered yes, no or not measured, with the facts.

Figures are those of the run."""

import math
from collections import Counter
from collections.abc import Iterable, Sequence
from dataclasses import dataclass
from statistics import median

from avatarsim.settings import PostureSettings, meanings
from reports.deciding import piles
from reports.deciding.moments import WAITS
from reports.deciding.tables import RAW_TRACKER
from reports.reading.load import Results, Row
from reports.sections.growth import Growth, Point
from reports.sections.unseen import is_room
from reports.words.metric_words import words
from reports.words.wording import count, listed, quantity
from runfiles.like_for_like import with_avatar
from runfiles.timing_protocol import least_of, repeats_of

YES, NO, PARTLY, UNMEASURED = "yes", "no", "partly", "not measured"
ABSENT = "not measured in this run"
"""Stands for the figure of a longer run."""
ELSEWHERE = ("put takes the avatars elsewhere between two frames, in scenes without moving bodies; reset begins the whole scene "
             "again")
"""How an avatar gets through a wall."""
HEADSET = 90.0
"""Frames per second of a headset."""
TUNED = ("mujoco/tuned", "pybullet/tuned")
"""Other engines with their best settings."""
LEAPS = "teleport"
"""The scene whose target leaps."""
SHOWN = ("residual_overlap_max", "tracker_offset_rms_free", "reversal_max", "link_jump_max", "frame_time_p50")
"""Metrics of what a user sees of an avatar first, and of what it costs."""
PER_FRAME = ("steps", "work")
"""Settings that say how much happens in a frame: more a second at a higher rate."""
NOT_FOR = (
    "to call it from C, Unity, Unreal or OpenXR in their process (there is Python, and ports: over UDP and WebSocket samples go "
    "in and poses come out)", "scenery that moves, such as lifts and doors",
    "triangle meshes as they are (shapes are convex pieces)",
    "a grip that attaches a thing to a hand (nothing is held by more than contact)",
    "to begin inside something (it is refused)",
)
"""What a project may need and does not get; each has its row among the answers."""


@dataclass(frozen=True)
class Answer:
    """One question and its answer: word is one of those above, facts a sentence or two."""

    question: str
    word: str
    facts: str


def not_for() -> str:
    """What stands in open text: for which projects this is nothing."""
    return f"Not for you if you need {'; '.join(NOT_FOR)}."


def answers(results: Results, ours: str, growth: Growth | None = None) -> tuple[Answer, ...]:
    """All questions, in the order in which they are asked."""
    return (
        Answer("Between tracker and avatar: which engine", PARTLY, avatars(results, ours)),
        Answer("Triangle meshes as they are", NO, "Shapes are convex pieces. Mesh files are read as convex hulls or, decomposed, "
               "as convex pieces; avatarsim pieces MESH makes them and bounds how far pieces and mesh are apart."),
        Answer("Scenery that is animated, such as lifts and doors", NO, "Bodies are fixed, simulated or links of an avatar. A "
               "link that is moved by a tracker stops at what it meets instead of pushing through it."),
        Answer("A user who steps or reaches through a wall", PARTLY, walls(results, ours)),
        Answer("A target that leaps (teleports)", PARTLY, leaps(results, ours)),
        Answer("A start inside something", NO, "load, reset and put raise StartOverlaps, which names the pair and its depth. "
               "PyBullet and MuJoCo start there and push it out."),
        Answer("The first start on a machine", PARTLY, "The engine is compiled once for a version and kind of processor, one to "
               "two minutes; python -m avatarsim compile does it ahead. No figure of this page has it in."),
        Answer("Every frame within the 11.1 ms of 90 Hz", PARTLY, f"{slowest(results, ours)} {budget()}"),
        Answer("Other frame rates than 60 Hz", PARTLY, rates(results, ours)),
        Answer("Several avatars", YES, f"Each with its own tracker. {grown(growth, ours, 'avatars')}"),
        Answer("Avatars of your own: hand-tracking skeletons, other bodies", YES, "Trees of links with hinges, ball joints and "
               "reach cones: described in Python, or read from URDF, MJCF and SMPL files; motion from BVH, AMC, NPZ, CSV and "
               "more (docs/files.md), or live by UDP and WebSocket (docs/live.md)."),
        Answer("Grabbing", NO, "Nothing attaches a thing to a hand, and a hand that closes on one pushes it away: fingers stop "
               "at its surface and press with the spring of equation 6 alone, one contact a link. "
               f"{grasped(results.rows) or f'How far such a thing falls is {ABSENT}.'}"),
        Answer("Bodies that come and go", PARTLY, "Between two frames: change(scene) goes on in another scene with what both "
               "have by name. It takes as long as to load that scene."),
        Answer("C, Unity, Unreal, OpenXR", NO, "The engine is called from Python; there is no other binding. Over UDP and "
               "WebSocket another program sends samples and gets poses, tracked hands of a headset among them "
               "(docs/live_ports.md)."),
        Answer("Several threads", PARTLY, "A frame of one world is computed on the thread that asks for it; advance_many passes "
               "frames of many worlds on as many threads as there are processors."),
        Answer("Stacks of boxes: which engine", PARTLY, stacks(results, ours)),
        Answer("Large worlds", YES if _points(growth, ours, "objects") else UNMEASURED,
               f"Most of what lies there is to rest. {grown(growth, ours, 'objects')} "
               f"{grown(growth, ours, 'contacts')}"),
        Answer("Contact force, joint torque, haptics", UNMEASURED, "The avatar is kinematic: no figure on this page is a force."),
        Answer("Licence", YES, "Apache-2.0."),
    )


def stacks(results: Results, ours: str) -> str:
    """Which engine for stacks, at rest and in motion, and where settings to copy stand."""
    said = piles.which(results, ours)
    return f"{said} More settings, to copy: Cheapest setting, stack_ten." if said else f"Stacks are {ABSENT}."


def avatars(results: Results, ours: str) -> str:
    """Medians of what is seen of an avatar and of what it costs, engine by engine with its best settings, over everyday scenes
    with an avatar and over the rooms of motions that nothing was tuned for; scenes in which all of them have the figure."""
    everyday = [scene for scene in results.everyday if scene in with_avatar(results.rows)]
    rooms = [scene for scene in results.scenes() if is_room(scene)]
    said = [text for kind, scenes in (("everyday scenes", everyday), ("rooms of untuned motions", rooms))
            if (text := _medians(results, (ours, *TUNED), scenes, kind))]
    return (f"{' '.join(said)} Smaller is better in all; times are not like for like, as said above." if said else
            f"Avatars are {ABSENT}.")


def _medians(results: Results, runs: Sequence[str], scenes: Sequence[str], kind: str) -> str:
    """"Medians of 9 everyday scenes: overlap ours 0.2 um, ...; to and fro ..."; "" where no scene has figures of all `runs`."""
    said = []
    for metric in SHOWN:
        found = {run: {scene: value for value, scene in _figures(results, run, metric) if scene in scenes} for run in runs}
        shared = set.intersection(*(set(one) for one in found.values()))
        if shared:
            unit = next(row.unit for row in results.rows if row.metric == metric)
            each = ", ".join(f"{run} {quantity(median(found[run][scene] for scene in shared), unit)}" for run in runs)
            said.append(f"{words(metric)} (in {len(shared)}) {each}")
    return f"Medians of the {kind}: {'; '.join(said)}." if said else ""


def _figures(results: Results, run: str, metric: str) -> list[tuple[float, str]]:
    """(figure, scene) of a run, where it has one that is a number."""
    return [(row.value, row.scenario) for row in results.rows
            if row.run == run and row.metric == metric and row.value is not None and math.isfinite(row.value)]


def walls(results: Results, ours: str) -> str:
    """What becomes of an avatar whose user goes through a wall, and how often that was in this run."""
    held = Counter[str]()
    for number, scene in (one for name in WAITS for one in _figures(results, ours, name)):
        held[scene] += int(number)
    found = sorted(((number, scene) for scene, number in held.items() if number), reverse=True)
    most = listed(tuple(f"{number} in {scene}" for number, scene in found[:4]))
    seen = f"{count(sum(held.values()), 'frame')} of {count(len(found), 'scene')}, most in these: {most}" if found else "in none"
    return (
        "The avatar stays on its side and slides along the wall; with joints it is led around where a path is found, a hand "
        "without joints is not (around: 2 leads it too). Where none is known it waits, which the status says. In this run, "
        f"with the frames in which a path is sought: {seen}. Nothing shows it at the user's place through the wall but the "
        f"application's own word: {ELSEWHERE}."
    )


def leaps(results: Results, ours: str) -> str:
    """How teleports of the tracker are followed, and how far behind and how restless ours and the tuned others are there."""
    told = [f"{words(metric)} " + ", ".join(f"{run} {quantity(found[0], unit)}" for run in (ours, *TUNED) if (
        found := [value for value, scene in _figures(results, run, metric) if scene == LEAPS]))
        for metric, unit in (("tracker_offset_rms", "m"), ("reversal_max", "m"))
        if any(scene == LEAPS for _, scene in _figures(results, ours, metric))]
    shown = f" In {LEAPS}: {'; '.join(told)}." if told else ""
    return ("In the frame of the leap, as far as the straight way is free; avatars with joints are then led around what is in "
            f"between, a root at {quantity(PostureSettings().catch_up_move, 'm/s')} and a joint at "
            f"{quantity(PostureSettings().catch_up_turn, 'rad/s')} at most beyond the user's; a wrist, at the end of several "
            f"joints, can show more.{shown} To cross walls: {ELSEWHERE}.")


def slowest(results: Results, ours: str) -> str:
    """The slowest frame of the run, of how many repeats it is the least, over how many scenes, how many of these are over the
    frame of a headset, and the slowest of a single repeat, which holds the disturbances of the machine."""
    found, scenes = _figures(results, ours, "frame_time_max"), {row.scenario for row in results.rows if row.run == ours}
    if not found:
        return f"The slowest frame is {ABSENT}."
    time, scene = max(found)
    over = sum(not time <= 1e6 / HEADSET for time, _ in found)
    longer = f"in {count(over, 'of them') if over > 1 else 'one of them'} a frame takes longer than 11.1 ms" if over else (
        "in each of these every frame that was timed fits into 11.1 ms")
    repeats = max(repeats_of(row.note) for row in results.rows if row.run == ours and row.metric == "frame_time_max")
    how = f", {least_of(repeats)}" if repeats else ""
    raw, where = max(_figures(results, ours, "frame_time_raw_max"), default=(math.nan, ""))
    single = f" In a single repeat, disturbances of the machine included: {quantity(raw, 'us')}, in {where}." if where else ""
    return (f"Slowest frame measured{how}: {quantity(time, 'us')}, in {scene}, over {len(found)} of "
            f"{count(len(scenes), 'scene')}; {longer}.{single}")


def budget() -> str:
    """What bounds the work of a frame, in the words of the setting."""
    return (f"work: {meanings(PostureSettings)['work']} It is that of postures; impacts of loose bodies are none of it, and "
            "have a cap that is no setting.")


def rates(results: Results, ours: str) -> str:
    """At which rates ours was measured in scenes with an avatar, and which settings are per frame."""
    avatars = with_avatar(row for row in results.rows if row.run == ours)
    hertz = sorted(round(1.0 / dt) for scene, dt in results.frame_times.items() if scene in avatars and dt > 0.0)
    seen = listed(tuple(f"{hertz.count(rate)} at {rate} Hz" for rate in dict.fromkeys(hertz)))
    values = PostureSettings()._asdict()
    return (
        f"Scenes with an avatar were measured at: {seen or ABSENT}. Times and speeds of the settings are in seconds, metres and "
        f"radians, whatever the rate. These are per frame, and mean more work a second at a higher rate: "
        f"{', '.join(f'{name} {values[name]}' for name in PER_FRAME)}."
    )


def grasped(rows: Iterable[Row]) -> str:
    """Where what hands close on ends, engine by engine; "" without such figures."""
    found = [row for row in rows if row.metric == "grasped_fall_end" and row.engine != RAW_TRACKER]
    if not found:
        return ""
    told = "; ".join(f"{row.run} {quantity(row.value, row.unit)}" for row in found)
    return (f"How well something is held no scene measures. In {found[0].scenario} a hand closes on a thing that stands on a "
            f"pedestal, and lifts nothing; {words('grasped_fall_end')}: {told}. 0 is where it stood, pushed aside or not.")


def _points(growth: Growth | None, ours: str, grows: str) -> list[Point]:
    """What this run timed of a kind of size."""
    return [one for one in growth.points if (one.grows, one.run) == (grows, ours) and one.p95 > 0.0] if growth else []


def grown(growth: Growth | None, ours: str, grows: str) -> str:
    """The largest size of a kind that this run timed, with its 95th percentile; or that it timed none, and what would."""
    points = _points(growth, ours, grows)
    if not points:
        return f"Frames with many {grows} are {ABSENT}; make bench times them."
    most = max(points, key=lambda one: (one.size, one.p95))
    return f"{most.size:,} {grows} ({most.mode}): {quantity(most.p95, 'us')} at the 95th percentile."
