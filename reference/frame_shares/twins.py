"""The frames of both methods with clocks: what asks for overlap, what solves for joints, what poses links, and all together."""

from typing import Any, Final

from avatarsim import lower_loop
from avatarsim.ik import certify as foresee
from avatarsim.ik import solve, sqp_step
from avatarsim.ik.certify import certify
from avatarsim.ik.constraints import add_touching
from avatarsim.ik.kinematics import carry_avatar, place_avatar, try_step
from avatarsim.model.skeleton import forward
from avatarsim.paper import algorithm_1 as paper_rounds
from avatarsim.paper import method as paper
from avatarsim.paper import walk_back as paper_walk
from avatarsim.paper.ccd_ik import free_link, link_contacts
from avatarsim.paper.push_apart import find_overlaps, push_apart
from reference.frame_shares.cycles import clocked, require_counter, twin

COLLISION, IK, POSING, PUSHING, WHOLE = range(5)
"""Slots: finding what overlaps and how deep, contact rows and certificates included; solving for joints; forward kinematics with
vertices and boxes; eq. 1's pushes of bodies (method `paper`); the whole frame."""
NAMES: Final = ("collision", "ik", "posing", "pushing", "whole")


def paper_twin() -> Any:
    """`follow_printed` with clocks."""
    require_counter()
    find, pose = clocked(find_overlaps, COLLISION), clocked(forward, POSING)
    treat = twin(paper_rounds.treat_chain, {
        "link_contacts": clocked(link_contacts, COLLISION), "free_link": clocked(free_link, IK),
    })
    push = twin(paper_rounds.push_bodies, {"push_apart": clocked(push_apart, PUSHING), "forward": pose})
    back = twin(paper_walk.walk_back, {"find_overlaps": find, "forward": pose})
    whole = twin(paper_rounds.follow_as_printed, {
        "find_overlaps": find, "forward": pose, "treat_chain": treat, "push_bodies": push, "walk_back": back,
    })
    return clocked(twin(paper.follow_printed, {"follow_as_printed": whole}), WHOLE)


def default_twin() -> Any:
    """`track` with clocks."""
    require_counter()
    check = clocked(certify, COLLISION)
    ahead = twin(foresee.foresee, {
        "carry_avatar": clocked(carry_avatar, POSING), "foresee_pair": clocked(foresee.foresee_pair, COLLISION),
    })
    solved = twin(sqp_step.try_qp, {
        "add_touching": clocked(add_touching, COLLISION), "choose_step": clocked(sqp_step.choose_step, IK), "foresee": ahead,
        "place_avatar": clocked(place_avatar, POSING), "certify": check,
    })
    back = twin(sqp_step.stay, {"try_step": clocked(try_step, POSING), "certify": check})
    one = twin(sqp_step.sqp_step, {"try_qp": solved, "stay": back, "adopt": clocked(sqp_step.adopt, POSING)})
    return clocked(twin(lower_loop.track, {"solve": twin(solve.solve, {"sqp_step": one})}), WHOLE)


TWINS: Final = {"paper": (paper, "follow_printed", paper_twin), "default": (lower_loop, "track", default_twin)}
"""By method: the module whose frame is replaced, the name there, and what makes the twin."""
