#!/usr/bin/env python3
"""Bakes presets from their own surfaces, filled and stuffed, and compares them with the presets made of their geometry.

usage: preset_surfaces.py PROGRAM OBJECTS FOLDER TABLE [NAME...]

PROGRAM is ringdown-bake, OBJECTS the folder presets/objects. gmsh cuts the surface of each preset's geometry into fine
triangles, which stand in an STL file as a modelling program would write it, so that the file knows nothing of curves.
It is baked as it is, and once more with a slit along one side, which is closed where it is short and left open, so
that the body is stuffed, where it is long. All else is as in the preset's own file, except that no group of the geometry
is held, and that the mesh size is the default one where the preset's own takes too much. Compared are the first 20 modes,
in order. The table, in Markdown, goes to TABLE. Exit code 1 when a bake fails or is more than 1 % off in its median mode.
"""
import ctypes
import ctypes.util
import os
import re
import resource
import statistics
import sys
import tomllib

import numpy as np

import ugly_assets
import ugly_bakes

MOST_OFF = 0.01  # in the median mode
# Sides of triangles: at most such a share of the diagonal long, and so many to a circle, 0: any. With the next where
# gmsh fails or takes more than CUT_S.
FINENESS = (1 / 40, 48), (1 / 80, 0), (1 / 60, 0)
CUT_S = 15
LIMIT_S = 100  # of processor time


class Gmsh:
    """The few calls of gmsh's C interface that cut the surface of a geometry into triangles."""

    def __init__(self):
        name = ctypes.util.find_library("gmsh")
        self.library = ctypes.CDLL(name)
        runs = int(name.split(".")[-1]) >= 9  # from 4.9 on, whether gmsh should run at once is asked, too
        self.call("gmshInitialize", 0, None, 0, *([0] if runs else []))
        self.number("General.Terminal", 0)

    def call(self, name, *arguments):
        error = ctypes.c_int(0)
        getattr(self.library, name)(*arguments, ctypes.byref(error))
        if error.value:
            sys.exit(f"{name} failed")

    def number(self, name, value):
        self.call("gmshOptionSetNumber", name.encode(), ctypes.c_double(value))

    def diagonal(self):
        box = [ctypes.c_double() for _ in range(6)]
        self.call("gmshModelGetBoundingBox", -1, -1, *(ctypes.byref(number) for number in box))
        low, high = (np.array([number.value for number in half]) for half in (box[:3], box[3:]))
        return np.linalg.norm(high - low)

    def cut(self, geo, stl, longest, around):
        self.call("gmshOpen", geo.encode())
        self.number("Mesh.MeshSizeMax", longest * self.diagonal())
        self.number("Mesh.MeshSizeFromCurvature", around)
        self.number("Mesh.Binary", 1)
        self.call("gmshModelMeshGenerate", 2)
        self.call("gmshWrite", stl.encode())


def cut(geo, stl):
    """In a process of its own, because gmsh aborts that where it fails. Says whether it did not."""
    for longest, around in FINENESS:
        child = os.fork()
        if child == 0:
            resource.setrlimit(resource.RLIMIT_CPU, (CUT_S, CUT_S))
            Gmsh().cut(geo, stl, longest, around)
            os._exit(0)
        if os.waitpid(child, 0)[1] == 0:
            return True
    return False


def read_stl(path):
    rows = np.fromfile(path, dtype=np.dtype([("normal", "<f4", 3), ("corners", "<f4", (3, 3)), ("rest", "<u2")]), offset=84)
    return rows["corners"].astype(float)


def compared(bank, truth):
    count = min(ugly_bakes.MODES, len(bank.frequency_hz), len(truth.frequency_hz))
    off = [abs(f / t - 1) for f, t in zip(bank.frequency_hz[:count], truth.frequency_hz[:count])]
    return statistics.median(off), max(off)


def without(text, section):
    return re.sub(rf"^\[+{section}\]+\n(?:(?!\[).*\n?)*", "", text, flags=re.MULTILINE)


