#!/usr/bin/env python3
"""Holds Ringdown's modes against those of real bodies, of other programs and of closed forms.

usage: truth.py [--short] [--docs] BAKE FOLDER [NAME...]

BAKE is ringdown-bake. Every table of tests/truth/things is baked into FOLDER, and its frequencies are compared, in order of
frequency, with those that the table lists. FOLDER gets truth.tsv, and truth.png where matplotlib is installed; --docs puts the
table and the picture into docs/how/truth.md, too. --short takes only what is baked in a second or two. Exit code 1 when a
figure is above its table's limit.

A table's rows are [frequency, how many modes have it, name]; a frequency of 0 is a mode that nobody has measured. With fit =
"E/rho" all frequencies are moved by one factor, so that the first one is exact.
"""
import csv
import math
import pathlib
import subprocess
import sys
import tomllib

HERE = pathlib.Path(__file__).resolve().parent
ROOT = HERE.parents[1]
sys.path.append(str(HERE.parent / "support"))

from bank_document import read_bank

COMPARED = 8  # the first so many frequencies of each thing
KINDS = ("measured", "calculated", "closed form")


def cents(ratio):
    return 1200 * math.log2(ratio)


def median(numbers):
    ordered = sorted(numbers)
    half = len(ordered) // 2
    return ordered[half] if len(ordered) % 2 else 0.5 * (ordered[half - 1] + ordered[half])


def read_thing(path):
    with open(path, "rb") as file:
        thing = tomllib.load(file)
    thing["name"] = path.stem
    return thing


def text(value):
    return '"' + value.replace('"', "'") + '"'


def of_cubic(c11, c12, c44):
    """The nine figures of a cubic crystal along its axes, from its three stiffnesses [Pa]."""
    modulus, ratio = (c11 - c12) * (c11 + 2 * c12) / (c11 + c12), c12 / (c11 + c12)
    figures = {f"youngs_modulus_{axis}_pa": modulus for axis in "123"}
    figures.update({f"poisson_ratio_{pair}": ratio for pair in ("12", "13", "23")})
    figures.update({f"shear_modulus_{pair}_pa": c44 for pair in ("12", "13", "23")})
    return figures


def write_object(thing, folder):
    """The object file and the material of a thing."""
    materials = folder / "materials"
    materials.mkdir(parents=True, exist_ok=True)
    material = thing["material"]
    crystal = of_cubic(*material["cubic_pa"]) if "cubic_pa" in material else {}
    figures = {
        "youngs_modulus_pa": crystal["youngs_modulus_1_pa"] if crystal else material["e_pa"],
        "poisson_ratio": crystal["poisson_ratio_12"] if crystal else material["nu"],
        "density_kg_m3": material["rho_kg_m3"],
        "alpha_per_s": 0.0,
        "beta_s": 0.0,
    }
    figures.update({f"orthotropic.{key}": value for key, value in crystal.items()})
    lines = [f'name = "{thing["name"]}"', f'description = {text(thing["what"])}']
    for key, value in figures.items():
        lines += ["", f"[{key}]", f"value = {value!r}", f'source = {text(material["source"])}']
    (materials / f'{thing["name"]}.toml').write_text("\n".join(lines) + "\n")

    listed = [row[0] * thing["unit_hz"] for row in thing["modes"]["list"] if row[0] > 0]
    geometry = (HERE / thing["geometry"]).resolve()
    top = thing.get("band_top_hz", 1.3 * listed[-1])
    lines = [
        f'description = {text(thing["what"])}',
        f'material = "{thing["name"]}"',
        f'geometry = "{geometry}"',
        "unit_m = 0.001",
        f'mesh_size_m = {0.001 * thing["mesh_size_mm"]!r}',
        f"band_hz = [0, {top!r}]",
        "surface_points = 40",
        "[parameters]",
    ]
    lines += [f"{key} = {value!r}" for key, value in thing["parameters"].items()]
    if crystal:
        lines += ["[grain]", "along = [1, 0, 0]", "radial = [0, 1, 0]"]
    path = folder / f'{thing["name"]}.toml'
    path.write_text("\n".join(lines) + "\n")
    return path, materials


