#!/usr/bin/env python3
"""Figures of bodies from their frequencies alone, by `ringdown compare --fit`, where all figures are known.

usage: compare_figures.py BIN FOLDER [NAME...]

BIN holds ringdown-bake and ringdown-compare. The frequencies are those of blocks by Rayleigh and Ritz, which share no code with
Ringdown, with noise of two cents. Each fit begins with wrong figures and must find the true ones within three of the standard
errors that it states, which must be small. Exit code 1 when it does not; 77 without numpy.
"""
import pathlib
import re
import subprocess
import sys

try:
    import numpy as np
except ImportError:
    print("skipped: python3-numpy is not installed")
    sys.exit(77)

ROOT = pathlib.Path(__file__).resolve().parents[2]
sys.path.append(str(ROOT / "tests/support"))

from block_resonances import cubic, isotropic, orthotropic, resonances_hz

NOISE_CENTS = 2

# E1 E2 E3 [Pa], nu12 nu13 nu23, G12 G13 G23 [Pa] of a board, and of the material that its fit begins with.
BOARD = ([11.0e9, 0.92e9, 0.55e9], [0.38, 0.45, 0.45], [0.85e9, 0.70e9, 0.06e9])
SPRUCE = ([11.0e9, 0.80e9, 0.55e9], [0.38, 0.45, 0.45], [0.75e9, 0.70e9, 0.06e9])
CRYSTAL = cubic(316.6e9, 102.8e9, 121.9e9)

# Of each body: the true size [mm] and solid, its density, and how many of its frequencies are listed; the drawn size, and whether
# as a surface in place of a parametric geometry; the longest edge of elements; the material that the fit begins with; what is fitted, and what must come out,
# each with the largest standard error [%].
BODIES = {
    "plate": dict(  # of a surface, with walls that are drawn 8 % too thin
        size=(60.0, 45.0, 5.4), solid=isotropic(74e9, 0.30), density=2700.0, count=24,
        drawn=(60.0, 45.0, 5.0), surface=True, mesh_mm=9.0, material=dict(young=70e9, nu=0.34),
        fit=("wall_scale=1", "poisson_ratio=0.34"),
        truth={"wall_scale": (1.08, 0.5), "poisson_ratio": (0.30, 3), "density": (2700.0, None), "E": (74.0, 1)},
    ),
    "block": dict(  # without --fit: nu is searched among all ratios, between which eleven of its modes change places
        size=(11.92, 10.93, 9.86), solid=isotropic(71.5e9, 0.338), density=2788.0, count=16,
        drawn=(11.92, 10.93, 9.86), mesh_mm=3.0, material=dict(young=70e9, nu=0.25), fit=(),
        truth={"c11": (71.5 * 0.662 / (1.338 * 0.324), 3), "c44": (71.5 / 2.676, 1), "E/rho": (71.5 / 70, 1)},
    ),
    "crystal": dict(
        size=(9.0, 8.0, 7.0), solid=CRYSTAL, density=5110.0, count=30, drawn=(9.0, 8.0, 7.0), mesh_mm=2.4,
        material=dict(nine=([270e9] * 3, [0.22] * 3, [130e9] * 3)),
        fit=("poisson_ratio_all=0.22", "shear_modulus_all_pa=130e9"),
        truth={"c11": (316.6, 1), "c12": (102.8, 3), "c44": (121.9, 0.5), "shear_modulus_all_pa": (121.9e9, 0.5)},
    ),
    "board": dict(
        size=(120.0, 90.0, 8.0), solid=orthotropic(*BOARD), density=440.0, count=20, drawn=(120.0, 90.0, 8.0), mesh_mm=18.0,
        material=dict(nine=SPRUCE, density=420.0),
        fit=("youngs_modulus_2_pa=8e8", "shear_modulus_12_pa=7.5e8"),
        truth={"E1": (11.0, 1), "youngs_modulus_2_pa": (0.92e9, 1), "shear_modulus_12_pa": (0.85e9, 1)},
    ),
}


def write_material(path, young=None, nu=None, nine=None, density=None):
    figures = {"density_kg_m3": density, "youngs_modulus_pa": young or nine[0][0], "poisson_ratio": nu or 0.3,
               "alpha_per_s": 0.0, "beta_s": 0.0}
    if nine:
        for k, axes in enumerate(("1", "2", "3")):
            figures[f"orthotropic.youngs_modulus_{axes}_pa"] = nine[0][k]
        for k, axes in enumerate(("12", "13", "23")):
            figures[f"orthotropic.poisson_ratio_{axes}"] = nine[1][k]
            figures[f"orthotropic.shear_modulus_{axes}_pa"] = nine[2][k]
    path.parent.mkdir(parents=True, exist_ok=True)
    lines = [f'name = "{path.stem}"', 'description = "what a fit begins with"']
    for key, value in figures.items():
        lines += [f"[{key}]", f"value = {value!r}", 'source = "chosen"']
    path.write_text("\n".join(lines) + "\n")


