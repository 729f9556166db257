"""Doors for values: every public constructor, tracker samples, settings, and scenes that are loaded and shown."""

import reprlib
from collections.abc import Callable, Iterator
from contextlib import suppress
from functools import partial
from pathlib import Path
from typing import Any

import hypothesis
import numpy as np
from hypothesis import HealthCheck, Phase, given, settings
from hypothesis import strategies as st
from hypothesis.strategies import SearchStrategy

from avatarsim.assets.meshes import pieces_of_mesh
from avatarsim.assets.meshes.decompose import PieceOptions
from avatarsim.assets.models.model import Model
from avatarsim.cleaning import Options, Shield, clean
from avatarsim.cleaning.joint_rates import Rates
from avatarsim.engine import Settings
from avatarsim.errors import AvatarsimError
from avatarsim.scene.avatar import Avatar, Drive, Link, rigid_avatar
from avatarsim.scene.body import TABLE_1, Body, ContactLaw, Mass, PairTable, Role, fixed, simulated, solid, volume
from avatarsim.scene.effects import Effects
from avatarsim.scene.joint import Ball, Hinge, Hinges, ReachCone, SwingTwist
from avatarsim.scene.motion import Motion
from avatarsim.scene.scene import Scene
from avatarsim.scene.shape import Box, Capsule, ConvexHull, Ellipsoid, Piece, Sphere, ellipsoid_hull
from avatarsim.scene.tracker import TrackerSample, checked, rest
from avatarsim.simulator import AvatarsimEngine
from tests.cleaning.rooms import FLOOR, model
from tests.hostile import values as v
from tests.hostile.doors import Case, Door, Unsound, finite, nothing, sound

Asked = tuple[Callable[..., object], dict[str, object]]
CHUNK = 250
"""Examples that are drawn at once; hypothesis gets slower with more."""


def told(value: object) -> str:
    """Return a value in few words, whatever its own answer to that is."""
    try:
        return reprlib.repr(value)
    except Exception as error:
        return f"{type(value).__name__} without words ({type(error).__name__})"


def drawn(strategy: SearchStrategy[Asked], seed: int, count: int) -> list[Asked]:
    """So many examples of a strategy, or all that it has; equal seeds draw equally."""
    found: list[Asked] = []

    @settings(max_examples=count, database=None, phases=[Phase.generate], deadline=None, derandomize=False,
              suppress_health_check=list(HealthCheck))
    @hypothesis.seed(seed)
    @given(strategy)
    def collect(example: Asked) -> None:
        found.append(example)

    collect()
    return found


def cases(strategy: Callable[[], SearchStrategy[Asked]], check: Callable[[object], object], seed: int, count: int, folder: Path
          ) -> Iterator[Case]:
    """Yield calls whose arguments hypothesis draws; `check` judges the returned value."""
    made = 0
    while made < count:
        examples = drawn(strategy(), seed * 100_003 + made, min(CHUNK, count - made))
        for make, arguments in examples:
            yield Case(f"{getattr(make, '__name__', make)}({told(arguments)})", partial(called, make, arguments, check))
        made += CHUNK


def called(make: Callable[..., object], arguments: dict[str, object], check: Callable[[object], object]) -> object:
    """Return the result of a call, once `check` has passed it."""
    return check(make(**arguments))


def shape_doors() -> list[SearchStrategy[Asked]]:
    """Return shapes, pieces, masses."""
    size = st.tuples(v.lengths, v.lengths, v.lengths)
    return [
        v.asked(Sphere, radius=v.lengths), v.asked(Capsule, radius=v.lengths, length=v.lengths), v.asked(Box, size=size),
        v.asked(Ellipsoid, radii=size), v.asked(ConvexHull, vertices=v.points),
        v.asked(Piece, shape=v.shapes, position=v.vectors, orientation=v.quaternions),
        v.asked(ellipsoid_hull, radii=size, vertices=st.integers(4, 200)), v.asked(solid, pieces=v.piece_tuples, mass=v.lengths),
        v.asked(Mass, mass=v.lengths, centre=v.vectors, inertia=st.just(np.eye(3))), v.asked(volume, shape=v.shapes),
    ]