def bake_preset(program, objects, folder, name):
    """A row of the table, and what is wrong."""
    with open(os.path.join(objects, name + ".toml"), encoding="utf-8") as file:
        text = file.read()
    preset = tomllib.loads(text)
    if any("group" in support for support in preset.get("support", [])):
        text = without(text, "support")
    # The bank that is kept has only the most important modes, so at least as many of all lie below its twentieth.
    kept = ugly_bakes.Bank.read(os.path.join(objects, "..", "banks", name + ".glb"))
    top_hz = min(ugly_bakes.BAND_HZ, 1.05 * kept.frequency_hz[: ugly_bakes.MODES][-1])
    options = ["--keep", "16384", "--no-cache", "--band", "20", str(top_hz)]
    geometry = os.path.abspath(os.path.join(objects, preset["geometry"]))

    def bake(file, text):
        path = os.path.join(folder, os.path.basename(file) + ".toml")
        with open(path, "w", encoding="utf-8") as out:
            out.write(text.replace(preset["geometry"], os.path.abspath(file)))
        return ugly_bakes.bake(program, path, path + ".glb", LIMIT_S, *options, material=preset["material"])

    truth = bake(geometry, text)
    if not truth.bank:
        return f"| `{name}` | {truth.said.splitlines()[-1]} |", f"{name} does not bake"
    geo, stl, open_stl = (os.path.join(folder, name + end) for end in (".geo", ".stl", ".slit.stl"))
    with open(geo, "w", encoding="ascii") as file:
        for key, value in preset.get("parameters", {}).items():
            file.write(f"{key} = {value};\n")
        file.write(f"mesh_size = {1e3 * preset.get('mesh_size_m', 0.01) / 2};\n")
        file.write(f'Include "{geometry}";\n')
        file.write("Recursive Delete { Surface{:}; }\n")  # those that bound no volume
        file.write('Physical Surface("skin") = CombinedBoundary { Volume{:}; };\n')
    if not cut(geo, stl):
        return f"| `{name}` | gmsh does not cut its surface |", f"gmsh does not cut {name}"
    surface = read_stl(stl)
    ugly_assets.write_stl(open_stl, ugly_assets.slit(surface))
    row, faults = f"| `{name}` | {len(surface)} |", []
    for file in (stl, open_stl):
        own_size = without(text, "parameters")
        run = bake(file, own_size)
        if not run.bank:
            run = bake(file, re.sub("^mesh_size_m.*\n", "", own_size, flags=re.MULTILINE))
        if not run.bank:
            row += f" {run.said.splitlines()[-1]} | | | |"
            faults.append(f"{file} does not bake")
            continue
        median, most = compared(run.bank, truth.bank)
        row += f" {run.bank.body} | {100 * median:.2g}, {100 * most:.2g} | {run.bank.unknowns} | {run.seconds:.0f} |"
        if median > MOST_OFF:
            faults.append(f"{name} is {100 * median:.2g} % off, {run.bank.body}")
    return row, "; ".join(faults)


HEAD = (
    "| preset | triangles | whole surface | median, most off % | unknowns | s | with a slit | median, most off % "
    "| unknowns | s |\n|--|--|--|--|--|--|--|--|--|--|"
)


def main(arguments):
    if len(arguments) < 4:
        sys.exit(__doc__)
    program, objects, folder, table = arguments[:4]
    os.makedirs(folder, exist_ok=True)
    faults = []
    with open(table, "w", encoding="utf-8") as out:
        print(HEAD, file=out)
        for name in arguments[4:] or sorted(file[:-5] for file in os.listdir(objects) if file.endswith(".toml")):
            row, fault = bake_preset(program, objects, folder, name)
            print(row, file=out, flush=True)
            print(row, flush=True)
            faults += [fault] if fault else []
    print("\n".join(faults))
    sys.exit(1 if faults else 0)


if __name__ == "__main__":
    main(sys.argv[1:])
