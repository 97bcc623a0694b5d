#!/usr/bin/env python3
"""Draws how cost grows: the mixer's time of a block, and time and memory of a modal analysis and of radiation.

usage: plot_growth.py MIXER.csv MODAL.csv RADIATION.csv PICTURE.png [--publish TREE]

The files are what the benchmarks wrote for their part `growth`. A slope is that of the logarithms of the upper half of the
points: 1 where twice as many cost twice as much. --publish keeps the points as docs/how/logs/growth.csv and puts the slopes
into the table of docs/how/benchmarks.md. Needs Debian's python3-matplotlib.
"""
import argparse
import csv
import math
from pathlib import Path

import matplotlib

matplotlib.use("Agg")
import matplotlib.pyplot as plt
from matplotlib import ticker

from results_table import as_csv, put_between, revision_of, write

# Okabe & Ito's colours, which the colour-blind can tell apart; each also has its own marker.
MIXER = {
    "modes": ("#0072B2", "o", "modes of 1 object"),
    "objects": ("#56B4E9", "s", "objects that share 10,240 modes"),
    "strikes a second": ("#D55E00", "^", "strikes a second on 1,000 objects of 50 modes"),
    "two-way contacts": ("#009E73", "D", "two-way contacts of 200 and 200 modes"),
    "channels": ("#CC79A7", "v", "channels of 100 objects of 100 modes"),
}
OFFLINE = {
    "unknowns": ("#0072B2", "o", "unknowns, 200 modes"),
    "modes of a body": ("#D55E00", "^", "modes, 39,900 unknowns"),
    "nodes": ("#009E73", "D", "nodes of a skin, radiation of one mode"),
}
RATE_HZ = 48000


def read(path):
    with open(path, newline="") as file:
        return list(csv.DictReader(file))


def points_of(mixer, modal, radiation):
    """What is counted, how many, seconds (in the mixer of a frame), MiB."""
    points = [
        (row["who"], float(row["count"]), 1e-6 * float(row["mean_us"]) / float(row["block"]), "")
        for row in mixer
        if row["part"] == "growth" and row["status"] == "ok"
    ]
    rows = [row for row in modal if row["part"] == "growth" and row["status"] == "ok"]
    for row in rows:  # meshes with one highest frequency come first, then one mesh with several
        measured = (float(row["processor_s"]), float(row["peak_mib"]))
        if row["top_hz"] == rows[0]["top_hz"]:
            points.append(("unknowns", float(row["unknowns"]), *measured))
        if row["mesh"] == rows[-1]["mesh"]:
            points.append(("modes of a body", float(row["modes"]), *measured))
    points += [("nodes", float(row["nodes"]), float(row["processor_s"]), float(row["peak_mib"])) for row in radiation]
    return points


def series(points, what, column):
    return sorted((p[1], p[column]) for p in points if p[0] == what and p[column] != "")


def slope(points):
    """By least squares."""
    upper = [(math.log(x), math.log(y)) for x, y in points[len(points) // 2 - 1 :]]
    mean_x, mean_y = (sum(values) / len(upper) for values in zip(*upper))
    return sum((x - mean_x) * (y - mean_y) for x, y in upper) / sum((x - mean_x) ** 2 for x, _ in upper)


def draw_panel(axes, points, styles, column, title, unit):
    for what, (colour, marker, label) in styles.items():
        line = series(points, what, column)
        if len(line) > 1:
            axes.loglog(*zip(*line), marker=marker, color=colour, label=f"{label}: slope {slope(line):.2f}")
    axes.set_title(title)
    axes.set_xlabel("number of them")
    axes.set_ylabel(unit)
    axes.xaxis.set_major_formatter(ticker.FuncFormatter(lambda value, _: f"{value:,.0f}"))
    axes.grid(True, which="major", alpha=0.3)
    axes.set_ylim(bottom=axes.get_ylim()[0] / 3)
    axes.legend(loc="lower right", frameon=False, fontsize=9)


def draw(points, path):
    figure = plt.figure(figsize=(14, 10))
    above = figure.add_subplot(2, 1, 1)
    above.axhline(1 / RATE_HZ, color="black", linewidth=0.8, linestyle=":", label="one core in real time")
    draw_panel(above, points, MIXER, 2, "the mixer", "processor time of a frame [s]")
    draw_panel(figure.add_subplot(2, 2, 3), points, OFFLINE, 2, "modal analysis and radiation", "processor time [s]")
    draw_panel(figure.add_subplot(2, 2, 4), points, OFFLINE, 3, "memory of them", "peak [MiB]")
    figure.tight_layout()
    figure.savefig(path, dpi=110)


def table(points):
    lines = ["| what grows | from | to | slope of time | slope of memory |", "|---|---|---|---|---|"]
    for what, (_, _, label) in {**MIXER, **OFFLINE}.items():
        time, memory = series(points, what, 2), series(points, what, 3)
        if len(time) < 2:
            continue
        costs = f"{slope(time):.2f} | " + (f"{slope(memory):.2f}" if memory else "-")
        lines.append(f"| {label} | {time[0][0]:,.0f} | {time[-1][0]:,.0f} | {costs} |")
    return "\n".join(lines)


def main():
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    for name in ("mixer", "modal", "radiation", "picture"):
        parser.add_argument(name)
    parser.add_argument("--publish", type=Path, metavar="TREE", help="the source tree whose log and page take the results")
    arguments = parser.parse_args()
    mixer = read(arguments.mixer)
    points = points_of(mixer, read(arguments.modal), read(arguments.radiation))
    draw(points, arguments.picture)
    if tree := arguments.publish:
        origin = {"machine": mixer[0]["machine"], "revision": revision_of(tree)}
        rows = [dict(zip(("what", "count", "seconds", "mib"), point), **origin) for point in points]
        write(tree / "docs/how/logs/growth.csv", as_csv(rows))
        put_between(tree / "docs/how/benchmarks.md", "growth", table(points))


if __name__ == "__main__":
    main()
