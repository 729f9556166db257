"""The accuracy pass: run one engine through one scenario, record everything, measure it, keep the recording."""

from collections.abc import Callable, Mapping
from contextlib import closing
from dataclasses import dataclass, replace
from pathlib import Path
from time import perf_counter

import numpy as np

from avatarsim.engine import Engine, FrameRecord, Snapshot
from avatarsim.errors import AvatarsimError, InvalidFile, MissingPackage, StartOverlaps, UnsupportedScene, described
from avatarsim.scene.scene import Scene
from avatarsim.scene.tracker import TrackerSample, link_poses_each
from avatarsim.spatial import rotation
from runfiles import overlapping, record
from runfiles.record import EVENTS, Integers, Recording
from scenarios.engines import opened
from scenarios.job import Job, Outcome, State
from scenarios.measure.everything import measured
from scenarios.measure.overlap import INSIDE_JUDGED
from scenarios.measure.phases import resting
from scenarios.run import native
from scenarios.run import scene_mesh as drawn
from scenarios.run.asked import Asked, asked
from scenarios.run.figures import figures, told
from scenarios.run.provenance import code_hash
from scenarios.run.thinned import thinned
from scenarios.scenario import REFUSAL, Scenario

FRAME_SECONDS = "frame_seconds"
"""Key in a recording's meta: median time [s] of a frame while other runs went on; too rough to be shown, it says how many frames
a glance can take."""


@dataclass(frozen=True, eq=False)
class Shown:
    """Frames of a job, the first of the load.

    state  measured, or the reason that there are no further frames, which the note explains
    about  version, cannot_say and settings of the engine, and its median time of a frame [s]
    """

    state: State
    frames: list[FrameRecord]
    about: dict[str, object]
    note: str = ""


def show(
    job: Job, what: Asked, inside: bool = True, loaded: Callable[[Engine], object] = id, ended: Callable[[Engine], object] = id,
) -> Shown:
    """Run the engine of a job through all its frames. An exception of the engine becomes the state of what is returned.

    Args:
        inside: record snapshots inside frames.
        loaded: called with the engine once it has loaded the scene.
        ended: called with the engine after its last frame.
    """
    scene, dt, frames, about = what.scene, what.scenario.dt, list[FrameRecord](), dict[str, object]()
    try:
        engine = opened(job.engine)
        cannot_say = dict(engine.cannot_say(scene))
        about |= {"version": engine.version, "cannot_say": cannot_say, "settings": {}}
        if "scene" in cannot_say:
            return Shown("cannot-say", [], about, cannot_say["scene"])
        settings = job.settings(engine, inside=inside)
    except MissingPackage as error:
        return Shown("not-measured", [], about, str(error))
    except Exception as error:
        # an engine may raise anything: that is its result, not the end of the comparison
        return Shown("crashed", [], about, f"before loading: {described(error)}")
    try:
        frames.append(engine.load(scene, settings, dt))
        about |= {"settings": dict(engine.settings_as_run()), "cannot_say": dict(engine.cannot_say(scene))}
        loaded(engine)
        spent = []
        for sample in what.samples:
            begun = perf_counter()
            frames.append(engine.advance(sample, dt))
            spent.append(perf_counter() - begun)
        about[FRAME_SECONDS] = float(np.median(spent)) if spent else 0.0
        ended(engine)
    except MissingPackage as error:
        return Shown("not-measured", frames, about, str(error))
    except UnsupportedScene as error:
        return Shown("cannot-say", frames, about, str(error))
    except StartOverlaps as error:
        return Shown("refused" if what.scenario.expects.get(REFUSAL) else "crashed", frames, about, described(error))
    except Exception as error:
        note = f"in frame {len(frames)}: {described(error)}" if frames else f"while loading: {described(error)}"
        return Shown("crashed", frames, about, note)
    finally:
        _close(engine)
    return Shown("measured", frames, about)


def accuracy(job: Job, folder: Path, judged: int = INSIDE_JUDGED) -> Outcome:
    """Run `job`, save its recording below `folder` and measure it, judging so many snapshots inside frames (all if the job is in
    full). Whatever goes wrong becomes an outcome of its own."""
    try:
        what = asked(job)
        scenario, scene = what.scenario, what.scene
        # an invalid sample is found here and is no fault of an engine
        what.samples  # noqa: B018
    except (AvatarsimError, ImportError) as error:
        return Outcome(job, "not-measured", f"the scene could not be made: {described(error)}")
    path = folder / "recordings" / f"{job.stem}.npz"
    judging = None if job.full else judged
    identity = {
        "scene_hash": what.scene_hash, "code": code_hash(), "frames": scenario.frames, "full": job.full, "dt": scenario.dt,
        "base": job.base, "options": repr(sorted(job.options.items())), "judged": judging,
    }
    drawn.write(scene, folder, scenario.name)
    if path.exists() and (earlier := kept(path, identity | {"version": _version(job.engine)})) is not None:
        return outcome_of(job, earlier, what, path)
    keeps = False

    def loaded(engine: Engine) -> None:
        nonlocal keeps
        native.write(engine, folder, job)
        keeps = native.keeps_steps(engine, job, scenario.everyday)

    def ended(engine: Engine) -> None:
        if keeps:
            native.write_steps(engine, folder, job)

    shown = show(job, what, loaded=loaded, ended=ended)
    frames, about = shown.frames, shown.about
    if shown.state == "crashed" and frames:
        left = gathered(job, scenario, scene, what.states, frames, {**about, **identity, "error": shown.note})
        record.save(thinned(left, scenario, scene), path, folder / record.MOTIONS)
        return Outcome(job, "crashed", shown.note, len(frames), about=about, recording=path)
    if shown.state != "measured":
        return Outcome(job, shown.state, shown.note, len(frames) if shown.state == "crashed" else 0, about=about)
    recording = gathered(job, scenario, scene, what.states, frames, {**about, **identity}, what.raw)
    return outcome_of(job, concluded(recording, what, judging, path), what, path)


