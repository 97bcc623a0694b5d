#!/usr/bin/env python3
"""Draws the modal benchmark, and publishes its results.

usage: plot_modal.py modal.csv PICTURE.png [--publish TREE]

Above, for each body: worst error of the first 50 modes against seconds, one line for each order of elements. Below: what
each program takes for the same 200 modes, with its ratio to ours. --publish keeps the rows as modal.csv in docs/how/logs
and puts this machine's row into the table of docs/how/benchmarks.md in place of an older one. Needs Debian's
python3-matplotlib.
"""
import csv

import matplotlib

matplotlib.use("Agg")
import matplotlib.pyplot as plt
from matplotlib import ticker

from results_table import command

# Okabe & Ito's colours, which the colour-blind can tell apart; each also has its own marker or hatch.
ELEMENTS = {
    "tet4": ("#999999", "s", "4 nodes, linear"),
    "tet10": ("#0072B2", "o", "10 nodes, quadratic"),
    "tet20": ("#D55E00", "^", "20 nodes, cubic"),
    "tet35": ("#009E73", "D", "35 nodes, quartic"),
}
METHODS = {
    "ours": ("#0072B2", "", "Ringdown"),
    "spectra-cholmod": ("#E69F00", "//", "Spectra + CHOLMOD"),
    "slepc-cholmod": ("#CC79A7", "\\\\", "SLEPc + CHOLMOD"),
    "slepc-mumps": ("#CC79A7", "..", "SLEPc + MUMPS"),
    "slepc-petsc": ("#CC79A7", "xx", "SLEPc + PETSc"),
    "ccx": ("#999999", "", "CalculiX"),
}
BODIES = ["block", "plate", "sphere", "bell"]
MOST_ERROR = 0.1  # [%] the promise
TABLE_HEAD = (
    "| machine | revision | 200 modes [s] | Spectra | SLEPc | CalculiX | 2 threads | 1,000 modes: Spectra | 200,000 unknowns [MiB] |"
    " worst error [%] of the first 10, 50 |\n" + "|---" * 10 + "|"
)


def number(text):
    return float(text) if text else None


def read(path):
    with open(path, newline="") as file:
        rows = list(csv.DictReader(file))
    for row in rows:
        for name in ("unknowns", "modes", "threads", "seconds", "peak_mib", "error_10_percent", "error_50_percent", "ratio", "top_hz"):
            row[name] = number(row[name])
    return rows


def ran(row):
    return row["status"] in ("ok", "over limit")


def peer_problem(rows, body):
    """Of a body, the rows of the mesh that all programs were given, by method."""
    return {row["method"]: row for row in rows if row["part"] == "peers" and row["case"] == body and ran(row)}


def draw_errors(axes, rows, body):
    axes.set_title(body)
    for element, (colour, marker, label) in ELEMENTS.items():
        points = sorted(
            (row["seconds"], row["error_50_percent"], row["unknowns"])
            for row in rows
            if row["part"] == "series"
            and row["case"] == body
            and row["element"] == element
            and row["method"] == "ours"
            and row["status"] == "ok"
            and row["error_50_percent"]
        )
        if points:
            axes.loglog([p[0] for p in points], [p[1] for p in points], marker=marker, color=colour, label=label)
    for row in rows:
        if row["case"] == body and row["part"] == "default" and row["status"] == "ok" and row["error_50_percent"]:
            axes.loglog(row["seconds"], row["error_50_percent"], "*", color="black", markersize=13, label="ringdown-bake as it comes")
    axes.axhline(MOST_ERROR, color="black", linewidth=0.8, linestyle=":")
    axes.set_xlabel("seconds, one core")
    axes.grid(True, which="major", alpha=0.3)
    axes.xaxis.set_major_formatter(ticker.FormatStrFormatter("%g"))
    axes.yaxis.set_major_formatter(ticker.FormatStrFormatter("%g"))
    axes.xaxis.set_minor_formatter(ticker.NullFormatter())


