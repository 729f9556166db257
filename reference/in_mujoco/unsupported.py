"""Features of a scene that MuJoCo does not support, as data: feature -> consequence."""

from collections.abc import Mapping

from avatarsim.scene.joint import Ball, Rigid
from avatarsim.scene.scene import Scene
from avatarsim.scene.shape import ConvexHull
from reference.narrowing import alike_in_all


def unsupported(scene: Scene, hinged: bool = False) -> Mapping[str, str]:
    """Return the differences; empty when MuJoCo can express all of the scene; `hinged`: each ball joint is three hinges."""
    features: dict[str, str] = {}
    links = scene.links
    balls = [link.joint for link in links if isinstance(link.joint, Ball)]
    pieces = [piece for body in scene.bodies for piece in body.pieces]
    pieces += [piece for link in links for piece in link.pieces]
    if any(isinstance(piece.shape, ConvexHull) for piece in pieces):
        features["vertices"] = "kept in single precision: hulls are off by up to 6e-8 of their distance from the origin"
    limited = any(ball.limits for ball in balls)
    if limited and hinged:
        features["swing and twist limits"] = (
            "three hinges with ranges replace each ball joint. They limit Cardan angles, the second to 89 degrees. Tendons limit "
            "swing cones besides"
        )
    elif limited:
        features["twist limits"] = (
            "our adapter makes ball joints, whose range limits their total rotation only. Preset tuned limits swing by "
            "tendons, which is not a documented limit. It clips the commanded twist; contact forces can still exceed the limit. "
            "Row mujoco/hinges has three hinges with ranges, whose angles differ from swing and twist"
        )
    if scene.effects.restitution:
        features["restitution"] = (
            "the default contact does not bounce; tuned, a one-step damper does, at the step in which overlap is "
            "found"
        )
    if scene.effects.coupling:
        features["virtual coupling"] = (
            "a weld is a spring that always pulls; that of equation 6 begins with a collision. With its K and R a link "
            "also sets out late. So a link goes back to its user as its weld has it"
        )
    if any(isinstance(avatar.links[0].joint, Rigid) for avatar in scene.avatars):
        features["rigid root"] = "links that cannot move make no contact with fixed bodies"
    return features | alike_in_all(scene)
