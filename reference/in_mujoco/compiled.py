"""MJCF of a model as it is stepped: values written into the compiled model are copied back into its MjSpec, which MuJoCo writes
as XML.

The adapter sets stiffness after compilation, since that depends on the step. Numbers in the XML have 17 digits, so that a reader
has the same doubles; how the tracker moves its mocap bodies and controls is no part of a model.
"""

import ctypes
from collections.abc import Iterable, Iterator, Mapping
from contextlib import contextmanager
from pathlib import Path

import mujoco
import numpy as np
from numpy.typing import NDArray

PAIRS_NAMED = 3
"""Different pairs of numbers that a setting spells out; the others are counted, and are in the XML."""

DIGITS = 17
"""Significant digits of a number in the XML: with fewer a double does not come back as it was."""
LIBRARY = "libmujoco.so*"
"""Name of MuJoCo's library in its package, which has the number of digits for a setting that Python's interface leaves out."""

Array = NDArray[np.float64]


def mjcf(spec: mujoco.MjSpec, model: mujoco.MjModel, data: mujoco.MjData) -> str:
    """Return the XML of `model`, which `spec` was compiled to, with the state of `data` as key frame "start"."""
    _options(spec, model)
    for geom in spec.geoms:
        k = model.geom(geom.name).id
        geom.solref, geom.solimp = model.geom_solref[k], model.geom_solimp[k]
        geom.margin, geom.gap = model.geom_margin[k], model.geom_gap[k]
    for pair in spec.pairs:
        k = model.pair(pair.name).id
        pair.solref, pair.solimp, pair.solreffriction = model.pair_solref[k], model.pair_solimp[k], model.pair_solreffriction[k]
        pair.margin, pair.gap = model.pair_margin[k], model.pair_gap[k]
    for joint in spec.joints:
        k = model.joint(joint.name).id
        joint.solref_limit, joint.solimp_limit = model.jnt_solref[k], model.jnt_solimp[k]
    for tendon in spec.tendons:
        k = model.tendon(tendon.name).id
        tendon.solref_limit, tendon.solimp_limit = model.tendon_solref_lim[k], model.tendon_solimp_lim[k]
    for weld in spec.equalities:
        k = model.equality(weld.name).id
        weld.solref, weld.solimp, weld.data = model.eq_solref[k], model.eq_solimp[k], model.eq_data[k]
    for actuator in spec.actuators:
        k = model.actuator(actuator.name).id
        actuator.gainprm, actuator.biasprm = model.actuator_gainprm[k], model.actuator_biasprm[k]
    for key in list(spec.keys):
        spec.delete(key)
    spec.add_key(name="start", qpos=data.qpos, qvel=data.qvel, mpos=data.mocap_pos.ravel(), mquat=data.mocap_quat.ravel())
    with written_digits(DIGITS):
        return str(spec.to_xml())


@contextmanager
def written_digits(digits: int) -> Iterator[None]:
    """Let MuJoCo write so many significant digits; where its library has another name, as many as it writes by itself."""
    libraries = sorted(Path(mujoco.__file__).parent.glob(LIBRARY))
    if not libraries:
        yield
        return
    library = ctypes.CDLL(str(libraries[0]))
    before = library._mjPRIVATE__get_xml_precision()
    library._mjPRIVATE__set_xml_precision(digits)
    try:
        yield
    finally:
        library._mjPRIVATE__set_xml_precision(before)


def resolved(model: mujoco.MjModel) -> Mapping[str, tuple[object, str]]:
    """Return the values that a reader of MJCF looks for: name -> (value, how it came about)."""
    option = model.opt
    flags = {"nativeccd": mujoco.mjtDisableBit.mjDSBL_NATIVECCD, "multiccd": mujoco.mjtDisableBit.mjDSBL_MULTICCD,
             "autoreset": mujoco.mjtDisableBit.mjDSBL_AUTORESET,
             "filterparent": mujoco.mjtDisableBit.mjDSBL_FILTERPARENT}
    options: dict[str, tuple[object, str]] = {
        "flag nativeccd": (_on(option.disableflags, flags["nativeccd"]), "MuJoCo's own convex collisions; untouched"),
        "flag multiccd": (_on(option.disableflags, flags["multiccd"]), "several contacts of two convex meshes; untouched"),
        "flag autoreset": (_on(option.disableflags, flags["autoreset"]),
                           "off: a state that has diverged must stay visible, MuJoCo's default is to go back to the first one"),
        "flag filterparent": (_on(option.disableflags, flags["filterparent"]),
                              "off: which pairs may meet is the scene's, and said by exclusions"),
        "ls_iterations": (int(option.ls_iterations), "untouched (steps of the solver's line search)"),
        "ls_tolerance": (float(option.ls_tolerance), "untouched"),
        "exclusions": (int(model.nexclude), "pairs of bodies that the scene lets pass through one another"),
    }
    for name, values, meaning in (
        ("geom condim", model.geom_condim, "1 without friction, 3 with sliding friction"),
        ("geom margin", model.geom_margin, "[m], from which contact begins"), ("geom gap", model.geom_gap, "[m], untouched"),
        ("geom solref", model.geom_solref, "(time constant [s], damping ratio), or negative (stiffness, damping)"),
        ("geom solimp", model.geom_solimp, "impedance"),
        ("pair solref", model.pair_solref, "of explicit pairs"),
        ("pair solreffriction", model.pair_solreffriction, "of explicit pairs; zeros: as solref"),
        ("pair solimp", model.pair_solimp, "of explicit pairs"), ("pair margin", model.pair_margin, "of explicit pairs [m]"),
        ("pair condim", model.pair_dim, "of explicit pairs"),
        ("joint solref limit", model.jnt_solref[model.jnt_limited.astype(bool)], "of joints with limits"),
        ("joint solimp limit", model.jnt_solimp[model.jnt_limited.astype(bool)], "of joints with limits"),
        ("tendon solref limit", model.tendon_solref_lim, "of swing limits"),
        ("weld solref", model.eq_solref, "of welds to tracked poses"), ("weld solimp", model.eq_solimp, "of welds to tracked "
                                                                                                        "poses"),
    ):
        if len(values):
            options[name] = _counted(values), meaning
    return options


def _options(spec: mujoco.MjSpec, model: mujoco.MjModel) -> None:
    ours, theirs = spec.option, model.opt
    for name in ("timestep", "integrator", "cone", "solver", "iterations", "tolerance", "impratio", "noslip_iterations",
                 "disableflags", "enableflags"):
        setattr(ours, name, getattr(theirs, name))


def _on(flags: int, bit: mujoco.mjtDisableBit) -> bool:
    return not flags & int(bit)


def _counted(values: Array) -> str:
    """Return the different rows of `values` and how often each occurs, the most frequent first."""
    rows, counts = np.unique(np.atleast_2d(values.T).T, axis=0, return_counts=True)
    order = np.argsort(-counts, kind="stable")
    parts = [f"{_row(rows[k])} x {counts[k]}" for k in order[:PAIRS_NAMED]]
    return ", ".join([*parts, *([f"{len(order) - PAIRS_NAMED} more"] if len(order) > PAIRS_NAMED else [])])


def _row(row: Iterable[float]) -> str:
    numbers = [f"{number:.6g}" for number in row]
    return numbers[0] if len(numbers) == 1 else f"({', '.join(numbers)})"
