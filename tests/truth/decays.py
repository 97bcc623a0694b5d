#!/usr/bin/env python3
"""Holds the decays that Ringdown computes against those that others measured.

usage: decays.py [--docs] BIN FOLDER [NAME...]

BIN holds ringdown-bake and ringdown-fit. Every file of tests/truth/decays is one thing with the decays of its modes. Its loss is
computed from three parts: the material's, from the preset material; the heat's, by the bake of a body of its size, or by the
closed form of Lifshitz & Roukes where only the wall is known; and the air's, by the bake, at the mode nearest in pitch. A thing
that is a recording is analysed by ringdown-fit. Recordings are not part of the project: those of the folder $RINGDOWN_MEASURED
are read, and missing ones left out. FOLDER gets decays.tsv and decays.png; --docs puts table and picture into docs/how/truth.md.
Exit code 1 when the things that count as free are further off than they were.
"""
import csv
import math
import os
import pathlib
import re
import subprocess
import sys
import tomllib

HERE = pathlib.Path(__file__).resolve().parent
ROOT = HERE.parents[1]
sys.path.append(str(HERE.parent / "support"))

from bank_document import read_bank
from truth import fill, median, read_thing, text

DATA = pathlib.Path(os.environ.get("RINGDOWN_MEASURED", ROOT.parent / "shared" / "data"))
ROOM_K = 293.15
# Of |log2(computed / measured T60)| over the modes of free things: the median, nine tenths, all. The first row is the aim,
# the second what the figures must not fall behind.
AIMS = (0.5, 1.35, 2.0)
LIMITS = (0.42, 1.8, 4.4)
LIMIT_MEAN = 0.6  # of one thing; above it the page names the cause


def read_material(name):
    with open(ROOT / "presets/materials" / f"{name}.toml", "rb") as file:
        return tomllib.load(file)


def material_decay(material, frequency):
    """[1/s] by the list of loss factors, straight in the logarithms, or by Rayleigh's constants."""
    if "loss_factor" not in material:
        alpha, beta = material["alpha_per_s"]["value"], material["beta_s"]["value"]
        return 0.5 * (alpha + beta * (2 * math.pi * frequency) ** 2)
    points = sorted((p["frequency_hz"], p["eta"]) for p in material["loss_factor"])
    eta = points[0][1] if frequency <= points[0][0] else points[-1][1]
    for (low, at_low), (high, at_high) in zip(points, points[1:]):
        if low < frequency < high:
            share = math.log(frequency / low) / math.log(high / low)
            eta = at_low * (at_high / at_low) ** share
    return math.pi * frequency * eta


def wall_decay(material, frequency, wall_m):
    """[1/s] of heat through a wall that bends (Lifshitz & Roukes, Phys. Rev. B 61, 2000)."""
    if "thermal" not in material or not wall_m:
        return 0.0
    young, density = material["youngs_modulus_pa"]["value"], material["density_kg_m3"]["value"]
    expansion, conductivity, heat = (material["thermal"][key]["value"]
                                     for key in ("expansion_per_k", "conductivity_w_mk", "heat_capacity_j_kgk"))
    xi = wall_m * math.sqrt(math.pi * frequency * density * heat / conductivity)
    if xi < 0.05:
        share = xi * xi / 5
    else:
        ratio = 1.0 if xi > 30 else (math.sinh(xi) + math.sin(xi)) / (math.cosh(xi) + math.cos(xi))
        share = 6 / xi**2 - 6 / xi**3 * ratio
    return math.pi * frequency * young * expansion**2 * ROOM_K / (density * heat) * share


