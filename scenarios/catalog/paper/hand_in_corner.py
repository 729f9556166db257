"""Figure 5 of the paper: an articulated hand and its forearm slide along the non-convex corner of two walls.

As `hand_in_corner_rigid`, with the Shadow hand: 24 hinges, and fingers that bend and stretch on the way.

In the 240 frames of a quick comparison the raw motion is inside walls in 192 of them (up to 0.077 m deep).
"""

import numpy as np

from avatarsim.spatial import rotation
from scenarios.building.avatars.shadow_hand import shadow_hand
from scenarios.building.promises import AVATAR
from scenarios.catalog.paper.hand_in_corner_rigid import in_corner

HALF = float(np.sqrt(0.5))
INTO_CORNER = rotation.from_matrix(np.array([[-HALF, 0.0, HALF], [HALF, 0.0, HALF], [0.0, 1.0, 0.0]]))
"""Turns fingers that point along z into the corner, towards +x and +y, the palm down."""
TIP = 0.485
"""From the elbow to the longest fingertip [m]."""

SCENARIO = in_corner("hand_in_corner", "An articulated hand with its forearm", shadow_hand, INTO_CORNER, TIP, AVATAR)
