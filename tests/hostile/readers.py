"""Doors for files: meshes, motion clips, models, settings, what a run leaves behind, what the caches keep."""

import random
from collections.abc import Callable, Iterable, Mapping
from functools import partial
from pathlib import Path
from tempfile import TemporaryDirectory

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
from scenarios.results.resume import check_plan, earlier_run, has_ended, write_plan
from scenarios.results.store import Store
from scenarios.running.own_settings import read as read_settings
from scenarios.studies.hard_cases.finished import Finished
from scenarios.table_2 import rows as rows_of_table_2
from tests.assets.motions.robots import robot
from tests.hostile import valid_files as valid
from tests.hostile.doors import Door, FileDoor, Unsound, finite, of_files, sound
from tests.hostile.mutation import damaged, damaged_csv, damaged_glb, damaged_json, damaged_xml, damaged_zip

ENGINES = ("avatarsim", "mujoco", "pybullet", "tracker")

BARE = Results((), {}, (), {}, 0, {}, ())
"""A run without a figure."""

TABLES: Mapping[str, tuple[Callable[[Path], object], tuple[str, ...]]] = {
    "settings": (settings.settings, (settings.FILE,)), "hard cases": (hard_cases.trials, (hard_cases.FILE,)),
    "effects": (effects.effects, (effects.FILE,)),
    "articles": (lambda folder: articles.articles(Run(folder, BARE)), ("growth.csv", articles.JUDGE)),
}
"""Readers of files of a run besides results.json, and which."""


def hull(folder: Path, path: Path) -> object:
    """One hull of a mesh, at a scale at which it is believed."""
    found = pieces_of_mesh(path, hull=True, kept=False, quiet=True)
    for piece in found.pieces:
        finite(piece.shape)
    return finite(found)


def certified(folder: Path, path: Path) -> object:
    """A clip's certificate: one from which the page of a folder is made, or none."""
    found = certificate.read(path)
    return None if found is None else index_page(certificate.summary("clean", [found], []))


def certified_folder(folder: Path, path: Path) -> object:
    """A folder's certificate: one whose list of what is not done makes a page."""
    return index_page(certificate.summary("clean", [], certificate.not_done(path)))


def whole_mesh(folder: Path, path: Path) -> object:
    """A mesh as it was read: finite, each triangle among its vertices."""
    found = finite_mesh(read_mesh(path))
    if not (0 <= found.triangles.min() <= found.triangles.max() < len(found.vertices)):
        raise Unsound("a triangle beyond the vertices")
    return found


def clip(folder: Path, path: Path) -> object:
    """A clip, at equal steps where it is not years long."""
    found = read_clip(path)
    return finite(retimed(found) if found.times[-1] < 1e3 else found)


def trajectory(folder: Path, path: Path) -> object:
    """The motion of a small robot, and the file again."""
    found = load_motion(path)
    motion = finite(found.motion(robot()))
    assert isinstance(motion, Motion)
    assert found.written(motion, robot())
    return motion


def body(folder: Path, path: Path) -> object:
    """The avatar and the motion of a body of the SMPL family, and the file again."""
    found = load_motion(path)
    own = found.model()
    assert own is not None
    motion = finite(found.motion(own))
    assert isinstance(motion, Motion)
    assert found.written(motion, own)
    return motion


def recorded(folder: Path, path: Path) -> object:
    """A clip on its skeleton: its avatar, its motion, and the file again."""
    file = load_motion(next(folder.glob("*.amc"), path))
    found = file.model()
    assert found.avatar is not None
    motion = file.motion(found)
    assert file.written(motion, found)
    return sound((found.avatar, finite(motion)))


def model(folder: Path, path: Path) -> object:
    """The avatar of the first body of a model."""
    root = parsed(path).find("worldbody/body")
    if root is None:
        return None
    tip = {"tip": (folder / "tip.stl", np.full(3, 0.1))}
    links = Mjcf(path, True, lambda geom: True, lambda body, volume: 1000.0 * volume if volume > 0.0 else 1.0, tip).links(root)
    return sound(Avatar("some", links))


def model_mesh(folder: Path, path: Path) -> object:
    """A hull for a link."""
    return finite(hull_of(path, np.full(3, 0.01), 64))


def own_settings(folder: Path, path: Path) -> object:
    """Rows, each for an engine that there is."""
    rows = read_settings(path, ENGINES)
    assert rows and all(row.engine in ENGINES for row in rows)
    return rows


def look(folder: Path, path: Path) -> object:
    """What is drawn of a scene."""
    return kept.drawn(folder, valid.SCENE)


def replays(folder: Path, path: Path) -> object:
    """What an engine showed in it, and which pairs overlapped."""
    return kept.shown(folder, valid.SCENE, (valid.RUN,))


