#!/usr/bin/python3
"""Writes the table of levels of docs/how/radiation.md: radiation_table.py RINGDOWN

RINGDOWN is the program, whose `info` says what each mode of a bank in presets/banks radiates. A row has a preset's lowest
modes; pairs of modes that differ by less than 0.5 % in frequency count as one.
"""
import math
import pathlib
import re
import subprocess
import sys

ROOT = pathlib.Path(__file__).resolve().parents[2]
PRESETS = ("wine-glass", "hand-bell", "gong", "steel-plate", "vibraphone-key", "tuning-fork")
COLUMNS = 7
PAIR = 1.005


def levels(ringdown, bank):
    """(frequency [Hz], level [dB SPL]) of each mode, in ascending order."""
    text = subprocess.run([ringdown, "info", bank], check=True, capture_output=True, text=True).stdout
    head, *rows = text.split("\n\n")[1].splitlines()
    place = re.split(r"\s{2,}|(?<=Hz) ", head.strip().replace("mode ", "mode  ")).index("dB SPL")
    return sorted((float(row.split()[1]), float(row.split()[place])) for row in rows)


def main():
    ringdown = sys.argv[1]
    print("| preset | " + " | ".join(f"mode {n + 1}" for n in range(COLUMNS)) + " |")
    print("|---" * (COLUMNS + 1) + "|")
    for name in PRESETS:
        modes = levels(ringdown, ROOT / f"presets/banks/{name}.glb")
        highest, loudest = modes[-1][0], max(level for _, level in modes)
        lowest = []
        for mode in modes:
            if not lowest or mode[0] > PAIR * lowest[-1][0]:
                lowest.append(mode)
        cells = [f"{f:.0f} Hz: {20 * math.log10(f / highest):.0f}, {level - loudest:.0f}" for f, level in lowest[:COLUMNS]]
        print(f"| {name} | " + " | ".join(cells + [""] * (COLUMNS - len(cells))) + " |")


if __name__ == "__main__":
    main()
