#!/usr/bin/env python3
"""Draws the radiation benchmark: error against processor time, beside a dense factorization for each mode.

usage: plot_radiation.py radiation.csv PICTURE.png

The file is what `ringdown_radiation_bench --compare` printed. Prints for each error of the factorizations how much longer
they take than the cheapest setting of Ringdown that is as accurate. Needs Debian's python3-matplotlib.
"""
import csv
import sys

import matplotlib

matplotlib.use("Agg")
import matplotlib.pyplot as plt

# Okabe & Ito's colours, which the colour-blind can tell apart; each also has its own marker.
WAYS = {
    "ours": ("#0072B2", "o", "Ringdown"),
    "obvious": ("#D55E00", "s", "dense factorization for each mode"),
}


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
    for other in (r for r in rows if r["way"] == "obvious"):
        able = [r for r in rows if r["way"] == "ours" and float(r["worst_db"]) <= float(other["worst_db"])]
        if not able:
            continue
        ours, theirs = min(float(r["processor_s"]) for r in able), float(other["processor_s"])
        print(f"{other['worst_db']} dB: {ours:.1f} s, a factorization for each mode {theirs:.1f} s: {theirs / ours:.1f} times")


if __name__ == "__main__":
    main()
