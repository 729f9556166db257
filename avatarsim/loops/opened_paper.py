"""What method `paper` keeps, opened again inside a kernel: fields in order, see `world.arena`."""

from avatarsim.collide.scratch import opened_scratch
from avatarsim.loops.opened_upper import opened_sweep
from avatarsim.loops.paper_memory import PaperMemory
from avatarsim.paper.chain import Chains
from avatarsim.separate.overlaps import Overlaps
from avatarsim.settings import AttractionSettings, CouplingSettings, PaperSettings
from avatarsim.world.arena import Opening, cube, flag_line, index_grid, index_line, line, real, vectors, whole
from avatarsim.world.opened import opened_filter, opened_posture
from avatarsim.world.view import opened


@opened
def opened_chains(o: Opening) -> Chains:
    """The next Chains."""
    return Chains(index_line(o)[0], index_line(o)[0], flag_line(o)[0], index_line(o)[0], vectors(o)[0])


@opened
def opened_overlaps(o: Opening) -> Overlaps:
    """The next Overlaps."""
    return Overlaps(
        opened_filter(o), opened_sweep(o), index_grid(o)[0], index_grid(o)[0], flag_line(o)[0], cube(o)[0], index_line(o)[0],
        opened_scratch(o),
    )


@opened
def opened_memory(o: Opening) -> PaperMemory:
    """The next PaperMemory."""
    return PaperMemory(
        opened_chains(o), opened_overlaps(o), index_line(o)[0], index_line(o)[0], index_line(o)[0], line(o)[0], opened_posture(o),
        opened_posture(o), opened_posture(o), vectors(o)[0], vectors(o)[0], flag_line(o)[0], vectors(o)[0], vectors(o)[0],
        vectors(o)[0], line(o)[0], vectors(o)[0], flag_line(o)[0], index_line(o)[0],
    )


@opened
def opened_settings(o: Opening) -> PaperSettings:
    """The next PaperSettings."""
    return PaperSettings(
        real(o), real(o), whole(o), real(o), real(o), real(o), whole(o), whole(o), real(o), whole(o),
    )


@opened
def opened_coupling(o: Opening) -> CouplingSettings:
    """The next CouplingSettings."""
    return CouplingSettings(real(o), real(o))


@opened
def opened_attraction(o: Opening) -> AttractionSettings:
    """The next AttractionSettings."""
    return AttractionSettings(real(o))
