"""Accuracy pass: run one engine through one scenario, measure its recording and save it."""

import math
from collections.abc import Mapping
from contextlib import ExitStack, closing, suppress
from dataclasses import dataclass, replace
from functools import cached_property
from importlib import import_module
from pathlib import Path
from time import perf_counter
from typing import Any

import numpy as np
from numpy.typing import NDArray

from avatarsim.engine import Engine, FrameRecord, Snapshot, require_record
from avatarsim.errors import AvatarsimError, InvalidFile, MissingPackage, StartOverlaps, UnsupportedScene, described
from avatarsim.scene.scene import Scene
from avatarsim.scene.tracker import TrackerSample, checked, link_poses_each
from avatarsim.spatial import rotation
from runfiles import overlapping, record
from runfiles.record import EVENTS, Recording
from scenarios.engines import opened
from scenarios.job import Job, Outcome, State
from scenarios.measure.everything import measured
from scenarios.measure.known import Known
from scenarios.measure.overlap import INSIDE_JUDGED
from scenarios.measure.phases import resting
from scenarios.run.provenance import code_hash, scene_hash
from scenarios.run.run_files import figures, figures_meta, thinned, write_native, write_scene, write_steps
from scenarios.scenario import REFUSAL, Motion, Scenario

Array = NDArray[np.float64]
Key = tuple[str, str, int, bool, int | None, tuple[str, ...], tuple[str, ...]]

FRAME_SECONDS = "frame_seconds"
"""Key in a recording's meta: median time [s] of a frame while other jobs run. Too rough to be shown; it plans quick timing."""


@dataclass(frozen=True, eq=False)
class Prepared:
    """A scenario at the length that is run, its scene and motion, and values that depend on these alone."""

    scenario: Scenario
    scene: Scene
    motion: Motion

    @cached_property
    def samples(self) -> list[TrackerSample]:
        """Samples of all frames. Raises InvalidSample."""
        return [checked(self.motion(k), self.scene.avatars) for k in range(self.scenario.frames)]

    @cached_property
    def states(self) -> list[TrackerSample]:
        """The first posture and all samples: one for each state that an engine shows."""
        return [self.scene.first_sample, *self.samples]

    @cached_property
    def raw(self) -> tuple[Array, Array]:
        """Link poses of the tracker in all states: (F+1, L, 3) [m] and (F+1, L, 4)."""
        return link_poses_each(self.scene.avatars, self.states)

    @cached_property
    def scene_hash(self) -> str:
        """Hash of the scene's description."""
        return scene_hash(self.scene)

    @cached_property
    def known(self) -> Known:
        """Values that all measures of the scene share; the scene is judged whole."""
        return Known(self.scenario, self.scene.whole)


_last: dict[Key, tuple[Scenario, Prepared]] = {}
"""The scene prepared last in this process: at most one, since engines come scene by scene."""


def prepare(job: Job) -> Prepared:
    """Return scenario, scene and motion of a job; those of the last job if equal. Raises errors of the catalogue."""
    key = job.catalogue, job.scenario, job.seed, job.full, job.frames, job.narrow, job.force
    offered: Scenario = import_module(job.catalogue).get(job.scenario)
    if key not in _last or _last[key][0] is not offered:
        _last.clear()
        scenario = offered.as_run(job.full)
        if job.frames is not None:
            scenario = replace(scenario, frames=min(job.frames, scenario.frames))
        scene = scenario.build()
        scene = replace(scene, narrow=(*scene.narrow, *job.narrow), force=(*scene.force, *job.force))
        _last[key] = offered, Prepared(scenario, scene, scenario.motion(scene, job.seed))
    return _last[key][1]


@dataclass(frozen=True, eq=False)
class Shown:
    """Frames of a job, the first of the load.

    state  measured, or the reason that there are no further frames, which the note explains
    about  version, unsupported features and settings of the engine, and its median time of a frame [s]
    """

    state: State
    frames: list[FrameRecord]
    about: dict[str, object]
    note: str = ""


