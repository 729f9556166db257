"""Every engine's settings that are swept, named by what they change against one of its own presets."""

from collections.abc import Iterable, Mapping
from dataclasses import dataclass, field

from avatarsim.scene.scene import Scene
from reference.presets import Kind, kind_of
from runfiles.engines import about
from scenarios.running.own_settings import OwnSettings

EVERYWHERE = tuple(Kind)
TRACKED = (Kind.DRIVEN, Kind.MIXED)
UNTRACKED = (Kind.BOUNCING, Kind.RESTING)
LOOSE = (*UNTRACKED, Kind.MIXED)


@dataclass(frozen=True)
class Setting:
    """One point of an engine's knobs.

    `base` is the preset beneath, `options` override it, `narrow` leaves out effects of the scene (ours only), `cut` advances each
    rendered frame in so many parts (for engines whose step is the frame). `kinds` are the scenes in which it changes anything,
    `calls` effects that such a scene must call for.
    """

    engine: str
    name: str
    base: str
    options: Mapping[str, object] = field(default_factory=dict)
    narrow: tuple[str, ...] = ()
    cut: int = 1
    kinds: tuple[Kind, ...] = EVERYWHERE
    calls: tuple[str, ...] = ()

    @property
    def is_preset(self) -> bool:
        """Whether it is the preset beneath as it comes."""
        return self.name == self.base

    @property
    def slug(self) -> str:
        """The name as part of a file name."""
        return self.name.replace("/", "_").replace(" ", ".")

    @property
    def run(self) -> str:
        """Engine and setting as tables name them."""
        return f"{self.engine}/{self.name}"


def _ours(name: str, base: str = "default", kinds: tuple[Kind, ...] = TRACKED, **options: float) -> Setting:
    return Setting("avatarsim", f"{base} {name}", base, options, kinds=kinds)


OURS = (
    Setting("avatarsim", "default", "default"),
    Setting("avatarsim", "paper", "paper"),
    _ours("stand_off=2e-5", stand_off=2e-5),
    _ours("stand_off=1e-3", stand_off=1e-3),
    _ours("steps=1", steps=1),
    _ours("steps=4", steps=4),
    _ours("damping_time=0", damping_time=0.0),
    _ours("damping_time=0.05", damping_time=0.05),
    _ours("work=300", work=300),
    _ours("sweeps=6", "paper", sweeps=6),
    _ours("rounds=4", "paper", rounds=4),
    Setting("avatarsim", "default continuous=off", "default", narrow=("continuous",), kinds=LOOSE),
    Setting("avatarsim", "default frame=1/120", "default", cut=2),
    Setting("avatarsim", "default frame=1/240", "default", cut=4),
)
"""Tolerances, caps, method, continuous detection, and the frame, which is the only step there is. What bounces and slides is
computed from event to event in closed form and has no tolerance to sweep."""


def _steps(engine: str, base: str, rates: Iterable[int], kinds: tuple[Kind, ...] = EVERYWHERE) -> tuple[Setting, ...]:
    return tuple(Setting(engine, f"{base} dt=1/{rate}", base, {"dt": 1.0 / rate}, kinds=kinds) for rate in rates)


def _mujoco(name: str, kinds: tuple[Kind, ...] = EVERYWHERE, **options: object) -> Setting:
    return Setting("mujoco", f"tuned {name}", "tuned", options, kinds=kinds)


DISCRETE = {"integrator": "DISCRETE", "refsafe": False, "contact": "soft", "contact_steps": 0.1, "limit_steps": 0.1}
"""MuJoCo's stiffest stop, for scenes in which nothing needs to bounce."""

MARGINS = (0.0, 2e-4, 4e-4, 1e-3)
"""Distances [m] from which on MuJoCo makes contact: of links, and of loose things. Ours has one of its own, `stand_off`, and
that is swept as well."""