class Body:
    """What a baked body of the thing's size loses to heat and to the air, mode by mode."""

    def __init__(self, bake, thing, folder):
        body = thing["body"]
        top = 1.3 * max(row[0] for row in thing["modes"])
        lines = [f'description = {text(thing["what"])}', f'material = "{thing["material"]}"', "radiation = true",
                 "surface_points = 40", f"band_hz = [20, {min(max(top, 500), 20000)!r}]"]
        geometry = body["geometry"]
        geometry = DATA / geometry[6:] if geometry.startswith("data:/") else (HERE / geometry).resolve()
        lines += [f'geometry = "{geometry}"']
        for key in ("unit_m", "mesh_size_m", "scale"):
            if key in body:
                lines.append(f"{key} = {body[key]!r}")
        lines += ["[parameters]"] + [f"{key} = {value!r}" for key, value in body.get("parameters", {}).items()]
        path, bank = folder / f'{thing["name"]}.toml', folder / f'{thing["name"]}.glb'
        path.write_text("\n".join(lines) + "\n")
        ran = subprocess.run([bake, str(path), "-o", str(bank)], capture_output=True, text=True, check=False)
        if ran.returncode != 0:
            sys.exit(f"{thing['name']}: {ran.stderr or ran.stdout}")
        model, numbers = read_bank(bank)
        extras = model["extras"]["ringdown"]
        self.frequency = numbers(model["frequencies"])
        self.air = extras["losses"].get("air", [0.0] * len(self.frequency))
        relaxations = extras.get("relaxations", [])
        per_mode = len(relaxations) // max(1, len(self.frequency))
        self.heat = [relaxations[per_mode * m : per_mode * (m + 1)] for m in range(len(self.frequency))]

    def decays(self, frequency):
        """Heat and air [1/s] of the mode nearest in pitch."""
        m = min(range(len(self.frequency)), key=lambda k: abs(math.log(self.frequency[k] / frequency)))
        omega, heat = 2 * math.pi * frequency, 0.0
        for strength, time in zip(self.heat[m][::2], self.heat[m][1::2]):
            heat += 0.5 * omega * strength * omega * time / (1 + (omega * time) ** 2)
        return heat, self.air[m]


COMPANION = 2 ** (60 / 1200)  # a blow's thump and its room add short modes beside a mode, as near as this


def strongest(rows):
    """Of modes near each other the one with the most energy: lists of (frequency, T60, energy in dB), by frequency."""
    clusters = []
    for row in sorted(rows):
        if clusters and row[0] < COMPANION * clusters[-1][-1][0]:
            clusters[-1].append(row)
        else:
            clusters.append([row])
    return [max(cluster, key=lambda row: row[2]) for cluster in clusters]


def recorded_modes(fit, paths, thing, folder):
    """[frequency, T60] of the modes up to 16 kHz that have at least 1/300 of the energy of the strongest in a third of the
    recordings, with decays that the fit knows to a tenth; the median of the recordings."""
    found = []
    for path in paths:
        kept = folder / f'{thing["name"]}-{path.stem}.txt'
        if not kept.exists():
            ran = subprocess.run([fit, str(path), "--floor", "50"], capture_output=True, text=True, check=False)
            kept.write_text(ran.stdout)
        rows = re.findall(r"^ +\d+ +([\d.]+) +\S+ +([\d.e+-]+) +([\d.e+-]+) +(-?[\d.]+) ", kept.read_text(), re.M)
        rows = [tuple(map(float, row)) for row in rows]
        rows = [(f, t60, level + 10 * math.log10(t60)) for f, t60, error, level in rows if error < 10 and f < 16000]
        loudest = max((row[2] for row in rows), default=0)
        found += [row for row in strongest(rows) if row[2] > loudest - 25 and row[0] >= thing.get("from_hz", 0)]
    merged = []
    for row in sorted(found):
        if merged and row[0] < 1.004 * merged[-1][0][0]:
            merged[-1].append(row)
        else:
            merged.append([row])
    return [[median([row[0] for row in one]), median([row[1] for row in one])]
            for one in merged if 3 * len(one) >= len(paths)]


def compare(thing, bake, fit, folder):
    """Rows of (frequency, measured T60, computed T60, material, heat, air [1/s]); None where its recording is missing."""
    if "recordings" in thing:
        paths = [path for pattern in thing["recordings"] for path in sorted(DATA.glob(pattern))]
        if not paths:
            return None
        thing["modes"] = recorded_modes(fit, paths, thing, folder)
    material = read_material(thing["material"])
    body = Body(bake, thing, folder) if "body" in thing else None
    rows = []
    for frequency, t60 in thing["modes"]:
        own = material_decay(material, frequency)
        heat, air = body.decays(frequency) if body else (wall_decay(material, frequency, thing.get("wall_m")), 0.0)
        if "thermal" not in material:
            heat = 0.0
        rows.append((frequency, t60, math.log(1000) / (own + heat + air), own, heat, air))
    return rows


def off(row):
    return math.log2(row[2] / row[1])


def summary(rows):
    logs = [off(row) for row in rows]
    return median([abs(log) for log in logs]), sum(logs) / len(logs), max(abs(log) for log in logs)


