"""Inverse kinematics as printed (Schmidl and Lin 2004): end effectors and goals, cyclic coordinate descent, attraction."""
