"""Why is a figure of another engine larger than 100 mm or 90 degrees: is it the engine, our adapter, or what the scene asks?"""

import math
from collections.abc import Iterable, Mapping, Sequence
from dataclasses import dataclass
from enum import Enum
from fnmatch import fnmatchcase
from types import MappingProxyType

from runfiles.behind import Figure, at_size_1
from runfiles.naming import BASELINE, GATED, base_of

LARGE = 0.1
"""[m]: figures of other engines above it want an explanation. A hand's width: no reader takes it for a question of settings."""
LARGE_ANGLE = 90.0
"""[deg]: the same of what is beyond a joint's limits. A quarter turn: an arm that is broken, not one that is bent too far."""
DEPTH, OFFSET, EXCESS = "residual_overlap_max", "tracker_offset_rms_free", "joint_limit_excess_max"


class Cause(Enum):
    """Where a large figure comes from."""

    ENGINE = "the engine"
    ADAPTER = "our adapter"
    SETTING = "our setting"
    SCENE = "the scene"


@dataclass(frozen=True)
class Explanation:
    """The cause, and one sentence without it."""

    cause: Cause
    sentence: str
    brief: str = ""
    """The cause in a few words, for where a figure stands in another sentence."""


@dataclass(frozen=True)
class Rule:
    """`why` holds for scenes and runs that match one of the patterns (`*` for anything), in these metrics."""

    scenes: tuple[str, ...]
    runs: tuple[str, ...]
    metrics: tuple[str, ...]
    why: Explanation

    def fits(self, scene: str, run: str, metric: str) -> bool:
        """Whether the rule speaks of this figure."""
        return metric in self.metrics and _matches(self.scenes, scene) and _matches(self.runs, run)


def explanation(scene: str, run: str, metric: str) -> Explanation | None:
    """Of the figure in that scene of that run; None where the cause is not known."""
    return next((rule.why for rule in EXPLAINED if rule.fits(scene, run, metric)), None)


def _matches(patterns: Sequence[str], name: str) -> bool:
    return any(fnmatchcase(name, pattern) for pattern in patterns)


def _engine(sentence: str) -> Explanation:
    return Explanation(Cause.ENGINE, sentence)


def _adapter(sentence: str, brief: str = "") -> Explanation:
    return Explanation(Cause.ADAPTER, sentence, brief)


def _setting(sentence: str) -> Explanation:
    return Explanation(Cause.SETTING, sentence)


def _depth(scenes: str, runs: str, why: Explanation) -> Rule:
    return Rule(tuple(scenes.split()), tuple(runs.split()), (DEPTH,), why)


def _offset(scenes: str, runs: str, why: Explanation) -> Rule:
    return Rule(tuple(scenes.split()), tuple(runs.split()), (OFFSET,), why)


def _excess(scenes: str, runs: str, why: Explanation) -> Rule:
    return Rule(tuple(scenes.split()), tuple(runs.split()), (EXCESS,), why)


PINNED = (
    "MuJoCo is pinned to 3.17.0. MuJoCo 4.0.0, of 6 November 2026, can look ahead for contacts (its flag speculative), against "
    "tunnelling: what tunnels here may not tunnel there, which was not measured. It is not taken, as it has a wrong Hessian with "
    "sparse Jacobians, whose repair is not published under the package's name."
)
"""Which MuJoCo runs, and what a newer one has that may change what is said of it here."""

_SHOT = (
    _depth("dt_torture_1ms", "mujoco/default", _engine(
        "MuJoCo 3.17 tunnels. A ball shot at 300 m/s is 0.29 m deep after its first step, which is the frame of 1 ms; five "
        "steps of the default contact slow it to 191 m/s, then it is more than half the wall's height of 2 m deep, no longer "
        "pushed back, and leaves at the far side of 20 m (frames on the wrong side). 1.05 m is the deepest that this wall "
        "allows."
    )),
    _depth("dt_torture_30ms", "mujoco/default", _engine(
        "MuJoCo 3.17 tunnels. At the default step, 2 ms here, a ball shot at 300 m/s is 0.59 m deep when it is found, slowed to "
        "237 m/s in one step, never turned, and leaves at the far side of 20 m of wall (frames on the wrong side)."
    )),
    _depth("far_from_origin scale_km scale_mm", "mujoco/default", _engine(
        "MuJoCo 3.17 tunnels, wherever the origin is and in any unit: a ball shot at 300 m/s (in units of its world) is 0.6 m "
        "deep when it is found at the end of a step of 2.1 ms, slowed to 234 m/s, never turned, and leaves at the far side of "
        "20 m of wall. scale_km and scale_mm are the same world a thousand times as large and as small."
    )),
    _depth("dt_torture_1ms", "mujoco/tuned pybullet/tuned", _engine(
        "a ball is shot at a wall at 300 m/s, and a frame of 1 ms is one step of every preset: the ball covers 0.3 m in it "
        "before it is found, and is shown there; the next step turns it. MuJoCo 3.17 and PyBullet 3.2.7 look for contacts at "
        "the ends of steps."
    )),
    _depth("scale_km", "mujoco/tuned", _engine(
        "the same little world a thousand times as large, and so is its depth: divided by a thousand it is that of "
        "far_from_origin and of scale_mm to four digits."
    )),
    _depth("scale_km scale_mm", "pybullet/default", _engine(
        "some lengths of Bullet are absolute: contacts rest at a slop of 10 um, hulls have a margin of 1 mm, contacts break at "
        "20 mm, in a world of kilometres as in one of metres, and speeds end at 100 m/s, the default of maxJointVelocity, which "
        "no preset sets. So nothing scales: the ball shot at 300 km/s is stopped before the wall there, turned in "
        "far_from_origin, and goes through the wall of scale_mm."
    )),
)
"""The ball that is shot, step by step, at all frame times, places and scales."""

