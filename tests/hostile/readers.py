"""Doors for files: meshes, motion clips, models, settings, the files of a run, the contents of the caches."""

import random
from collections.abc import Callable, Mapping
from functools import partial
from pathlib import Path
from tempfile import TemporaryDirectory
from typing import Any

import numpy as np

from avatarsim.assets.meshes import cache, pieces_of_mesh
from avatarsim.assets.meshes.mesh import read_mesh
from avatarsim.assets.meshes.repairs import finite as finite_mesh
from avatarsim.assets.models.load import load_avatar
from avatarsim.assets.motions.deepmimic import read_clip
from avatarsim.assets.motions.load import load_motion
from avatarsim.clips import certificate
from avatarsim.clips.page.index_page import index_page
from avatarsim.scene.avatar import Avatar
from avatarsim.scene.motion import Motion
from benchmarks import table_2 as rows_of_table_2
from reports import write_report
from reports.pages import articles
from reports.reading import kept
from reports.reading.load import Results
from reports.reading.load import load as load_results
from reports.summaries import baseline
from reports.tables import effects, hard_cases, settings
from reports.tables.run import Run
from runfiles import record
from scenarios.building.avatars.mjcf import Mjcf, parsed
from scenarios.building.avatars.stl import hull_of
from scenarios.job import Job
from scenarios.motion.mocap import retimed
from scenarios.run.own_settings import read as read_settings
from scenarios.run.provenance import check_plan, earlier_run, has_ended, write_plan
from scenarios.studies.checkpoint import Checkpoint
from tests.assets.motions.robots import robot
from tests.hostile import valid_files as valid
from tests.hostile.doors import Damage, Door, FileDoor, Unsound, finite, of_files, sound
from tests.hostile.mutation import damaged, damaged_glb, damaged_json, damaged_words, damaged_zip

ENGINES = ("avatarsim", "mujoco", "pybullet", "tracker")

BARE = Results((), {}, (), {}, 0, {}, ())
"""A run without a figure."""

TABLES: Mapping[str, tuple[Callable[[Path], object], tuple[str, ...]]] = {
    "settings": (settings.settings, ("settings.csv",)), "hard cases": (hard_cases.by_case, ("hard_cases.csv",)),
    "effects": (effects.effects, ("effects.csv",)),
    "articles": (lambda folder: articles.articles(Run(folder, BARE)), ("growth.csv", articles.JUDGE)),
}
"""Readers of files of a run besides results.json, and which."""


def hull(folder: Path, path: Path) -> object:
    """Return one hull of a mesh, at a scale at which it is accepted."""
    found = pieces_of_mesh(path, hull=True, kept=False, quiet=True)
    for piece in found.pieces:
        finite(piece.shape)
    return finite(found)


def certified(folder: Path, path: Path) -> object:
    """Return a clip's certificate: one from which the page of a folder is made, or none."""
    found = certificate.read(path)
    return None if found is None else index_page(certificate.summary("clean", [found], []))


def certified_folder(folder: Path, path: Path) -> object:
    """Read a folder's certificate: one whose list of clips not done makes a page."""
    return index_page(certificate.summary("clean", [], certificate.not_done(path)))


def whole_mesh(folder: Path, path: Path) -> object:
    """Return a mesh as it was read: finite, each triangle among its vertices."""
    found = finite_mesh(read_mesh(path))
    if not (0 <= found.triangles.min() <= found.triangles.max() < len(found.vertices)):
        raise Unsound("a triangle beyond the vertices")
    return found


def clip(folder: Path, path: Path) -> object:
    """Return a clip, at equal steps where it is not years long."""
    found = read_clip(path)
    return finite(retimed(found) if found.times[-1] < 1e3 else found)


def trajectory(folder: Path, path: Path) -> object:
    """Return the motion of a small robot, and the file again."""
    found = load_motion(path)
    motion = finite(found.motion(robot()))
    assert isinstance(motion, Motion)
    assert found.written(motion, robot())
    return motion


def body(folder: Path, path: Path) -> object:
    """Return the avatar and the motion of a body of the SMPL family, and the file again."""
    found = load_motion(path)
    own: Any = found.model()
    motion = finite(found.motion(own))
    assert isinstance(motion, Motion)
    assert found.written(motion, own)
    return motion


def recorded(folder: Path, path: Path) -> object:
    """Return a clip on its skeleton: its avatar, its motion, and the file again."""
    file = load_motion(next(folder.glob("*.amc"), path))
    found: Any = file.model()
    motion = file.motion(found)
    assert file.written(motion, found)
    return sound((found.avatar, finite(motion)))


