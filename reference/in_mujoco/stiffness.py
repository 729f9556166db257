"""The settings that depend on the length of a step, written into a compiled model."""

import mujoco
import numpy as np
from numpy.typing import NDArray

from avatarsim.errors import InvalidInput
from reference.in_mujoco.laws import Law
from reference.in_mujoco.motors import DRIVES
from reference.in_mujoco.world import World
from reference.presets import Options

SOFTEST = 0.02
"""MuJoCo's default time constant [s] of limits."""

STIFFEST = 2.0
"""Shortest time constant, in steps, that MuJoCo can follow, and that refsafe admits."""

CONTACTS = ("soft", "one_step")
"""Contact laws: MuJoCo's spring and damper, or a damper that acts within one step (Newton's law of
restitution)."""


JOINTS = ("balls", "hinges")
"""Models of a ball joint with limits: MuJoCo's ball, whose range is of its total turn, or three hinges with ranges, the last
about the limb. Servos are in balls only."""
FLOORS = ("boxes", "planes")
"""Models of a fixed box: a box, or an infinite plane at its top."""


def check_words(chosen: Options) -> None:
    """Raise for words that MuJoCo or the adapter does not know, and for a step or servos that are not above 0."""
    for name, ours in (("contact", CONTACTS), ("drive", DRIVES), ("floors", FLOORS), ("ball_joints", JOINTS)):
        chosen.word("mujoco", name, ours)
    if chosen["drive"].value == "motors" and chosen["ball_joints"].value == "hinges":
        raise InvalidInput("option ball_joints of mujoco", "hinges", "balls where the drive is motors, whose servos are in balls")
    words_of = {"integrator": mujoco.mjtIntegrator, "cone": mujoco.mjtCone, "solver": mujoco.mjtSolver}
    for name, prefix in (("integrator", "mjINT_"), ("cone", "mjCONE_"), ("solver", "mjSOL_")):
        known = [word.removeprefix(prefix) for word in words_of[name].__members__ if word.startswith(prefix)]
        chosen.word("mujoco", name, known)
    for name in ("dt", "motor_stiffness", "motor_damping_ratio"):
        if not chosen.number(name) > 0.0:
            raise InvalidInput(f"option {name} of mujoco", chosen[name].value, "above 0")
    if not chosen.number("motor_force") >= 0.0:
        raise InvalidInput("option motor_force of mujoco", chosen["motor_force"].value, "0 or above")