def draw_times(axes, rows, body):
    problem = peer_problem(rows, body)
    if not problem:
        axes.axis("off")
        return
    first = next(iter(problem.values()))
    axes.set_title(f"{body}: {first['unknowns']:,.0f} unknowns, {problem.get('ours', first)['modes']:.0f} modes")
    shown = [method for method in METHODS if method in problem]
    for place, method in enumerate(shown):
        colour, hatch, _ = METHODS[method]
        row = problem[method]
        axes.barh(place, row["seconds"], color=colour, hatch=hatch, edgecolor="white")
        over = "> " if row["status"] == "over limit" else ""
        text = f" {over}{row['seconds']:.3g} s" + (f" = {over}{row['ratio']:.1f} x" if row["ratio"] and method != "ours" else "")
        axes.text(row["seconds"], place, text, va="center", fontsize=9)
    axes.set_yticks(range(len(shown)), [METHODS[method][2].replace(" + ", "\n+ ") for method in shown])
    axes.invert_yaxis()
    axes.set_xlim(0, 1.45 * max(row["seconds"] for row in problem.values()))
    axes.set_xlabel("seconds, one core")
    axes.spines[["top", "right"]].set_visible(False)


def draw(rows, path):
    figure, axes = plt.subplots(2, len(BODIES), figsize=(17, 8.5))
    for column, body in enumerate(BODIES):
        draw_errors(axes[0, column], rows, body)
        draw_times(axes[1, column], rows, body)
    axes[0, 0].set_ylabel("worst error of the first 50 modes [%]")
    handles = {}
    for panel in axes[0]:
        handles.update(zip(*panel.get_legend_handles_labels()[::-1]))
    figure.legend(handles.values(), handles.keys(), loc="upper center", ncol=5, frameon=False)
    figure.tight_layout(rect=(0, 0, 1, 0.95))
    figure.savefig(path, dpi=110)


def ratio_text(row):
    if row is None:
        return "-"
    if not ran(row):
        return row["status"]
    return ("> " if row["status"] == "over limit" else "") + f"{row['ratio']:.1f}"


def table_row(rows, revision):
    """Ratios: block / plate / sphere / bell, of SLEPc's ways the fastest."""
    columns = {"ours": [], "spectra-cholmod": [], "slepc": [], "ccx": [], "threads": []}
    for body in BODIES:
        problem = peer_problem(rows, body)
        ours = problem.get("ours")
        slepc = min((r for m, r in problem.items() if m.startswith("slepc")), key=lambda r: r["seconds"], default=None)
        twice = [r for r in rows if ours and r["part"] == "threads" and r["case"] == body and r["status"] == "ok"]
        columns["ours"].append(f"{ours['seconds']:.1f}" if ours else "-")
        columns["spectra-cholmod"].append(ratio_text(problem.get("spectra-cholmod")))
        columns["slepc"].append(ratio_text(slepc))
        columns["ccx"].append(ratio_text(problem.get("ccx")))
        columns["threads"].append(f"{ours['seconds'] / twice[0]['seconds']:.2f}" if twice else "-")
    many = [r for r in rows if r["part"] == "many" and r["method"] == "spectra-cholmod" and ran(r)]
    large = [r for r in rows if r["part"] == "memory" and r["status"] == "ok"]
    baked = [r for r in rows if r["part"] == "default" and r["status"] == "ok"]
    worst = [max((r[key] for r in baked if r[key] is not None), default=None) for key in ("error_10_percent", "error_50_percent")]
    cells = [rows[0]["machine"], revision] + [" / ".join(values) for values in columns.values()]
    cells += [ratio_text(many[0] if many else None), f"{large[0]['peak_mib']:.0f}" if large else "-"]
    cells.append(", ".join("-" if value is None else f"{value:.3g}" for value in worst))
    return "| " + " | ".join(cells) + " |"


if __name__ == "__main__":
    command(__doc__, read, draw, "modal", TABLE_HEAD, table_row)