def joint_doors() -> list[SearchStrategy[Asked]]:
    """Return materials and joints."""
    pairs = st.dictionaries(st.tuples(v.materials, v.materials), v.contacts, max_size=3)
    return [
        v.asked(ContactLaw, restitution=st.floats(0.0, 1.0), friction=st.floats(0.0, 1.0)), v.asked(PairTable, pairs=pairs),
        v.asked(Hinge, axis=v.directions, lower=st.floats(-2.0, 0.0), upper=st.floats(0.0, 2.0)),
        v.asked(Hinges, hinges=st.lists(v.hinges, min_size=1, max_size=3).map(tuple)),
        v.asked(SwingTwist, axis=v.directions, centre=v.directions, swing=v.lengths, twist=st.just((-1.0, 1.0))),
        v.asked(Ball, limits=v.swings, cone=st.none() | v.cones),
        v.asked(ReachCone, vertices=st.integers(3, 8).map(lambda n: v.ring(n, 0.7)), visible_point=st.just((0.0, 0.0, 1.0))),
        v.asked(Effects, overlap_removal=st.booleans(), kinematics=st.booleans(), limits=st.booleans()),
    ]


def body_doors() -> list[SearchStrategy[Asked]]:
    """Return links, avatars, bodies, samples, scenes."""
    placed = {"pieces": v.piece_tuples, "position": v.vectors, "orientation": v.quaternions}
    moving = {"mass": v.masses, "velocity": v.vectors, "angular_velocity": v.vectors}
    link = {"parent": st.none() | st.just("a"), "joint": v.roots, "pieces": v.piece_tuples, "mass": v.masses}
    posture = st.builds(lambda avatar: (rest((avatar,)), (avatar,)), v.avatars)
    return [
        v.asked(Link, name=v.names, **link, material=v.materials, anchor=v.vectors, orientation=v.quaternions),
        v.asked(Avatar, name=v.names, links=v.avatars.map(lambda avatar: avatar.links), chains=st.just(()), ignore=st.just(()),
                coupled_mass=st.none() | v.lengths, size_range=st.just((0.01, 20.0)), drive=st.none()),
        v.asked(Drive, stiffness=v.lengths, damping=v.lengths, largest_force=v.lengths),
        v.asked(rigid_avatar, name=v.names, pieces=v.piece_tuples, mass=v.masses),
        v.asked(Body, name=v.names, role=st.sampled_from(Role), material=v.materials, **placed, **moving),
        v.asked(fixed, name=v.names, material=v.materials, **placed),
        v.asked(simulated, name=v.names, material=v.materials, **placed, **moving),
        v.asked(sample_checked, known=posture, time=v.lengths, positions=st.none(), rotations=st.none(), angles=st.none()),
        v.asked(Scene, name=v.names, bodies=st.lists(v.bodies, max_size=3).map(tuple), gravity=v.vectors, start=st.none(),
                avatars=st.lists(v.avatars, max_size=1).map(tuple), materials=v.tables | st.just(TABLE_1),
                exclude=st.just(()), narrow=st.just(()), require=st.just(()), force=st.just(())),
    ]


def sample_checked(known: object, **replaced: object) -> object:
    """Return a sample with some of its parts replaced, as the engine checks it."""
    if not (isinstance(known, tuple) and len(known) == 2 and isinstance(known[0], TrackerSample)):
        return checked(known, ())  # type: ignore[arg-type]
    base, avatars = known
    parts = {name: getattr(base, name) if part is None else part for name, part in replaced.items()}
    return finite(checked(TrackerSample(**parts), avatars))  # type: ignore[arg-type]


