"""The tuples of a world again, inside a kernel, from the arena that holds them: fields in order, see `arena`."""

from avatarsim.world.arena import Opening, flag_grid, grid, index_line, line, matrices, vectors, whole
from avatarsim.world.dynamics import Dynamics, Velocities
from avatarsim.world.geometry import Geometry, Poses
from avatarsim.world.pair_filter import PairFilter
from avatarsim.world.shapes import shapes_in
from avatarsim.world.skeleton import Posture, Skeleton
from avatarsim.world.view import opened


@opened
def opened_filter(o: Opening) -> PairFilter:
    """The next PairFilter."""
    return PairFilter(index_line(o)[0], index_line(o)[0], index_line(o)[0])


@opened
def opened_geometry(o: Opening) -> Geometry:
    """The next Geometry."""
    return Geometry(shapes_in(index_line(o)[0])[0], vectors(o)[0], index_line(o)[0], index_line(o)[0], opened_filter(o))


@opened
def opened_dynamics(o: Opening) -> Dynamics:
    """The next Dynamics."""
    return Dynamics(
        index_line(o)[0], line(o)[0], matrices(o)[0], matrices(o)[0], index_line(o)[0], grid(o)[0], grid(o)[0], line(o)[0]
    )


@opened
def opened_poses(o: Opening) -> Poses:
    """The next Poses."""
    return Poses(vectors(o)[0], matrices(o)[0], vectors(o)[0], grid(o)[0], grid(o)[0])


@opened
def opened_velocities(o: Opening) -> Velocities:
    """The next Velocities."""
    return Velocities(vectors(o)[0], vectors(o)[0])


@opened
def opened_skeleton(o: Opening) -> Skeleton:
    """The next Skeleton."""
    return Skeleton(
        whole(o), index_line(o)[0], index_line(o)[0], index_line(o)[0], vectors(o)[0], matrices(o)[0], vectors(o)[0],
        grid(o)[0], grid(o)[0], matrices(o)[0], index_line(o)[0], vectors(o)[0], vectors(o)[0], vectors(o)[0],
        flag_grid(o)[0],
    )


@opened
def opened_posture(o: Opening) -> Posture:
    """The next Posture."""
    return Posture(vectors(o)[0], matrices(o)[0], line(o)[0])
