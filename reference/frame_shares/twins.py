"""The frames of both methods with clocks: what asks for overlap, what solves for joints, what poses links, and all together."""

from typing import Any, Final

from avatarsim.collide.support import support
from avatarsim.loops import checked, paper, paper_rounds, paper_walk
from avatarsim.posture import follow, foreseen, step, walk
from avatarsim.posture.contact_row import add_row, rows_of_listed
from avatarsim.posture.free_link import free_link, link_contacts
from avatarsim.posture.goal import aim
from avatarsim.posture.kinematics import carry, forward, place_links
from avatarsim.posture.nearest_step import nearest_step
from avatarsim.separate.overlaps import find_overlaps
from avatarsim.separate.push_apart import push_apart
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


def checked_twin() -> Any:
    """`follow_opened` with clocks."""
    require_counter()
    pose, check = clocked(step.try_step, POSING), clocked(step.check, COLLISION)
    foresee = twin(foreseen.foresee, {
        "carry": clocked(carry, POSING), "farthest_of": clocked(foreseen.farthest_of, COLLISION),
        "support": clocked(support, COLLISION), "add_row": clocked(add_row, COLLISION),
    })
    attempt = twin(step.attempt, {
        "rows_of_listed": clocked(rows_of_listed, COLLISION), "nearest_step": clocked(nearest_step, IK),
        "foresee": foresee, "place_links": clocked(place_links, POSING), "check": check,
    })
    certifies = twin(step.certifies, {"try_step": pose, "check": check})
    back_off, less_far = (twin(one, {"certifies": certifies}) for one in (step.back_off, step.go_less_far))
    one = twin(step.step, {
        "attempt": attempt, "back_off": back_off, "go_less_far": less_far, "aim": clocked(aim, IK),
        "adopt": clocked(step.adopt, POSING),
    })
    frame = twin(follow.follow, {"walk": twin(walk.walk, {"step": one})})
    return clocked(twin(checked.follow_opened, {"follow": frame}), WHOLE)


TWINS: Final = {"paper": (paper, "follow_printed", paper_twin), "default": (checked, "follow_opened", checked_twin)}
"""By method: the module whose frame is replaced, the name there, and what makes the twin."""
