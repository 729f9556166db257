"""Every tolerance, cap and constant that a user may want to change, with its unit and what breaks if it changes."""

import re
from collections.abc import Mapping
from typing import NamedTuple


class PostureSettings(NamedTuple):
    """How a checked posture follows the tracker (method `default`).

    stand_off       [m] gap aimed at. 2e-5: more corrections and a longer slowest frame; 1e-3: air one can see.
    least_gap       [m] gap accepted. Room for curvature and solver error between this and `stand_off`.
    wedged_gap      [m] gap accepted when squeezed from two sides; 0 would let a wedged link never move again.
    turn_cap        [rad] largest change of a joint in one step; larger, and first-order rows stop predicting.
    move_cap        [m] largest translation of a root in one step; larger widens the swept boxes and the slowest frame.
    stray_turn      [rad] how far a contact may throw a joint off its own way in one step; infinite, and wrists spin.
    stray_move      [m] the same for the translation of a root.
    steps           steps per frame; 1 halves the top speed, 3 only costs time. So many times `turn_cap` and `move_cap`, beside
                    what the user did in that frame, is the motion budget of a frame, along a planned path too.
    corrections     rounds of new contact rows per attempt; 8 makes the slowest frames 2.5 times slower.
    attempts        attempts per step; the second one aims at softer gaps.
    sweeps          sweeps of the dual solver per round.
    work            budget of one frame in units of about a microsecond, counted and not timed, so results repeat. 40: limbs that
                    come free are held back, and bodies jump twice as far; 80: the slowest frames of getting up take 100 us.
    merit           share of the step's own length by which the distance to the tracker must shrink while the tracker
                    rests; 0 lets limbs circle around an obstacle for ever.
    root_weight     how much a root resists against a joint; below 1 the body drifts where a hand would do.
    stiffness_floor floor of a joint's weight in units of the median; 1 is closer to the tracker, 3 smoother.
    turn_share      what angles weigh beside link origins. 0.7: origins a tenth nearer to the user's where limbs are pressed on,
                    angles farther, and limbs are caught more often; 1: a finger that pushes a ball ends half a degree farther
                    turned from the user's; 1.1: who is thrown about waits in traps for longer; 1.4: chains lag.
    turn_alone      the same of avatars without joints (`turned_aside.py`). 1: behind a wall a hand's place is a tenth farther
                    from the user's; 0.36: in a corner, where it stays as it is held, it turns by 29 degrees for 13 mm.
    stuck_frames    frames without progress, the tracker's own posture being free, before the way is untied.
    untie           1 allows a stated jump to the tracker's posture when limbs are tied and nothing fixed is crossed.
    search_after    frames without coming nearer to a tracker whose own posture is free, or far off, before a way is searched.
    search_work     work of that search per frame, in the units of `work`; 0 searches nothing, and a trap may last.
    leap_search     searches more, each of `search_work`, in a frame in which the tracker leaps farther than the steps of a frame
                    go and something holds the avatar up. 0: it is led there in the frames after, and the frame of the leap
                    takes 2 ms at most; 7: up to 7 ms. Of one humanoid on a core of 2.6 GHz: `python -m scenarios.leap_times`.
    around          0: no way is searched around what walls the avatar off, it waits there. 1: only for avatars with joints, since
                    a hand without any that is pushed through a table is to lie on it: it is led nowhere. 2: for all.
    trapped_frames  frames of this kind in a row that make a posture `trapped`, which its frame records then say; not before
                    `search_after`, since until then nobody has looked.
    trapped_jump    frames of this kind after which a trapped avatar is shown at the tracker's posture, whatever lies between:
                    a stated jump, counted as a crossing. 0: never, it stays until a way is found.
    walled_jump     the same where something that is no link stands between the trunk and the tracker's. 0: it waits there.
    """

    stand_off: float = 2e-4
    least_gap: float = 5e-5
    wedged_gap: float = 2e-6
    turn_cap: float = 0.35
    move_cap: float = 0.15
    stray_turn: float = 0.15
    stray_move: float = 0.05
    steps: int = 2
    corrections: int = 4
    attempts: int = 2
    sweeps: int = 15
    work: int = 50
    merit: float = 0.01
    root_weight: float = 3.0
    stiffness_floor: float = 3.0
    turn_share: float = 1.07
    turn_alone: float = 0.55
    stuck_frames: int = 12
    untie: int = 1
    search_after: int = 1
    search_work: int = 1200
    leap_search: int = 7
    around: int = 1
    trapped_frames: int = 12
    trapped_jump: int = 0
    walled_jump: int = 0