def apart(folder: Path, path: Path) -> object:
    """A recording whose user's motion is a file of its own."""
    (found,) = folder.glob("recordings/*.npz")
    return record.load(found)


def results(folder: Path, path: Path) -> object:
    """The figures of a run."""
    return load_results(folder)


def kept_figures(folder: Path, path: Path) -> object:
    """The committed figures of the gate."""
    return baseline.load(path)


def table(read: Callable[[Path], object], folder: Path, path: Path) -> object:
    """One table of a page."""
    return read(folder)


def page(folder: Path, path: Path) -> object:
    """All pages of a run."""
    return write_report(folder)


def cached(folder: Path, path: Path) -> object:
    """Kept pieces, or a sentence on why they are computed anew."""
    with valid.cache_in(folder):
        answer, said = cache.load(valid.PIECES)
    assert answer is not None or said
    return sound(answer)


def store(folder: Path, path: Path) -> object:
    """What a sweep has found before: nothing, or what it was."""
    found = Store(folder).get("kind", "key")
    if found is not None and {name: value for name, value in found.items() if name not in ("key", "kind")} != STORED:
        raise Unsound("an entry that was changed")
    return found


def stored() -> valid.Files:
    """An entry of its store."""
    with TemporaryDirectory() as made:
        Store(Path(made)).put("kind", "key", STORED)
        return {path.name: path.read_bytes() for path in Path(made).iterdir()}


def finished(folder: Path, path: Path) -> object:
    """What a run on stability has finished before."""
    found = Finished(path, "0")
    for one in found.known.values():
        assert all(type(getattr(one, name)) is kind for name, kind in (("state", str), ("frames", int), ("note", str)))
        assert all(isinstance(x, float) for place in one.end for x in place)
    return found


def resumed(folder: Path, path: Path) -> object:
    """The folder of an earlier run, and whether it came to its end."""
    return has_ended(earlier_run(folder, "compare"))


JOBS = tuple(Job("ball_drop", "mujoco", preset, seed=1, options={"iterations": 50, "cone": "elliptic"}) for preset in ("a", "b"))
"""What the plan of a run holds."""


def plan() -> valid.Files:
    """The plan of a run."""
    with TemporaryDirectory() as made:
        write_plan(Path(made), ("compare", "--filter", "ball_drop"), JOBS)
        return {path.name: path.read_bytes() for path in Path(made).iterdir()}


def planned(folder: Path, path: Path) -> object:
    """Whether a run may be gone on with."""
    return check_plan(folder, JOBS)


def table_2(folder: Path, path: Path) -> object:
    """What Table 2 takes from a run."""
    found = rows_of_table_2.runs(folder)
    assert not found or found[0].scene == valid.TABLE_2
    return found


def of_table_2() -> valid.Files:
    """A run of a scene of Table 2: results, its recording, the user's motion."""
    results = valid.run()["results.json"].replace(valid.SCENE.encode(), valid.TABLE_2.encode())
    return {"results.json": results, **valid.recorded_apart()}


STORED = {"figures": {"p50": 3.5, "note": ""}, "end": [[0.1, 2.5, -3.0]], "run": "mujoco/default"}
OUTCOME = (b'{"state": "survived", "frames": 36, "overlap": 1e-7, "energy": "NaN", "bad": 0, "end": [[0.1, 2.5, -3.0], [1, 2]], '
           b'"seconds": 0.25, "note": ""}')
FINISHED = {"stability.jsonl": b'{"stamp": "0", "key": "k", "outcome": %s}\n' % OUTCOME * 3}
EARLIER = {"results.json": b'{"schema_version": 1, "provenance": {"command": "python -m scenarios compare --full"}, "rows": []}'}


def some(names: Iterable[str]) -> Callable[[], valid.Files]:
    """Some files of the whole run."""
    return lambda: {name: valid.run()[name] for name in names}


def public_model(folder: Path, path: Path) -> object:
    """Avatar, room and loose bodies of an MJCF or URDF file."""
    return sound(load_avatar(folder / ("robot.urdf" if path.suffix == ".urdf" else "robot.xml"), fix="all", couplings="leave"))


