"""The nearest free posture, found offline: the best that any method that stays with the user can reach in a frame.

Shares no solver, no collision query and no kinematics with an engine: sequential quadratic programs over joint rates, solved by
non-negative least squares, with distances from the judge's library, from many starts.
"""
