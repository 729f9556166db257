"""A swept setting in the words of the engine itself: options of MuJoCo's model, calls of PyBullet."""

from collections.abc import Callable, Mapping

from scenarios.studies.sweep.grid import Setting

Said = Callable[[object], str]


def _plain(name: str) -> Said:
    # a float to its last digit, so that it is the one that was measured
    return lambda value: f"{name}{value!r}" if isinstance(value, float) else f"{name}{value}"


def _enum(name: str, prefix: str) -> Said:
    return lambda value: f"opt.{name} = mujoco.{prefix}_{value}"


def _flag(yes: str, no: str) -> Said:
    return lambda value: yes if value else no


MUJOCO: Mapping[str, Said] = {
    "dt": _plain("opt.timestep = "),
    "integrator": _enum("integrator", "mjtIntegrator.mjINT"),
    "cone": _enum("cone", "mjtCone.mjCONE"),
    "iterations": _plain("opt.iterations = "),
    "refsafe": _flag("refsafe on", "opt.disableflags |= mjDSBL_REFSAFE"),
    "sleep": _flag("opt.enableflags |= mjENBL_SLEEP", "no mjENBL_SLEEP"),
    "contact_time": lambda value: f"geom_solref = ({value}, 1)",
    "contact_steps": lambda value: f"geom_solref = ({value} opt.timestep, 1)",
    "limit_steps": lambda value: f"jnt_solref = ({value} opt.timestep, 1)",
    "solimp": lambda value: f"geom_solimp = {value}",
    "margin": _plain("geom_margin of links = "),
    "loose_margin": lambda value: f"geom_margin of what is not driven = {value!r} / 2 (two add up), pair_margin = {value!r}",
    "weld_time": lambda value: f"eq_solref of welds = ({value}, 1)",
    "drive": lambda value: "position actuators in joints, only the root welded" if value == "motors" else "a weld per link",
    "motor_force": _plain("actuator_forcerange = +-"),
    "armature": lambda value: f"dof_armature = {value} of a link's inertia",
}
"""Our name of a setting -> what is set in an mjModel."""



def _call(function: str, argument: str) -> Said:
    return lambda value: f"{function}({argument}={value!r})" if isinstance(value, float) else f"{function}({argument}={value})"


ENGINE, DYNAMICS = "setPhysicsEngineParameter", "changeDynamics"
PYBULLET: Mapping[str, Said] = {
    "dt": _call(ENGINE, "fixedTimeStep"),
    "solver_iterations": _call(ENGINE, "numSolverIterations"),
    "contact_slop": _call(ENGINE, "contactSlop"),
    "contact_erp": _call(ENGINE, "contactERP"),
    "breaking_threshold": _call(ENGINE, "contactBreakingThreshold"),
    "collision_margin": _call(DYNAMICS, "collisionMargin"),
    "processing_threshold": _call(DYNAMICS, "contactProcessingThreshold"),
    "sleep": lambda value: f"{DYNAMICS}(activationState={'ACTIVATION_STATE_ENABLE_SLEEPING' if value else 0})",
    "split_impulse": lambda value: f"{ENGINE}(useSplitImpulse={int(bool(value))})",
    "hinge_force": _call("setJointMotorControl2", "force"),
    "ball_force": lambda value: f"setJointMotorControlMultiDof(force=[{value}] * 3)",
}
"""Our name of a setting -> the call that sets it."""
BY_ENGINE = {"mujoco": MUJOCO, "pybullet": PYBULLET}


def native(setting: Setting) -> str:
    """What is set in the engine's own words beside the preset beneath; "" for a preset and for engines of which we have no words.
    Options that only our adapter knows are left out: the row for `--settings` has them all."""
    words = BY_ENGINE.get(setting.engine, {})
    return "; ".join(words[name](value) for name, value in setting.options.items() if name in words)
