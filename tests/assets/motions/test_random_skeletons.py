"""Random skeletons, orders of channels and postures: places as by matrices, and numbers that come back."""

from pathlib import Path
from tempfile import TemporaryDirectory

import numpy as np
from hypothesis import given, settings
from hypothesis import strategies as st

from avatarsim.assets.motions import euler
from avatarsim.assets.motions.bvh import read_bvh
from avatarsim.scene.motion import Motion
from avatarsim.spatial import rotation
from tests.assets.motions.files import bvh
from tests.assets.motions.twins import bvh_places

TURNS = ("Xrotation", "Yrotation", "Zrotation")
PLACES = ("Xposition", "Yposition", "Zposition")
ORDERS = [(i, j, k) for i in range(3) for j in range(3) for k in range(3) if len({i, j, k}) == 3]


@st.composite
def skeletons(draw: st.DrawFn) -> tuple[str, int]:
    """Return a hierarchy of up to seven joints, all channels at the root and up to three turns below, and the channel count."""
    parents = [-1] + [draw(st.integers(0, k)) for k in range(draw(st.integers(0, 6)))]
    channels = [draw(st.permutations(TURNS + PLACES))]
    channels += [draw(st.permutations(TURNS))[: draw(st.integers(0, 3))] for _ in parents[1:]]
    offsets = draw(st.lists(st.tuples(*[st.integers(-30, 30)] * 3), min_size=len(parents), max_size=len(parents)))

    def said(k: int) -> str:
        x, y, z = offsets[k]
        inside = "".join(said(child) for child, parent in enumerate(parents) if parent == k)
        inside = inside or "End Site\n{\nOFFSET 0 7 0\n}\n"
        channel = " ".join([str(len(channels[k])), *channels[k]])
        return f"{'JOINT' if k else 'ROOT'} j{k}\n{{\nOFFSET {x} {y} {z}\nCHANNELS {channel}\n{inside}}}\n"

    return f"HIERARCHY\n{said(0)}", sum(map(len, channels))


@settings(max_examples=60, deadline=None)
@given(skeletons(), st.integers(0, 2**32 - 1), st.sampled_from(["y", "z"]))
def test_random_skeletons_come_back(made: tuple[str, int], seed: int, up: str) -> None:
    hierarchy, channels = made
    random = np.random.default_rng(seed)
    # multiples of ten put many joints into gimbal lock
    shape = (4, channels)
    values = np.where(random.random(shape) < 0.5, random.normal(0.0, 200.0, shape), 10.0 * random.integers(-40, 40, shape))
    with TemporaryDirectory() as folder:
        path = Path(folder) / "some.bvh"
        path.write_text(bvh(hierarchy, values))
        file = read_bvh(path, scale=0.01, up=up, limits=False)
        own, skeleton = file.recording.motion, file.recording.skeleton
        places = skeleton.poses(own.positions, own.rotations, own.angles)[0]
        for k, frame in enumerate(bvh_places(path.read_text())):
            expected = 0.01 * file.recording.axes.vectors(np.stack([frame[bone.name] for bone in skeleton.bones]))
            assert np.abs(places[k] - expected).max() < 1e-11
        model = file.model()
        path.write_bytes(file.written(file.motion(model), model))
        assert (read_bvh(path, scale=0.01, up=up, limits=False).recording.values == values).all()
        # every joint moved by a little: other numbers, the same motion
        little = rotation.from_rotation_vector(random.normal(0.0, 1e-3, own.rotations[..., 1:].shape))
        turned = rotation.multiply(own.rotations, little)
        moved = Motion(own.times, own.positions + 0.001, turned, own.angles + 0.001)
        path.write_bytes(file.written(moved, model))
        back = read_bvh(path, scale=0.01, up=up, limits=False).recording
        balls = [k for k, bone in enumerate(skeleton.bones) if len(bone.axes) == 3]
        off = rotation.multiply(rotation.conjugate(turned), back.motion.rotations)[:, balls]
        assert np.linalg.norm(off[..., 1:], axis=-1).max() < 5e-10
        assert np.abs(back.motion.angles - moved.angles).max(initial=0.0) < 1e-9
        assert np.abs(back.motion.positions[:, 0] - moved.positions[:, 0]).max() < 1e-9


@settings(max_examples=200, deadline=None)
@given(
    st.sampled_from(ORDERS), st.tuples(*[st.floats(-7.0, 7.0)] * 3), st.tuples(*[st.floats(-1e-4, 1e-4)] * 3),
    st.sampled_from([None, 0.5 * np.pi, -0.5 * np.pi, 1.5 * np.pi]),
)
def test_angles_are_those_nearest_the_given_ones(
    order: tuple[int, int, int], angles: tuple[float, float, float], away: tuple[float, float, float], locked: float | None
) -> None:
    near = np.array(angles)
    if locked is not None:
        near[1] = locked
    wanted = euler.quaternion(order, near + np.array(away))
    found = euler.cardan(order, wanted, near)
    off = rotation.multiply(rotation.conjugate(wanted), euler.quaternion(order, found))
    assert np.linalg.norm(off[1:]) < 1e-9
    if abs(np.cos(near[1])) > 0.1:
        assert np.abs(found - near).max() < 3e-3