_ROD_SENTENCE = (
    "partly the shape we gave it. The floor was a box 0.2 m thick; a default contact of 20 ms lets the rod sink by more than "
    "its radius of 10 mm, and MuJoCo's capsule and box make one contact then, so that the other end swings through. The same "
    "with a plane: falling_rod 32 mm deep at its ends instead of 1.01 m, painleve 126 mm instead of 1.87 m; tuned 5.4 and 2.1 "
    "mm with either. Both scenes are given a plane now; what is still deep is the default contact."
)

_STRONG = "the root's constraint, which is given up to 100 kN (root_force; as it is made it has 500 N),"
"""The constraint by which PyBullet's default leads a root."""
_CONTACTS = (
    _depth("falling_rod painleve", "mujoco/default", Explanation(Cause.ADAPTER, _ROD_SENTENCE)),
    _depth("slender_spin", "mujoco/default", _engine(
        "a thin rod spins and nothing touches it. With the default integrator, Euler, its speed grows without end and poses are "
        "no numbers from frame 32 on. MuJoCo would then go back to the first state, at rest (autoreset); the adapter switches "
        "that off, so that it is seen. IMPLICIT, documented for gyroscopic motion, and IMPLICITFAST stay finite and lose 99.9 % "
        "of the angular momentum; RK4, which is tuned, 0.13 % at the default step."
    )),
    _depth("heavy_on_light_ratios", "mujoco/default", _engine(
        "a body rests on one of a ten-thousandth of its mass: a default contact gives way by the load over the mass of what "
        "bears it, and the light body is pressed into the floor by half its height."
    )),
    _depth("heavy_on_light_ratios", "pybullet/default", _engine(
        "bodies rest on ones of a thousandth and a ten-thousandth of their mass, and the default solver lets the light ones be "
        "pressed into the floor; the tuned one, with more iterations, does not."
    )),
    _depth("slivers", "mujoco/default", _engine(
        "MuJoCo 3.17 tunnels. Boxes fly at 20 m/s at a sheet of 1 mm; a default step covers 40 mm, so that they are found when "
        "half of them is through, and leave on the other side."
    )),
    _depth("coincident_start deep_overlap", "*", Explanation(
        Cause.SCENE, "it begins 200 mm inside itself, and this is the first frame; our engine refuses the scene."
    )),
    _depth("worn_floor split_invariance", "pybullet/*", Explanation(
        Cause.ADAPTER,
        "PyBullet takes 16 pieces for one body and drops the others without a word, so that of 64 stones of a floor 16 were "
        "there and what slid on fell off their end. The adapter now makes several bodies of them; figures of this size are of "
        "before."
    )),
    _depth("teleport", "mujoco/default", Explanation(
        Cause.SCENE, "the tracker jumps by metres to where its own posture is 212 mm deep, and welds of every link draw the "
                     "body after it. Tuned, with a weld of 60 ms, is not drawn that deep."
    )),
    _depth("teleport", "pybullet/default", _setting(
        f"{_STRONG} pulls the body into what it meets on the way of a tracker that jumps by metres: "
        "its deepest contact at the end of a frame is 162 mm, with root_force 2000 N 41 mm."
    )),
)

