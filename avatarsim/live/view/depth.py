"""How deep bodies are in each other, as a page asks for it: by a judge where there is one, else by our own distances."""

from collections.abc import Callable

from avatarsim.live.messages import Array
from avatarsim.scene.scene import Scene

Depth = Callable[[Scene, Array, Array, Array], float]
"""Deepest penetration [m] of a scene whose bodies and links are at positions (n, 3) [m] and orientations (n, 4), with hinges at
angles (hinges,) [rad]."""
