"""Files of a job in the folder of its run: its scene, its recording with figures, its scene as the simulator has it."""

import gzip
import io
import math
from collections.abc import Mapping
from dataclasses import fields, replace
from pathlib import Path
from typing import Any

import numpy as np

from avatarsim.engine import Engine
from avatarsim.errors import InvalidFile
from avatarsim.scene.scene import Scene
from avatarsim.scene.shape import Box, Capsule, Ellipsoid, Piece, Sphere
from runfiles.files import write_json, write_whole
from runfiles.naming import TUNED
from runfiles.native_files import FOLDER, STEPS, replay
from runfiles.record import Recording
from scenarios import catalog
from scenarios.job import Job
from scenarios.measure.posture.joints import places
from scenarios.measure.side import outside
from scenarios.measure.value import Missing, Value
from scenarios.scenario import Scenario

SCENES, SCENE_VERSION = "scenes", 1
"""Folder of the files of scenes in that of a run, and their layout."""
DIGITS = 7
"""Decimals of a vertex [m]: a tenth of a micrometre, far below the resolution of a picture."""
FIGURES, NOTES = "figures", "notes"
"""Keys in the meta of a recording: value or (reason, fault) by metric; notes by metric."""


def write_scene(scene: Scene, folder: Path, name: str) -> None:
    """Write the file of scenario `name`, unless it is there: all engines have the same scene."""
    path = folder / SCENES / f"{name}.json"
    if not path.exists():
        write_json(path, scene_mesh(scene))


def scene_mesh(scene: Scene) -> dict[str, object]:
    """Return the data that a page needs to draw a scene and to weigh its bodies.

    Bodies and links are in canonical order, each with role, convex pieces and, of a simulated one, its mass; parents are the
    indices of the links' parents, None for a root.
    """
    pieces = [body.pieces for body in scene.bodies] + [link.pieces for link in scene.links]
    masses = [body.mass for body in scene.bodies] + [None for _ in scene.links]
    return {
        "schema_version": SCENE_VERSION, "scene": scene.name, "gravity": list(scene.gravity),
        "parents": [place.parent for place in places(scene)],
        "bodies": [
            {
                "name": name, "role": role.name.lower(), "pieces": [_piece(piece) for piece in of_body],
                "mass": None if mass is None else {
                    "mass": mass.mass, "centre": list(mass.centre), "inertia": mass.inertia.tolist(),
                },
            }
            for name, role, of_body, mass in zip(scene.names, scene.roles, pieces, masses, strict=True)
        ],
    }


def _piece(piece: Piece) -> dict[str, object]:
    """Return kind and lengths [m] of a convex shape, and its pose on its body."""
    match shape := piece.shape:
        case Sphere():
            lengths: dict[str, object] = {"kind": "sphere", "radius": shape.radius}
        case Capsule():
            lengths = {"kind": "capsule", "radius": shape.radius, "length": shape.length}
        case Box():
            lengths = {"kind": "box", "size": list(shape.size)}
        case Ellipsoid():
            lengths = {"kind": "ellipsoid", "radii": list(shape.radii)}
        case _:
            lengths = {"kind": "hull", "vertices": shape.vertices.round(DIGITS).tolist()}
    return {**lengths, "position": list(piece.position), "orientation": list(piece.orientation)}


def figures_meta(values: Mapping[str, Value], notes: Mapping[str, str]) -> dict[str, object]:
    """Return figures and notes for the meta of a recording."""
    figures = {name: [one.reason, one.fault] if isinstance(one, Missing) else float(one) for name, one in values.items()}
    return {FIGURES: figures, NOTES: dict(notes)}


def figures(recording: Recording) -> tuple[dict[str, Value], dict[str, str]]:
    """Return figures and notes from the meta of a recording. Raises InvalidFile where they are absent or malformed."""
    values, notes = (recording.meta.get(name) for name in (FIGURES, NOTES))
    if not isinstance(values, dict) or not isinstance(notes, dict) or len(recording.overlap) not in (0, len(recording.times)):
        raise InvalidFile("figures of a recording", type(values).__name__, "those that the run measured")
    return {str(name): _value(name, value) for name, value in values.items()}, {str(k): str(v) for k, v in notes.items()}


