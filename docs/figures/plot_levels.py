#!/usr/bin/python3
"""Draws the frequencies of a bank over the level of its liquid.

usage: plot_levels.py RINGDOWN BANK PICTURE.png REFERENCE.tsv

RINGDOWN is the program. Lines come from `ringdown fill` of BANK, which must know its levels, at 120 of them; points are
those of the reference: a height [mm], a number of nodal diameters and a frequency [Hz] in each row after the first.
Needs Debian's python3-matplotlib.
"""
import pathlib
import re
import subprocess
import sys
import tempfile

import matplotlib

matplotlib.use("Agg")
import matplotlib.pyplot as plt
import numpy as np

from presets_page import modes_of

STEPS = 120
TICKS_HZ = (500, 700, 1000, 1500, 2000, 3000, 5000, 7000, 10000)


def fill(ringdown, bank, level_m, output):
    command = [ringdown, "fill", bank, "--level", f"{level_m:.6g}", "-o", output]
    return subprocess.run(command, capture_output=True, text=True)


def range_m(ringdown, bank, output):
    """Lowest and highest level, as the refusals of levels beyond them state."""
    ends = [re.search(r"at ([-0-9.e]+) m", fill(ringdown, bank, level, output).stderr) for level in (-1e5, 1e5)]
    return [float(end[1]) for end in ends]


def main():
    if len(sys.argv) != 5:
        sys.exit(__doc__)
    ringdown, bank, picture, reference = sys.argv[1:]
    with tempfile.TemporaryDirectory() as folder:
        filled = pathlib.Path(folder) / "filled.glb"
        low, high = range_m(ringdown, bank, filled)
        levels = np.linspace(low, high, STEPS + 2)[1:-1]  # the ends are known to four digits only
        rows = []
        for level in levels:
            fill(ringdown, bank, level, filled)
            rows.append([frequency for frequency, _ in modes_of(ringdown, filled)])
    figure, axes = plt.subplots(figsize=(8, 4.2), layout="constrained")
    axes.plot(1000 * levels, rows, color="#0072b2", linewidth=1.1)
    for diameters, marker in ((2, "o"), (3, "s"), (4, "^")):
        points = [row for row in np.loadtxt(reference, skiprows=1) if row[1] == diameters]
        axes.plot(*np.transpose(points)[[0, 2]], marker, color="#d55e00", markersize=4, label=f"reference, m = {diameters}")
    axes.legend(loc="lower left", fontsize=8)
    axes.set_yscale("log")
    ticks = [tick for tick in TICKS_HZ if np.min(rows) / 1.2 < tick < np.max(rows)]
    axes.set_yticks(ticks, [str(tick) for tick in ticks])
    axes.yaxis.set_minor_formatter(matplotlib.ticker.NullFormatter())
    axes.set_xlabel("height of the liquid's surface [mm]")
    axes.set_ylabel("frequency [Hz]")
    axes.grid(alpha=0.3)
    figure.savefig(picture, dpi=100, pil_kwargs={"optimize": True})


if __name__ == "__main__":
    main()
