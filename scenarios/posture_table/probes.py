"""Retargeted clips as probes: each clip of a folder in three rooms, with the floor 5 cm above the user's soles and 3 cm below.

A second catalogue, whose folder is named by the command line: each process that runs a probe is told it first (`use`).
"""

from collections.abc import Callable, Mapping
from dataclasses import replace
from functools import cache
from itertools import product
from pathlib import Path
from types import MappingProxyType

import numpy as np

from avatarsim.assets.motions.deepmimic import Clip, read_clip
from avatarsim.errors import InvalidInput, InvalidScene, StartOverlaps, UnknownName
from avatarsim.model.world import build
from avatarsim.pose_queries import require_free
from avatarsim.scene.avatar import Avatar
from avatarsim.scene.body import Body
from avatarsim.scene.scene import Scene
from scenarios.building import gallery, stage
from scenarios.building.avatars.humanoid import humanoid
from scenarios.building.avatars.standing import standing
from scenarios.building.reach import reach
from scenarios.motion.mocap import placed, retimed
from scenarios.motion.track import LEAD_IN, Track, track_of
from scenarios.scenario import Region, Scenario
from scenarios.unseen import rooms
from scenarios.unseen.drawn_motion import EVERY, SINKS

NAME = __name__
"""The module that a job names as its catalogue."""
PREFIX = "probe_"
"""How the names of these scenes begin."""
HEIGHTS = dict(zip(("sunk", "afloat"), SINKS, strict=True))
"""Height [m] of a clip's lowest points (their 5th percentile) over the floor: both ends of what the drawn motions range over."""
SHORT = 1200
"""Postures below which a clip is played there and back: twenty seconds meet the room often enough to count."""
AHEAD = 0.05
"""Least gap [m] between the standing avatar and the wall before it."""
MIDDLES = ((0.0, 0.0), (-2.5, 0.0), (2.5, 0.0), (0.3, 0.5), (-2.0, 0.7), (2.2, 0.6), (-0.5, -0.7), (1.0, -0.6), (0.9, 0.8))
HEADINGS = (0.0, 0.8, 1.6, 2.4, 3.2)
"""Where in the gallery [m] the middle of a clip's way is put, through the doorway first, and its heading [rad]: the first that
starts free is taken."""


Probe = tuple[Scene, Track]
"""A scene and what its user does."""


def use(folder: Path | None) -> None:
    """Take the clips of `folder`, every *.txt in it, as this process's; InvalidInput where there is none."""
    if folder is not None and not _clips_in(folder):
        raise InvalidInput("--clips", str(folder), "a folder with clips: *.txt as pybullet_data has them, 44 numbers a frame")
    _folder[:] = [] if folder is None else [folder]


_folder: list[Path] = []
"""The folder in use, if any: jobs travel by name, and the name has no room for a path."""


def _clips_in(folder: Path) -> dict[str, Path]:
    return {path.stem.removeprefix("humanoid3d_"): path for path in sorted(folder.glob("*.txt"))}


def names(every: int = 1) -> list[str]:
    """One clip of `every` in every room at both heights; nothing where no folder is in use."""
    if not _folder:
        return []
    chosen = list(_clips_in(_folder[0]).values())[::every]
    return [name for name, (path, _, _) in _found(_folder[0]).items() if path in chosen]


def get(name: str) -> Scenario:
    """The scene called `name`; UnknownName lists those that exist."""
    found = _found(_folder[0]) if _folder else {}
    if name not in found:
        raise UnknownName("probe", name, found)
    return _scenario(name, *found[name])


def group_of(name: str) -> str:
    """Room and height of a probe, as the table groups them."""
    return PREFIX + "_".join(name.removeprefix(PREFIX).split("_")[:2])


@cache
def _found(folder: Path) -> Mapping[str, tuple[Path, str, float]]:
    clips = _clips_in(folder).items()
    return MappingProxyType({f"{PREFIX}{room}_{height}_{clip}": (path, room, HEIGHTS[height])
                             for (clip, path), room, height in product(clips, ROOMS, HEIGHTS)})