def show(job: Job, prepared: Prepared, inside: bool = True, folder: Path | None = None, latest: float = math.inf) -> Shown:
    """Run the engine of a job through all its frames. An exception of the engine becomes the state of the result.

    Args:
        inside: record snapshots inside frames.
        folder: of the run, for the scene and the steps as the engine has them; None: not written.
        latest: longest time [s] of all frames before the last; an engine that takes more is not measured.
    """
    scene, dt, frames, about = prepared.scene, prepared.scenario.dt, list[FrameRecord](), dict[str, object]()
    with ExitStack() as stack:
        try:
            engine = opened(job.engine)
            stack.callback(_close, engine)
            unsupported = dict(engine.unsupported(scene))
            about |= {"version": engine.version, "unsupported": unsupported, "settings": {}}
            if "scene" in unsupported:
                return Shown("cannot-say", [], about, unsupported["scene"])
            first = engine.load(scene, job.settings(engine, inside=inside), dt)
            frames.append(require_record(first, scene.names, "of the load"))
            about |= {"settings": dict(engine.settings_as_run()), "unsupported": dict(engine.unsupported(scene))}
            keeps_steps = folder is not None and write_native(engine, folder, job, prepared.scenario.everyday)
            spent = list[float]()
            for sample in prepared.samples:
                if sum(spent) > latest:
                    return Shown("not-measured", frames, about, f"not through after {latest:g} s")
                begun = perf_counter()
                shown = engine.advance(sample, dt)
                spent.append(perf_counter() - begun)
                frames.append(require_record(shown, scene.names, "that it returned"))
            about[FRAME_SECONDS] = float(np.median(spent)) if spent else 0.0
            if folder is not None and keeps_steps:
                write_steps(engine, folder, job)
        except MissingPackage as error:
            return Shown("not-measured", frames, about, str(error))
        except UnsupportedScene as error:
            return Shown("cannot-say", frames, about, str(error))
        except StartOverlaps as error:
            return Shown("refused" if prepared.scenario.expects.get(REFUSAL) else "crashed", frames, about, described(error))
        except Exception as error:
            # an engine may raise anything: that is its result, not the end of the comparison
            when = f"in frame {len(frames)}" if frames else "while loading"
            return Shown("crashed", frames, about, f"{when}: {described(error)}")
    return Shown("measured", frames, about)


def _close(engine: Engine) -> None:
    """Close an engine; a failure changes no figure."""
    with suppress(Exception):
        engine.close()


def accuracy(job: Job, folder: Path, judged: int = INSIDE_JUDGED) -> Outcome:
    """Run a job, save its recording below the folder of the run, and measure it. Every failure becomes an outcome.

    Args:
        judged: snapshots inside frames that are judged; all if the job is in full.
    """
    try:
        prepared = prepare(job)
        # an invalid sample is found here and is no fault of an engine
        prepared.samples  # noqa: B018
    except (AvatarsimError, ImportError) as error:
        return Outcome(job, "not-measured", f"the scene could not be made: {described(error)}")
    scenario, scene = prepared.scenario, prepared.scene
    path = folder / "recordings" / f"{job.stem}.npz"
    judging = None if job.full else judged
    identity = {
        "scene_hash": prepared.scene_hash, "code": code_hash(), "frames": scenario.frames, "full": job.full, "dt": scenario.dt,
        "base": job.base, "options": repr(sorted(job.options.items())), "judged": judging,
    }
    write_scene(scene, folder, scenario.name)
    if path.exists() and (earlier := stored_recording(path, identity | {"version": _version(job.engine)})) is not None:
        return outcome_of(job, earlier, prepared, path)
    shown = show(job, prepared, folder=folder)
    frames, about = shown.frames, shown.about
    if shown.state == "crashed" and frames:
        left = gathered(job, scenario, scene, prepared.states, frames, {**about, **identity, "error": shown.note})
        record.save(thinned(left, scenario, scene), path, folder / record.MOTIONS)
        return Outcome(job, "crashed", shown.note, len(frames), about=about, recording=path)
    if shown.state != "measured":
        return Outcome(job, shown.state, shown.note, about=about)
    recording = gathered(job, scenario, scene, prepared.states, frames, {**about, **identity}, prepared.raw)
    figures = measured(recording, prepared.known, judging)
    overlapping.write(figures.overlapping, folder, path.stem)
    thin = thinned(recording, scenario, scene.whole)
    thin = replace(thin, meta={**thin.meta, **figures_meta(figures.values, figures.notes)}, overlap=figures.overlap)
    record.save(thin, path, folder / record.MOTIONS)
    return outcome_of(job, thin, prepared, path)