def model(folder: Path, path: Path) -> object:
    """Return the avatar of the first body of a model."""
    root = parsed(path).find("worldbody/body")
    if root is None:
        return None
    tip = {"tip": (folder / "tip.stl", np.full(3, 0.1))}
    links = Mjcf(path, True, lambda geom: True, lambda body, volume: 1000.0 * volume if volume > 0.0 else 1.0, tip).links(root)
    return sound(Avatar("some", links))


def own_settings(folder: Path, path: Path) -> object:
    """Return rows, each for an engine that there is."""
    rows = read_settings(path, ENGINES)
    assert rows and all(row.engine in ENGINES for row in rows)
    return rows


def cached(folder: Path, path: Path) -> object:
    """Return kept pieces, or a sentence on why they are computed anew."""
    with valid.cache_in(folder):
        answer, said = cache.load(valid.PIECES)
    assert answer is not None or said
    return sound(answer)


def finished(folder: Path, path: Path) -> object:
    """Return the entries that a study has finished before: none, or the original ones."""
    found = Checkpoint(path, "0").known
    if found and found != {"key": ANSWER}:
        raise Unsound("an answer that was changed")
    return found


JOBS = tuple(Job("ball_drop", "mujoco", preset, seed=1, options={"iterations": 50, "cone": "elliptic"}) for preset in ("a", "b"))
"""Jobs of a run's plan."""


def made(write: Callable[[Path], object]) -> valid.Files:
    """Return files that a function writes into a folder."""
    with TemporaryDirectory() as folder:
        write(Path(folder))
        return {path.name: path.read_bytes() for path in Path(folder).iterdir()}


def table_2(folder: Path, path: Path) -> object:
    """Return the values that Table 2 takes from a run."""
    found = rows_of_table_2.runs(folder)
    assert not found or found[0].scene == valid.TABLE_2
    return found


ANSWER = {"state": "measured", "values": {"a": 3.5}, "end": [[0.1, 2.5, -3.0]], "note": ""}
EARLIER = {"results.json": b'{"schema_version": 1, "provenance": {"command": "python -m scenarios compare --full"}, "rows": []}'}


def chosen(files: Callable[[], valid.Files], holds: Callable[[str], bool]) -> valid.Files:
    """Return some of these files."""
    return {name: content for name, content in files().items() if holds(name)}


def run_files(*names: str) -> Callable[[], valid.Files]:
    """Return some files of the whole run."""
    return partial(chosen, valid.run, names.__contains__)


def reader(
    name: str, weight: float, damage: Damage, ask: Callable[[Path, Path], object], also: str = "", slow: bool = False
) -> Door:
    """Return the door of one of the small texts; `also` names files next to it that stay whole."""
    files = FileDoor(lambda: valid.texts()[name], damage, ask, (lambda: valid.texts()[also]) if also else dict)
    return of_files(name, weight, files, slow=slow)


