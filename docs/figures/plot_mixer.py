#!/usr/bin/env python3
"""Draws the mixer's benchmark, and publishes its results.

usage: plot_mixer.py mixer.csv PICTURE.png [--publish TREE]

Above: modes per core of ours and of others, by how many modes ring. Below: error of each kernel against how many modes it
sustains, and a scene that dies away. --publish keeps the rows as docs/how/logs/mixer.csv, with the revision of the source
tree unless the file tells it, puts this machine's row into the table of docs/how/benchmarks.md in place of an older one, and
the ratios into README. Needs Debian's python3-matplotlib.
"""
import csv

import matplotlib

matplotlib.use("Agg")
import matplotlib.pyplot as plt
from matplotlib import ticker

from results_table import command

# Okabe & Ito's colours, which the colour-blind can tell apart; each also has its own marker.
PLAYERS = {  # name and objects
    ("ours", 1): ("#0072B2", "o", "Ringdown, 1 object"),
    ("ours", 10): ("#56B4E9", "s", "Ringdown, 10 objects"),
    ("faust", 1): ("#D55E00", "^", "Faust pm.modeFilter"),
    ("klank", 1): ("#009E73", "D", "scsynth Klank"),
    ("two-pole", 1): ("#999999", "v", "two-pole filters"),
    ("closed form", 1): ("#999999", "x", "exp * sin"),
}
MOST_ERROR_DB = -110  # the promise
TABLE_HEAD = (
    "| machine | revision | 10,000 modes: modes per core, block 64 / 128 / 256 | in 10 objects |"
    " x Faust: 10,000, 1,000, 100 modes | x Klank: 10,000, 1,000, 100 modes | error [dB] after 1 s / 10 min |"
    " bytes per mode | silent block [us] | strike of 100 / 500 modes [us] | load of 10,000 strikes/s | dying tail / loud |\n"
    + "|---" * 12 + "|"
)
NUMBERS = ("modes", "objects", "block", "time_s", "count", "modes_per_core", "mean_us", "p50_us", "bytes_per_mode", "ratio", "error_db")


def read(path):
    with open(path, newline="") as file:
        rows = list(csv.DictReader(file))
    for row in rows:
        for name in NUMBERS:
            row[name] = float(row[name]) if row.get(name) else None
    return rows


def measured(rows, part, **wanted):
    return [r for r in rows if r["part"] == part and r["status"] == "ok" and all(r[k] == v for k, v in wanted.items())]


def throughput(rows, who, objects, modes, block):
    """Of a peer's several ways the fastest; None when there is none."""
    found = [r for r in measured(rows, "throughput", objects=objects, modes=modes, block=block) if r["who"].startswith(who)]
    return max(found, key=lambda r: r["modes_per_core"], default=None)


def counts_of(rows):
    return sorted({r["modes"] for r in measured(rows, "throughput")})


def draw_throughput(axes, rows, block):
    counts = counts_of(rows)
    if not counts:
        return axes.axis("off")
    for (who, objects), (colour, marker, label) in PLAYERS.items():
        found = [throughput(rows, who, objects, modes, block) for modes in counts]
        points = [(r["modes"], r["modes_per_core"]) for r in found if r]
        if not points:
            continue
        axes.loglog(*zip(*points), marker=marker, color=colour, label=label)
        last = found[-1]
        if last and who != "ours":
            axes.annotate(f" 1/{last['ratio']:.0f}", points[-1], va="center", fontsize=9, color=colour)
    axes.set_title(f"block of {block}")
    axes.set_xlabel("modes ringing")
    axes.set_ylabel("modes that one core sustains at 48 kHz")
    axes.set_xlim(right=2 * max(counts))
    axes.set_xticks(counts, [f"{count:,.0f}" for count in counts])
    axes.grid(True, which="major", alpha=0.3)
    axes.yaxis.set_major_formatter(ticker.FuncFormatter(lambda value, _: f"{value:,.0f}"))