def bake(program, thing, folder):
    """All frequencies of a thing [Hz] and the errors that the bank states of them, ascending."""
    path, materials = write_object(thing, folder)
    bank = folder / f'{thing["name"]}.glb'
    ran = subprocess.run(
        [program, str(path), "--materials", str(materials), "-o", str(bank)], capture_output=True, text=True, check=False
    )
    if ran.returncode != 0:
        sys.exit(f"{thing['name']}: {ran.stderr or ran.stdout}")
    model, numbers = read_bank(bank)
    return sorted(zip(numbers(model["frequencies"]), model["extras"]["ringdown"]["frequencyErrors"]))


def compare(thing, baked):
    """Rows of (name, listed, baked, cents, stated error in cents) after the fit, and that fit's factor on E/rho."""
    at, pairs = 0, []
    for row in thing["modes"]["list"]:
        many, name = row[1], row[2] if len(row) > 2 else ""
        if at + many > len(baked):
            sys.exit(f"{thing['name']}: the bank has {len(baked)} modes, and the table asks for {at + many}")
        if row[0] > 0:
            own = sum(frequency for frequency, _ in baked[at : at + many]) / many
            stated = max(error for _, error in baked[at : at + many])
            pairs.append((name, row[0] * thing["unit_hz"], own, cents(1 + stated)))
        at += many
        if len(pairs) == COMPARED:
            break
    factor = pairs[0][1] / pairs[0][2] if thing["fit"] == "E/rho" else 1
    rows = [(name, listed, factor * own, cents(factor * own / listed), stated) for name, listed, own, stated in pairs]
    return rows, factor**2


def summary(thing, rows, stiffness):
    fitted = thing["fit"] == "E/rho"
    off = [abs(row[3]) for row in (rows[1:] if fitted else rows)]  # the first one is exact where it was fitted to
    return {
        "thing": thing["what"],
        "kind": thing["kind"],
        "modes": len(off),
        "fitted": f"E/rho x {stiffness:.3f}" if fitted and 0.5 < stiffness < 2 else "E/rho" if fitted else "nothing",
        "first_off": -0.5 * cents(stiffness) if fitted and 0.5 < stiffness < 2 else math.nan,
        "median": median(off),
        "worst": max(off),
        "stated": max(row[4] for row in rows),
    }


def draw(results, picture):
    try:
        import matplotlib
    except ImportError:
        print("no picture: python3-matplotlib is not installed")
        return
    matplotlib.use("Agg")
    import matplotlib.pyplot as plt

    colours = dict(zip(KINDS, ("#D55E00", "#0072B2", "#009E73")))
    figure, axes = plt.subplots(figsize=(8.6, 0.42 * len(results) + 1.2), constrained_layout=True)
    for line, (thing, rows, _, _) in enumerate(results):
        first = 1 if thing["fit"] == "E/rho" else 0
        axes.plot([row[3] for row in rows[first:]], [line] * (len(rows) - first), "|", ms=13, mew=1.8,
                  color=colours[thing["kind"]])
    axes.set_yticks(range(len(results)), [f'{thing["what"]}' for thing, *_ in results], fontsize=7)
    axes.invert_yaxis()
    axes.set_xscale("symlog", linthresh=1)
    ticks = [-100, -30, -10, -3, -1, 0, 1, 3, 10, 30, 100, 300]
    axes.set_xticks(ticks, [str(tick) for tick in ticks])
    axes.grid(axis="x", lw=0.4)
    axes.set_xlabel("Ringdown over the published frequency [cents]")
    for kind in KINDS:
        axes.plot([], [], "|", ms=10, mew=1.8, color=colours[kind], label=kind)
    axes.legend(fontsize=7, loc="lower right")
    figure.savefig(picture, dpi=110)


