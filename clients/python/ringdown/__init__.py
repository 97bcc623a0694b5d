"""Solid objects as playable, physically exact sound.

    import ringdown

    bank = ringdown.Bank.open("bell.glb")             # from ringdown.bake(), or a preset of Ringdown
    sound = ringdown.render([(0.0, "bell", (0, 0, 0.1), (0, 0, -0.02))], {"bell": bank})

`sound` is a numpy array of frames x 2 samples at 48 kHz. render() and render_scene() compute a whole piece, Mixer a block
at a time, and bake() makes banks from meshes. Units are SI. Everything that fails raises ringdown.Error with one sentence;
what is wrong with an argument's value or a file is its subclass InputError, a ValueError, too.
To play live, send OSC to the daemon ringdownd (strike.py).
"""

from typing import TYPE_CHECKING, Any

from ._core import Bank, Mixer, version
from .baking import bake
from .errors import Error, InputError
from .rendering import render, render_scene
from .values import Losses, Material, Pattern, Piece, Status

if TYPE_CHECKING:
    from ._scene import Scene

__version__: str = version()
__all__ = ["Bank", "Error", "InputError", "Losses", "Material", "Mixer", "Pattern", "Piece", "Scene", "Status", "bake", "render",
           "render_scene"]


def __getattr__(name: str) -> Any:
    if name == "Scene":  # loaded when it is needed, because it brings ODE
        from ._scene import Scene

        return Scene
    raise AttributeError(f"module 'ringdown' has no attribute '{name}'")