class IkSettings(NamedTuple):
    """How a posture follows the tracker (method `ik`, docs/posture.md).

    stand_off       [m] gap aimed at. 2e-5: more corrections and a longer slowest frame; 1e-3: air one can see.
    least_gap       [m] gap accepted. Room for curvature and solver error between this and `stand_off`.
    wedged_gap      [m] gap accepted when squeezed from two sides; 0 would let a wedged link never move again.
    catch_up_turn   [rad/s] how fast a joint may turn beyond what the target turns. Larger: turns that look like jumps; smaller:
                    limbs that come free are late.
    catch_up_move   [m/s] the same of a root. Larger: jumps; smaller: a body that was held off comes late.
    damping_time    [s] in which a step in contact goes half of the way to the nearest posture, beyond the target's own motion.
                    0: limbs in contact go to and fro a little more; 0.05: contacts that give way are followed late.
    settle_time     [s] over which the target's speed is low-passed, in proportion to which the catch-up speeds fall once it holds
                    still. Larger: limbs that are pressed on things wander for longer; smaller: what is far away comes late.
    stall_time      [s] without progress after which a path is searched, or else the frame record says that an avatar waits.
    near            [m] an avatar whose link origins are all nearer than this to the target does not wait.
    steps           steps per frame at most. 1: fast targets lag in contact; 3 only costs time.
    corrections     rounds of new contact rows per step; 8 makes the slowest frames 2.5 times slower.
    work            work that a frame may cost, in units of about a microsecond, counted and not timed, so that results repeat.
                    When it is spent the last certified state is shown, and the record says so.
    plan_work       the part of it that searches for paths may take, in the same units. 0: no path is searched; more: paths are
                    found in fewer frames, each of which takes longer.
    around          0: no path is searched, an avatar waits behind what holds it off. 1: only for avatars with joints, since a
    hand
                    without any that is pushed through a table is to lie on it. 2: for all.
    """

    stand_off: float = 2e-4
    least_gap: float = 5e-5
    wedged_gap: float = 2e-6
    catch_up_turn: float = 12.5
    catch_up_move: float = 5.0
    damping_time: float = 0.01
    settle_time: float = 0.5
    stall_time: float = 0.1
    near: float = 0.05
    steps: int = 2
    corrections: int = 4
    work: int = 1200
    plan_work: int = 800
    around: int = 1


class CouplingSettings(NamedTuple):
    """Eq. 6, the virtual coupling between tracker and driven body, with the paper's constants.

    spring   [N/m] the paper's K. Softer: a hand lags behind the tracker after a collision; stiffer: heavy objects feel like
             walls.
    damping  [N s/m] the paper's R. Less: a hand swings about its user after a collision; more: it creeps back.
    """

    spring: float = 1000.0
    damping: float = 40.0


class AttractionSettings(NamedTuple):
    """Coach and trainee (method `paper`).

    rate  [1/s] share of the way to the tracker's angles taken per second. 30: nine tenths of the way back in five frames of
          1/60 s. Higher is stiffer, lower trails behind the user.
    """

    rate: float = 30.0


class PaperSettings(NamedTuple):
    """How eqs. 1-6 and Algorithm 1 are repeated until nothing overlaps.

    stand_off        [m] added to every PD_g. 0 leaves bodies touching, and rounding decides whether they overlap.
    tolerance        [m] an end effector this close to its goal is there; must stay below `stand_off`, or the loop spins.
    sweeps           most sweeps of CCD per goal. Few: goals are missed, more rounds; many: time spent on goals out of reach.
    still            [rad] a sweep in which no joint turns more than this changes nothing any more.
    bend             [rad] a straight chain is bent by this before CCD is tried again; 0 leaves it straight, as printed.
    parallel         sine of the angle below which a link counts as parallel to the obstacle's surface; 0 switches the case off.
    rounds           most rounds over all chains per frame; what overlaps then is walked back.
    patience         rounds in which only limbs turn and trunks move; from then on a limb that is still caught shifts its whole
                     avatar, and simulated bodies give way. At least `rounds`: neither ever happens.
    walk_back        share of the frame's way to which the walk back is found. Coarser: a visible gap; finer: more queries.
    couple           1: roots follow the tracker by eq. 6; 0: at once.
    """

    stand_off: float = 1e-4
    tolerance: float = 2e-5
    sweeps: int = 24
    still: float = 1e-9
    bend: float = 0.1
    parallel: float = 0.17
    rounds: int = 16
    patience: int = 6
    walk_back: float = 1e-6
    couple: int = 1


class Chosen(NamedTuple):
    """All settings of one run together."""

    posture: PostureSettings = PostureSettings()
    paper: PaperSettings = PaperSettings()
    coupling: CouplingSettings = CouplingSettings()
    attraction: AttractionSettings = AttractionSettings()
    ik: IkSettings = IkSettings()


def meanings(group: type) -> Mapping[str, str]:
    """What each setting of a group means, with its unit where it has one: read from the group's docstring, which is the one place
    where that is written. Empty where Python was told to drop docstrings."""
    found: dict[str, str] = {}
    name = ""
    for line in (group.__doc__ or "").splitlines():
        entry = re.match(r"    ([a-z_]+) +(\S.*)", line)
        if entry and entry[1] in group.__annotations__:
            name = entry[1]
            found[name] = entry[2].strip()
        elif name and line.startswith("      ") and line.strip():
            found[name] += f" {line.strip()}"
        else:
            name = ""
    return found