def doors() -> tuple[Door, ...]:
    """Return all of them; weights are cases in a thousand."""
    found = []
    for ending, damage in (("obj", damaged), ("stl", damaged), ("stl_ascii", damaged), ("ply", damaged), ("off", damaged),
                           ("dae", damaged), ("glb", damaged_glb), ("gltf", damaged_json)):
        files, also = partial(valid.meshes, ending), FileDoor.also
        if ending == "gltf":
            # the JSON part of glTF files, which names the others
            files = partial(chosen, partial(valid.meshes, "gltf"), lambda name: name.endswith(".gltf"))
            also = partial(valid.meshes, "gltf")
        found.append(of_files(f"mesh {ending}", 30.0, FileDoor(files, damage, whole_mesh, also)))
        # to measure a hull against its mesh takes a tenth of a second
        found.append(of_files(f"hull {ending}", 1.0, FileDoor(files, damage, hull, also), slow=True))
    found += [
        of_files("motion clip", 60.0, FileDoor(valid.clip, damaged_json, clip)),
        of_files("trajectory npz", 40.0, FileDoor(valid.trajectory, damaged_zip, trajectory)),
        reader("trajectory csv", 40.0, damaged_words, trajectory),
        of_files("body npz", 40.0, FileDoor(valid.body, damaged_zip, body), slow=True),
        reader("bvh", 60.0, damaged, recorded, slow=True), reader("amc", 30.0, damaged, recorded, "asf", slow=True),
        reader("asf", 30.0, damaged, recorded, "amc", slow=True),
        reader("model", 60.0, damaged_words, model, "mesh of a model", slow=True),
        # each is compiled in a process of its own, which takes half a second
        reader("avatar", 1.0, damaged_words, public_model, "mesh of an avatar", slow=True),
        reader("avatar looked at", 0.5, damaged_words, looked_at, "mesh of an avatar", slow=True),
        reader("mesh of an avatar", 0.5, damaged, public_model, "avatar", slow=True),
        reader("mesh of a model", 30.0, damaged, lambda folder, path: finite(hull_of(path, np.full(3, 0.01), 64))),
        reader("certificate", 20.0, damaged_json, certified),
        reader("certificate of a folder", 10.0, damaged_json, certified_folder),
        reader("settings", 60.0, damaged, own_settings),
        of_files("results.json", 50.0, FileDoor(run_files("results.json"), damaged_json,
                                                lambda folder, path: load_results(folder)), slow=True),
        of_files("look of a scene", 25.0, FileDoor(partial(kept_in, "scenes"), damaged_json,
                                                   lambda folder, path: kept.read_scene(folder, valid.SCENE))),
        of_files("replays", 50.0, FileDoor(partial(kept_in, "recordings", "overlaps"), damaged_zip,
                                           lambda folder, path: kept.shown(folder, valid.SCENE, (valid.RUN,))), slow=True),
        of_files("recording", 25.0, FileDoor(valid.recording, damaged_zip, lambda folder, path: record.load(path)), slow=True),
        of_files("motion of a user", 25.0, FileDoor(valid.recorded_apart, damaged_zip, lambda folder, path: record.load(
            next(folder.glob("recordings/*.npz")))), slow=True),
        of_files("plan of a run", 15.0, FileDoor(
            lambda: made(lambda folder: write_plan(folder, ("compare", "--filter", "ball_drop"), JOBS)), damaged_json,
            lambda folder, path: check_plan(folder, JOBS))),
        of_files("run for Table 2", 15.0, FileDoor(
            lambda: {"results.json": valid.run()["results.json"].replace(valid.SCENE.encode(), valid.TABLE_2.encode()),
                     **valid.recorded_apart()}, damaged_of_run, table_2), slow=True),
        of_files("kept pieces", 30.0, FileDoor(valid.pieces, damaged, cached), slow=True),
        of_files("finished before", 15.0, FileDoor(
            lambda: made(lambda folder: Checkpoint(folder / "study.jsonl", "0").put("key", ANSWER)), damaged_line, finished)),
        of_files("earlier run", 15.0, FileDoor(
            lambda: EARLIER, damaged_json, lambda folder, path: has_ended(earlier_run(folder, "compare")))),
        of_files("baseline", 15.0, FileDoor(partial(committed, "baseline.csv"), damaged_words,
                                            lambda folder, path: baseline.load(path))),
        of_files("pages", 2.0, FileDoor(valid.run, damaged_by_name, lambda folder, path: write_report(folder), valid.kept),
                 slow=True, reserves=True),
    ]
    for name, (read, names) in TABLES.items():
        door = FileDoor(run_files(*names), damaged_by_name, lambda folder, path, read=read: read(folder))  # type: ignore[misc]
        found.append(of_files(f"table {name}", 10.0, door))
    return tuple(found)


def public_model(folder: Path, path: Path) -> object:
    """Return avatar, room and loose bodies of an MJCF or URDF file."""
    return sound(load_avatar(folder / ("robot.urdf" if path.suffix == ".urdf" else "robot.xml"), fix="all"))


def looked_at(folder: Path, path: Path) -> object:
    """Return the same by the shapes to be looked at, finely, from its first keyframe."""
    keyed: dict[str, Any] = {} if path.suffix == ".urdf" else {"keyframe": 0}
    name = "robot.urdf" if path.suffix == ".urdf" else "robot.xml"
    return sound(load_avatar(folder / name, fix="all", collide="visual", fit=1e-4, **keyed))


def damaged_of_run(data: bytes, rng: random.Random) -> bytes:
    """Damage a file of JSON or an archive, distinguished by its first byte."""
    return (damaged_json if data[:1] == b"{" else damaged_zip)(data, rng)


def damaged_line(data: bytes, rng: random.Random) -> bytes:
    """Return a file of a JSON object a line, of which the first was damaged; now and then byte by byte."""
    first, _, rest = data.partition(b"\n")
    return damaged(data, rng) if rng.random() < 0.4 else damaged_json(first, rng) + b"\n" + rest


def damaged_by_name(data: bytes, rng: random.Random) -> bytes:
    """Damage a table or a JSON file, distinguished by its first byte."""
    return (damaged_json if data[:1] in b"{[" else damaged_words)(data, rng)


def kept_in(*folders: str) -> valid.Files:
    """Return files of a scene in some folders of a run."""
    return chosen(valid.kept, lambda name: name.split("/")[0] in folders)


def committed(name: str) -> valid.Files:
    """Return the first lines of a committed table."""
    content = (Path(__file__).parents[2] / "reports" / name).read_bytes()
    return {name: b"\n".join(content.splitlines()[:20]) + b"\n"}