def kept(path: Path, identity: Mapping[str, object]) -> Recording | None:
    """The recording that an earlier, unfinished run left at `path`: whole, without error, of the same scene by the same code, and
    measured as it would be now."""
    if not overlapping.path(path.parent.parent, path.stem).exists():
        return None
    try:
        found = record.load(path)
        figures(found)
    except InvalidFile:
        return None
    same = all(found.meta.get(name) == value for name, value in identity.items())
    return found if same and "error" not in found.meta else None


def concluded(recording: Recording, what: Asked, judged: int | None, path: Path) -> Recording:
    """Measure a whole recording, and save what is kept of it together with its figures."""
    found = measured(recording, what.known, judged)
    overlapping.write(found.overlapping, path.parent.parent, path.stem)
    thin = thinned(recording, what.scenario, what.scene.whole)
    left = replace(thin, meta={**thin.meta, **told(found.values, found.notes)}, overlap=found.overlap)
    record.save(left, path, path.parent.parent / record.MOTIONS)
    return left


def outcome_of(job: Job, recording: Recording, what: Asked, path: Path) -> Outcome:
    """What came of a job whose recording has been measured."""
    about = {name: recording.meta.get(name, {}) for name in ("version", "cannot_say", "settings")}
    about["lapsed"] = dict(what.scene.lapsed)
    values, notes = figures(recording)
    overlap, hashes = tuple(recording.overlap.tolist()), tuple(recording.state_hashes.tolist())
    cost = float(str(recording.meta.get(FRAME_SECONDS, 0.0)))
    rests = tuple(resting(recording, what.scene).tolist())
    return Outcome(job, "measured", "", recording.frames, values, notes, overlap, about, path, hashes, cost, rests)


def _version(name: str) -> str:
    """Version of an engine, "" of one that does not open."""
    try:
        with closing(opened(name)) as engine:
            return engine.version
    except Exception:
        # running the engine finds the cause again
        return ""


def _close(engine: Engine) -> None:
    try:
        engine.close()
    except Exception:
        # its frames are all there; failing to tidy up changes no figure
        return


def gathered(
    job: Job, scenario: Scenario, scene: Scene, states: list[TrackerSample], frames: list[FrameRecord],
    about: Mapping[str, object], raw: tuple[record.Array, record.Array] | None = None,
) -> Recording:
    """The frames that an engine showed, and the tracker's own posture beside each, as one recording; `raw` are the link poses of
    `states` where they are known."""
    shown = [frame.shown for frame in frames]
    inside = [(k, snapshot) for k, frame in enumerate(frames) for snapshot in frame.inside if k > 0]
    raw_positions, raw_orientations = raw or link_poses_each(scene.avatars, states[: len(frames)])
    n, hinges = len(scene.names), sum(avatar.hinge_count for avatar in scene.avatars)
    # an engine that gives no angles, or a wrong number of them, has given none
    given = all(len(frame.angles) == hinges for frame in frames)
    angles = [frame.angles if given else np.zeros(0) for frame in frames]
    within = [snapshot for _, snapshot in inside]
    return Recording(
        meta={
            "scene": scenario.name, "engine": job.engine, "preset": job.preset, "seed": job.seed, "dt": scenario.dt,
            "names": scene.names, **about,
        },
        times=np.arange(len(frames), dtype=np.float64) * scenario.dt,
        positions=_stack(shown, "positions", n, 3), orientations=_turns(shown, n),
        velocities=_stack(shown, "velocities", n, 3), angular_velocities=_stack(shown, "angular_velocities", n, 3),
        angles=np.array(angles, dtype=np.float64).reshape(len(frames), -1),
        raw_positions=raw_positions, raw_orientations=rotation.continuous(raw_orientations),
        raw_angles=np.array([sample.angles for sample in states[: len(frames)]], dtype=np.float64).reshape(len(frames), -1),
        inside_time=np.array([snapshot.time for snapshot in within], dtype=np.float64),
        inside_frame=np.array([k for k, _ in inside], dtype=np.int64),
        inside_event=np.array([EVENTS.index(snapshot.event) for snapshot in within], dtype=np.int64),
        inside_positions=_stack(within, "positions", n, 3), inside_orientations=_turns(within, n),
        inside_velocities=_stack(within, "velocities", n, 3),
        inside_angular_velocities=_stack(within, "angular_velocities", n, 3),
        state_hashes=np.array([frame.state_hash() for frame in frames]),
        counts=_tally([frame.counts for frame in frames]), statuses=_tally([frame.statuses for frame in frames]),
    )


def _stack(snapshots: list[Snapshot], name: str, n: int, width: int) -> record.Array:
    """(len(snapshots), n, width) of one field; an engine that gives another shape is told so by numpy."""
    return np.array([getattr(snapshot, name) for snapshot in snapshots], dtype=np.float64).reshape(len(snapshots), n, width)


def _turns(snapshots: list[Snapshot], n: int) -> record.Array:
    """(len(snapshots), n, 4) orientations whose signs do not change from row to row."""
    # an engine may show what is not finite
    with np.errstate(over="ignore", invalid="ignore"):
        return rotation.continuous(_stack(snapshots, "orientations", n, 4))


def _tally(per_frame: list[Mapping[str, int]]) -> dict[str, Integers]:
    """name -> (F+1,), 0 where a frame does not mention it."""
    names = sorted({name for tally in per_frame for name in tally})
    return {name: np.array([tally.get(name, 0) for tally in per_frame], dtype=np.int64) for name in names}
