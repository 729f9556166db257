"""A swept setting in the words of the engine itself: options of MuJoCo's model, calls of PyBullet.

Only what can be set in what the preset loaded and is then all that changes. A step is no such thing: constants of contacts,
friction and limits are written for it, and targets are told step by step; so are margins, which links share with what is loose,
and the time of welds, by which targets are led.
"""

from collections.abc import Callable, Mapping

from scenarios.studies.sweep.grid import Setting

Said = Callable[[object], str]


def _enum(name: str, prefix: str) -> Said:
    return lambda value: f"opt.{name} = mujoco.{prefix}_{value}"


def _flag(yes: str, no: str) -> Said:
    return lambda value: yes if value else no


SLEEP, REFSAFE = "mujoco.mjtEnableBit.mjENBL_SLEEP", "mujoco.mjtDisableBit.mjDSBL_REFSAFE"
MUJOCO: Mapping[str, Said] = {
    "integrator": _enum("integrator", "mjtIntegrator.mjINT"),
    "cone": _enum("cone", "mjtCone.mjCONE"),
    "iterations": lambda value: f"opt.iterations = {value}",
    "refsafe": _flag(f"opt.disableflags &= ~{REFSAFE}", f"opt.disableflags |= {REFSAFE}"),
    "sleep": _flag(f"opt.enableflags |= {SLEEP}", f"opt.enableflags &= ~{SLEEP}"),
}
"""Our name of a setting -> what is set in an mjModel."""


def _call(function: str, argument: str) -> Said:
    # a float to its last digit, so that it is the one that was measured
    return lambda value: f"{function}({argument}={value!r})" if isinstance(value, float) else f"{function}({argument}={value})"


ENGINE, DYNAMICS = "setPhysicsEngineParameter", "changeDynamics"
PYBULLET: Mapping[str, Said] = {
    "solver_iterations": _call(ENGINE, "numSolverIterations"),
    "contact_slop": _call(ENGINE, "contactSlop"),
    "breaking_threshold": _call(ENGINE, "contactBreakingThreshold"),
    "collision_margin": _call(DYNAMICS, "collisionMargin"),
    "sleep": lambda value: f"{DYNAMICS}(activationState={'ACTIVATION_STATE_ENABLE_SLEEPING' if value else 0})",
    "hinge_force": _call("setJointMotorControl2", "force"),
    "ball_force": lambda value: f"setJointMotorControlMultiDof(force=[{value}] * 3)",
}
"""Our name of a setting -> the call that sets it."""
BY_ENGINE = {"mujoco": MUJOCO, "pybullet": PYBULLET}


def native(setting: Setting) -> str:
    """What is set in the engine's own words in what it loaded with the preset beneath, if that is all that the setting changes;
    "" for a preset, for engines of which we have no words, and where any option has none: the row for `--settings` has all."""
    words = BY_ENGINE.get(setting.engine, {})
    if not all(name in words for name in setting.options):
        return ""
    return "; ".join(words[name](value) for name, value in setting.options.items())