MUJOCO = (
    Setting("mujoco", "default", "default"),
    Setting("mujoco", "tuned", "tuned"),
    *_steps("mujoco", "default", (60, 240, 1920)),
    *_steps("mujoco", "tuned", (60, 120, 240, 480, 1920)),
    _mujoco("iterations=10", iterations=10),
    _mujoco("cone=PYRAMIDAL", cone="PYRAMIDAL"),
    _mujoco("kappa=0.02", LOOSE, kappa=0.02),
    _mujoco("contact_time=0.004", contact="soft", contact_time=0.004, solimp=(0.95, 0.99, 0.001)),
    _mujoco("DISCRETE dt=1/240", TRACKED, dt=1.0 / 240.0, **DISCRETE),
    _mujoco("DISCRETE", TRACKED, **DISCRETE),
    _mujoco("motors DISCRETE", (Kind.DRIVEN,), drive="motors", motor_force=100.0, **DISCRETE),
    _mujoco("motors DISCRETE dt=1/240", (Kind.DRIVEN,), dt=1.0 / 240.0, drive="motors", armature=4.0, lead=0.0, weld_time=0.04,
            **DISCRETE),
    _mujoco("weld_time=0.01", TRACKED, weld_time=0.01),
    *(_mujoco(f"margin={margin:g}", TRACKED, margin=margin) for margin in MARGINS),
    *(_mujoco(f"loose_margin={margin:g}", LOOSE, loose_margin=margin) for margin in MARGINS),
    *_steps("mujoco", "tuned", (3840,), LOOSE),
    *_steps("mujoco", "tuned", (7680,), UNTRACKED),
    Setting("mujoco", "tuned sleep=true", "tuned", {"sleep": True}, kinds=LOOSE, calls=("sleeping",)),
    Setting("mujoco", "tuned sleep=true margin=0", "tuned", {"sleep": True, "margin": 0.0}, kinds=(Kind.MIXED,),
            calls=("sleeping",)),
)
"""Step, iterations, cone, stiffness of contacts and welds, margins, integrator, motors in place of welds, sleep."""


def _pybullet(name: str, kinds: tuple[Kind, ...] = EVERYWHERE, **options: object) -> Setting:
    return Setting("pybullet", f"tuned {name}", "tuned", options, kinds=kinds)


PYBULLET = (
    Setting("pybullet", "default", "default"),
    Setting("pybullet", "tuned", "tuned"),
    *_steps("pybullet", "default", (60, 960)),
    *_steps("pybullet", "tuned", (60, 120, 240, 1920)),
    *_steps("pybullet", "tuned", (480,), LOOSE),
    *_steps("pybullet", "tuned", (960,), TRACKED),
    _pybullet("solver_iterations=10", solver_iterations=10),
    _pybullet("solver_iterations=200", solver_iterations=200),
    _pybullet("contact_erp=0.1", set_contact_erp=True, contact_erp=0.1),
    _pybullet("drive=velocity", TRACKED, drive="velocity"),
    _pybullet("force=30", TRACKED, hinge_force=30.0, ball_force=30.0),
    _pybullet("multibody erp=0", (Kind.BOUNCING,), maximal=False, split_impulse=False, contact_erp=0.0),
    _pybullet("processing_threshold=1", (Kind.BOUNCING,), processing_threshold=1.0),
    _pybullet("slop=1e-4", contact_slop=1e-4),
    _pybullet("margin=0.001", collision_margin=0.001),
    _pybullet("breaking_threshold=0.02", TRACKED, breaking_threshold=0.02),
    _pybullet("pieces_as_links=off", TRACKED, pieces_as_links=False),
    Setting("pybullet", "default feed_forward", "default", {"feed_forward": True, "ball_gain": 0.5}, kinds=TRACKED),
    *_steps("pybullet", "tuned", (3840,), LOOSE),
    *_steps("pybullet", "tuned", (7680,), UNTRACKED),
    Setting("pybullet", "tuned sleep=true", "tuned", {"sleep": True}, kinds=LOOSE, calls=("sleeping",)),
)
"""Step, iterations, how hard contacts push and how early, margins, how the hand is driven, which solver bodies are in,
motors that know the user's velocity, sleep."""

BY_ENGINE = {"avatarsim": OURS, "mujoco": MUJOCO, "pybullet": PYBULLET}
"""Engines of which we know what to turn; of all others their presets are taken."""


def settings_of(engine: str, presets: Iterable[str], own: Iterable[OwnSettings] = ()) -> tuple[Setting, ...]:
    """What is swept of one engine: the grid, or its presets where there is no grid, and a reader's own rows."""
    known = BY_ENGINE.get(engine) or tuple(Setting(engine, preset, preset) for preset in presets)
    rows = tuple(Setting(engine, row.name, row.base, dict(row.options)) for row in own if row.engine == engine)
    return (*known, *rows)


def applicable(setting: Setting, scene: Scene) -> bool:
    """Whether the setting can change anything in this scene."""
    derived = scene.derived_effects
    return kind_of(scene) in setting.kinds and all(getattr(derived, effect) for effect in (*setting.narrow, *setting.calls))


def sleeps(setting: Setting, scene: Scene) -> bool:
    """Whether what rests in `scene` falls asleep with the setting: in ours by itself, in the others where they are told to."""
    if about(setting.engine).sleeps:
        return scene.derived_effects.sleeping and "sleeping" not in setting.narrow
    return setting.base == "sleeping" or bool(setting.options.get("sleep", False))