def _value(name: object, value: object) -> Value:
    match value:
        case bool():
            pass
        case int() | float() | "NaN" | "Infinity" | "-Infinity":
            return float(value)
        case [str(reason), "engine" | "scene" | "package" as fault]:
            return Missing(reason, fault)
    raise InvalidFile(f"figure {name} of a recording", value, "a number, or a reason and the place of the fault")


def thinned(recording: Recording, scenario: Scenario, scene: Scene) -> Recording:
    """Return a measured recording reduced to its needed part: every state shown, and few of those inside frames.

    Sub-steps and events are nine tenths of a recording. The first of each frame inside which something is outside its region
    stays; velocities of links become NaN, those of bodies stay for the energies that pages draw.
    """
    wrong = np.flatnonzero(outside(recording.inside_positions, scenario.regions, scene.names))
    _, first = np.unique(recording.inside_frame[wrong], return_index=True)
    inside = [entry.name for entry in fields(recording) if entry.name.startswith("inside_")]
    few = replace(recording, **{name: getattr(recording, name)[wrong[first]] for name in inside})
    bodies = {name: getattr(recording, name).copy() for name in ("velocities", "angular_velocities")}
    for velocities in bodies.values():
        velocities[:, recording.links] = np.nan
    return replace(few, **bodies)


def write_native(engine: Engine, folder: Path, job: Job, everyday: bool) -> bool:
    """Write the loaded scene in the language of the simulator, if the engine has a method `native() -> (ending, text)`.

    An engine with `keep_steps` stores its commands from now on, in everyday scenes with preset tuned: of all scenes they would
    take 150 MB. Returns whether it does.
    """
    if native := getattr(engine, "native", None):
        ending, text = native()
        # without a time in it, so that equal texts are equal files
        data = gzip.compress(text.encode("utf-8"), mtime=0)
        write_whole(folder / FOLDER / f"{job.stem}.{ending}.gz", lambda file: file.write(data))
    keep_steps = getattr(engine, "keep_steps", None) if everyday and job.preset == TUNED else None
    if keep_steps:
        keep_steps()
    return keep_steps is not None


def write_steps(engine: Any, folder: Path, job: Job) -> None:
    """Write the commands of every step, and the program that plays them, so that a scene can be played without this project."""
    steps, program = engine.steps_told()
    if steps:
        packed = io.BytesIO()
        np.savez_compressed(packed, allow_pickle=False, **steps)
        write_whole(folder / FOLDER / f"{job.stem}.{STEPS}", lambda file: file.write(packed.getvalue()))
        write_whole(folder / replay(job.engine), lambda file: file.write(program.encode("utf-8")))


def checked_recording(recording: Recording, path: Path) -> Recording:
    """Return the recording at `path`, if it fits the catalogue's scene and its tracker and times are finite.

    Raises InvalidFile.
    """
    scene = catalog.get(path.name.split(".")[0]).build()
    bodies, links, hinges = len(scene.names), len(scene.links), scene.first_sample.angles.size
    of_tracker = ("times", "raw_positions", "raw_orientations", "raw_angles")
    valid = {"positions": (bodies,), "raw_positions": (links,), "raw_angles": (hinges,), "angles": (0, hinges)}
    for name in (*valid, *of_tracker):
        array = getattr(recording, name)
        if name in valid and array.shape[1] not in valid[name]:
            raise InvalidFile(f"width of {name} in recording {path}", array.shape[1], f"{valid[name][-1]}, as in the scene")
        if name in of_tracker and not np.isfinite(array).all():
            raise InvalidFile(f"{name} in recording {path}", "not all finite", "finite numbers")
    dt = recording.meta.get("dt")
    if recording.frames < 1 or not isinstance(dt, int | float) or not 0.0 < dt < math.inf:
        raise InvalidFile(f"frames and dt of recording {path}", (recording.frames, dt), "1 frame at least, of more than 0 s")
    return recording
