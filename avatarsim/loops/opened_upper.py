"""What the upper loop keeps, opened again inside a kernel: fields in order, see `world.arena`."""

from avatarsim.collide.scratch import opened_scratch
from avatarsim.collide.sweep_memory import SweepMemory
from avatarsim.impact.contacts import Contacts
from avatarsim.impact.events import Events
from avatarsim.impact.masses import Masses
from avatarsim.loops.islands import Islands
from avatarsim.loops.last_forces import LastForces
from avatarsim.loops.soonest import Soonest
from avatarsim.loops.upper_memory import Memory, Switches
from avatarsim.motion.free_rotation import Series
from avatarsim.motion.manifold import Manifold
from avatarsim.motion.path import Paths
from avatarsim.world.arena import Opening, cube, flag_line, grid, index_grid, index_line, line, matrices, stack, vectors, yes
from avatarsim.world.opened import opened_filter, opened_poses
from avatarsim.world.view import opened


@opened
def opened_masses(o: Opening) -> Masses:
    """The next Masses."""
    return Masses(line(o)[0], matrices(o)[0])


@opened
def opened_paths(o: Opening) -> Paths:
    """The next Paths."""
    return Paths(
        index_line(o)[0], vectors(o)[0], vectors(o)[0], index_line(o)[0], matrices(o)[0], matrices(o)[0], line(o)[0],
        vectors(o)[0], vectors(o)[0],
    )


@opened
def opened_contacts(o: Opening) -> Contacts:
    """The next Contacts."""
    return Contacts(
        index_line(o)[0], index_grid(o)[0], index_line(o)[0], index_line(o)[0], index_line(o)[0], matrices(o)[0], vectors(o)[0],
        vectors(o)[0], line(o)[0], line(o)[0], line(o)[0], vectors(o)[0], grid(o)[0], matrices(o)[0], matrices(o)[0],
        matrices(o)[0], matrices(o)[0], line(o)[0], grid(o)[0], grid(o)[0], vectors(o)[0], index_line(o)[0], index_line(o)[0],
        vectors(o)[0], vectors(o)[0], vectors(o)[0], vectors(o)[0], index_line(o)[0], matrices(o)[0], matrices(o)[0], grid(o)[0],
        grid(o)[0], grid(o)[0], line(o)[0], line(o)[0], grid(o)[0], grid(o)[0], index_grid(o)[0], index_line(o)[0],
        index_line(o)[0], index_line(o)[0],
    )


@opened
def opened_last(o: Opening) -> LastForces:
    """The next LastForces."""
    return LastForces(
        index_line(o)[0], index_line(o)[0], index_line(o)[0], vectors(o)[0], index_line(o)[0], index_line(o)[0]
    )


@opened
def opened_islands(o: Opening) -> Islands:
    """The next Islands."""
    return Islands(
        index_line(o)[0], index_line(o)[0], index_line(o)[0], index_grid(o)[0], index_line(o)[0], index_line(o)[0],
        index_line(o)[0], index_line(o)[0], index_line(o)[0], index_line(o)[0], index_line(o)[0], line(o)[0], line(o)[0],
        line(o)[0], vectors(o)[0], vectors(o)[0], vectors(o)[0], vectors(o)[0], vectors(o)[0], vectors(o)[0], vectors(o)[0],
    )


@opened
def opened_manifold(o: Opening) -> Manifold:
    """The next Manifold."""
    return Manifold(
        vectors(o)[0], vectors(o)[0], line(o)[0], index_line(o)[0], vectors(o)[0], vectors(o)[0], vectors(o)[0], vectors(o)[0],
        vectors(o)[0],
    )


@opened
def opened_sweep(o: Opening) -> SweepMemory:
    """The next SweepMemory."""
    return SweepMemory(
        grid(o)[0], grid(o)[0], index_grid(o)[0], flag_line(o)[0], index_line(o)[0], index_grid(o)[0], index_line(o)[0],
        index_line(o)[0], index_line(o)[0],
    )


@opened
def opened_memory(o: Opening) -> Memory:
    """The next Memory of the upper loop."""
    return Memory(
        vectors(o)[0], index_line(o)[0], index_line(o)[0], index_line(o)[0], index_line(o)[0], index_line(o)[0], opened_masses(o),
        opened_masses(o), matrices(o)[0], line(o)[0], line(o)[0], opened_poses(o), opened_paths(o),
        Series(vectors(o)[0], vectors(o)[0], grid(o)[0]), opened_contacts(o), opened_manifold(o), opened_scratch(o),
        vectors(o)[0], vectors(o)[0], vectors(o)[0], vectors(o)[0], grid(o)[0], opened_filter(o), opened_sweep(o),
        index_grid(o)[0], grid(o)[0], grid(o)[0], opened_last(o), index_line(o)[0], vectors(o)[0], vectors(o)[0],
        index_line(o)[0], opened_poses(o), opened_islands(o), index_line(o)[0], line(o)[0], line(o)[0], index_line(o)[0],
        index_grid(o)[0], index_line(o)[0], index_line(o)[0], grid(o)[0], line(o)[0], vectors(o)[0], index_line(o)[0],
        index_grid(o)[0], line(o)[0], line(o)[0], Soonest(index_line(o)[0], index_line(o)[0], index_grid(o)[0]),
        vectors(o)[0], vectors(o)[0],
    )


@opened
def opened_events(o: Opening) -> Events:
    """The next Events."""
    return Events(
        index_line(o)[0], line(o)[0], index_line(o)[0], index_grid(o)[0], cube(o)[0], stack(o)[0], cube(o)[0], cube(o)[0]
    )


@opened
def opened_switches(o: Opening) -> Switches:
    """The next Switches."""
    return Switches(yes(o), yes(o), yes(o), yes(o), yes(o))
