"""Banks as tables of other libraries, which are imported when they are asked for."""

import importlib
from typing import Any, Dict

import numpy as np

from ._core import Bank


def to_dataframe(bank: Bank) -> Any:
    """A pandas.DataFrame with one row for each mode; columns that the bank does not know are left out."""
    pandas = _library("pandas", "to_dataframe")
    table = pandas.DataFrame(_columns(bank))
    table.index.name = "mode"
    return table


def to_xarray(bank: Bank) -> Any:
    """An xarray.Dataset over mode, point, axis and triangle; mass and provenance are its attributes."""
    xarray = _library("xarray", "to_xarray")
    variables: Dict[str, Any] = {name: ("mode", numbers) for name, numbers in _columns(bank).items()}
    variables["shapes"] = (("mode", "point", "axis"), bank.shapes)
    variables["points_m"] = (("point", "axis"), bank.points_m)
    variables["triangles"] = (("triangle", "corner"), bank.triangles)
    about = {"name": bank.name, "mass_kg": bank.mass_kg, "center_of_mass_m": bank.center_of_mass_m,
             "inertia_kg_m2": bank.inertia_kg_m2, "axes_wxyz": bank.axes_wxyz, **bank.provenance}
    return xarray.Dataset(variables, coords={"axis": ["x", "y", "z"]}, attrs=about)


def _columns(bank: Bank) -> Dict[str, Any]:
    columns: Dict[str, Any] = {
        "frequency_hz": bank.frequencies_hz,
        "undamped_frequency_hz": bank.undamped_frequencies_hz,
        "decay_per_s": bank.decays_per_s,
        "frequency_error": bank.frequency_errors,
        "shape_error": bank.shape_errors,
        "level_error_db": bank.level_errors_db,
        "level_pa": bank.levels_pa(),
    }
    if bank.losses is not None:
        columns.update({f"{part}_per_s": numbers for part, numbers in bank.losses._asdict().items()})
    return {name: np.array(numbers) for name, numbers in columns.items() if numbers is not None}


def _library(name: str, method: str) -> Any:
    try:
        return importlib.import_module(name)
    except ImportError as missing:
        raise ImportError(f"Bank.{method}() needs the Python library {name}, which is not installed: "
                          f"apt install python3-{name}, or pip install {name}") from missing
