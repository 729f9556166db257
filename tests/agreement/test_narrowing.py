"""Effects that an author omits are omitted by the other engines too, or reported as unsupported."""

from dataclasses import replace

import mujoco
import numpy as np
import pytest

from avatarsim.engine import Settings
from reference.in_mujoco.engine import MujocoEngine
from reference.in_mujoco.unsupported import unsupported as mujoco_unsupported
from reference.narrowing import ALWAYS_THERE, alike_in_all
from scenarios import catalog

SCENES = {
    "restitution": "ball_drop", "friction": "incline", "limits": "mocap_punch_wall", "self_contact": "mocap_punch_wall",
    "overlap_removal": "mocap_punch_wall", "coupling": "hand_over_table", "dynamics": "ball_drop", "gyroscopic": "dzhanibekov",
}
"""A scene that needs the effect."""


SWITCHED = ("restitution", "friction", "limits", "self_contact")


@pytest.mark.parametrize("effect", ALWAYS_THERE)
def test_what_stays_all_the_same_is_said(effect: str) -> None:
    scene = catalog.get(SCENES[effect]).build()
    said = f"no {effect.replace('_', ' ')}"
    assert said not in mujoco_unsupported(scene)
    less = replace(scene, narrow=(effect,))
    assert said in mujoco_unsupported(less) and said in alike_in_all(less)
    pybullet = pytest.importorskip("reference.in_pybullet.unsupported", exc_type=ImportError)
    assert said in pybullet.unsupported(less) and said not in pybullet.unsupported(scene)


@pytest.mark.parametrize("effect", SWITCHED)
def test_what_is_switched_off_changes_mujoco_s_model(effect: str) -> None:
    scene = catalog.get(SCENES[effect]).build()
    less = replace(scene, narrow=(effect,))
    assert mujoco_unsupported(less).keys() <= mujoco_unsupported(scene).keys()
    models = []
    for one in (scene, less):
        engine = MujocoEngine()
        engine.load(one, Settings("tuned"), 1.0 / 60.0)
        model, data = engine._world.model, engine._data
        mujoco.mj_forward(model, data)
        models.append({
            "restitution": np.vstack([model.geom_solref, model.pair_solref]),
            "friction": model.pair_dim.copy(),
            "limits": np.concatenate([model.jnt_limited, [model.ntendon]]), "self_contact": model.exclude_signature.copy(),
        })
    with_it, without = models[0][effect], models[1][effect]
    assert with_it.shape != without.shape or not np.array_equal(with_it, without)
    if effect == "limits":
        assert not without.any()
    elif effect == "friction":
        assert (without == 1).all()


@pytest.mark.parametrize(("name", "coupled"), [("hand_over_table", True), ("coupling_sweep", True), ("mocap_punch_wall", False)])
def test_reports_the_spring_of_equation_6_as_unsupported(name: str, coupled: bool) -> None:
    scene = catalog.get(name).build()
    pybullet = pytest.importorskip("reference.in_pybullet.unsupported", exc_type=ImportError)
    for features in (mujoco_unsupported(scene), pybullet.unsupported(scene)):
        assert ("virtual coupling" in features) == coupled
