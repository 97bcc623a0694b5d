#!/usr/bin/env python3
"""Holds the constants that `ringdown compare` finds in frequencies alone against those that the measurers found in them.

usage: identify.py [--docs] BIN FOLDER [NAME...]

BIN holds ringdown-compare and ringdown-bake. Every table of tests/truth/things with a [published] part becomes a folder with its
object file and a list modes.csv of its measured frequencies; the weight is that of its dimensions and density. A mode that
several modes share counts once. Bodies that are alike in all directions give c11 and c44, cubic crystals c12 as well. FOLDER
gets the folders, and identified.tsv; --docs puts the table into docs/how/truth.md. Exit code 1 when a constant is off by more than the two errors allow: two standard errors
of the fit, and that which the table states for the measurers'.
"""
import csv
import math
import pathlib
import re
import subprocess
import sys

from truth import HERE, ROOT, fill, of_cubic, read_thing, write_object

FOUND = re.compile(r"^(c\d\d) +([0-9.]+) GPa \+- ([0-9.e+-]+) %", re.M)


def volume_m3(parameters):
    sizes = {key: value / 1000 for key, value in parameters.items()}
    if "diameter" in sizes:
        return math.pi / 4 * sizes["diameter"] ** 2 * sizes["thickness"]
    return sizes["length"] * sizes["width"] * sizes["thickness"]


def figures_of(material):
    """What is fitted beside E/rho: nu, or two figures of a cubic crystal."""
    if "cubic_pa" not in material:
        return ["--fit", f"poisson_ratio={material['nu']!r}"]
    crystal = of_cubic(*material["cubic_pa"])
    return ["--fit", f"poisson_ratio_all={crystal['poisson_ratio_12']!r}",
            "--fit", f"shear_modulus_all_pa={crystal['shear_modulus_12_pa']!r}"]


def identify(binaries, thing, folder):
    """{constant: (value in GPa, standard error in %)}."""
    inputs = folder / thing["name"]
    inputs.mkdir(parents=True, exist_ok=True)
    _, materials = write_object(thing, inputs)
    listed = thing["published"].get("lines") or [row[0] for row in thing["modes"]["list"] if row[0] > 0]
    (inputs / "modes.csv").write_text("frequency_hz\n" + "".join(f"{line * thing['unit_hz']!r}\n" for line in listed))
    weight = volume_m3(thing["parameters"]) * thing["material"]["rho_kg_m3"]
    ran = subprocess.run([binaries / "ringdown-compare", inputs, "--materials", materials, "--weight", repr(weight),
                          "-o", inputs / "page.html", *figures_of(thing["material"])],
                         capture_output=True, text=True, check=False)
    found = {name: (float(value), float(percent)) for name, value, percent in FOUND.findall(ran.stdout)}
    if ran.returncode or not found:
        sys.exit(f"{thing['name']}: {ran.stderr or ran.stdout}")
    return found


def table(rows):
    lines = ["| body | constant | found [GPa] | standard error | measurers [GPa] | their error | off |", "|---|---|---|---|---|---|---|"]
    return lines + [f"| {what} | {constant} | {value:.2f} | {percent:.2g} % | {theirs:.2f} | {allowed:.2g} % | {off:+.1f} % |"
                    for what, constant, value, percent, theirs, allowed, off in rows]


def main():
    words = [word for word in sys.argv[1:] if word != "--docs"]
    if len(words) < 2:
        sys.exit(__doc__)
    binaries, folder, names = pathlib.Path(words[0]), pathlib.Path(words[1]), words[2:]
    things = [read_thing(path) for path in sorted((HERE / "things").glob("*.toml"))]
    rows, faults = [], 0
    for thing in things:
        published = thing.get("published")
        if not published or (names and thing["name"] not in names):
            continue
        for constant, (value, percent) in identify(binaries, thing, folder).items():
            theirs, allowed = published[f"{constant}_gpa"], published[f"{constant}_error_percent"]
            off = 100 * (value / theirs - 1)
            good = abs(off) <= math.hypot(2 * percent, allowed)
            faults += not good
            rows.append([thing["what"], constant, value, percent, theirs, allowed, off])
            print(f"{thing['name']:<24} {constant} {value:8.3f} GPa +- {percent:.2f} %, published {theirs} +- {allowed} %: "
                  f"{off:+.2f} %{'' if good else ', MORE THAN ALLOWED'}", flush=True)
    with open(folder / "identified.tsv", "w", newline="") as file:
        writer = csv.writer(file, delimiter="\t", lineterminator="\n")
        writer.writerow(["thing", "constant", "found_gpa", "error_percent", "published_gpa", "their_error_percent", "off_percent"])
        writer.writerows(rows)
    if "--docs" in sys.argv:
        fill(ROOT / "docs/how/truth.md", "constants, by tests/truth/identify.py", table(rows))
    sys.exit(1 if faults else 0)


if __name__ == "__main__":
    main()
