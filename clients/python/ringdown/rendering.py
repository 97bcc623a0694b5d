"""Renders scores and scenes to arrays, sample for sample as `ringdown render` does."""

import math
import operator
import os
from typing import Any, Callable, Dict, Iterable, List, Mapping, NamedTuple, Optional, Sequence, Tuple, Union

import numpy as np
import numpy.typing as npt

from ._core import Bank, Mixer
from .errors import InputError

Event = Union[Mapping[str, Any], Sequence[Any]]
BankOrPath = Union[Bank, str, "os.PathLike[str]"]
Floats = npt.NDArray[np.float32]
Progress = Callable[[float], None]

TAIL_S = 5.0  # after the last event, where no length is given
SCENE_PIECE = 256  # frames between two steps of a scene: a mixer takes 4096 events between two blocks
FLUSH_EVENTS = 2048

# Events that the mixer carries out at their frames, and changes before which the block is split.
TIMED = Mixer.VERBS
CHANGES = ("fill", "hold", "material", "mute", "resonator", "solo", "remove")


class _Timed(NamedTuple):
    frame: int
    do: str
    arguments: Dict[str, Any]


def _timed(event: Event, numbers: Mapping[str, int], rate_hz: float) -> _Timed:
    if isinstance(event, Mapping):
        arguments = dict(event)
    else:
        names = ("time_s", "object", "point_m", "impulse_ns", "contact_time_s")
        if not 4 <= len(event) <= len(names):
            raise InputError(f"a strike is (time_s, object, point_m, impulse_ns[, contact_time_s]), not {event!r}")
        arguments = dict(zip(names, event))
    do = arguments.pop("do", "strike")
    if do not in TIMED and do not in CHANGES:
        raise InputError(f"'{do}' is not an event; there are {', '.join(TIMED + CHANGES)}")
    if ("time_s" in arguments) == ("frame" in arguments):
        raise InputError(f"an event has either a time_s or a frame: {event!r}")
    if "frame" in arguments:
        frame = operator.index(arguments.pop("frame"))
    else:
        frame = _nearest(_real(arguments.pop("time_s"), "time_s") * rate_hz)
    if frame < 0:
        raise InputError(f"an event comes before the beginning: {event!r}")
    name = arguments.get("object")
    if isinstance(name, str):
        if name not in numbers:
            raise InputError(f"there is no object '{name}'; there are {', '.join(numbers) or 'none'}")
        arguments["object"] = numbers[name]
    return _Timed(frame, do, arguments)


def _real(value: Any, name: str) -> float:
    """A number as a float; text is refused."""
    if isinstance(value, (str, bytes, bytearray)):
        raise TypeError(f"{name} must be a number, not {value!r}")
    return float(value)


def _nearest(value: float) -> int:
    if not math.isfinite(value):
        raise InputError(f"a time is {value}; it must be a finite number")
    return math.floor(abs(value) + 0.5) * (1 if value >= 0 else -1)


class _Piece:
    """One rendering: a mixer, perhaps with a scene, and the samples so far."""

    def __init__(self, mixer: Mixer, scene: Any, frames: int) -> None:
        self.mixer, self.scene = mixer, scene
        self.sound = np.empty((frames, 2), np.float32, order="F")
        self.now = 0
        self.sent = 0

    def render_until(self, end: int) -> None:
        if self.scene is not None:
            for at in [*range(self.now + SCENE_PIECE, end, SCENE_PIECE), end][: end - self.now]:
                self.scene.advance(at)
                self.mixer.render(0)  # the events move from the mixer's short ring to its queue
        self.mixer.render_into(self.sound[self.now : end])
        self.now = end

    def carry_out(self, event: _Timed) -> None:
        frame = max(self.now, event.frame)
        method = getattr(self.mixer, event.do)
        if event.do in TIMED:
            self.sent += 1
            if self.sent % FLUSH_EVENTS == 0:
                self.mixer.render(0)
            method(frame=frame, **event.arguments)
        else:
            self.render_until(frame)
            method(**event.arguments)


def _play(
    events: Iterable[Event],
    objects: Mapping[str, BankOrPath],
    scene_path: Optional[Union[str, "os.PathLike[str]"]],
    seconds: Optional[float],
    block_frames: int,
    progress: Optional[Progress],
    settings: Mapping[str, Any],
) -> Floats:
    if block_frames < 1:
        raise InputError("block_frames must be at least 1")
    mixer = Mixer(**settings)
    numbers = {
        name: mixer.add(bank if isinstance(bank, Bank) else Bank.open(bank), name) for name, bank in objects.items()
    }
    scene = None
    if scene_path is not None:
        from ._scene import Scene

        scene = Scene(mixer, scene_path)
    rate_hz = mixer.sample_rate_hz
    score: List[_Timed] = sorted((_timed(event, numbers, rate_hz) for event in events), key=lambda event: event.frame)
    if seconds is None:
        seconds = max(score[-1].frame / rate_hz + TAIL_S if score else 0.0, scene.duration_s if scene else 0.0)
    if not 0 < seconds <= 86400:
        raise InputError("there is nothing to render: give events, or a length of 0 to 86400 seconds")
    latency = mixer.latency_frames
    frames = _nearest(seconds * rate_hz) + latency
    piece = _Piece(mixer, scene, frames)
    next_event = 0
    for begin in range(0, frames, block_frames):
        end = min(begin + block_frames, frames)
        while next_event < len(score) and score[next_event].frame < end:
            piece.carry_out(score[next_event])
            next_event += 1
        piece.render_until(end)
        if progress is not None:
            progress(end / frames)
    return piece.sound[latency:]


def render(
    events: Iterable[Event],
    objects: Mapping[str, BankOrPath],
    *,
    seconds: Optional[float] = None,
    block_frames: int = 256,
    progress: Optional[Progress] = None,
    **settings: Any,
) -> Floats:
    """The sound of a score: frames x 2 numbers of type float32.

    An event is a strike, (time_s, object, point_m, impulse_ns) or with a contact_time_s as fifth, or a dictionary of
    the arguments of a method of Mixer with "time_s" (or "frame") and "do", the method's name, "strike" where it is left
    out: {"time_s": 0.5, "do": "gain", "object": "bell", "gain": 0.3}. They may come in any order.

    objects: names of objects and their banks, or the files of these. seconds: default: until 5 s after the last event.
    block_frames changes nothing but rounding. progress: called with the fraction done; what it raises ends the work.
    settings: arguments of Mixer, sample_rate_hz for example.

    The samples equal those that `ringdown render` writes with the same settings, bit for bit.
    """
    return _play(events, objects, None, seconds, block_frames, progress, settings)


def render_scene(
    path: Union[str, "os.PathLike[str]"],
    seconds: Optional[float] = None,
    *,
    events: Iterable[Event] = (),
    objects: Optional[Mapping[str, BankOrPath]] = None,
    block_frames: int = 256,
    progress: Optional[Progress] = None,
    **settings: Any,
) -> Floats:
    """The sound of a scene file (.toml), as render() returns it.

    seconds: default: as long as the file says. events and objects play along as in render(); objects of the scene itself
    are named by their numbers, which follow those of `objects`.
    """
    return _play(events, objects or {}, path, seconds, block_frames, progress, settings)
