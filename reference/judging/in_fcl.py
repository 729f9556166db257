"""Signed distance of two convex shapes by python-fcl, also in a process of its own: on some boxes face to face it ends it.

Only `fcl.distance` is used: fcl's collide reports depths that are not minimal, or negative.
"""

import multiprocessing
import os
from collections.abc import Sequence
from contextlib import suppress
from multiprocessing.connection import Connection

import fcl
import numpy as np
from numpy.typing import NDArray

from avatarsim.scene.shape import Box, Capsule, Ellipsoid, Shape, Sphere
from reference.judging.geometry import wound_faces

Array = NDArray[np.float64]
Question = tuple[Shape, Array, Shape, Array, Array]
"""A shape and its turn (3, 3), another and its turn, and where the first lies as seen from the second (3,) [m]."""

TIMEOUT = 60.0
"""Longest wait [s] for one answer before the process counts as lost; an answer takes microseconds, starting under a second."""


def fcl_geometry(shape: Shape) -> fcl.CollisionGeometry:
    """Return `shape` as fcl's own kind of it; hulls vertex for vertex."""
    if isinstance(shape, Sphere):
        return fcl.Sphere(shape.radius)
    if isinstance(shape, Capsule):
        return fcl.Capsule(shape.radius, shape.length)
    if isinstance(shape, Box):
        return fcl.Box(*shape.size)
    if isinstance(shape, Ellipsoid):
        return fcl.Ellipsoid(*shape.radii)
    faces = wound_faces(shape.vertices)[1]
    return fcl.Convex(shape.vertices, len(faces), np.insert(faces, 0, 3, axis=1).flatten())


def fcl_distance(
    a: fcl.CollisionGeometry, turn_a: Array, at_a: Array, b: fcl.CollisionGeometry, turn_b: Array, at_b: Array
) -> float:
    """Return the signed distance [m] by fcl of two geometries at rotations (3, 3) and positions (3,) [m]."""
    request = fcl.DistanceRequest(enable_signed_distance=True, gjk_solver_type=fcl.GJKSolverType.GST_LIBCCD)
    first = fcl.CollisionObject(a, fcl.Transform(turn_a, at_a))
    second = fcl.CollisionObject(b, fcl.Transform(turn_b, at_b))
    return float(fcl.distance(first, second, request, fcl.DistanceResult()))


def fcl_distances(questions: Sequence[Question]) -> Array:
    """Return fcl's signed distances (n,) [m], computed in its own process; nan where that process ended without an answer."""
    answers, begun = np.full(len(questions), np.nan), 0
    # a process that is started anew: a fork of one that has threads may hang
    context = multiprocessing.get_context("spawn")
    while begun < len(questions):
        here, there = context.Pipe()
        child = context.Process(target=_answer, args=(there, list(questions[begun:])), daemon=True)
        child.start()
        there.close()
        with suppress(EOFError, ConnectionError):
            while begun < len(questions) and here.poll(TIMEOUT):
                answers[begun] = here.recv()
                begun += 1
        if begun < len(questions):
            # the one that ended it has no answer; the next process goes on behind it
            begun += 1
            child.kill()
        here.close()
        child.join()
    return answers


def _answer(connection: Connection, questions: Sequence[Question]) -> None:
    """Run that process: one number for each question. Messages of fcl as it ends are dropped."""
    os.dup2(os.open(os.devnull, os.O_WRONLY), 2)
    with suppress(ConnectionError):
        for a, turn_a, b, turn_b, from_b_to_a in questions:
            connection.send(fcl_distance(fcl_geometry(a), turn_a, from_b_to_a, fcl_geometry(b), turn_b, np.zeros(3)))