class Stiffness:
    """Writes time step, contact law, limits and welds into the model of one world."""

    def __init__(self, world: World, chosen: Options) -> None:
        self._world, self._chosen = world, chosen

    def set_options(self) -> None:
        """Set the options that do not depend on the step."""
        option, model = self._world.model.opt, self._world.model
        option.integrator = getattr(mujoco.mjtIntegrator, f"mjINT_{self._word('integrator')}")
        option.cone = getattr(mujoco.mjtCone, f"mjCONE_{self._word('cone')}")
        option.iterations, option.tolerance = int(self._chosen.number("iterations")), self._chosen.number("tolerance")
        option.impratio, option.noslip_iterations = self._chosen.number("impratio"), int(self._chosen.number("noslip_iterations"))
        option.solver = getattr(mujoco.mjtSolver, f"mjSOL_{self._word('solver')}")
        for name, flag in (("refsafe", "REFSAFE"), ("islands", "ISLAND"), ("warm_starts", "WARMSTART")):
            bit = int(getattr(mujoco.mjtDisableBit, f"mjDSBL_{flag}"))
            option.disableflags = option.disableflags & ~bit if self._chosen[name].value else option.disableflags | bit
        if self._chosen["sleep"].value:
            option.enableflags |= int(mujoco.mjtEnableBit.mjENBL_SLEEP)
        model.eq_solimp[:, :3] = self._chosen["weld_solimp"].value
        model.eq_data[:, 10] = self._chosen.number("weld_rotation")
        model.geom_margin[:] = self._geom_margins()
        margins = self._chosen.number("margin"), self._chosen.number("loose_margin")
        model.pair_margin[:] = np.where(self._world.pair_driven, *margins)
        for solimp in (model.geom_solimp, model.pair_solimp, model.jnt_solimp, model.tendon_solimp_lim):
            solimp[:, :3] = self._chosen["solimp"].value

    def _geom_margins(self) -> NDArray[np.float64]:
        """Return the margin [m] of each geom: MuJoCo adds those of two geoms that meet.

        Loose bodies meet all bodies that are not driven at `loose_margin`, in halves. Without loose bodies links carry halves of
        `margin`, so that two links, and a link and a wall, meet at one. With loose bodies links carry all of it but the half that
        the others have, since nothing is to hover at `margin` over fixed bodies; two links then meet at more.
        """
        world, margin, half = self._world, self._chosen.number("margin"), 0.5 * self._chosen.number("loose_margin")
        if not len(world.free[0]):
            return np.full(len(world.geom_driven), 0.5 * margin)
        return np.where(world.geom_driven, max(margin - half, 0.0), half)

    def set_step(self, step: float) -> None:
        """Set the options that depend on the step [s]."""
        model = self._world.model
        model.opt.timestep = step
        for g, law in enumerate(self._world.geom_law):
            model.geom_solref[g] = self._contact(law, step)
        for p, law in enumerate(self._world.pair_law):
            model.pair_solref[p] = self._contact(law, step)
            model.pair_solreffriction[p] = self._friction(law, step)
        steps = self._chosen.number("limit_steps")
        limit = (steps * step if steps > 0.0 else SOFTEST, 1.0)
        model.jnt_solref[:] = limit
        model.tendon_solref_lim[:] = limit
        if self._chosen.number("weld_stiffness") > 0.0:
            for weld, (one, other) in enumerate(zip(model.eq_obj1id, model.eq_obj2id, strict=True)):
                mass = float(max(model.body_mass[one], model.body_mass[other]))
                model.eq_solref[weld] = -self._chosen.number("weld_stiffness") / mass, -self._chosen.number("weld_damping") / mass
        else:
            model.eq_solref[:] = (self.weld_time(step), 1.0)

    def weld_time(self, step: float) -> float:
        """Return the time constant [s] of the welds to the tracked poses."""
        steps = self._chosen.number("weld_steps")
        return steps * step if steps > 0.0 else self._chosen.number("weld_time")

    def lead(self, step: float) -> float:
        """Return the time [s] by which the welds aim ahead of the tracker.

        A weld of time constant T and full impedance d follows a steady motion 2 T d behind (damping over stiffness).
        """
        if self._chosen.number("weld_stiffness") > 0.0:
            return self._chosen.number("lead") * self._chosen.number("weld_damping") / self._chosen.number("weld_stiffness")
        return self._chosen.number("lead") * 2.0 * self.weld_time(step) * float(self._world.model.eq_solimp[:1, 1].sum())

    def _contact(self, law: Law, step: float) -> tuple[float, float]:
        """Return MuJoCo's two solref numbers: (time constant, damping ratio), or negative (stiffness, damping)."""
        if self._word("contact") == "soft":
            steps = self._chosen.number("contact_steps")
            return (steps * step if steps > 0.0 else self._chosen.number("contact_time")), 1.0
        kappa = self._chosen.number("kappa_driven" if law.stops else "kappa_resting" if law.rubs else "kappa")
        # a stiffness of exactly 0 would be read as the other format
        return -max(kappa, 1e-12) / step**2, -(1.0 + law.restitution) / step

    def _friction(self, law: Law, step: float) -> tuple[float, float]:
        """Return solreffriction of a pair: friction is not bouncy, and zeros would give it the contact's own constants."""
        if self._word("contact") == "soft":
            return 0.0, 0.0
        if not law.rubs:
            return self._chosen.number("friction_steps") * step, 1.0
        longest = self._chosen.number("friction_time_resting")
        return max(STIFFEST * step, min(self._chosen.number("friction_steps_resting") * step, longest)), 1.0

    def _word(self, name: str) -> str:
        return str(self._chosen[name].value)