def write_surface(path, size):
    x, y, z = (0.5 * length for length in size)
    corners = [(sx * x, sy * y, sz * z) for sx in (-1, 1) for sy in (-1, 1) for sz in (-1, 1)]
    quads = ((1, 2, 4, 3), (5, 7, 8, 6), (1, 5, 6, 2), (3, 4, 8, 7), (1, 3, 7, 5), (2, 6, 8, 4))
    lines = [f"v {a} {b} {c}" for a, b, c in corners] + ["f " + " ".join(map(str, quad)) for quad in quads]
    path.write_text("\n".join(lines) + "\n")


def write_object(folder, body):
    """The object file, in a folder of its own with the list of frequencies."""
    inputs = folder / "inputs"
    inputs.mkdir(parents=True, exist_ok=True)
    lines = ['material = "drawn"', "unit_m = 0.001", f"mesh_size_m = {0.001 * body['mesh_mm']!r}"]
    if body.get("surface"):
        write_surface(folder / "drawn.obj", body["drawn"])
        lines += [f'geometry = "{folder / "drawn.obj"}"']
    else:
        lines += [f'geometry = "{ROOT / "presets/objects/box.geo"}"', "[parameters]"]
        lines += [f"{name} = {length}" for name, length in zip(("length", "width", "thickness"), body["drawn"])]
    if "nine" in body["material"]:
        lines += ["[grain]", "along = [1, 0, 0]", "radial = [0, 1, 0]"]
    (inputs / "body.toml").write_text("\n".join(lines) + "\n")
    return inputs


def found_in(text):
    """{name: (value, relative standard error)} of the lines with an error; without one it is 0."""
    rows = re.findall(r"^(\S+) +([0-9.e+-]+)[^+\n]*?(?:\+- ([0-9.e+-]+) %.*)?$", text, re.M)
    return {name: (float(value), float(error or 0) / 100) for name, value, error in rows}


def faults_of(name, body, binaries, folder):
    random = np.random.default_rng(5)
    exact = resonances_hz([0.001 * length for length in body["size"]], body["density"], body["solid"], body["count"])
    heard = exact * 2 ** (NOISE_CENTS * random.normal(size=exact.size) / 1200)
    write_material(folder / "materials/drawn.toml", **{"density": body["density"], **body["material"]})
    inputs = write_object(folder, body)
    (inputs / "modes.csv").write_text("frequency_hz\n" + "".join(f"{f!r}\n" for f in heard.tolist()))
    weight = body["density"] * np.prod(body["size"]) * 1e-9
    command = [binaries / "ringdown-compare", inputs, "--materials", folder / "materials", "--weight", repr(float(weight)),
               "-o", folder / "page.html"]
    for figure in body["fit"]:
        command += ["--fit", figure]
    ran = subprocess.run([str(word) for word in command], capture_output=True, text=True, check=False)
    print(f"{name}\n{ran.stdout}{ran.stderr}", flush=True)
    if ran.returncode:
        return [f"{name}: exit code {ran.returncode}"]
    found, faults = found_in(ran.stdout), []
    for figure, (true, most_percent) in body["truth"].items():
        value, error = found.get(figure, (float("nan"), 0))
        allowed = 3 * error if most_percent else 0.005
        if not abs(value / true - 1) <= allowed:
            faults.append(f"{name}: {figure} is {value}, not {true} +- {100 * allowed:.2g} %")
        if most_percent and not 0 < 100 * error <= most_percent:
            faults.append(f"{name}: the standard error of {figure} is {100 * error:.2g} %")
    figures = 1 + max(len(body["fit"]), 1)
    line = re.search(r"^correlation.*$", ran.stdout, re.M)
    if not line or len(re.findall(r"[+-][01]\.\d\d", line[0])) != figures * (figures - 1) // 2:
        faults.append(f"{name}: the correlations of {figures} figures are not all there")
    return faults


def main():
    binaries, folder, names = pathlib.Path(sys.argv[1]), pathlib.Path(sys.argv[2]).resolve(), sys.argv[3:]
    faults = []
    for name, body in BODIES.items():
        if not names or name in names:
            faults += faults_of(name, body, binaries, folder / name)
    print("\n".join(faults) or "as it should be")
    sys.exit(1 if faults else 0)


if __name__ == "__main__":
    main()
