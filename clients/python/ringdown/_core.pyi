import os
from typing import Any, Optional, Sequence, Union

import numpy as np
import numpy.typing as npt

from .values import Material, Status

Path = Union[str, bytes, "os.PathLike[str]"]
Numbers = Union[Sequence[float], npt.NDArray[Any]]
Floats = npt.NDArray[np.float32]
Doubles = npt.NDArray[np.float64]

def version() -> str: ...

class Bank:
    @staticmethod
    def open(path: Path) -> Bank: ...
    @staticmethod
    def parse(glb: Union[bytes, bytearray, memoryview], name: str = "bank") -> Bank: ...
    @property
    def name(self) -> str: ...
    @property
    def frequencies_hz(self) -> Doubles: ...
    @property
    def decays_per_s(self) -> Doubles: ...
    @property
    def shapes(self) -> Floats: ...
    @property
    def points_m(self) -> Floats: ...
    @property
    def triangles(self) -> npt.NDArray[np.uint32]: ...
    @property
    def material(self) -> Optional[Material]: ...
    @property
    def mass_kg(self) -> Optional[float]: ...
    @property
    def center_of_mass_m(self) -> Doubles: ...
    @property
    def has_radiation(self) -> bool: ...
    def levels_pa(self) -> Doubles: ...
    def far_field(self, mode: int, directions: npt.ArrayLike) -> npt.NDArray[np.complex64]: ...

class Mixer:
    def __init__(
        self,
        sample_rate_hz: float = 48000.0,
        *,
        full_scale_pa: float = 20.0,
        limiter_db: Optional[float] = -1.0,
        floor_db: float = 120.0,
        exact_contacts: bool = False,
        travel_time: bool = False,
        ambisonic_order: int = 0,
        threads: int = 1,
        head: Optional[Path] = None,
    ) -> None: ...
    def add(self, bank: Bank, name: Optional[str] = None) -> int: ...
    def remove(self, object: int) -> None: ...
    def material(
        self,
        object: int,
        *,
        stiffness: float = 1.0,
        density: float = 1.0,
        size: float = 1.0,
        alpha: float = 1.0,
        beta: float = 1.0,
    ) -> None: ...
    def hold(
        self,
        object: int,
        point_m: Numbers,
        damping_ns_m: float = 10.0,
        *,
        direction: Numbers = (0, 0, 0),
        number: int = 0,
        frame: Optional[int] = None,
    ) -> None: ...
    def mute(self, object: int, on: bool = True) -> None: ...
    def solo(self, object: int, on: bool = True) -> None: ...
    def excite(self, input: int, object: int, point_m: Numbers, force_n: Numbers) -> None: ...
    def strike(
        self,
        object: int,
        point_m: Numbers,
        impulse_ns: Numbers,
        contact_time_s: float = 0.0002,
        frame: Optional[int] = None,
    ) -> None: ...
    def strike_at(
        self,
        object: int,
        point: int,
        impulse_ns: Numbers,
        contact_time_s: float = 0.0002,
        frame: Optional[int] = None,
    ) -> None: ...
    def click(
        self, object: int, impulse_ns: Numbers, contact_time_s: float = 0.0002, frame: Optional[int] = None
    ) -> None: ...
    def touch(
        self,
        object: int,
        point_m: Numbers,
        force_n: Numbers,
        slip_m_s: float = 0.0,
        roll_m_s: float = 0.0,
        *,
        number: int = 0,
        roughness_m: float = 2e-6,
        correlation_m: float = 5e-5,
        spectral_slope: float = -2.4,
        frame: Optional[int] = None,
    ) -> None: ...
    def bow(
        self,
        object: int,
        point_m: Numbers,
        direction: Numbers,
        speed_m_s: float,
        force_n: float,
        *,
        width_m: float = 0.0,
        rosin: float = 0.8,
        number: int = 0,
        frame: Optional[int] = None,
    ) -> None: ...
    def mallet(
        self,
        object: int,
        point_m: Numbers,
        velocity_m_s: Numbers,
        mass_kg: float = 0.02,
        head: float = 1e7,
        bounce: float = 0.9,
        *,
        frame: Optional[int] = None,
    ) -> None: ...
    def couple(
        self,
        object: int,
        point_m: Numbers,
        other: int,
        other_point_m: Numbers,
        direction: Numbers,
        *,
        weight_n: float = 0.0,
        gap_m: float = 0.0,
        stiffness: float = 1e8,
        friction: float = 0.3,
        bounce: float = 0.6,
        mass_kg: float = 0.0,
        number: int = 0,
        frame: Optional[int] = None,
    ) -> None: ...
    def ring(
        self, object: int, first: int = 0, count: int = 1, amplitude: float = 0.1, frame: Optional[int] = None
    ) -> None: ...
    def gain(self, object: int, gain: float, ramp_s: float = 0.0, frame: Optional[int] = None) -> None: ...
    def pan(self, object: int, pan: float, frame: Optional[int] = None) -> None: ...
    def clear(self, object: int, ramp_s: float = 0.0, frame: Optional[int] = None) -> None: ...
    def pose(
        self,
        object: int,
        position_m: Numbers,
        rotation_wxyz: Numbers = (1, 0, 0, 0),
        frame: Optional[int] = None,
    ) -> None: ...
    def listener(
        self,
        position_m: Optional[Numbers],
        rotation_wxyz: Numbers = (1, 0, 0, 0),
        frame: Optional[int] = None,
    ) -> None: ...
    def air(
        self, temperature_c: float = 20.0, humidity_percent: float = 50.0, frame: Optional[int] = None
    ) -> None: ...
    def render(self, frames: int, inputs: Optional[npt.ArrayLike] = None) -> Floats: ...
    def render_into(
        self, array: Floats, ambisonics: Optional[Floats] = None, inputs: Optional[npt.ArrayLike] = None
    ) -> None: ...
    def render_ambisonics(self, frames: int, inputs: Optional[npt.ArrayLike] = None) -> Floats: ...
    @property
    def now(self) -> int: ...
    @property
    def latency_frames(self) -> int: ...
    @property
    def sample_rate_hz(self) -> float: ...
    @sample_rate_hz.setter
    def sample_rate_hz(self, value: float) -> None: ...
    @property
    def status(self) -> Status: ...
