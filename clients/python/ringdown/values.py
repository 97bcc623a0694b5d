"""Values that banks and mixers return."""

from typing import NamedTuple


class Material(NamedTuple):
    """The material of a bank."""

    name: str
    youngs_modulus_pa: float
    poisson_ratio: float
    density_kg_m3: float


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
