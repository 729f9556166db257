"""What the coupling keeps, opened again inside a kernel: fields in order, see `world.arena`."""

from avatarsim.coupling.virtual_coupling import Springs
from avatarsim.ik.state import Contacts
from avatarsim.settings import CouplingSettings
from avatarsim.world.arena import Opening, index_grid, index_line, line, real, vectors
from avatarsim.world.opened import opened_poses
from avatarsim.world.view import opened


@opened
def opened_springs(o: Opening) -> Springs:
    """The next Springs."""
    settings = CouplingSettings(real(o), real(o))
    return Springs(
        settings, vectors(o)[0], vectors(o)[0], vectors(o)[0], line(o)[0], line(o)[0], line(o)[0], vectors(o)[0], line(o)[0],
        opened_poses(o), opened_poses(o), index_line(o)[0],
    )


@opened
def opened_contacts(o: Opening) -> Contacts:
    """The next Contacts."""
    return Contacts(index_line(o)[0], index_grid(o)[0], vectors(o)[0], line(o)[0])