def draw(results, picture):
    try:
        import matplotlib
    except ImportError:
        print("no picture: python3-matplotlib is not installed")
        return
    matplotlib.use("Agg")
    import matplotlib.pyplot as plt

    figure, axes = plt.subplots(figsize=(8.6, 0.3 * len(results) + 1.2), constrained_layout=True)
    for line, (thing, rows) in enumerate(results):
        colour = "#0072B2" if thing["held"] == "free" else "#999999"
        axes.plot([2 ** off(row) for row in rows], [line] * len(rows), "|", ms=11, mew=1.8, color=colour)
    axes.set_yticks(range(len(results)), [thing["what"] for thing, _ in results], fontsize=7)
    axes.invert_yaxis()
    axes.set_xscale("log", base=2)
    axes.axvspan(0.5, 2, color="#0072B2", alpha=0.07, lw=0)
    axes.grid(axis="x", lw=0.4)
    axes.set_xlabel("Ringdown's T60 over the measured one; blue: free things")
    figure.savefig(picture, dpi=110)


def table(results):
    lines = ["| thing | held | modes | from ... to [Hz] | T60 over measured, mean | median of the factor | largest | supplies a constant |",
             "|---|---|---|---|---|---|---|---|"]
    for thing, rows in results:
        middle, mean, worst = summary(rows)
        lines.append(f'| {thing["what"]} | {thing["held"]} | {len(rows)} | {min(r[0] for r in rows):.0f} ... '
                     f'{max(r[0] for r in rows):.0f} | {2**mean:.2f} | {2**middle:.2f} | {2**worst:.2f} | '
                     f'{"yes" if thing.get("supplies") else "no"} |')
    return lines


def sources(results):
    return [f'- **{thing["what"]}** ({thing["held"]}): {thing["source"]}. {thing["remark"]}' for thing, _ in results]


def overall(results, name):
    logs = sorted(abs(off(row)) for _, rows in results for row in rows)
    if not logs:
        return 0.0, 0.0, 0.0
    figures = median(logs), logs[min(len(logs) - 1, math.ceil(0.9 * len(logs)) - 1)], logs[-1]
    print(f"{name}: {len(results)} things, {len(logs)} modes: |log2| median {figures[0]:.2f}, 90 % below {figures[1]:.2f}, "
          f"worst {figures[2]:.2f}")
    return figures


def main():
    flags = {word for word in sys.argv[1:] if word.startswith("--")}
    words = [word for word in sys.argv[1:] if not word.startswith("--")]
    if len(words) < 2 or not flags <= {"--docs"}:
        sys.exit(__doc__)
    programs, folder, names = pathlib.Path(words[0]), pathlib.Path(words[1]), words[2:]
    folder.mkdir(parents=True, exist_ok=True)
    things = [read_thing(path) for path in sorted((HERE / "decays").glob("*.toml"))]
    results, missing = [], []
    for thing in sorted(things, key=lambda t: (t["held"] != "free", t["name"])):
        if names and thing["name"] not in names:
            continue
        rows = compare(thing, programs / "ringdown-bake", programs / "ringdown-fit", folder)
        if not rows:
            missing.append(thing["name"])
            continue
        results.append((thing, rows))
        middle, mean, worst = summary(rows)
        print(f'{thing["name"]:34} {thing["held"]:8} {len(rows):3} modes: |log2| median {middle:5.2f}, worst {worst:5.2f}; '
              f'mean {mean:+5.2f}' + ("  ABOVE 0.6" if abs(mean) > LIMIT_MEAN and thing["held"] == "free" else ""), flush=True)
    with open(folder / "decays.tsv", "w", encoding="utf-8", newline="") as file:
        out = csv.writer(file, delimiter="\t", lineterminator="\n")
        out.writerow(["thing", "held", "frequency_hz", "measured_t60_s", "computed_t60_s", "material_per_s", "heat_per_s",
                      "air_per_s"])
        for thing, rows in results:
            for row in rows:
                out.writerow([thing["name"], thing["held"], *(f"{figure:.4g}" for figure in row)])
    for name in missing:
        print(f"left out: {name}, whose recording is not in {DATA}")
    free = [result for result in results if result[0]["held"] == "free"]
    figures = overall(free, "free")
    overall([r for r in free if not r[0].get("supplies")], "of them those that supply no constant")
    overall([r for r in results if r[0]["held"] != "free"], "held")
    draw(results, folder / "decays.png")
    if "--docs" in flags:
        page = ROOT / "docs/how/truth.md"
        fill(page, "decays, by tests/truth/decays.py", table(results))
        fill(page, "sources of decays, by tests/truth/decays.py", sources(results))
        (ROOT / "docs/figures/decays.png").write_bytes((folder / "decays.png").read_bytes())
        (ROOT / "docs/how/logs/decays.tsv").write_bytes((folder / "decays.tsv").read_bytes())
    print("aim:  median {}, 90 % below {}, worst {}".format(*AIMS))
    sys.exit(not names and any(figure > limit for figure, limit in zip(figures, LIMITS)))


if __name__ == "__main__":
    main()
