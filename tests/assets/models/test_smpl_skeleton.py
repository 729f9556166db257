"""Skeletons of the SMPL family: trees as the format has them, a body of plausible segments, and exact joints of a file."""

import numpy as np
import pytest

from avatarsim.assets.models.smpl_skeleton import TREES, approximate, from_smpl_axes, measured, to_smpl_axes, tree_of


@pytest.mark.parametrize("member", TREES)
def test_trees_have_parents_before_children_and_two_equal_sides(member: str) -> None:
    tree = TREES[member]
    names = [name for name, _ in tree]
    assert len(set(names)) == len(names) and tree_of(len(tree)) == member
    assert all(parent < k for k, (_, parent) in enumerate(tree))
    assert [k for k, (_, parent) in enumerate(tree) if parent < 0] == [0]

    def mirrored(name: str) -> str:
        other = {"left": "right", "right": "left"}.get(name.split("_")[0])
        return name if other is None else f"{other}_{name.partition('_')[2]}"

    for name, parent in tree[1:]:
        twin = tree[names.index(mirrored(name))]
        assert names[twin[1]] == mirrored(names[parent])


@pytest.mark.parametrize("member", TREES)
@pytest.mark.parametrize("stature", [1.1, 1.7, 2.0])
def test_the_approximate_body_is_as_tall_as_asked_and_even(member: str, stature: float) -> None:
    skeleton, _ = approximate(member, stature)
    assert np.ptp(skeleton.rest[:, 2]) == pytest.approx(stature, rel=0.01)
    names = [bone.name for bone in skeleton.bones]
    places = skeleton.rest
    for k, name in enumerate(names):
        if name.startswith("left_"):
            twin = places[names.index(f"right_{name.removeprefix('left_')}")]
            assert np.allclose(places[k] * np.array([1.0, -1.0, 1.0]), twin)
            assert places[k, 1] > 0.0
    # fingertip to fingertip a body is as wide as it is tall
    assert np.ptp(places[:, 1]) == pytest.approx(stature, rel=0.06)
    # feet point forward
    assert places[names.index("left_foot"), 0] > places[names.index("left_ankle"), 0]


def test_axes_of_the_family_are_turned_and_not_mirrored() -> None:
    axes = np.eye(3)
    assert np.allclose(to_smpl_axes(from_smpl_axes(axes)), axes)
    assert np.linalg.det(from_smpl_axes(axes)) == pytest.approx(1.0)
    # left, up, forward of the family are our y, z, x
    assert from_smpl_axes(axes).tolist() == [[0.0, 1.0, 0.0], [0.0, 0.0, 1.0], [1.0, 0.0, 0.0]]


def test_joints_of_a_file_are_where_it_has_them() -> None:
    whole, pelvis = approximate("SMPL-H", 1.8)
    joints = to_smpl_axes(whole.rest[:52]) + pelvis
    found, place = measured("SMPL-H", np.concatenate([joints, np.zeros((3, 3))]))
    assert np.allclose(to_smpl_axes(found.rest[:52] - found.rest[0]), joints - joints[0], atol=1e-12)
    assert np.allclose(place, pelvis)
    assert np.ptp(found.rest[:, 2]) == pytest.approx(1.8, rel=2e-3)


def test_hands_hang_on_wrists_finger_by_finger() -> None:
    for member in ("SMPL-H", "SMPL-X"):
        names = [name for name, _ in TREES[member]]
        parents = {name: names[parent] for name, parent in TREES[member][1:]}
        assert parents["left_index1"] == "left_wrist" and parents["right_thumb1"] == "right_wrist"
        assert parents["left_ring3"] == "left_ring2" and parents["right_pinky2"] == "right_pinky1"
    assert [len(tree) for tree in TREES.values()] == [24, 52, 55]
    assert tree_of(53) is None
