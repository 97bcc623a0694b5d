#!/usr/bin/env python3
"""Draws the radiation benchmark: error against processor time, beside a dense factorization for each mode.

usage: plot_radiation.py radiation.csv PICTURE.png

The file is what `ringdown_radiation_bench --compare` printed. Prints the ratio of the times at the error that Ringdown
reaches by default. Needs Debian's python3-matplotlib.
"""
import csv
import math
import sys

import matplotlib

matplotlib.use("Agg")
import matplotlib.pyplot as plt

# Okabe & Ito's colours, which the colour-blind can tell apart; each also has its own marker.
WAYS = {
    "ours": ("#0072B2", "o", "Ringdown"),
    "obvious": ("#D55E00", "s", "dense factorization for each mode"),
}


def time_at(rows, error):
    """Seconds at an error, on straight lines between the logarithms; beyond the last point the line is continued."""
    points = sorted((math.log(float(r["worst_db"])), math.log(float(r["processor_s"]))) for r in rows)
    pairs = list(zip(points, points[1:]))
    wanted = math.log(error)
    (x0, y0), (x1, y1) = next((p for p in pairs if p[0][0] <= wanted <= p[1][0]), pairs[0])
    return math.exp(y0 + (y1 - y0) * (wanted - x0) / (x1 - x0)), points[0][0] <= wanted


def main():
    source, picture = sys.argv[1:3]
    with open(source, encoding="utf-8") as file:
        rows = list(csv.DictReader(file))
    figure, axes = plt.subplots(figsize=(6.4, 4.2), constrained_layout=True)
    for way, (colour, marker, name) in WAYS.items():
        own = sorted((r for r in rows if r["way"] == way), key=lambda r: float(r["processor_s"]))
        seconds = [float(r["processor_s"]) for r in own]
        axes.plot(seconds, [float(r["worst_db"]) for r in own], marker=marker, color=colour, label=f"{name}, worst mode")
        axes.plot(seconds, [float(r["median_db"]) for r in own], marker=marker, color=colour, linestyle=":",
                  markerfacecolor="white", label=f"{name}, median")
        for row in own:
            axes.annotate(row["unknowns"], (float(row["processor_s"]), float(row["worst_db"])), fontsize=7,
                          textcoords="offset points", xytext=(4, 4))
    axes.set(xscale="log", yscale="log", xlabel="processor time of all modes [s]", ylabel="error of the power [dB]")
    axes.axhline(0.5, color="#999999", linewidth=0.8)
    axes.legend(fontsize=8)
    axes.grid(alpha=0.3)
    figure.savefig(picture, dpi=120)
    ours = min((r for r in rows if r["way"] == "ours"), key=lambda r: float(r["worst_db"]))
    other, within = time_at([r for r in rows if r["way"] == "obvious"], float(ours["worst_db"]))
    print(f"at {ours['worst_db']} dB: {ours['processor_s']} s, a factorization for each mode {other:.0f} s"
          f"{'' if within else ' (continued beyond what was run)'}: {other / float(ours['processor_s']):.1f} times")


if __name__ == "__main__":
    main()
