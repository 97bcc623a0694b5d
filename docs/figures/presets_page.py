#!/usr/bin/python3
"""Writes docs/use/presets.md and a picture for each preset's bank: presets_page.py RINGDOWN

RINGDOWN is the program. What the page says comes from presets/objects/*.toml and from `ringdown info` of presets/banks.
"""
import io
import pathlib
import re
import subprocess
import sys
import tomllib

from PIL import Image

ROOT = pathlib.Path(__file__).resolve().parents[2]
PICTURES = ROOT / "docs/figures/presets"
MOST_BYTES = 25_000
HEAD = """# The presets

The presets are the objects of `presets/objects`. Their banks, of 17 to 1,630 kB, are in `presets/banks`. Play one:

    ringdownd --object it=presets/banks/NAME.glb --connect &
    ringdown strike it --vertex 0 --impulse 0,0,-0.01

Each picture shows the shape of the most important mode, coloured by how far each place moves (dark: at rest, yellow: moves most). Beside it is the
spectrum, in dB over Hz, of a blow at the point where the object responds most. The first T60 belongs to the mode at the pitch, if there is one; the
second belongs to the most important mode, which is the loudest in most blows. A [pitch](materials.md#pitch) in bold is stated; the others are
estimated. [Pictures of a bank](previews.md) show more modes. `./run presets` bakes the presets that have changed.

Folders hold more banks. `bottles/wine` is a bottle whose [air has a note](materials.md#air-with-a-note): slap it, or blow it. Two are
instruments: the 37 bars of the `vibraphone`, and the `glass-harp`, a wine glass that water tunes. Play them, and the tines and teeth of `kalimba` and
`music-box-comb`, by [maps of notes](midi.md).

| | object | material | pitch in Hz (note, cents) | T60 of the pitch [s] | T60 of the loudest [s] |
|---|---|---|---|---|---|
"""


def info(ringdown, bank):
    return subprocess.run([ringdown, "info", bank], check=True, capture_output=True, text=True).stdout


def modes_of(ringdown, bank):
    """(frequency [Hz], T60 [s]) of each mode, in the bank's order."""
    modes = []
    for line in info(ringdown, bank).split("\n\n")[1].splitlines()[1:]:
        words = line.split()
        modes.append((float(words[1]), float(words[2])))
    return modes


def pitch_of(ringdown, bank):
    """As "220.0 (A3 +0)", in bold where it is stated; "none"."""
    line = next(line for line in info(ringdown, bank).splitlines() if line.startswith("pitch "))
    found = re.match(r"pitch +([0-9.]+) Hz \((.*) ct\), as (\w+)", line)
    if not found:
        return "none"
    frequency, stated = float(found[1]), found[3] != "estimated"
    text = f"{frequency:.{0 if frequency >= 1000 else 1}f} ({found[2]})"
    return f"**{text}**" if stated else text


def t60_at(pitch, modes):
    """T60 of the longest mode within a third of a semitone of the pitch; empty where there is none."""
    if pitch == "none":
        return ""
    frequency = float(pitch.strip("*").split()[0])
    near = [t60 for own, t60 in modes if abs(own / frequency - 1) < 0.02]
    return f"{max(near):.2g}" if near else ""


def small_picture(ringdown, bank, path):
    drawn = path.with_suffix(".part.png")
    subprocess.run([ringdown, "picture", bank, "-o", drawn, "--small"], check=True)
    image = Image.open(drawn).convert("RGB")
    drawn.unlink()
    for colours in (128, 64, 32, 16):
        bytes_ = io.BytesIO()
        image.quantize(colours, dither=Image.Dither.NONE).save(bytes_, "PNG", optimize=True)
        if bytes_.tell() <= MOST_BYTES:
            break
    path.write_bytes(bytes_.getvalue())


def row(ringdown, path):
    thing = tomllib.loads(path.read_text())
    name, bank = path.stem, ROOT / "presets/banks" / f"{path.stem}.glb"
    label = f"`{name}`: {thing.get('description', '').replace('|', '/')}"
    if not bank.exists():
        return f"| | {label} | {thing.get('material', '')} | | | |\n"
    picture = PICTURES / f"{name}.png"
    small_picture(ringdown, bank, picture)
    modes = modes_of(ringdown, bank)
    pitch = pitch_of(ringdown, bank)
    return (f"| ![{name}](../figures/presets/{name}.png) | {label} | {thing.get('material', '')} | {pitch} "
            f"| {t60_at(pitch, modes)} | {modes[0][1]:.2g} |\n")


def main():
    ringdown = pathlib.Path(sys.argv[1]).resolve()
    PICTURES.mkdir(parents=True, exist_ok=True)
    objects = sorted((ROOT / "presets/objects").glob("*.toml"))
    names = {path.stem for path in objects}
    rows = [row(ringdown, path) for path in objects]
    for picture in PICTURES.glob("*.png"):
        if picture.stem not in names:
            picture.unlink()
    (ROOT / "docs/use/presets.md").write_text(HEAD + "".join(rows))


if __name__ == "__main__":
    main()