_LAG_MUJOCO = _engine(
    "a weld of the default time constant of 20 ms follows a steady motion 38 ms behind (2 T d), limbs move at several m/s, and "
    "the offset is 42 ms of its target's speed. Without bodies and self-contact it is nearly as large; aimed ahead by that "
    "lag, as tuned, less than half."
)
_LAG_PYBULLET = _setting(
    "motors are given no target velocity by default (feed_forward), as in a call that leaves it out; a ball motor of "
    "default gain then corrects a fiftieth of its error per step, so that limbs trail a steady turn by 50 steps, 0.2 s. "
    "Without bodies and self-contact it stays (mocap_run 122 of 121 mm); with the tracker's velocity and ball_gain 0.5 "
    "(pybullet/follows) it is 8.8 mm in mocap_run, 2.0 of 124 in mocap_crawl, 4.1 of 140 in mocap_getup_faceup. What trails "
    "is caught by walls and furniture besides, and even the root is held off then."
)
_UNSAID = (
    "avatars are built by createMultiBody, which has no word for the limits of spherical joints that Bullet has for "
    "models in URDF files"
)
_STOPS_PYBULLET = _adapter(
    f"{_UNSAID}; a motor torque stands in for them (limit_force), and after a contact it holds a limb at "
    "the other end of its range while its user is free again. It is few frames: in mocap_run 3 of 9 free ones, in "
    "mocap_getup_facedown 2 of 212. Without that torque it is worse: mocap_run 299 mm instead of 110, mocap_getup_facedown "
    "688 instead of 194."
)
_SERVOS = _setting(
    "a servo has the torque that our setting gives it, 100 N m, and aims ahead by its lag in steady motion only: mocap_run is "
    "128 mm off; mocap_spin 26 here, at 30 N m without lead 173 with all contacts off."
)
_WALL = _engine(
    "the hand passes through the wall while its user reaches through at up to 20 m/s, and is held on the far side when the user "
    "is free again (frames on the wrong side tell how long): MuJoCo 3.17 and PyBullet 3.2.7 look for contacts at the ends of "
    "steps."
)
_FOLLOWING = (
    _offset("thin_wall_hand", "mujoco/default pybullet/default", _WALL),
    _offset("mocap_* unseen_*", "mujoco/default", _LAG_MUJOCO),
    _offset("unseen_door unseen_gallery", "mujoco/tuned mujoco/hinges", Explanation(
        Cause.SCENE, "its user walks through the wall beside the door; a body that goes through nothing stays on its side of the "
                     "wall until the user is back, ours too."
    )),
    _offset("mocap_* unseen_*", "mujoco/servos", _SERVOS),
    _offset("mocap_* unseen_* chain_order", "pybullet/default", _LAG_PYBULLET),
    _offset("mocap_* unseen_*", "pybullet/tuned", _STOPS_PYBULLET),
    _offset("unseen_*", "pybullet/follows", _adapter(
        f"{_UNSAID}, and a limb that was pushed round to the other side of an obstacle or of its own joint stays "
        "there, at times with the root; where nothing catches it, it is the nearest of all to its user."
    )),
    _depth("mocap_* unseen_*", "pybullet/default pybullet/follows", _setting(
        f"{_STRONG} and motors of 100 kN m, their default, pull the body into what it meets: deepest "
        "contact at the end of a frame mocap_crawl 91 mm, with root_force 2000 N 3.7; mocap_getup_facedown 101 and 4.8; in "
        "rooms of drawn motions a fifth."
    )),
    _depth("mocap_* unseen_*", "mujoco/default", _engine(
        "welds of 20 ms pull the body after its user, and a default contact is a spring of 20 ms that gives way to them; "
        "tuned, whose contacts act within a step, hardly does."
    )),
)