@cache
def _scenario(name: str, path: Path, room: str, height: float) -> Scenario:
    count = len(_forward(path).times)
    frames = LEAD_IN + (count if count >= SHORT else 2 * count)
    return Scenario(
        name=name, title=f"A clip retargeted to the humanoid, {room}, its soles {100.0 * height:+.0f} cm over the floor.",
        judged="As the unseen motions: promises, and how it looks.", build=lambda: _probe(name, path, room, height)[0],
        motion=lambda scene, seed: _probe(name, path, room, height)[1].motion(), frames=frames, bounds=rooms.PROMISES,
        regions=(_allowed(path, room),),
    )


def _allowed(path: Path, room: str) -> Region:
    """Where links may be; the place of the wall depends on the clip."""
    if room == "wall":
        return stage.before_wall(_face(path), rooms.LINKS)
    return gallery.inside(rooms.LINKS) if room == "gallery" else rooms.ABOVE


@cache
def _forward(path: Path) -> Clip:
    """The clip at the steps of a rendered frame, turned so that its farthest point lies ahead, along x."""
    clip = retimed(read_clip(path))
    way = clip.root_positions[:, :2] - clip.root_positions[0, :2]
    far = way[np.linalg.norm(way, axis=1).argmax()]
    return placed(clip, 0.0, 0.0, -float(np.arctan2(far[1], far[0])))


@cache
def _lowest(path: Path) -> float:
    """The 5th percentile of the lowest points [m] of a clip."""
    return float(np.percentile(-_reach(humanoid(), _forward(path), (0.0, 0.0, -1.0)), 5.0))


def _reach(human: Avatar, clip: Clip, direction: tuple[float, float, float]) -> np.ndarray:
    track = track_of(clip, human)
    return reach((human,), [track.posture(k) for k in range(0, len(track), EVERY)], direction)


def _clip(path: Path, height: float) -> Clip:
    clip = _forward(path)
    return replace(clip, root_positions=clip.root_positions + np.array([0.0, 0.0, height - _lowest(path)]))


@cache
def _face(path: Path) -> float:
    """Where the wall begins along x [m]: at the median reach of the clip, so that it is beyond the wall half of the time."""
    human = humanoid()
    stands = float(reach((human,), (standing(human),), (1.0, 0.0, 0.0))[0])
    return max(stands + AHEAD, float(np.median(_reach(human, _forward(path), (1.0, 0.0, 0.0)))))


@cache
def _probe(name: str, path: Path, room: str, height: float) -> Probe:
    return ROOMS[room](name, path, height)


def _led(clip: Clip, human: Avatar, scene: Scene) -> Track:
    """The clip, there and back if it is short, led in from the scene's start."""
    track = track_of(clip, human)
    return (track if len(track) >= SHORT else track.there_and_back(2 * len(track))).led_in(scene.first_sample)


def _ahead(name: str, bodies: tuple[Body, ...], path: Path, height: float) -> Probe:
    """Before `bodies`, the way ahead leading into them."""
    human = humanoid()
    scene = Scene(name, bodies, (human,), start=standing(human))
    return scene, _led(_clip(path, height), human, scene)


def _wall(name: str, path: Path, height: float) -> Probe:
    return _ahead(name, (stage.floor(), stage.wall_ahead(_face(path))), path, height)


def _corridor(name: str, path: Path, height: float) -> Probe:
    return _ahead(name, rooms.corridor(), path, height)


def _gallery(name: str, path: Path, height: float) -> Probe:
    """In the gallery, at the first place where the avatar starts free."""
    human, clip = humanoid(), _clip(path, height)
    middle = 0.5 * (clip.root_positions.max(axis=0) + clip.root_positions.min(axis=0))[:2]
    for (x, y), turn in product(MIDDLES, HEADINGS):
        c, s = np.cos(turn), np.sin(turn)
        first = np.array([x, y]) - np.array([[c, -s], [s, c]]) @ middle
        first = np.clip(first, (-4.4, -2.4), (4.4, 2.4))
        at = float(first[0]), float(first[1]), turn
        scene = Scene(name, gallery.gallery(), (human,), start=standing(human, *at))
        try:
            require_free(build(scene))
        except StartOverlaps:
            continue
        return scene, _led(placed(clip, *at), human, scene)
    raise InvalidScene(f"start of {name}", f"{len(MIDDLES) * len(HEADINGS)} places", "one that is free")


ROOMS: Mapping[str, Callable[[str, Path, float], Probe]] = {"wall": _wall, "gallery": _gallery, "corridor": _corridor}
"""Rooms by name: floor and an endless wall, the gallery, a narrow corridor under a low ceiling."""
