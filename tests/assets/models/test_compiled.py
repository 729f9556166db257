"""Checks of the compiler process's output: missing, truncated or non-finite data is an InvalidFile."""

import io
from pathlib import Path

import numpy as np
import pytest

from avatarsim.assets.models.compiled import Compiled, received
from avatarsim.errors import InvalidFile

NONE, ZEROS = np.zeros(0, dtype=np.int32), np.zeros((0, 3))


def answer(**changed: object) -> bytes:
    """Return a world with one ball on a hinge, as the process would send it, with changes; None leaves an array out."""
    names = {"body_name": ["world", "arm"], "jnt_name": ["turn"], "geom_name": ["ball"]}
    arrays: dict[str, object] = {
        **{key: np.array(value, dtype=np.str_) for key, value in names.items()},
        **{f"{key}_name": np.zeros(0, dtype=np.str_) for key in ("eq", "mesh", "key", "mended", "plate", "plugin", "unread")},
        "free_root": np.array(False), "is_urdf": np.array(False),
        "model_name": np.array("m"), "flexes": np.array(0), "qpos0": np.zeros(1),
        "body_parentid": np.zeros(2, np.int32), "body_mocapid": np.full(2, -1), "body_mass": np.ones(2),
        **{f"body_{key}": np.zeros((2, 3)) for key in ("pos", "ipos", "inertia")},
        **{f"body_{key}": np.tile([1.0, 0.0, 0.0, 0.0], (2, 1)) for key in ("quat", "iquat")},
        "jnt_type": np.array([3]), "jnt_bodyid": np.array([1]), "jnt_qposadr": np.array([0]), "jnt_limited": np.array([True]),
        "jnt_velocity": np.zeros(1),
        "jnt_pos": np.zeros((1, 3)), "jnt_axis": np.array([[0.0, 0.0, 1.0]]), "jnt_range": np.array([[-1.0, 1.0]]),
        "geom_type": np.array([2]), "geom_bodyid": np.array([1]), "geom_dataid": np.array([-1]), "geom_contype": np.array([1]),
        "geom_group": np.array([0]),
        "geom_conaffinity": np.array([1]), "geom_pos": np.zeros((1, 3)), "geom_quat": np.array([[1.0, 0.0, 0.0, 0.0]]),
        "geom_size": np.full((1, 3), 0.1), "geom_friction": np.ones(1), "geom_priority": np.zeros(1, np.int32),
        "geom_condim": np.full(1, 3, np.int32),
        "gravity": np.zeros(3), "pair_friction": np.zeros(0), "key_qpos": np.zeros((0, 1)), "key_mpos": np.zeros((0, 0)),
        "key_mquat": np.zeros((0, 0)),
        **{key: NONE for key in ("exclude_signature", "pair_geom1", "pair_geom2", "mesh_vertnum", "mesh_facenum")},
        **{f"eq_{key}": NONE for key in ("type", "objtype", "obj1id", "obj2id", "active0")},
        "eq_data": np.zeros((0, 11)), "mesh_vert": ZEROS, "mesh_face": ZEROS.astype(np.int32),
    } | changed
    buffer = io.BytesIO()
    np.savez(buffer, **{key: value for key, value in arrays.items() if value is not None})  # type: ignore[arg-type]
    return buffer.getvalue()


def test_a_whole_answer_is_a_model() -> None:
    model = received("a.xml", answer())
    assert isinstance(model, Compiled) and model.body_name == ("world", "arm") and model.geom_size.dtype == np.float64


@pytest.mark.parametrize(("changed", "said"), [
    ({"qpos0": None}, "arrays of compiled model a.xml"),
    ({"body_pos": np.full((2, 3), np.nan)}, "body_pos of a.xml is 'not finite'"),
    ({"geom_type": np.array(["2"])}, "geom_type of a.xml"), ({"refused": np.array('["a", 1, "b"]')}, "a is 1; valid: b"),
])
def test_an_answer_that_is_none_is_refused(changed: dict[str, object], said: str) -> None:
    with pytest.raises(InvalidFile, match=said):
        received("a.xml", answer(**changed))


@pytest.mark.parametrize("cut", [0, 1, 100, -1, -100])
def test_an_answer_that_is_cut_off_is_refused(cut: int) -> None:
    with pytest.raises(InvalidFile, match="compiled model a.xml"):
        received("a.xml", answer()[:cut])


def test_no_object_of_an_answer_is_unpickled() -> None:
    with pytest.raises(InvalidFile, match="allow_pickle"):
        received("a.xml", answer(body_pos=np.array([Path(), None], dtype=object)))
