#!/usr/bin/env python3
"""Bodies of which both a mesh and recordings of others exist: pitch and decay, by `ringdown compare`.

usage: recorded.py [--docs] BIN FOLDER

BIN holds ringdown-bake and ringdown-compare. The mesh is also baked with elements of order 4, which shows whether a recorded mode
lacks a match because of the mesh. A body is a file of tests/truth/decays whose recordings and mesh lie in the folder
$RINGDOWN_MEASURED; neither is part of the project, and bodies without them are left out. FOLDER gets the pages of
ringdown-compare and a table of what it printed, and of each recorded mode that matches none of the body's with the reason; --docs
puts the table into docs/how/truth.md.
"""
import html
import pathlib
import re
import resource
import subprocess
import sys

from decays import DATA, HERE, ROOT
from truth import cents, fill, read_bank, read_thing

TOP_HZ = 13864  # of the bakes of ringdown-compare: its --top, and the largest tuning that it searches


def run(command):
    ran = subprocess.run([str(word) for word in command], capture_output=True, text=True, check=False)
    if ran.returncode:
        sys.exit(f"{command[0]}: {ran.stderr or ran.stdout}")
    return ran.stdout


def cells_of(table):
    """The rows of a table of the page, without its head."""
    return [[html.unescape(re.sub("<[^>]*>", "", cell)) for cell in re.findall(r"<td[^>]*>(.*?)</td>", row)]
            for row in re.findall(r"<tr><td.*?</tr>", table)]


def compared(binaries, thing, folder):
    """What ringdown-compare prints, its table of modes without a match, and its processor time."""
    inputs = folder / thing["name"]
    inputs.mkdir(parents=True, exist_ok=True)
    for path in [path for pattern in thing["recordings"] for path in DATA.glob(pattern)] + [DATA / thing["body"]["geometry"][6:]]:
        link = inputs / path.name
        if not link.exists():
            link.symlink_to(path)
    before = resource.getrusage(resource.RUSAGE_CHILDREN)
    said = run([binaries / "ringdown-compare", inputs, "--material", thing["material"], "-o", folder / f"{thing['name']}.html"])
    after = resource.getrusage(resource.RUSAGE_CHILDREN)
    page = (folder / f"{thing['name']}.html").read_text()
    others = page.split("<h2>Modes without a match</h2>")[1]
    return said, cells_of(others), after.ru_utime + after.ru_stime - before.ru_utime - before.ru_stime


def refined(binaries, thing, folder):
    """How the modes of the band change from the elements of ringdown-compare to those of order 4."""
    frequencies = []
    for element in ("tet20", "tet35"):
        bank = folder / f"{thing['name']}-{element}.glb"
        run([binaries / "ringdown-bake", DATA / thing["body"]["geometry"][6:], "--material", thing["material"], "--element", element,
             "--band", 20, TOP_HZ, "--set-material", "expansion_per_k=0", "--points", 1048576, "-o", bank, "--quiet"])
        model, numbers = read_bank(bank)
        frequencies.append(sorted(numbers(model["frequencies"])))
    coarse, fine = frequencies
    if len(coarse) != len(fine):
        return f"elements of order 4 have {len(fine)} modes in the band, those of order 3 have {len(coarse)}"
    lower = [-cents(b / a) for a, b in zip(coarse, fine)]
    return (f"with elements of order 4 the same {len(fine)} modes lie in the band, {min(lower):.2f} to {max(lower):.2f} cents lower: the "
            "mesh hides no mode")


def table_of(binaries, thing, folder):
    said, others, seconds = compared(binaries, thing, folder)
    print(said, f"processor time {seconds:.0f} s", flush=True)
    line = lambda name: re.search(rf"^{name} +(.*)$", said, re.M).group(1)
    body = re.search(r": (\d+ of the \d+ recorded modes match one of the bank's \d+)", said).group(1)
    distances = [float(distance) for distance in re.findall(r"^distance +([0-9.]+) dB", said, re.M)]
    lines = ["| quantity | result |", "|---|---|",
             f"| verdict | {line('verdict')} |", f"| pitch | {body}; {line('frequencies')} |", f"| chance | {line('chance')} |",
             f"| E/rho | {line('E/rho')} |", f"| nu | {line('nu')} |", f"| loss factor | {line('loss factor')} |",
             f"| sound of the matching modes | {min(distances)} to {max(distances)} dB from the recordings |",
             f"| unmatched | {line('unmatched')} |", f"| finer elements | {refined(binaries, thing, folder)} |",
             "", "| recorded [Hz] | T60 [s] | level [dB] | recordings | why it has no match |", "|---|---|---|---|---|"]
    return lines + ["| " + " | ".join(row) + " |" for row in others]


def main():
    words = [word for word in sys.argv[1:] if word != "--docs"]
    if len(words) != 2:
        sys.exit(__doc__)
    binaries, folder = pathlib.Path(words[0]).resolve(), pathlib.Path(words[1]).resolve()
    folder.mkdir(parents=True, exist_ok=True)
    for path in sorted((HERE / "decays").glob("*.toml")):
        thing = read_thing(path)
        if not thing.get("body", {}).get("geometry", "").startswith("data:/"):
            continue
        if not (DATA / thing["body"]["geometry"][6:]).exists():
            print(f"left out: {thing['name']}, whose mesh and recordings are not in {DATA}")
            continue
        lines = table_of(binaries, thing, folder)
        print("\n".join(lines))
        (folder / f"{thing['name']}.md").write_text("\n".join(lines) + "\n")
        if "--docs" in sys.argv:
            fill(ROOT / "docs/how/truth.md", f"{thing['name']}, by tests/truth/recorded.py", lines)


if __name__ == "__main__":
    main()