def mesh_doors() -> list[SearchStrategy[Asked]]:
    """Return meshes as arrays, with all wishes; one hull, since to decompose takes seconds."""
    from tests.assets.meshes.solids import cube, ell

    meshes = st.sampled_from((cube(), ell()))
    options = {"threshold": st.floats(0.01, 1.0), "seed": v.seeds, "most_vertices": st.integers(8, 64), "most_pieces": st.none(),
              "repair": st.sampled_from(("auto", "remesh", "refuse"))}
    return [
        v.asked(hull_of_mesh, mesh=meshes, scale=v.lengths, y_up=st.booleans(), **options),
        v.asked(PieceOptions, hull=st.booleans(), **options),
    ]


def hull_of_mesh(**arguments: Any) -> object:
    """Return one convex piece."""
    return pieces_of_mesh(**arguments, kept=False, quiet=True, hull=True)


COUNTS = ("steps", "corrections", "attempts", "sweeps", "work", "search_work", "leap_search", "rounds", "patience")
"""Options for the time that an engine may work. They may allow hours, which settings are trusted with: here up to 50."""
LENGTHS = (
    "stand_off", "least_gap", "wedged_gap", "turn_cap", "move_cap", "stray_turn", "merit", "root_weight", "stiffness_floor",
    "turn_share", "turn_alone", "catch_up_turn", "catch_up_move", "natural_frequency", "settle_time", "stall_time", "near",
    "spring", "damping", "rate", "tolerance", "still", "bend", "parallel", "walk_back",
)
"""Options that are no counts."""


def engine_doors() -> list[SearchStrategy[Asked]]:
    """Return a hand above a table, with any settings, frame time and sample; and generated scenes."""
    options: SearchStrategy[dict[str, Any]] = st.one_of(
        st.dictionaries(st.sampled_from(COUNTS), st.integers(0, 50) | v.numbers.filter(small), max_size=2),
        st.dictionaries(st.sampled_from(LENGTHS), v.numbers, max_size=2), st.just({}),
    )
    presets = st.sampled_from(("default", "ik", "paper"))
    scenes = st.builds(lambda bodies, avatar: Scene("some", tuple({body.name: body for body in bodies}.values()), (avatar,)),
                       st.lists(v.bodies, max_size=3), v.avatars)
    return [
        v.asked(shown, scene=st.just(hand_over_table()), preset=presets, options=options, seed=v.seeds, dt=st.just(1 / 60),
                record=st.booleans(), moves=st.lists(v.seeds, max_size=3)),
        v.asked(shown, scene=scenes, preset=presets, options=st.just({}), seed=st.just(0), dt=st.floats(1e-4, 0.1),
                record=st.booleans(), moves=st.lists(v.seeds, min_size=1, max_size=4)),
    ]


def cleaning_doors() -> list[SearchStrategy[Asked]]:
    """Return options, clips of random postures of random avatars among random bodies, and streams of coordinates."""
    options = st.builds(Options, margin=st.floats(1e-5, 0.05), blend=st.floats(0.0, 0.3), opinion=st.just(False))
    rows = st.lists(st.builds(lambda seed: np.random.default_rng(seed).normal(size=12), v.seeds), min_size=1, max_size=4)
    return [
        v.asked(Options, margin=st.floats(1e-5, 0.1), blend=st.floats(0.0, 2.0), loose=st.booleans(), seed=v.seeds,
                opinion=st.booleans()),
        v.asked(cleaned, avatar=v.avatars, bodies=st.lists(v.bodies, max_size=3), moves=st.lists(v.seeds, min_size=1, max_size=6),
                step=v.lengths, options=options),
        v.asked(shielded, rows=rows, rate=st.floats(10.0, 100.0), options=options, speed=v.rates, acceleration=v.rates),
    ]


def cleaned(avatar: Avatar, bodies: list[Body], moves: list[int], step: float, options: Options) -> object:
    """Clean a clip of random postures. Raises Unsound where something overlaps in the output."""
    known = [move for move in (moves if isinstance(moves, list) else [moves]) if isinstance(move, int) and 0 <= move < 1000]
    samples = [v.sample((avatar,), move, 0.3) for move in known] if isinstance(avatar, Avatar) else []
    arrays = ([getattr(sample, name) for sample in samples] for name in ("positions", "rotations", "angles"))
    times = step * np.arange(len(samples)) if isinstance(step, float) else step
    motion = Motion(times, *(np.array(array) for array in arrays))  # type: ignore[arg-type]
    found = clean(motion, Model(avatar, None, (), ()), bodies, options)
    if not found.after.is_clean or found.after.unproven:
        after = found.after
        raise Unsound(f"a cleaned motion is not clean: {after.overlapping} {after.unproven} {after.limit_excess}")
    return found.motion.positions