def doors() -> tuple[Door, ...]:
    """All of them; weights are cases in a thousand."""
    found = []
    for ending, damage in (("obj", damaged), ("stl", damaged), ("stl_ascii", damaged), ("ply", damaged), ("off", damaged),
                           ("glb", damaged_glb), ("gltf", damaged_json)):
        files = some_gltf if ending == "gltf" else partial(valid.meshes, ending)
        also = partial(valid.meshes, "gltf") if ending == "gltf" else dict
        found.append(of_files(f"mesh {ending}", 30.0, FileDoor(files, damage, whole_mesh, also)))
        # to measure a hull against its mesh takes a tenth of a second
        found.append(of_files(f"hull {ending}", 1.0, FileDoor(files, damage, hull, also), slow=True))
    found += [
        of_files("motion clip", 60.0, FileDoor(valid.clip, damaged_json, clip)),
        of_files("trajectory npz", 40.0, FileDoor(valid.trajectory, damaged_zip, trajectory)),
        of_files("trajectory csv", 40.0, FileDoor(valid.trajectory_table, damaged_csv, trajectory)),
        of_files("body npz", 40.0, FileDoor(valid.body, damaged_zip, body), slow=True),
        of_files("bvh", 60.0, FileDoor(valid.bvh_file, damaged, recorded), slow=True),
        of_files("amc", 30.0, FileDoor(valid.amc_file, damaged, recorded, valid.asf_file), slow=True),
        of_files("asf", 30.0, FileDoor(valid.asf_file, damaged, recorded, valid.amc_file), slow=True),
        of_files("model", 60.0, FileDoor(valid.model, damaged_xml, model, valid.model_mesh), slow=True),
        # each is compiled in a process of its own, which takes half a second
        of_files("avatar", 1.0, FileDoor(valid.robots, damaged_xml, public_model, valid.robot_mesh), slow=True),
        of_files("mesh of an avatar", 0.5, FileDoor(valid.robot_mesh, damaged, public_model, valid.robots), slow=True),
        of_files("mesh of a model", 30.0, FileDoor(valid.model_mesh, damaged, model_mesh)),
        of_files("certificate", 20.0, FileDoor(valid.certificate_of_a_clip, damaged_json, certified)),
        of_files("certificate of a folder", 10.0, FileDoor(valid.certificate_of_a_folder, damaged_json, certified_folder)),
        of_files("settings", 60.0, FileDoor(valid.settings, damaged, own_settings)),
        of_files("results.json", 50.0, FileDoor(some(["results.json"]), damaged_json, results), slow=True),
        of_files("look of a scene", 25.0, FileDoor(lambda: part_of_kept("scenes"), damaged_json, look)),
        of_files("replays", 50.0, FileDoor(lambda: part_of_kept("recordings", "overlaps"), damaged_zip, replays), slow=True),
        of_files("recording", 25.0, FileDoor(valid.recording, damaged_zip, lambda folder, path: record.load(path)), slow=True),
        of_files("motion of a user", 25.0, FileDoor(valid.recorded_apart, damaged_zip, apart), slow=True),
        of_files("plan of a run", 15.0, FileDoor(plan, damaged_json, planned)),
        of_files("run for Table 2", 15.0, FileDoor(of_table_2, damaged_of_run, table_2), slow=True),
        of_files("kept pieces", 30.0, FileDoor(valid.pieces, damaged, cached), slow=True),
        of_files("found before", 15.0, FileDoor(stored, damaged_json, store)),
        of_files("finished before", 15.0, FileDoor(lambda: FINISHED, damaged_line, finished)),
        of_files("earlier run", 15.0, FileDoor(lambda: EARLIER, damaged_json, resumed)),
        of_files("baseline", 15.0, FileDoor(partial(committed, "baseline.csv"), damaged_csv, kept_figures)),
        of_files("pages", 2.0, FileDoor(valid.run, damaged_by_name, page, valid.kept), slow=True, reserves=True),
    ]
    for name, (read, names) in TABLES.items():
        found.append(of_files(f"table {name}", 10.0, FileDoor(some(names), damaged_by_name, partial(table, read))))
    return tuple(found)


def damaged_of_run(data: bytes, rng: random.Random) -> bytes:
    """A file of JSON or an archive, told apart by its first byte."""
    return (damaged_json if data[:1] == b"{" else damaged_zip)(data, rng)


def damaged_line(data: bytes, rng: random.Random) -> bytes:
    """A file of a JSON object a line, of which the first was damaged; now and then byte by byte."""
    first, _, rest = data.partition(b"\n")
    return damaged(data, rng) if rng.random() < 0.4 else damaged_json(first, rng) + b"\n" + rest


def damaged_by_name(data: bytes, rng: random.Random) -> bytes:
    """A table or a JSON file, told apart by its first byte."""
    return (damaged_json if data[:1] in b"{[" else damaged_csv)(data, rng)


def some_gltf() -> valid.Files:
    """The JSON part of glTF files, which names the others."""
    return {name: content for name, content in valid.meshes("gltf").items() if name.endswith(".gltf")}


def part_of_kept(*folders: str) -> valid.Files:
    """Files of a scene in some folders of a run."""
    return {name: content for name, content in valid.kept().items() if name.split("/")[0] in folders}


def committed(name: str) -> valid.Files:
    """The first lines of a committed table."""
    content = (Path(__file__).parents[2] / "reports" / name).read_bytes()
    return {name: b"\n".join(content.splitlines()[:20]) + b"\n"}