def table(results):
    lines = ["| thing | compared with | fitted | first mode before that [cents] | modes | median [cents] | worst [cents] | "
             "stated by the bank [cents] |",
             "|---|---|---|---|---|---|---|---|"]
    for thing, _, found, _ in results:
        first = "" if math.isnan(found["first_off"]) else f'{found["first_off"]:+.0f}'
        lines.append(f'| {found["thing"]} | {found["kind"]} | {found["fitted"]} | {first} | {found["modes"]} | '
                     f'{found["median"]:.1f} | {found["worst"]:.1f} | {found["stated"]:.1f} |')
    return lines


def sources(results):
    return [f'- **{thing["what"]}** ({thing["kind"]}): {thing["source"]}. Material: {thing["material"]["source"]}. '
            f'{thing["remark"][0].upper()}{thing["remark"][1:]}.' for thing, *_ in results]


def fill(page, mark, lines):
    """Puts lines between the two marks of a page."""
    whole = page.read_text()
    begin, end = f"<!-- begin: {mark} -->\n", f"<!-- end: {mark} -->"
    head, rest = whole.split(begin)
    page.write_text(head + begin + "\n".join(lines) + "\n" + end + rest.split(end)[1])


def main():
    flags = {word for word in sys.argv[1:] if word.startswith("--")}
    words = [word for word in sys.argv[1:] if not word.startswith("--")]
    if len(words) < 2 or not flags <= {"--short", "--docs"}:
        sys.exit(__doc__)
    program, folder, names = words[0], pathlib.Path(words[1]), words[2:]
    things = [read_thing(path) for path in sorted((HERE / "things").glob("*.toml"))]
    things = [t for t in things if (not names or t["name"] in names) and ("--short" not in flags or t.get("short"))]
    things.sort(key=lambda t: KINDS.index(t["kind"]))
    folder.mkdir(parents=True, exist_ok=True)
    results, faults = [], 0
    for thing in things:
        rows, stiffness = compare(thing, bake(program, thing, folder))
        found = summary(thing, rows, stiffness)
        good = found["median"] <= thing["limit_median_cents"] and found["worst"] <= thing["limit_worst_cents"]
        faults += not good
        results.append((thing, rows, found, good))
        print(f'{thing["name"]:28} {thing["kind"]:11} {found["modes"]} modes: median {found["median"]:6.2f}, '
              f'worst {found["worst"]:6.2f} cents; fitted: {found["fitted"]}' + ("" if good else "  ABOVE ITS LIMIT"), flush=True)
    with open(folder / "truth.tsv", "w", encoding="utf-8", newline="") as file:
        rows = csv.writer(file, delimiter="\t", lineterminator="\n")
        rows.writerow(["thing", "kind", "mode", "published_hz", "ringdown_hz", "off_cents", "stated_cents"])
        for thing, modes, _, _ in results:
            for name, listed, own, off, stated in modes:
                figures = (f"{listed:.7g}", f"{own:.7g}", f"{off:.2f}", f"{stated:.2f}")
                rows.writerow([thing["name"], thing["kind"], name, *figures])
    measured = [found for thing, _, found, _ in results if thing["kind"] == "measured"]
    print(f"{len(results)} things, {len(measured)} of them measured; {faults} above their limits")
    if "--short" not in flags:
        draw(results, folder / "truth.png")
    if "--docs" in flags:
        page = ROOT / "docs/how/truth.md"
        fill(page, "table, by tests/truth/truth.py", table(results))
        fill(page, "sources, by tests/truth/truth.py", sources(results))
        (ROOT / "docs/figures/truth.png").write_bytes((folder / "truth.png").read_bytes())
        (ROOT / "docs/how/logs/truth.tsv").write_bytes((folder / "truth.tsv").read_bytes())
    sys.exit(1 if faults else 0)


if __name__ == "__main__":
    main()