def shielded(rows: list[object], rate: float, options: Options, speed: Rates, acceleration: Rates) -> object:
    """Filter a stream of coordinates that goes on after a refused row. Raises Unsound for an output that is no posture."""
    shield, shown = Shield(model(), (FLOOR,), rate, options, speed, acceleration), np.zeros(12)
    for row in rows if isinstance(rows, list) else [rows]:
        with suppress(AvatarsimError):
            shown = shield(row)  # type: ignore[arg-type]
    return shown


def small(value: object) -> bool:
    """Return whether a number causes little work."""
    return not (isinstance(value, int | float | np.number) and abs(float(min(max(value, -1e9), 1e9))) > 50.0)


def hand_over_table() -> Scene:
    """Return a fist over a table, a ball on it."""
    fist, ball = (Piece(Sphere(0.04)),), (Piece(Sphere(0.05)),)
    table = fixed("table", (Piece(Box((1.0, 1.0, 0.05))),), "wood")
    start = TrackerSample(0.0, np.array([[0.0, 0.0, 0.3]]), np.array([[1.0, 0.0, 0.0, 0.0]]), np.zeros(0))
    loose = simulated("ball", ball, "wood", solid(ball, 0.2), (0.2, 0.0, 0.076))
    return Scene("reach", (table, loose), (rigid_avatar("hand", fist, solid(fist, 0.5)),), start=start)


ENGINE = AvatarsimEngine()
"""One for all cases: a state that an input leaves behind in it meets the next case."""


def shown(scene: Scene, preset: str, options: dict[str, object], seed: int, dt: float, record: bool, moves: list[int]) -> object:
    """Return the states that the engine shows of a scene after some moves of the user."""
    shown_first = ENGINE.load(scene, Settings(preset, options, seed, record), dt)
    records = [shown_first]
    for place in moves if isinstance(moves, list) else [moves]:
        posture = v.sample(scene.avatars, place, 2.0) if isinstance(place, int) and 0 <= place < 1000 else place
        records.append(ENGINE.advance(posture, dt))  # type: ignore[arg-type]
    for one in records:
        for name in ("positions", "orientations", "velocities", "angular_velocities"):
            if not np.isfinite(getattr(one.shown, name)).all():
                raise Unsound(f"{name} shown are not finite")
    return records[-1].shown.positions


def doors() -> tuple[Door, ...]:
    """Return all of them; each constructor's strategy is drawn as often as its neighbours in a group."""
    groups: tuple[tuple[str, float, Callable[[], list[SearchStrategy[Asked]]]], ...] = (
        ("shapes", 90.0, shape_doors), ("joints", 70.0, joint_doors), ("bodies", 80.0, body_doors),
        ("mesh arrays", 2.0, mesh_doors), ("engine", 10.0, engine_doors), ("cleaning", 5.0, cleaning_doors),
    )
    return tuple(
        Door(name, weight, partial(cases, partial(one_of, made), sound), slow=weight <= 10.0,
             warm=partial(compiled, made) if name in ("engine", "cleaning") else nothing)
        for name, weight, made in groups
    )


def one_of(made: Callable[[], list[SearchStrategy[Asked]]]) -> SearchStrategy[Asked]:
    """Return any of the strategies of a group."""
    return st.one_of(made())


def compiled(made: Callable[[], list[SearchStrategy[Asked]]]) -> None:
    """Let both methods run the first scenes of a seed, so that no case waits for a kernel to be compiled or read."""
    for make, arguments in drawn(one_of(made), 0, 60):
        with suppress(Exception):
            make(**arguments)