_HINGES = (
    "Three hinges with ranges in its place limit it in part: row mujoco/hinges, in rooms that nothing was tuned for."
)
_UNLIMITED = "adapter: twist unlimited"
_BALLS_UNLIMITED = "adapter: ball joints unlimited"
_LIMITS = (
    _excess("limit_torture*", "mujoco/* pybullet/*", Explanation(
        Cause.SCENE, "the user asks for postures beyond every limit all the time; defaults follow the user there, as their ball "
                     "joints are made without swing or twist limits and default limits of hinges give way within 20 ms. What "
                     "tuned loses is twist, which our adapter leaves unlimited in MuJoCo (see the other rules of twist) and of "
                     "which PyBullet's limit_force is a stand-in (124 degrees of twist, 41 of swing)."
    )),
    _excess("teleport", "mujoco/* pybullet/*", Explanation(
        Cause.SCENE, "the tracker jumps by metres and the body is drawn after it through whatever its limbs catch on; nearly "
                     "all of it is twist, which our adapter leaves unlimited (tuned: twist 147 degrees, swing 6.9): it makes "
                     "MuJoCo ball joints, whose range limits the total turn, and PyBullet's by createMultiBody, which has no "
                     "word for their limits."
    )),
    _excess("hand_in_corner*", "mujoco/default", _engine(
        "hinges of fingers that are pressed into a corner: a default limit is a spring of 20 ms (at two steps 58 degrees "
        "instead of 96)."
    )),
    _excess("hand_in_corner*", "pybullet/default", _setting(
        f"{_STRONG} breaks hinges of fingers that are pressed into a corner (79 degrees at 60 N instead of 135)."
    )),
    _excess("*", "mujoco/default", _adapter(
        "our adapter makes MuJoCo ball joints, whose range limits the total turn, so that default joints have neither swing cone "
        "nor twist limit; contacts turn limbs about their axes. With swing limits as tendons and targets clamped it is alike "
        f"(mocap_spin 149 instead of 146 degrees, all of it twist). {_HINGES}", _UNLIMITED
    )),
    _excess("*", "mujoco/servos", _adapter(
        "it is twist, which our adapter leaves unlimited: it makes MuJoCo ball joints, whose range limits the total turn. "
        f"{_HINGES}", _UNLIMITED
    )),
    _excess("unseen_*", "mujoco/hinges", _adapter(
        "our adapter makes three hinges of each ball joint, and these are within some degrees of their ranges: "
        "what is beyond is the difference of their angles from swing and twist, which the scene limits and the judge measures.",
        "adapter: angles of hinges are not swing and twist"
    )),
    _excess("*", "mujoco/tuned mujoco/sleeping", _adapter(
        "it is twist, which our adapter leaves unlimited: it makes MuJoCo ball joints, whose range limits the total turn; swing, "
        "which tendons limit, is 2.4 degrees beyond at most (mocap_crawl 100 degrees of twist, 0.5 of swing; mocap_spin 120 and "
        f"0.2). {_HINGES}", _UNLIMITED
    )),
    _excess("*", "pybullet/tuned pybullet/sleeping", _adapter(
        f"{_UNSAID}. A motor torque stands in for them (limit_force), and what pushes a limb is at times stronger.",
        _BALLS_UNLIMITED
    )),
    _excess("*", "pybullet/default pybullet/follows", _adapter(
        f"{_UNSAID}, and 100 kN, our setting for the root's constraint, against motors of 100 kN m twists what is caught: with "
        "root_force 2000 N joints go a third to half as far beyond.", _BALLS_UNLIMITED
    )),
)

EXPLAINED: tuple[Rule, ...] = (*_SHOT, *_CONTACTS, *_FOLLOWING, *_LIMITS)
"""The first that fits holds."""


ASKED = (DEPTH, OFFSET)
"""Metrics in metres that a reader sees: how deep something is in something else, how far a link is from a target that is free."""
BOUNDS = {DEPTH: LARGE, OFFSET: LARGE, EXCESS: LARGE_ANGLE}
"""Every metric of which large figures are explained, and what is large, in its own unit."""
SAME = 0.01
"""Share by which a variant of a preset may differ from it and still have its explanation: its settings are the same but for those
that the row is about. Larger would hand on the cause of a figure that has another one."""


@dataclass(frozen=True)
class Large:
    """One row whose `value`, at size 1, is above its bound or no number, and why; None while that is not known."""

    row: Figure
    why: Explanation | None
    value: float

    @property
    def said(self) -> str:
        """The explanation as a sentence that begins with its cause."""
        return "not yet explained" if self.why is None else f"{self.why.cause.value}: {self.why.sentence}"


def large(rows: Iterable[Figure], scales: Mapping[str, float] = MappingProxyType({})) -> tuple[Large, ...]:
    """Every figure of another engine above its bound, lengths before angles and the largest first; what has no explanation stands
    before what has one. A world of another size (`scales`: scene -> size) counts as if it had size 1: a thousand times as large,
    it leads no list for that."""
    aside = {BASELINE, GATED[0]}
    asked = [row for row in rows if row.metric in BOUNDS and row.run.partition("/")[0] not in aside and row.value is not None]
    values = {(row.scenario, row.seed, row.metric, row.run): row.value for row in asked}
    found = [
        Large(row, _why(row, values), value) for row in asked
        if (value := at_size_1(row.value, row.unit, scales.get(row.scenario, 1.0))) is not None
        and not value <= BOUNDS[row.metric]
    ]
    return tuple(sorted(found, key=lambda one: (one.why is not None, one.row.metric == EXCESS, -_size(one.value))))


def briefly(scene: str, run: str) -> str:
    """Why joints of a run go beyond their limits in a scene, in a few words; "" where no rule has them."""
    found = explanation(scene, run, EXCESS)
    return found.brief if found is not None else ""


def _why(row: Figure, values: dict[tuple[str, int, str, str], float | None]) -> Explanation | None:
    """The rule of its own run, or of the preset that its run is a variant of where that has the same value."""
    found, base = explanation(row.scenario, row.run, row.metric), base_of(row.run)
    if found is not None or not base:
        return found
    other = values.get((row.scenario, row.seed, row.metric, base))
    same = other is not None and row.value is not None and (
        abs(row.value - other) <= SAME * abs(other) or math.isnan(row.value) and math.isnan(other))
    return explanation(row.scenario, base, row.metric) if same else None


def _size(value: float) -> float:
    return value if math.isfinite(value) else math.inf
