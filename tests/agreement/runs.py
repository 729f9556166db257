"""Runs of an engine, and figures of its shown states."""

from collections.abc import Iterable
from typing import TypeVar

import numpy as np
from numpy.typing import NDArray

from avatarsim.engine import Engine, FrameRecord, Settings
from avatarsim.scene.scene import Scene
from avatarsim.scene.tracker import TrackerSample, rest
from reference.judging.judge import Judge
from scenarios import catalog
from scenarios.measure.posture.limits import joint_limit_excess

Array = NDArray[np.float64]
AnyEngine = TypeVar("AnyEngine", bound=Engine)
FRAME = 1.0 / 60.0
MM = 1e-3


def played(engine: Engine, scene: Scene, samples: Iterable[TrackerSample], settings: Settings, dt: float = FRAME
           ) -> list[FrameRecord]:
    """Return the records of a run: the first as loaded, then one per sample. The engine is closed."""
    records = [engine.load(scene, settings, dt)]
    records += [engine.advance(sample, dt) for sample in samples]
    engine.close()
    return records


def loaded(engine: AnyEngine, scene: Scene, settings: Settings, dt: float = FRAME) -> AnyEngine:
    """Return the engine at the start of a scene; it stays open."""
    engine.load(scene, settings, dt)
    return engine


def idle(scene: Scene, frames: int, dt: float = FRAME) -> list[TrackerSample]:
    """Return samples of a scene whose avatars, if any, stay at rest."""
    return [rest(scene.avatars, (frame + 1) * dt) for frame in range(frames)]


def of_catalog(engine: Engine, name: str, settings: Settings, frames: int | None = None) -> tuple[Scene, list[FrameRecord]]:
    """Return a scene of the catalogue and the records of its run with seed 0, up to `frames`."""
    scenario = catalog.get(name)
    scene = scenario.build()
    motion = scenario.motion(scene, 0)
    samples = (motion(frame) for frame in range(frames or scenario.frames))
    return scene, played(engine, scene, samples, settings, scenario.dt)


def poses(records: list[FrameRecord]) -> tuple[Array, Array]:
    """Return positions (F, n, 3) [m] and orientations (F, n, 4)."""
    shown = [record.shown for record in records]
    return np.array([state.positions for state in shown]), np.array([state.orientations for state in shown])


def depths(scene: Scene, records: list[FrameRecord]) -> Array:
    """Return the deepest overlap (F,) [m] of any two bodies."""
    return np.array([verdict.deepest for verdict in Judge(scene).each(*poses(records))])


def limit_excess(scene: Scene, records: list[FrameRecord]) -> Array:
    """Return the largest excess (F,) [deg] over the limits of a joint."""
    _, turns = poses(records)
    angles = np.array([record.angles for record in records])
    return np.degrees(joint_limit_excess(scene, turns[:, len(scene.bodies) :], angles))
