#!/usr/bin/env python3
"""Holds the constants that `ringdown compare` finds in frequencies alone against those that the measurers found in them.

usage: identify.py BIN FOLDER [NAME...]

BIN holds ringdown-compare and ringdown-bake. Every table of tests/truth/things with a [published] part, c11_gpa and c44_gpa of a
body that is alike in all directions, becomes a folder with its object file and a list modes.csv of its measured frequencies;
the weight is that of its dimensions and density. A mode that several modes share counts once. FOLDER gets the folders, and
identified.tsv. Exit code 1 when a constant is off by more than the two errors allow: two standard errors of the fit, and that
which the table states for the measurers'.
"""
import csv
import math
import pathlib
import re
import subprocess
import sys

from truth import HERE, read_thing, write_object

NUMBERS = re.compile(r"E +([0-9.]+) GPa \+- ([0-9.e+-]+) %; c11 ([0-9.]+), c44 ([0-9.]+) GPa")
NU = re.compile(r"^nu +([0-9.]+) \+- ([0-9.e+-]+)", re.M)


def volume_m3(parameters):
    sizes = {key: value / 1000 for key, value in parameters.items()}
    if "diameter" in sizes:
        return math.pi / 4 * sizes["diameter"] ** 2 * sizes["thickness"]
    return sizes["length"] * sizes["width"] * sizes["thickness"]


def spread(young, relative, nu, off):
    """Relative errors of c11 and c44 from those of E and nu, as if they were independent."""
    c11 = lambda ratio: (1 - ratio) / ((1 + ratio) * (1 - 2 * ratio))
    return (math.hypot(relative, (c11(nu + off) - c11(nu - off)) / (2 * c11(nu))), math.hypot(relative, off / (1 + nu)))


def identify(binaries, thing, folder):
    inputs = folder / thing["name"]
    inputs.mkdir(parents=True, exist_ok=True)
    _, materials = write_object(thing, inputs)
    rows = [row[0] * thing["unit_hz"] for row in thing["modes"]["list"] if row[0] > 0]
    (inputs / "modes.csv").write_text("frequency_hz\n" + "".join(f"{row!r}\n" for row in rows))
    weight = volume_m3(thing["parameters"]) * thing["material"]["rho_kg_m3"]
    ran = subprocess.run([binaries / "ringdown-compare", inputs, "--materials", materials, "--weight", repr(weight),
                          "-o", inputs / "page.html"], capture_output=True, text=True, check=False)
    found, nu = NUMBERS.search(ran.stdout), NU.search(ran.stdout)
    if ran.returncode or not found or not nu:
        sys.exit(f"{thing['name']}: {ran.stderr or ran.stdout}")
    young, percent, c11, c44 = map(float, found.groups())
    errors = spread(young, percent / 100, *map(float, nu.groups()))
    return [("c11", c11, 100 * errors[0]), ("c44", c44, 100 * errors[1])], ran.stdout


def main():
    if len(sys.argv) < 3:
        sys.exit(__doc__)
    binaries, folder, names = pathlib.Path(sys.argv[1]), pathlib.Path(sys.argv[2]), sys.argv[3:]
    things = [read_thing(path) for path in sorted((HERE / "things").glob("*.toml"))]
    rows, faults = [], 0
    for thing in things:
        published = thing.get("published")
        if not published or (names and thing["name"] not in names):
            continue
        for constant, value, percent in identify(binaries, thing, folder)[0]:
            theirs, allowed = published[f"{constant}_gpa"], published["error_percent"]
            off = 100 * (value / theirs - 1)
            good = abs(off) <= math.hypot(2 * percent, allowed)
            faults += not good
            rows.append([thing["name"], constant, value, f"{percent:.2f}", theirs, allowed, f"{off:+.2f}"])
            print(f"{thing['name']:<24} {constant} {value:8.3f} GPa +- {percent:.2f} %, published {theirs} +- {allowed} %: "
                  f"{off:+.2f} %{'' if good else ', MORE THAN ALLOWED'}", flush=True)
    with open(folder / "identified.tsv", "w", newline="") as file:
        writer = csv.writer(file, delimiter="\t", lineterminator="\n")
        writer.writerow(["thing", "constant", "found_gpa", "error_percent", "published_gpa", "their_error_percent", "off_percent"])
        writer.writerows(rows)
    sys.exit(1 if faults else 0)


if __name__ == "__main__":
    main()
