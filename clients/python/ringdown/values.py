"""Values that banks and mixers return."""

from typing import NamedTuple, Optional, Tuple

import numpy as np
import numpy.typing as npt

Doubles = npt.NDArray[np.float64]
Triple = Tuple[float, float, float]


class Material(NamedTuple):
    """The material of a bank."""

    name: str
    youngs_modulus_pa: float
    poisson_ratio: float
    density_kg_m3: float


class Losses(NamedTuple):
    """The decays of a bank's modes by cause, M numbers each [1/s]; together they are the decays."""

    material: Doubles
    thermoelastic: Doubles  # heat that flows in the body
    air: Doubles
    support: Doubles


class Status(NamedTuple):
    """The state of a mixer: counts since its start, and values of the last block."""

    strikes: int  # played so far
    late: int  # events that arrived after their frame
    dropped: int  # events refused because too many waited
    refused: int  # strikes on what does not exist any more
    not_finite: int  # voices silenced because a state was not a sensible number
    objects: int  # that exist
    sounding: int  # voices that rang in the last block
    ringing_modes: int  # modes that rang in the last block
    peak: float  # largest |sample| of the last block


class Piece(NamedTuple):
    """A piece of an object that can break, in the object's frame."""

    object: Optional[int]  # its number in the mixer; None: it never rings, or this is of a bank
    mass_kg: float
    center_of_mass_m: Triple
    inertia_kg_m2: Triple  # principal moments
    axes_wxyz: Tuple[float, float, float, float]  # turns the principal axes into the object's frame
    velocity_m_s: Triple  # beyond the motion that the object had before the blow
    spin_rad_s: Triple


class Pattern(NamedTuple):
    """One way in which an object can break."""

    at_m: Triple  # the place of the blow
    crack_energy_j: float  # what the crack takes from the vibration; 0: the bank does not know
    pieces: Tuple[Piece, ...]
