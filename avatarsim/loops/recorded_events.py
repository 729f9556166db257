"""Events of a frame, from the upper loop's buffer to snapshots that a recording keeps."""

import numpy as np

from avatarsim.engine import Snapshot
from avatarsim.impact.events import APPROACH, Events
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
