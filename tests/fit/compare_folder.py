#!/usr/bin/env python3
"""A folder of recordings through `ringdown compare`, of a thing whose truth is known.

usage: compare_folder.py BIN FOLDER

BIN holds ringdown-bake and ringdown-compare. The thing is a tile of which the material's file knows neither E, nu nor damping;
its sound is the sum of its modes by numpy, struck at two points, with noise; once more with a click and in a room. Exit code 1
when compare finds another material, or says nothing useful where the folder is wrong; 77 without numpy.
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

from dull_sounds import RATE, click, read_bank, room, write

ROOT = pathlib.Path(__file__).resolve().parents[2]
NU, STIFFER, ETA = 0.31, 1.08, 1.7e-3

OBJECT = """description = "A tile"
material = "porcelain"
geometry = "{geometry}"
unit_m = 0.001
mesh_size_m = 0.02
band_hz = [20, 20000]
[parameters]
length = 150
width = 113
thickness = 7
"""


def run(command):
    ran = subprocess.run([str(word) for word in command], capture_output=True, text=True, check=False)
    return ran.returncode, ran.stdout, ran.stderr


def number(pattern, text):
    found = re.search(pattern, text)
    if not found:
        sys.exit(f"no '{pattern}' in:\n{text}")
    return float(found.group(1))


def record(inputs, frequencies, decays, dry):
    """Two blows as a microphone hears them: near, or with the contact's click and in a room of 0.4 s."""
    random = np.random.default_rng(3)
    t = np.arange(int(1.2 * RATE)) / RATE
    for name in ("middle", "edge"):
        sound = np.zeros(t.size)
        for f, d in zip(frequencies, decays):
            if f < 15000:
                sound += (0.3 + random.random()) * np.exp(-d * t) * np.sin(2 * np.pi * f * t)
        if not dry:
            sound = room(random, sound / np.max(np.abs(sound)) + click(random, 1.2, 0.01, -3, 0.15), 0.4, 0.25)
        silence = np.zeros(int(0.2 * RATE))
        sound = np.concatenate([silence, 0.8 * sound / np.max(np.abs(sound))])
        write(inputs / f"{name}.wav", sound + 10 ** (-55 / 20) * random.normal(size=sound.size))


def faults_of(out, close):
    """What compare found that is not the truth; `close`: how near nu and the loss factor are to be, and the cents."""
    found = {
        "E/rho": (number(r"E/rho +([0-9.]+) times", out), STIFFER, 0.004),
        "nu": (number(r"nu +([0-9.]+)", out), NU, close[0]),
        "loss factor": (number(r"loss factor +([0-9.e+-]+)", out) / ETA, 1, close[1]),
        "mean cents": (number(r"frequencies +([0-9.]+) cents", out), 0, close[2]),
    }
    faults = [f"{name}: {value} is not {truth} +- {most}" for name, (value, truth, most) in found.items()
              if abs(value - truth) > most]
    return faults if "verdict      good" in out else faults + ["the verdict is not good"]


def main():
    binaries, folder = pathlib.Path(sys.argv[1]), pathlib.Path(sys.argv[2])
    inputs = folder / "tile"
    inputs.mkdir(parents=True, exist_ok=True)
    object_file = inputs / "tile.toml"
    object_file.write_text(OBJECT.format(geometry=ROOT / "presets/objects/box.geo"))
    young = number(r"youngs_modulus_pa\]\s+value = ([0-9.e]+)", (ROOT / "presets/materials/porcelain.toml").read_text())
    bank = folder / "real.glb"
    code, _, said = run([binaries / "ringdown-bake", object_file, "-o", bank, "--set-material", f"poisson_ratio={NU}",
                         "--set-material", f"youngs_modulus_pa={STIFFER * young}", "--set-material", f"loss_factor={ETA}"])
    if code:
        sys.exit(said)
    frequencies, decays, _ = read_bank(bank)
    record(inputs, frequencies, decays, dry=False)
    code, out, said = run([binaries / "ringdown-compare", inputs, "-o", folder / "room.html"])
    print(out, said)
    faults = ["compare failed in the room"] if code else ["in a room: " + fault for fault in faults_of(out, (0.02, 0.15, 2))]
    record(inputs, frequencies, decays, dry=True)
    page = folder / "tile.html"
    code, out, said = run([binaries / "ringdown-compare", inputs, "-o", page, "--bank", folder / "fitted.glb"])
    print(out, said)
    if code:
        sys.exit("compare failed")
    faults += faults_of(out, (0.01, 0.03, 1))
    html = page.read_text()
    if html.count("<svg") != 4 or "middle.wav" not in html or "nan" in html.lower():
        faults.append("the page lacks its pictures")
    again = sorted(read_bank(folder / "fitted.glb")[0])
    worst = max(abs(1200 * np.log2(a / b)) for a, b in zip(again, sorted(frequencies)))
    if worst > 1:
        faults.append(f"the bank that was written is {worst:.2f} cents off")
    empty = folder / "empty"
    empty.mkdir(exist_ok=True)
    for where, word in ((empty, "no recording"), (folder / "nowhere", "cannot read the folder")):
        code, _, said = run([binaries / "ringdown-compare", where])
        if code == 0 or word not in said:
            faults.append(f"{where}: exit code {code}, '{said.strip()}'")
    print("\n".join(faults) or "as it should be")
    sys.exit(1 if faults else 0)


if __name__ == "__main__":
    main()