def draw_errors(axes, rows):
    if not measured(rows, "accuracy"):
        return axes.axis("off")
    for who in {row["who"] for row in measured(rows, "accuracy")}:
        both = measured(rows, "accuracy", who=who)
        axes.semilogx([r["modes_per_core"] for r in both], [r["error_db"] for r in both], color="#BBBBBB", linewidth=1)
    for row in measured(rows, "accuracy"):
        ours = row["who"].startswith("ours")
        colour = "#0072B2" if ours else "#555555"
        later = row["time_s"] > 1
        axes.semilogx(row["modes_per_core"], row["error_db"], "o", color=colour, fillstyle="none" if later else "full", markersize=10 if later else 6)
        if not later:
            name = row["who"].replace("ours", "Ringdown")
            point = (row["modes_per_core"], row["error_db"])
            axes.annotate(name, point, (9, -9 if ours else 3), textcoords="offset points", fontsize=9, color=colour)
    axes.plot([], [], "o", color="black", label="after 1 s")
    axes.plot([], [], "o", color="black", fillstyle="none", markersize=10, label="after 10 min")
    axes.axhline(MOST_ERROR_DB, color="black", linewidth=0.8, linestyle=":")
    axes.set_title("error of the sum of 2,000 modes, 20 Hz to 0.499 fs")
    axes.set_xlabel("modes that one core sustains")
    axes.set_ylabel("relative error [dB]")
    axes.set_xlim(right=6 * axes.get_xlim()[1])
    axes.xaxis.set_major_formatter(ticker.FuncFormatter(lambda value, _: f"{value:,.0f}"))
    axes.grid(True, which="major", alpha=0.3)
    axes.legend(loc="center left", frameon=False)


def draw_decay(axes, rows):
    scene = measured(rows, "decay")
    if not scene:
        return axes.axis("off")
    times = [r["time_s"] for r in scene]
    axes.plot(times, [r["p50_us"] for r in scene], color="#0072B2", label="block time")
    axes.set_title(f"a scene of {scene[0]['objects']:.0f} objects dies away")
    axes.set_xlabel("seconds since the strike")
    axes.set_ylabel(f"time of a block of {scene[0]['block']:.0f} [us]", color="#0072B2")
    axes.set_ylim(0, 1.1 * max(r["p50_us"] for r in scene))
    other = axes.twinx()
    other.plot(times, [r["modes"] for r in scene], color="#D55E00", linestyle="--", label="audible modes")
    other.set_ylabel("audible modes", color="#D55E00")
    other.set_ylim(0, 1.1 * max(r["modes"] for r in scene))
    other.yaxis.set_major_formatter(ticker.FuncFormatter(lambda value, _: f"{value:,.0f}"))
    axes.grid(True, alpha=0.3)


def draw(rows, path):
    figure, axes = plt.subplots(2, 2, figsize=(14, 10))
    draw_throughput(axes[0, 0], rows, 64)
    draw_throughput(axes[0, 1], rows, 128)
    draw_errors(axes[1, 0], rows)
    draw_decay(axes[1, 1], rows)
    figure.legend(*axes[0, 0].get_legend_handles_labels(), loc="upper center", ncol=6, frameon=False)
    figure.tight_layout(rect=(0, 0, 1, 0.97))
    figure.savefig(path, dpi=110)


def text(row, key, style="{:.3g}"):
    return style.format(row[key]) if row and row[key] is not None else "-"


def first(rows, part, **wanted):
    return next(iter(measured(rows, part, **wanted)), None)


def ours(rows, objects, blocks, key, style):
    return " / ".join(text(throughput(rows, "ours", objects, 10000, block), key, style) for block in blocks)


def ratios(rows, peer):
    """For each count block 64 / 128."""
    cells = []
    for modes in (10000, 1000, 100):
        cells.append(" / ".join(text(throughput(rows, peer, 1, modes, block), "ratio", "{:.1f}") for block in (64, 128)))
    return ", ".join(cells)


def table_row(rows, revision):
    storm = first(rows, "storm")
    tails = [r["ratio"] for r in measured(rows, "tail") if r["who"] != "loud"]
    cells = [
        rows[0]["machine"],
        revision,
        ours(rows, 1, (64, 128, 256), "modes_per_core", "{:,.0f}"),
        ours(rows, 10, (64, 128, 256), "modes_per_core", "{:,.0f}"),
        ratios(rows, "faust"),
        ratios(rows, "klank"),
        " / ".join(text(first(rows, "accuracy", who="ours: mixer", time_s=t), "error_db", "{:.0f}") for t in (1, 600)),
        ours(rows, 1, (128,), "bytes_per_mode", "{:.0f}"),
        text(first(rows, "silence"), "mean_us"),
        " / ".join(text(first(rows, "strike", modes=modes), "mean_us") for modes in (100, 500)),
        f"{storm['mean_us'] * 48e-3 / storm['block']:.2f}" if storm else "-",
        f"{max(tails):.2f}" if tails else "-",
    ]
    return "| " + " | ".join(cells) + " |"


def readme_cells(rows):
    """For 10,000 modes, in blocks of 64 and 128."""
    cells = {}
    for peer, name in (("faust", "Faust's `pm.modeFilter`"), ("klank", "SuperCollider's Klank")):
        least, most = sorted(throughput(rows, peer, 1, 10000, block)["ratio"] for block in (64, 128))
        cells[name] = f"{least:.0f} to {most:.0f} times as many modes per core"
    return cells


if __name__ == "__main__":
    command(__doc__, read, draw, "mixer", TABLE_HEAD, table_row, readme_cells)
