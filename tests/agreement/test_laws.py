"""MuJoCo's priorities and explicit pairs together give exactly the scene's table, for any table."""

import mujoco
import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from avatarsim.engine import Settings
from avatarsim.scene.body import TABLE_1, ContactLaw, PairTable, fixed, simulated, solid
from avatarsim.scene.scene import Scene
from avatarsim.scene.shape import Box, ConvexHull, Piece, Sphere
from avatarsim.spatial import rotation
from reference.in_mujoco.engine import MujocoEngine
from reference.in_mujoco.laws import contact_laws, law_between
from scenarios import catalog
from scenarios.catalog.paper.ball_drop import SCENARIO as BALL_DROP
from tests.agreement.runs import loaded, played
from tests.agreement.scenes import every_joint, hand, posture, pressed

MATERIALS = ("human", "metal", "wood")
BALL = (Piece(Sphere(0.1)),)


def crowd(materials: list[str], still: list[bool], table: PairTable = TABLE_1, **more: object) -> Scene:
    """Return balls that all touch at the origin, of the given materials, some of them fixed."""
    bodies = [
        fixed(f"f{k}", BALL, m) if s else simulated(f"s{k}", BALL, m, solid(BALL, 1.0))
        for k, (m, s) in enumerate(zip(materials, still, strict=True))
    ]
    return Scene("crowd", tuple(bodies), materials=table, **more)  # type: ignore[arg-type]


coefficients = st.sampled_from([0.0, 0.1, 0.2, 0.3])


@given(
    st.lists(st.tuples(st.sampled_from(MATERIALS), st.booleans()), min_size=2, max_size=7),
    st.lists(st.tuples(coefficients, coefficients), min_size=6, max_size=6),
)
def test_every_pair_has_its_law(bodies: list[tuple[str, bool]], numbers: list[tuple[float, float]]) -> None:
    keys = [(a, b) for i, a in enumerate(MATERIALS) for b in MATERIALS[i:]]
    table = PairTable({key: ContactLaw(*values) for key, values in zip(keys, numbers, strict=True)})
    scene = crowd([m for m, _ in bodies], [s for _, s in bodies], table)
    laws = contact_laws(scene, bounce=True)
    for a in range(len(bodies)):
        for b in range(a + 1, len(bodies)):
            if scene.pair_filter[a, b]:
                (rank_a, law_a), (rank_b, law_b) = laws.own[a], laws.own[b]
                said = laws.explicit.get((a, b), law_a if rank_a >= rank_b else law_b)
                assert said == law_between(scene, a, b)


def test_table_1_needs_few_explicit_pairs() -> None:
    """Six balls and six slabs: 51 pairs, most of them covered by priorities alone."""
    laws = contact_laws(BALL_DROP.build(), bounce=True)
    assert 0 < len(laws.explicit) <= 12


def test_contacts_of_mujoco_have_stated_friction_and_pairs() -> None:
    """The contacts that MuJoCo makes when all balls overlap: every wanted pair once, and no other."""
    scene = crowd(["human", "metal", "wood", "wood", "metal"], [False, False, False, True, True], exclude=(("s0", "s1"),))
    engine = loaded(MujocoEngine(), scene, Settings("tuned"))
    model, data = engine._world.model, engine._data
    mujoco.mj_forward(model, data)
    found = {}
    for contact in data.contact[: data.ncon]:
        a, b = sorted(int(model.geom(int(g)).name[1:].split(".")[0]) for g in contact.geom)
        assert (a, b) not in found
        found[a, b] = float(contact.friction[0])
    n = len(scene.names)
    wanted = {(a, b) for a in range(n) for b in range(a + 1, n) if scene.pair_filter[a, b]}
    assert set(found) == wanted
    for (a, b), friction in found.items():
        assert friction == scene.materials.contact(scene.material_names[a], scene.material_names[b]).friction


def test_links_of_an_avatar_meet_as_the_scene_says() -> None:
    """MuJoCo's own rule would also exclude grandparents across rigid joints."""
    avatar = every_joint()
    scene = Scene("self", avatars=(avatar,), start=posture(avatar, 0))
    engine = loaded(MujocoEngine(), scene, Settings("tuned"))
    model = engine._world.model
    excluded = {(int(s) >> 16, int(s) & 0xFFFF) for s in model.exclude_signature}
    ids = engine._world.body_ids
    for a in range(5):
        for b in range(a + 1, 5):
            low, high = sorted((int(ids[a]), int(ids[b])))
            assert ((low, high) in excluded or (high, low) in excluded) == (not scene.pair_filter[a, b])
    assert model.opt.disableflags & int(mujoco.mjtDisableBit.mjDSBL_FILTERPARENT)


@pytest.mark.parametrize("margin", [0.0, 0.0004])
def test_a_loose_margin_holds_what_rests_and_not_the_hand(margin: float) -> None:
    """Geoms and pairs that are not driven add up to it; a link and a loose body meet at the margin of the links."""
    scenario = catalog.get("stack_ten")
    engine = loaded(MujocoEngine(), scenario.build(), Settings("tuned", {"loose_margin": margin}), scenario.dt)
    assert np.allclose(engine._model.geom_margin, 0.5 * margin) and np.allclose(engine._model.pair_margin, margin)
    grasp = catalog.get("hand_grasp")
    engine.load(grasp.build(), Settings("tuned", {"loose_margin": margin, "margin": 0.001}), grasp.dt)
    driven = engine._world.geom_driven
    assert driven.any() and not driven.all() and np.allclose(engine._model.geom_margin[~driven], 0.5 * margin)
    assert np.allclose(engine._model.geom_margin[driven], 0.001 - 0.5 * margin)
    assert np.allclose(engine._model.pair_margin, np.where(engine._world.pair_driven, 0.001, margin))


@pytest.mark.parametrize("margin", [0.0, 0.003])
def test_margin_keeps_a_driven_hand_off_the_table(margin: float) -> None:
    """Contacts begin at the margin and act there: the hand rests at that height."""
    table = fixed("table", (Piece(Box((1.5, 1.0, 0.05))),), "wood", (0.0, 0.0, -0.025))
    scene = Scene("press", (table,), (hand(),), start=pressed(0))
    samples = [pressed(frame) for frame in range(1, 31)]
    shown = played(MujocoEngine(), scene, samples, Settings("tuned", {"margin": margin}))[-1].shown
    turn = shown.orientations[1]
    lowest = min(
        float((rotation.rotate(turn, piece.shape.vertices + np.array(piece.position))[:, 2]).min())
        for piece in scene.links[0].pieces if isinstance(piece.shape, ConvexHull)
    )
    assert lowest + shown.positions[1, 2] == pytest.approx(margin, abs=2e-4)