def stored_recording(path: Path, identity: Mapping[str, object]) -> Recording | None:
    """Return the recording of an earlier run: whole, without error, of the same scene, code and measures; None if not."""
    if not overlapping.path(path.parent.parent, path.stem).exists():
        return None
    try:
        recording = record.load(path)
        figures(recording)
    except InvalidFile:
        return None
    same = all(recording.meta.get(name) == value for name, value in identity.items())
    return recording if same and "error" not in recording.meta else None


def outcome_of(job: Job, recording: Recording, prepared: Prepared, path: Path) -> Outcome:
    """Return the outcome of a job whose recording has been measured."""
    about = {name: recording.meta.get(name, {}) for name in ("version", "unsupported", "settings")}
    about["lapsed"] = dict(prepared.scene.lapsed)
    values, notes = figures(recording)
    overlap, hashes = tuple(recording.overlap.tolist()), tuple(recording.state_hashes.tolist())
    cost = float(str(recording.meta.get(FRAME_SECONDS, 0.0)))
    rests = tuple(resting(recording, prepared.scene).tolist())
    return Outcome(job, "measured", "", recording.frames, values, notes, overlap, about, path, hashes, cost, rests)


def _version(name: str) -> str:
    """Return the version of an engine, "" of one that does not open."""
    try:
        with closing(opened(name)) as engine:
            return engine.version
    except Exception:
        # running the engine finds the cause again
        return ""


def gathered(
    job: Job, scenario: Scenario, scene: Scene, states: list[TrackerSample], frames: list[FrameRecord],
    about: Mapping[str, object], raw: tuple[Array, Array] | None = None,
) -> Recording:
    """Return the frames of an engine, and the tracker's own posture in each, as one recording.

    Args:
        about: further entries of its meta.
        raw: link poses of `states`, where they are known.
    """
    inside = [(k, snapshot) for k, frame in enumerate(frames) for snapshot in frame.inside if k > 0]
    within = [snapshot for _, snapshot in inside]
    raw_positions, raw_orientations = raw or link_poses_each(scene.avatars, states[: len(frames)])
    n, hinges = len(scene.names), sum(avatar.hinge_count for avatar in scene.avatars)
    # an engine that gives no angles, or a wrong number of them, has given none
    given = all(len(frame.angles) == hinges for frame in frames)
    angles = [frame.angles if given else np.zeros(0) for frame in frames]
    return Recording(
        meta={
            "scene": scenario.name, "engine": job.engine, "preset": job.preset, "seed": job.seed, "dt": scenario.dt,
            "names": scene.names, **about,
        },
        times=np.arange(len(frames), dtype=np.float64) * scenario.dt,
        **_stacked([frame.shown for frame in frames], n), **_stacked(within, n, "inside_"),
        angles=np.array(angles, dtype=np.float64).reshape(len(frames), -1),
        raw_positions=raw_positions, raw_orientations=rotation.continuous(raw_orientations),
        raw_angles=np.array([sample.angles for sample in states[: len(frames)]], dtype=np.float64).reshape(len(frames), -1),
        inside_time=np.array([snapshot.time for snapshot in within], dtype=np.float64),
        inside_frame=np.array([k for k, _ in inside], dtype=np.int64),
        inside_event=np.array([EVENTS.index(snapshot.event) for snapshot in within], dtype=np.int64),
        state_hashes=np.array([frame.state_hash() for frame in frames]),
        counts=_by_name([frame.counts for frame in frames]), statuses=_by_name([frame.statuses for frame in frames]),
    )


def _stacked(snapshots: list[Snapshot], n: int, prefix: str = "") -> dict[str, Any]:
    """Return poses and velocities of S snapshots, (S, n, 3) or (S, n, 4); signs of orientations do not change along rows."""
    arrays = {
        prefix + name: np.array([getattr(one, name) for one in snapshots], dtype=np.float64).reshape(len(snapshots), n, width)
        for name, width in (("positions", 3), ("orientations", 4), ("velocities", 3), ("angular_velocities", 3))
    }
    # an engine may show poses that are not finite
    with np.errstate(over="ignore", invalid="ignore"):
        return arrays | {prefix + "orientations": rotation.continuous(arrays[prefix + "orientations"])}


def _by_name(per_frame: list[Mapping[str, int]]) -> dict[str, NDArray[np.int64]]:
    """Return numbers (F+1,) by name, 0 in frames without the name."""
    names = sorted({name for numbers in per_frame for name in numbers})
    return {name: np.array([numbers.get(name, 0) for numbers in per_frame], dtype=np.int64) for name in names}
