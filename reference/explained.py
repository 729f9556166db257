"""Why is a figure of another engine larger than 100 mm: is it the engine, our adapter, or what the scene asks?

Data, by scene and run. Each sentence says what was looked at: recordings of both presets, or the same scene at other settings
or in another scale. A figure without an entry is printed as not yet explained.
"""

from collections.abc import Mapping
from dataclasses import dataclass
from enum import Enum

LARGE = 0.1
"""[m]: figures of other engines above it want an explanation. A hand's width: no reader takes it for a question of settings."""


class Cause(Enum):
    """Where a large figure comes from."""

    ENGINE = "the engine"
    ADAPTER = "our adapter"
    SCENE = "the scene"


@dataclass(frozen=True)
class Explanation:
    """The cause, and one sentence without it."""

    cause: Cause
    sentence: str


def _engine(sentence: str) -> Explanation:
    return Explanation(Cause.ENGINE, sentence)


_BEGINS_INSIDE = Explanation(
    Cause.SCENE, "it begins 200 mm inside itself, and this is the first frame; our engine refuses the scene."
)
_RUNS = ("mujoco/default", "mujoco/tuned", "pybullet/default", "pybullet/tuned")

_SHOT_MUJOCO = _engine(
    "a ball is shot at a wall at 300 m/s; it is found at the end of a step of 2 ms, up to 0.6 m deep, and the default "
    "contact, a spring of 20 ms, stops it later still. Tuned steps are shorter, and frames of 1/60 s show the ball after it "
    "has left."
)
_ONE_STEP = _engine(
    "a ball is shot at a wall at 300 m/s, and a frame of 1 ms is one step: the ball covers 0.3 m in it before it is found; "
    "the engine looks for contacts at the ends of steps."
)
_FAR_FROM_ORIGIN = _engine(
    "not the distance from the origin: the same ball of 300 m/s is as deep, in its own scale, in scale_mm and scale_km. It "
    "is found at the end of a step of 2 ms and stopped by a default spring of 20 ms."
)
_KILOMETRES = _engine(
    "the same little world a thousand times as large, and so is its depth: divided by a thousand it is that of "
    "far_from_origin and of scale_mm to four digits."
)
_ROD = _engine(
    "at the default time constant of 20 ms the rod sinks by more than its radius of 10 mm when it lands; from then on only "
    "one of its ends is held at the surface, and the other swings through the floor. Tuned, with contacts that stop within a "
    "step, it stays on the floor."
)
_LAG_MUJOCO = _engine(
    "a weld of the default time constant of 20 ms follows a steady motion some 40 ms behind; this clip's limbs move at "
    "several m/s. Tuned aims ahead by that lag."
)
_LAG_PYBULLET = _engine(
    "the root is within 15 mm of its user in half of the frames, wrists and ankles are up to 0.9 m off: joint motors at the "
    "default gain of 0.1 without a target velocity trail fast limbs. Tuned gives the velocity."
)
_SIXTEEN = Explanation(
    Cause.ADAPTER,
    "PyBullet takes 16 pieces for one body and drops the others without a word, so that of 64 stones of a floor 16 were "
    "there and what slid on fell off their end. The adapter now makes several bodies of them; figures of this size are of "
    "before."
)

EXPLAINED: Mapping[tuple[str, str], Explanation] = {
    **{(scene, run): _BEGINS_INSIDE for scene in ("coincident_start", "deep_overlap") for run in _RUNS},
    **{("worn_floor", f"pybullet/{preset}"): _SIXTEEN for preset in ("default", "tuned")},
    **{("split_invariance", f"pybullet/{preset}"): _SIXTEEN for preset in ("default", "tuned")},
    ("dt_torture_1ms", "mujoco/default"): _SHOT_MUJOCO,
    ("dt_torture_1ms", "mujoco/tuned"): _ONE_STEP,
    ("dt_torture_1ms", "pybullet/tuned"): _ONE_STEP,
    ("dt_torture_30ms", "mujoco/default"): _SHOT_MUJOCO,
    ("far_from_origin", "mujoco/default"): _FAR_FROM_ORIGIN,
    ("scale_km", "mujoco/default"): _KILOMETRES,
    ("scale_km", "mujoco/tuned"): _KILOMETRES,
    ("scale_km", "pybullet/default"): _engine(
        "the same little world a thousand times as large: divided by a thousand it is 0.4 mm, as deep as default contacts "
        "leave bodies in dt_torture (0.3 mm) and far_from_origin (1.4 mm)."
    ),
    ("slender_spin", "mujoco/default"): _engine(
        "a thin rod spins and nothing touches it; poses are no numbers in the end with the default integrator, Euler. With "
        "RK4, which is tuned, they are."
    ),
    ("falling_rod", "mujoco/default"): _ROD,
    ("painleve", "mujoco/default"): _ROD,
    ("heavy_on_light_ratios", "mujoco/default"): _engine(
        "a body rests on one of a ten-thousandth of its mass: a default contact gives way by the load over the mass of what "
        "bears it, and the light body is pressed into the floor by half its height."
    ),
    ("heavy_on_light_ratios", "pybullet/default"): _engine(
        "bodies rest on ones of a thousandth and a ten-thousandth of their mass, and the default solver lets the light ones "
        "be pressed into the floor; the tuned one, with more iterations, does not."
    ),
    ("slivers", "mujoco/default"): _engine(
        "boxes fly at 20 m/s at a sheet of 1 mm; a default step covers 40 mm, so that they are found when half of them is "
        "through, and leave on the other side."
    ),
    **{("mocap_" + clip, "mujoco/default"): _LAG_MUJOCO for clip in ("backflip", "run")},
    **{
        ("mocap_" + clip, "pybullet/default"): _LAG_PYBULLET
        for clip in ("backflip", "cartwheel", "dance_a", "dance_b", "jump", "spin", "walk")
    },
    ("chain_order", "pybullet/default"): _LAG_PYBULLET,
    **{
        ("thin_wall_hand", f"{engine}/default"): _engine(
            "the hand passes through the wall while its user reaches through at up to 20 m/s, and is held on the far side "
            "when the user is free again (frames on the wrong side tell how long): contacts are looked for at the ends of "
            "steps."
        ) for engine in ("mujoco", "pybullet")
    },
}
"""By (scene, run)."""
