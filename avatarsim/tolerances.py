"""Ladders of tolerances: rounding, the judged overlap, and the gaps that a posture keeps, which are shares of the one it aims at.

A rung is a number without a unit. Where it is used it is a share, or means as many m, rad, s or J, or their rates: frames, bodies
and speeds of people are of the order of one. On rounding: Higham 2002, Accuracy and Stability of Numerical Algorithms.
"""

from sys import float_info

EPSILON = float_info.epsilon
"""[a share] from 1 to the next number of double precision."""

GRAIN = 1e-14
"""[a share, m, or rad] error of a few products in double precision, some fifty roundings."""

LAST_PLACES = GRAIN / 10.0
"""[a share] error of one number: a few units in the last place."""

GRAINS = 10.0 * GRAIN
"""[a share, or J] error of a sum of such products. Larger: an error passes for rounding; smaller: rounding for an error, and
iterations do not end."""

ROUNDING = 100.0 * GRAIN
"""[m, or a share] error of sums of a frame's products, a hundred times over."""

COARSE_ROUNDING = 10.0 * ROUNDING
"""[a share] error of a shape's size by rounded coordinates far from the origin. Larger: a wrong distance by as much; smaller:
shapes there are not recognised, or an answer is given up that cannot be better, and slower ways are taken."""

NOTHING = 1e-9
"""[m, rad, their rates, s, or a share] far below shown or judged differences (JUDGED), and far above rounding: an overlap of a
start, an excess, an offset or a difference that is taken for none."""

PROOF = NOTHING / 10.0
"""[a share, rad, m/s, or s] slack of a proof. Larger: wrong answers by as much; smaller: rounding decides."""

SLIGHT = 10.0 * NOTHING
"""[m, m/s, or a share] error where some of it is made up for later in the frame: a tenth of a nanometre in it."""

ROUGH = 10.0 * SLIGHT
"""[m, m/s, or a share] error where the next frame makes up for it: some nanometres in a frame."""

JUDGED = 10.0 * ROUGH
"""[m, m/s, or a share] the overlap that is judged, a micrometre: no figure shows less. Larger: it can be measured."""

SAME_DIRECTION = JUDGED
"""Sine of the angle below which two directions count as one, and share below which a sum of directions has none."""

SLIM = 1e-3
"""Sine of the angle of two edges below which they are taken for nearly parallel, and height of a simplex, relative to the shapes'
size, below which it is taken for nearly flat. Smaller: a vector product of theirs is off by 1e-16 / sine, and the point in which
they cross runs away; larger: well-formed ones take longer ways."""

SHORT_TURN = 0.5
"""[rad] the largest turn over which an expansion about none is used: a linear or quadratic model, or a series of few terms.
Larger: linear steps lead elsewhere, and the series needs more terms; smaller: more steps."""

SMALL = 1e-2
"""[m] size below which a body counts as small: bodies may spin faster in proportion and still rest, and have narrower boxes; no
arm of a joint weighs less. Larger: bodies that one can see spin count as resting; smaller: small ones never rest, and joints that
hardly move anything spin."""

FINE = 0.1
"""Share of a gap, or of the way of a frame, within which it counts as reached. Larger: gaps are off by as much, and paths are
left early; smaller: more rounds, and stops at nodes of paths."""

REGULAR = NOTHING
"""Share of its own by which the diagonal of a Gram matrix is raised (Tikhonov): equal rows then share the load, and a row without
any lever divides by something. 1e-6: the certificate sees their error."""

assert 0.0 < EPSILON < LAST_PLACES < GRAIN < GRAINS < ROUNDING < COARSE_ROUNDING < PROOF
assert PROOF < NOTHING < SLIGHT < ROUGH < JUDGED < SLIM

POSTURE_GAP = 2e-4
"""[m] gap that a posture aims at unless a setting says otherwise: `settings.PostureSettings`, with the effects of a change."""

LEAST_SHARE = 0.25
"""[stand-offs] gap that is accepted. Between it and the stand-off there is room for the curvature of a step and for the solver's
error; it may not be 1. The share is that of the settings which it replaces, and was not tuned anew."""

WEDGED_SHARE = 0.01
"""[stand-offs] gap to which a pair may go that is squeezed from two sides; 0 would let a wedged link never move again."""

assert 0.0 < WEDGED_SHARE < LEAST_SHARE < 1.0
