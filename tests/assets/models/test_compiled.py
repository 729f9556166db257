"""Checks of the compiler process's output: missing, truncated or non-finite data is an InvalidFile."""

import io
from pathlib import Path
from typing import Any

import numpy as np
import pytest

from avatarsim.assets.models.compiled import Compiled, received
from avatarsim.errors import InvalidFile
from tests.assets.models.in_process import run_here

MODEL = (
    '<mujoco model="m"><worldbody><body name="arm"><joint name="turn"/><geom name="ball" size="0.1"/></body></worldbody></mujoco>'
)


@pytest.fixture(scope="module")
def whole(tmp_path_factory: pytest.TempPathFactory) -> dict[str, Any]:
    """Return the arrays of a world with one ball on a hinge."""
    path = tmp_path_factory.mktemp("model") / "a.xml"
    path.write_text(MODEL)
    with np.load(io.BytesIO(run_here(path, path.parent, 1.0, "collision"))) as found:
        return dict(found)


def answer(whole: dict[str, Any], **changed: object) -> bytes:
    """Return arrays as the process would send them, with changes; None leaves one out."""
    buffer = io.BytesIO()
    np.savez(buffer, **{key: value for key, value in (whole | changed).items() if value is not None})
    return buffer.getvalue()


def test_a_whole_answer_is_a_model(whole: dict[str, Any]) -> None:
    model = received("a.xml", answer(whole))
    assert isinstance(model, Compiled) and model.body_name == ("world", "arm") and model.geom_size.dtype == np.float64


@pytest.mark.parametrize(("changed", "said"), [
    ({"qpos0": None}, "arrays of compiled model a.xml"),
    ({"body_pos": np.full((2, 3), np.nan)}, "body_pos of a.xml is 'not finite'"),
    ({"geom_type": np.array(["2"])}, "geom_type of a.xml"), ({"refused": np.array('["a", 1, "b"]')}, "a is 1; valid: b"),
])
def test_an_answer_that_is_none_is_refused(whole: dict[str, Any], changed: dict[str, object], said: str) -> None:
    with pytest.raises(InvalidFile, match=said):
        received("a.xml", answer(whole, **changed))


@pytest.mark.parametrize("cut", [0, 1, 100, -1, -100])
def test_an_answer_that_is_cut_off_is_refused(whole: dict[str, Any], cut: int) -> None:
    with pytest.raises(InvalidFile, match="compiled model a.xml"):
        received("a.xml", answer(whole)[:cut])


def test_no_object_of_an_answer_is_unpickled(whole: dict[str, Any]) -> None:
    with pytest.raises(InvalidFile, match="allow_pickle"):
        received("a.xml", answer(whole, body_pos=np.array([Path(), None], dtype=object)))
