"""Constrained inverse kinematics: the nearest posture to a target that overlaps nothing and keeps the limits of joints."""
