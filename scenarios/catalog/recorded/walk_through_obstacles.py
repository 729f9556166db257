"""A walk through the gallery past its furniture: "a comfortable posture even if walking through a path with obstacles".

The recorded clip "walk" is bent along a curve that leads everywhere a little too near.
"""

import numpy as np
from numpy.typing import NDArray

from avatarsim.assets.motions.deepmimic import Clip
from avatarsim.scene.scene import Scene
from avatarsim.spatial import rotation
from scenarios.building.gallery import gallery, inside
from scenarios.building.stage import with_human
from scenarios.motion.mocap import load_clip, repeated, retimed
from scenarios.motion.track import track_of
from scenarios.scenario import Motion

Array = NDArray[np.float64]

CORNERS = (
    (-3.55, -1.2), (-3.58, 0.3), (-3.3, 0.83), (-2.3, 0.86), (-1.2, 0.5), (0.0, 0.12), (1.2, 0.55), (2.2, 0.75),
    (3.6, 0.47), (4.75, 0.5), (4.75, -0.6), (3.8, -0.44), (2.75, -1.0), (2.35, -1.7), (2.6, -2.4), (4.0, -2.0),
)
"""Places that the path leads past [m]: the table's side, through the doorway off its middle, past sculpture and bench."""
SPACING = 0.01
"""Distance [m] of the points by which the path is stored."""


def path() -> tuple[Array, Array]:
    """Return points (n, 2) every SPACING along a smooth curve through the corners (each cut short), and headings (n,) [rad]."""
    corners = np.array(CORNERS)
    # corners are cut twice (Chaikin), which leaves a curve without kinks that a walker could follow
    for _ in range(4):
        a, b = corners[:-1], corners[1:]
        cut = np.stack([0.75 * a + 0.25 * b, 0.25 * a + 0.75 * b], axis=1).reshape(-1, 2)
        corners = np.vstack([corners[:1], cut, corners[-1:]])
    lengths = np.concatenate([[0.0], np.cumsum(np.linalg.norm(np.diff(corners, axis=0), axis=1))])
    along = np.arange(0.0, lengths[-1], SPACING)
    points = np.stack([np.interp(along, lengths, corners[:, axis]) for axis in (0, 1)], axis=1)
    ahead = np.gradient(points, axis=0)
    return points, np.unwrap(np.arctan2(ahead[:, 1], ahead[:, 0]))


def bent(clip: Clip) -> Clip:
    """Return the clip, which walks along x, with its way along x laid on the path and turned as the path turns."""
    points, headings = path()
    way = clip.root_positions[:, 0] - clip.root_positions[0, 0]
    along = np.arange(len(points)) * SPACING
    heading = np.interp(way, along, headings)
    sway = clip.root_positions[:, 1]
    x = np.interp(way, along, points[:, 0]) - sway * np.sin(heading)
    y = np.interp(way, along, points[:, 1]) + sway * np.cos(heading)
    turn = rotation.from_axis_angle(np.tile([0.0, 0.0, 1.0], (len(heading), 1)), heading)
    turned = {**clip.rotations, "root": rotation.multiply(turn, clip.rotations["root"])}
    return Clip(clip.name, False, clip.times, np.stack([x, y, clip.root_positions[:, 2]], axis=1), turned, clip.angles)


def motion(scene: Scene, seed: int) -> Motion:
    """Return a motion: half a second into the stride, then along the path; enough rounds of the clip for all frames."""
    return track_of(bent(retimed(repeated(load_clip("walk"), 13))), scene.avatars[0]).led_in(scene.first_sample).motion()


SCENARIO = with_human(
    "walk_through_obstacles",
    "A recorded walk leads through the gallery, round its table, through the doorway and past the exhibits, too near.",
    "Overlap; limits; how far the avatar is from its user, who sees no furniture; jumps.", motion, gallery,
    (*path()[0][0].tolist(), float(path()[1][0])), frames=900, short=420, region=inside("human/*"),
)
