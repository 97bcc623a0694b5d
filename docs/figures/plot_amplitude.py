#!/usr/bin/env python3
"""Draws how far a strike anywhere on a body is from its finite elements, against the bytes of its bank.

usage: plot_amplitude.py SERIES.tsv PICTURE.png

One panel for each body, one line for each way of choosing points and of interpolating between them: the median of the
modes' errors against the size of the bank, from rows as docs/how/logs/amplitude-series.tsv has them. A star is the
body's preset. Needs Debian's python3-matplotlib.
"""
import csv
import math
import sys

import matplotlib

matplotlib.use("Agg")
import matplotlib.pyplot as plt
from matplotlib import ticker

PROMISE_PERCENT = 3
# Okabe & Ito's colours, which the colour-blind can tell apart; each also has its own marker.
WAYS = {
    "by form, exact": ("points by form, exact values", "#999999", "s"),
    "by error, exact": ("points by error, exact values", "#D55E00", "^"),
    "six-node, fitted": ("points by error, fitted, six-node triangles", "#CC79A7", "v"),
    "by error, fitted": ("points by error, fitted values", "#0072B2", "o"),
    "by error, fitted, compressed": ("the same, compressed", "#009E73", "D"),
    "preset": ("preset", "black", "*"),
}


def read(path):
    with open(path, newline="") as file:
        rows = list(csv.DictReader(file, delimiter="\t"))
    series = {}
    for row in rows:
        point = (float(row["bytes"]) / 1000, float(row["median [%]"]))
        series.setdefault(row["object"], {}).setdefault(row["way"], []).append(point)
    return series


def draw(axes, body, ways):
    for way, (label, colour, marker) in WAYS.items():
        kilobytes, percent = zip(*sorted(ways[way]))
        size = 12 if way == "preset" else 5
        axes.loglog(kilobytes, percent, marker=marker, markersize=size, color=colour, label=label, zorder=3)
    axes.axhline(PROMISE_PERCENT, color="black", linestyle=":", linewidth=1.2)
    axes.set_title(body)
    for axis in (axes.xaxis, axes.yaxis):
        axis.set_major_formatter(ticker.FormatStrFormatter("%g"))
        axis.set_minor_formatter(ticker.NullFormatter())
    axes.grid(alpha=0.3)


def main():
    if len(sys.argv) != 3:
        sys.exit(__doc__)
    series = read(sys.argv[1])
    columns = 2
    rows = math.ceil(len(series) / columns)
    figure, panels = plt.subplots(rows, columns, figsize=(8, 3.3 * rows + 0.7), sharex=True, sharey=True, squeeze=False)
    for axes, (body, ways) in zip(panels.flat, series.items()):
        draw(axes, body, ways)
    figure.supxlabel("bank [kB]")
    figure.supylabel("error of the median mode [%]")
    handles, labels = panels[0][0].get_legend_handles_labels()
    figure.tight_layout(rect=(0, 0, 1, 1 - 0.8 / figure.get_figheight()))
    figure.legend(handles, labels, loc="upper center", ncol=2, fontsize=9, frameon=False)
    figure.savefig(sys.argv[2], dpi=120)


if __name__ == "__main__":
    main()
