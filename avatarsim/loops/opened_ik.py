"""What the lower loop of method `default` keeps, opened again inside a kernel: fields in order, see `world.arena`."""

from avatarsim.collide.scratch import opened_scratch
from avatarsim.coupling.opened import opened_contacts
from avatarsim.ik.pair_cache import PairCache
from avatarsim.ik.state import (
    Avatars,
    Budget,
    ConstraintRows,
    Failed,
    IkScratch,
    IkState,
    Objective,
    Touching,
    tracking_in,
)
from avatarsim.planner.state import Ghost, Plan, searches_in
from avatarsim.settings import PostureSettings
from avatarsim.world.arena import Opening, cube, flag_line, grid, index_grid, index_line, line, matrices, real, vectors, whole
from avatarsim.world.opened import opened_poses, opened_posture
from avatarsim.world.view import opened


@opened
def opened_avatars(o: Opening) -> Avatars:
    """The next Avatars."""
    return Avatars(
        index_line(o)[0], index_line(o)[0], index_line(o)[0], index_line(o)[0], index_grid(o)[0], index_line(o)[0], line(o)[0],
    )


@opened
def opened_pair_cache(o: Opening) -> PairCache:
    """The next PairCache."""
    return PairCache(
        index_line(o)[0], index_line(o)[0], vectors(o)[0], line(o)[0], index_line(o)[0], vectors(o)[0], line(o)[0],
        index_line(o)[0], index_line(o)[0], index_line(o)[0],
    )


@opened
def opened_touching(o: Opening) -> Touching:
    """The next Touching."""
    return Touching(index_line(o)[0], index_grid(o)[0], index_line(o)[0])


@opened
def opened_budget(o: Opening) -> Budget:
    """The next Budget."""
    return Budget(line(o)[0], line(o)[0], line(o)[0], line(o)[0], line(o)[0])


@opened
def opened_state(o: Opening) -> IkState:
    """The next IkState."""
    return IkState(
        tracking_in(index_line(o)[0])[0], opened_posture(o), opened_posture(o), vectors(o)[0], line(o)[0], opened_contacts(o),
        opened_touching(o), opened_pair_cache(o), index_grid(o)[0], index_line(o)[0], grid(o)[0], vectors(o)[0], opened_budget(o),
    )


@opened
def opened_objective(o: Opening) -> Objective:
    """The next Objective."""
    return Objective(
        vectors(o)[0], matrices(o)[0], vectors(o)[0], line(o)[0], line(o)[0], line(o)[0], line(o)[0], vectors(o)[0],
        vectors(o)[0],
        vectors(o)[0], matrices(o)[0], matrices(o)[0], grid(o)[0], grid(o)[0], line(o)[0],
    )


@opened
def opened_rows(o: Opening) -> ConstraintRows:
    """The next ConstraintRows."""
    return ConstraintRows(
        index_line(o)[0], index_line(o)[0], index_line(o)[0], index_grid(o)[0], index_grid(o)[0], grid(o)[0], grid(o)[0],
        line(o)[0], line(o)[0], line(o)[0], line(o)[0], vectors(o)[0], grid(o)[0], grid(o)[0], flag_line(o)[0], grid(o)[0],
        index_line(o)[0], line(o)[0],
    )


@opened
def opened_working(o: Opening) -> IkScratch:
    """The next IkScratch."""
    return IkScratch(
        opened_posture(o), opened_poses(o), vectors(o)[0], grid(o)[0], grid(o)[0], grid(o)[0], line(o)[0], line(o)[0], line(o)[0],
        line(o)[0], index_line(o)[0], index_line(o)[0], opened_objective(o), opened_rows(o), Failed(index_line(o)[0],
        index_grid(o)[0]),
        opened_scratch(o), index_line(o)[0], cube(o)[0],
    )


@opened
def opened_plan(o: Opening) -> Plan:
    """The next Plan."""
    return Plan(
        searches_in(index_line(o)[0])[0], cube(o)[0], index_grid(o)[0], index_grid(o)[0], index_grid(o)[0], index_line(o)[0]
    )


@opened
def opened_ghost(o: Opening) -> Ghost:
    """The next Ghost."""
    return Ghost(
        opened_posture(o), opened_poses(o), opened_state(o), opened_working(o), opened_posture(o), opened_posture(o), line(o)[0]
    )


@opened
def opened_settings(o: Opening) -> PostureSettings:
    """The next PostureSettings."""
    return PostureSettings(
        real(o), real(o), real(o), real(o), real(o), real(o), real(o), whole(o), whole(o), whole(o)
    )
