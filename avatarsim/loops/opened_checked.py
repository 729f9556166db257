"""What the checked lower loop keeps, opened again inside a kernel: fields in order, see `world.arena`."""

from avatarsim.collide.scratch import Scratch, scratch_at
from avatarsim.ik.state import Contacts
from avatarsim.loops.coupling import Springs
from avatarsim.posture.way_memory import Way
from avatarsim.posture.workspace import Closeness, Goal, Memory, PairMemory, Rows
from avatarsim.settings import CouplingSettings, PostureSettings
from avatarsim.world.arena import (
    Opening,
    cube,
    flag_grid,
    flag_line,
    grid,
    index_grid,
    index_line,
    line,
    matrices,
    real,
    stack,
    vectors,
    whole,
)
from avatarsim.world.opened import opened_poses, opened_posture
from avatarsim.world.view import opened


@opened
def opened_scratch(o: Opening) -> Scratch:
    """The next Scratch."""
    return scratch_at(index_line(o)[0])


@opened
def opened_closeness(o: Opening) -> Closeness:
    """The next Closeness."""
    return Closeness(
        index_grid(o)[0], index_line(o)[0], index_line(o)[0], line(o)[0], vectors(o)[0], vectors(o)[0], matrices(o)[0],
        line(o)[0], vectors(o)[0], vectors(o)[0], matrices(o)[0], matrices(o)[0], grid(o)[0], grid(o)[0], line(o)[0],
        line(o)[0], line(o)[0], vectors(o)[0], vectors(o)[0], matrices(o)[0], vectors(o)[0], matrices(o)[0], line(o)[0],
    )


@opened
def opened_goal(o: Opening) -> Goal:
    """The next Goal."""
    return Goal(
        line(o)[0], line(o)[0], line(o)[0], line(o)[0], line(o)[0], line(o)[0], line(o)[0], opened_posture(o), opened_posture(o),
        opened_posture(o), line(o)[0], opened_closeness(o), opened_posture(o),
        grid(o)[0], line(o)[0], line(o)[0], grid(o)[0], line(o)[0], grid(o)[0],
    )


@opened
def opened_rows(o: Opening) -> Rows:
    """The next Rows."""
    return Rows(
        grid(o)[0], grid(o)[0], line(o)[0], line(o)[0], line(o)[0], grid(o)[0], index_grid(o)[0], line(o)[0], line(o)[0],
        index_line(o)[0], index_line(o)[0], grid(o)[0], line(o)[0], line(o)[0], vectors(o)[0], grid(o)[0],
    )


@opened
def opened_pairs(o: Opening) -> PairMemory:
    """The next PairMemory."""
    return PairMemory(
        cube(o)[0], grid(o)[0], index_grid(o)[0], cube(o)[0], grid(o)[0], index_grid(o)[0], flag_grid(o)[0], index_grid(o)[0],
        index_line(o)[0], index_grid(o)[0], index_line(o)[0], index_line(o)[0],
    )


@opened
def opened_memory(o: Opening) -> Memory:
    """The next Memory of the posture solver."""
    return Memory(
        opened_poses(o), vectors(o)[0], vectors(o)[0], grid(o)[0], grid(o)[0], line(o)[0], opened_goal(o), opened_rows(o),
        opened_pairs(o), flag_line(o)[0], line(o)[0], index_line(o)[0], opened_scratch(o), cube(o)[0],
    )


@opened
def opened_settings(o: Opening) -> PostureSettings:
    """The next PostureSettings."""
    return PostureSettings(
        real(o), real(o), real(o), real(o), real(o), real(o), real(o), whole(o), whole(o), whole(o), whole(o), whole(o), real(o),
        real(o), real(o), real(o), real(o), whole(o), whole(o), whole(o), whole(o), whole(o), whole(o), whole(o), whole(o),
        whole(o),
    )


@opened
def opened_springs(o: Opening) -> Springs:
    """The next Springs."""
    settings = CouplingSettings(real(o), real(o))
    return Springs(
        settings, vectors(o)[0], vectors(o)[0], vectors(o)[0], line(o)[0], line(o)[0], vectors(o)[0], line(o)[0], opened_poses(o),
        opened_poses(o), index_line(o)[0],
    )


@opened
def opened_contacts(o: Opening) -> Contacts:
    """The next Contacts."""
    return Contacts(index_line(o)[0], index_grid(o)[0], vectors(o)[0], line(o)[0])


@opened
def opened_way(o: Opening) -> Way:
    """The next Way."""
    return Way(
        opened_memory(o), opened_posture(o), opened_poses(o), opened_posture(o), opened_posture(o), cube(o)[0], stack(o)[0],
        grid(o)[0], index_line(o)[0], index_line(o)[0], line(o)[0], index_line(o)[0], index_line(o)[0], line(o)[0],
        index_line(o)[0], index_line(o)[0],
    )
