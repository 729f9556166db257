"""Events and steps of a frame, from the buffers of the two loops to snapshots that a recording keeps."""

import numpy as np

from avatarsim.engine import Snapshot
from avatarsim.impact.events import APPROACH, Events
from avatarsim.jit.layout import Array
from avatarsim.world.doors import write_shown
from avatarsim.world.world import World


def snapshots(world: World, events: Events, begun: float) -> tuple[Snapshot, ...]:
    """One snapshot per recorded event; `begun` [s] is when the frame began."""
    kept = []
    for k in range(min(int(events.kept[0]), len(events.time))):
        positions, orientations = np.empty_like(events.position[k]), np.empty((len(world.centres), 4))
        write_shown(events.position[k], events.rotation[k], world.centres, 0, positions, orientations)
        name = "approach" if events.kind[k] == APPROACH else "impact"
        linear, angular = events.linear[k].copy(), events.angular[k].copy()
        kept.append(Snapshot(begun + float(events.time[k]), positions, orientations, linear, angular, name))
    return tuple(kept)


def trail_snapshots(world: World, trail: Array, time: float) -> tuple[Snapshot, ...]:
    """One snapshot, at `time` [s], per row of the trail (k, nl, 12) of a lower loop: positions [m] and rotations of links; all
    other bodies, and all velocities, as they are now."""
    first, kept = world.skeleton.first, []
    for links in trail:
        position, rotation = world.poses.position.copy(), world.poses.rotation.copy()
        position[first:], rotation[first:] = links[:, :3], links[:, 3:].reshape(-1, 3, 3)
        positions, orientations = np.empty_like(position), np.empty((len(world.centres), 4))
        write_shown(position, rotation, world.centres, 0, positions, orientations)
        linear, angular = world.velocities.linear.copy(), world.velocities.angular.copy()
        kept.append(Snapshot(time, positions, orientations, linear, angular))
    return tuple(kept)
