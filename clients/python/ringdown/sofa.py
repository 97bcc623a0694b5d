"""Directivity as a SOFA file (AES69, FreeFieldDirectivityTF 1.1), for programs of spatial audio."""

import importlib
import os
from datetime import datetime, timezone
from typing import TYPE_CHECKING, Any, Union

import numpy as np
import numpy.typing as npt

from ._core import Bank, version
from .errors import Error, InputError

if TYPE_CHECKING:
    from ._core import Numbers


def write(
    bank: Bank,
    path: Union[str, "os.PathLike[str]"],
    at_m: "Numbers",
    direction: "Numbers",
    frequencies_hz: npt.ArrayLike,
    step_deg: float = 5.0,
    distance_m: float = 0.0,
) -> None:
    """Writes the pressure per newton of a force at a place of the surface, on a sphere of directions around the object.

    distance_m: of the sphere from the object's middle; 0: ten times the largest distance of the surface. Needs netCDF4.
    """
    frequencies = np.atleast_1d(np.asarray(frequencies_hz, float))
    if not 1 <= step_deg <= 90:
        raise InputError(f"step_deg is {step_deg}; it can be from 1 to 90")
    try:
        netcdf: Any = importlib.import_module("netCDF4")
    except ImportError as missing:
        raise ImportError("Bank.to_sofa() needs the Python library netCDF4, which is not installed: "
                          "apt install python3-netcdf4, or pip install netCDF4") from missing
    middle = np.asarray(bank.center_of_mass_m)
    distance = distance_m or 10 * float(np.linalg.norm(bank.points_m - middle, axis=1).max())
    directions = _sphere(step_deg)
    azimuth, elevation = np.radians(directions[:, 0]), np.radians(directions[:, 1])
    places = middle + distance * np.stack(
        (np.cos(elevation) * np.cos(azimuth), np.cos(elevation) * np.sin(azimuth), np.sin(elevation)), axis=1)
    heard = np.array([bank.pressure_frf(at_m, direction, place, frequencies) for place in places])
    unfinished = f"{os.fspath(path)}.{os.getpid()}.part"
    try:
        with netcdf.Dataset(unfinished, "w", format="NETCDF4") as file:
            _fill(file, bank, frequencies, directions, distance, heard)
        os.replace(unfinished, path)
    except OSError as failure:
        raise Error(f"cannot write {os.fspath(path)}: {failure.strerror or failure}", "input_output") from failure
    finally:
        if os.path.exists(unfinished):
            os.remove(unfinished)


def _sphere(step_deg: float) -> npt.NDArray[np.float64]:
    """Azimuth and elevation in degrees: rings of equal step, and one direction at each pole."""
    rings, sectors = round(180 / step_deg), round(360 / step_deg)
    inner = [(360 * s / sectors, 180 * r / rings - 90) for r in range(1, rings) for s in range(sectors)]
    return np.array([(0, -90), *inner, (0, 90)], float)


def _fill(file: Any, bank: Bank, frequencies: Any, directions: Any, distance: float, heard: Any) -> None:
    now = datetime.now(timezone.utc).strftime("%Y-%m-%d %H:%M:%S")
    name = bank.name or "object"
    for key, text in {
        "Conventions": "SOFA", "Version": "2.1", "SOFAConventions": "FreeFieldDirectivityTF",
        "SOFAConventionsVersion": "1.1", "DataType": "TF", "RoomType": "free field", "Title": f"Directivity of {name}",
        "DateCreated": now, "DateModified": now, "APIName": "Ringdown", "APIVersion": version(), "AuthorContact": "",
        "Organization": "", "License": "No license provided, ask the author for permission", "DatabaseName": "Ringdown",
        "SourceType": name, "SourceManufacturer": "", "ApplicationName": "Ringdown", "ApplicationVersion": version(),
        "Comment": "Computed from a modal model; sound pressure per newton of force [Pa/N]",
        "Descriptions": "driven by a force at one place of its surface",
    }.items():
        file.setncattr_string(key, text)
    for dimension, size in {"I": 1, "C": 3, "M": 1, "R": len(directions), "E": 1, "N": len(frequencies)}.items():
        file.createDimension(dimension, size)

    def add(variable: str, dimensions: Any, values: Any, **attributes: str) -> None:
        made = file.createVariable(variable, "f8", dimensions)
        made[:] = values
        for key, text in attributes.items():
            made.setncattr_string(key, text)

    cartesian = {"Type": "cartesian", "Units": "metre"}
    add("ListenerPosition", ("I", "C"), [[0, 0, 0]], **cartesian)
    add("ListenerView", ("I", "C"), [[1, 0, 0]], **cartesian)
    add("ListenerUp", ("I", "C"), [[0, 0, 1]])
    places = np.column_stack((directions, np.full(len(directions), distance)))
    add("ReceiverPosition", ("R", "C", "I"), places[:, :, None], Type="spherical", Units="degree, degree, metre")
    add("SourcePosition", ("I", "C"), [[0, 0, 0]], Reference="centre of mass", **cartesian)
    add("SourceView", ("I", "C"), [[1, 0, 0]], Reference="x axis of the object's frame", **cartesian)
    add("SourceUp", ("I", "C"), [[0, 0, 1]], Reference="z axis of the object's frame")
    add("EmitterPosition", ("E", "C", "I"), np.zeros((1, 3, 1)), **cartesian)
    add("Data.Real", ("M", "R", "N"), heard.real[None])
    add("Data.Imag", ("M", "R", "N"), heard.imag[None])
    add("N", ("N",), frequencies, LongName="frequency", Units="hertz")
