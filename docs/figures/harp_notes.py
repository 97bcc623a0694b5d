#!/usr/bin/python3
"""Writes presets/notes/glass-harp.toml: harp_notes.py RINGDOWN

RINGDOWN is the program. Each note is a glass of presets/banks/glass-harp whose rim, in the two modes with two nodal
diameters, has the note's pitch at some level of the water. The level is found by false position over `ringdown fill`.
"""
import math
import pathlib
import subprocess
import sys
import tempfile

from presets_page import ROOT, modes_of

NAMES = ("c", "cs", "d", "ds", "e", "f", "fs", "g", "gs", "a", "as", "b")
CENTS = 0.02  # how near to the note a level has to come
FORCE_N = 6  # on the middle glass; half of it until a key is pressed harder
HEAD = """# Wine glasses tuned by water. Each is rubbed along its rim while its key is down, as by a wet finger.
# docs/figures/harp_notes.py finds the levels; an object without its water has none of these pitches.
release_s = 1.5
damp_s = 0.3
banks = "../banks/glass-harp"
"""
NOTE = """
[[note]]
note = {note}
object = "{name}"
bank = "{bank}"
level_m = {level:.6f}
point_m = [{x:.5f}, 0, {z:.5f}]
bow_direction = [0, 1, 0]
bow_speed_m_s = 0.15
bow_force_n = {force:.2f}
"""
# Glasses with their lowest and highest notes and their sizes.
GLASSES = (("middle", 76, 85, 1),)
FULL_HZ, LEVELS_M, POINT_M = 640, (0.075, 0.16), (0.032, 0.16)  # at size 1


def level_of(pitch_at, wanted_hz, low, high):
    """The level between two at which the pitch, which falls as the level rises, is the wanted one."""
    def cents(level):
        return 1200 * math.log2(pitch_at(level) / wanted_hz)

    above, below = cents(low), cents(high)
    if not above > 0 > below:
        sys.exit(f"{wanted_hz:.1f} Hz lies outside of the glass's range, {above:.0f} to {below:.0f} cents from it")
    while True:
        level = low + (high - low) * above / (above - below)
        now = cents(level)
        if abs(now) < CENTS:
            return level
        if now > 0:
            low, above, below = level, now, below / 2  # Illinois: the end that stays counts half
        else:
            high, below, above = level, now, above / 2


def notes_of(ringdown):
    text = ""
    for name, first, last, size in GLASSES:
        bank = ROOT / f"presets/banks/glass-harp/{name}.glb"
        full = [frequency for frequency, _ in modes_of(ringdown, bank)]
        rim = sorted(range(len(full)), key=lambda mode: abs(full[mode] * size - FULL_HZ))[:2]
        with tempfile.TemporaryDirectory() as kept:
            filled = pathlib.Path(kept) / "filled.glb"

            def pitch_at(level):
                subprocess.run([ringdown, "fill", bank, "--level", f"{level:.9g}", "-o", filled], check=True,
                               capture_output=True)
                modes = modes_of(ringdown, filled)
                return math.sqrt(modes[rim[0]][0] * modes[rim[1]][0])

            for note in range(first, last + 1):
                level = level_of(pitch_at, 440 * 2 ** ((note - 69) / 12), *(size * end for end in LEVELS_M))
                text += NOTE.format(note=note, name=f"{NAMES[note % 12]}{note // 12 - 1}", bank=name, level=level,
                                    x=size * POINT_M[0], z=size * POINT_M[1], force=size * FORCE_N)
    return text


def main():
    if len(sys.argv) != 2:
        sys.exit(__doc__)
    ringdown = pathlib.Path(sys.argv[1]).resolve()
    (ROOT / "presets/notes/glass-harp.toml").write_text(HEAD + notes_of(ringdown))


if __name__ == "__main__":
    main()
