#!/usr/bin/env python3
"""Draws the rooms of the source tree and the ways between them: architecture.py [OUTPUT.png]"""
import pathlib
import sys

import matplotlib

matplotlib.use("Agg")
import matplotlib.pyplot as plt
from matplotlib.patches import FancyBboxPatch

OFFLINE, REAL_TIME, SHARED, PROGRAMS = "#dce9f7", "#fbe5d0", "#e4f0dc", "#eeeeee"
WIDTH, HEIGHT = 2.1, 0.74

# name: column, row, what it does, colour
ROOMS = {
    "mesh": (0, 4, "tetrahedra", OFFLINE),
    "fem": (1, 4, "K and M", OFFLINE),
    "solve": (2, 4, "every mode", OFFLINE),
    "bake": (3, 4, "mesh to bank", OFFLINE),
    "fit": (4, 4, "recording to modes", OFFLINE),
    "liquid": (0, 3, "water inside and around", OFFLINE),
    "materials": (1, 3, "figures by name", SHARED),
    "radiate": (2, 3, "modes into air", OFFLINE),
    "modal": (3, 3, "banks", SHARED),
    "gltf": (4, 3, "their container", SHARED),
    "scene": (0, 2, "bodies to events", REAL_TIME),
    "protocol": (1, 2, "requests, OSC", REAL_TIME),
    "server/session": (2, 2, "what requests do", REAL_TIME),
    "synth": (3, 2, "events to samples", REAL_TIME),
    "contact": (4, 2, "forces", REAL_TIME),
    "server": (2, 1, "ringdownd, JACK", PROGRAMS),
    "clients/library": (3, 1, "C, Python, plug-in", PROGRAMS),
    "clients/cli": (0, 1, "ringdown, bakers", PROGRAMS),
    "clients/viewer": (1, 1, "the window", PROGRAMS),
}
WAYS = [
    ("mesh", "fem"), ("fem", "solve"), ("solve", "bake"), ("bake", "modal"), ("radiate", "bake"), ("materials", "bake"),
    ("liquid", "bake"),
    ("fit", "modal"), ("gltf", "modal"), ("modal", "synth"), ("scene", "server/session", -0.2), ("protocol", "server/session"),
    ("server/session", "synth"), ("contact", "synth"), ("server/session", "server"), ("server/session", "clients/library"),
]


def centre(name):
    column, row = ROOMS[name][:2]
    return 2.5 * column, 1.25 * row


def edge(name, towards):
    """Where a straight line from the room's middle to another's leaves its box."""
    (x, y), (tx, ty) = centre(name), centre(towards)
    dx, dy = tx - x, ty - y
    scale = min(WIDTH / 2 / abs(dx) if dx else 9, HEIGHT / 2 / abs(dy) if dy else 9)
    return x + scale * dx, y + scale * dy


def main():
    output = sys.argv[1] if len(sys.argv) > 1 else pathlib.Path(__file__).with_suffix(".png")
    figure, axes = plt.subplots(figsize=(10, 5))
    for name, (_, _, does, colour) in ROOMS.items():
        x, y = centre(name)
        axes.add_patch(FancyBboxPatch((x - WIDTH / 2, y - HEIGHT / 2), WIDTH, HEIGHT, boxstyle="round,pad=0,rounding_size=0.1",
                                      facecolor=colour, edgecolor="#555555", linewidth=0.8))
        axes.text(x, y + 0.13, name, ha="center", va="center", fontsize=9, weight="bold")
        axes.text(x, y - 0.17, does, ha="center", va="center", fontsize=8)
    for start, end, *bend in WAYS:
        style = f"arc3,rad={bend[0]}" if bend else "arc3"
        a, b = (edge(start, end), edge(end, start)) if not bend else (
            (centre(start)[0], centre(start)[1] + HEIGHT / 2), (centre(end)[0] - 0.3, centre(end)[1] + HEIGHT / 2))
        axes.annotate("", b, a, arrowprops={"arrowstyle": "-|>", "color": "#555555", "linewidth": 1, "connectionstyle": style})
    for row, word in ((4, "offline"), (3, "shared"), (2, "real time"), (1, "programs")):
        axes.text(-1.25, 1.25 * row, word, ha="right", va="center", fontsize=9, style="italic", color="#555555")
    axes.set_xlim(-2.5, 11.2)
    axes.set_ylim(0.7, 5.5)
    axes.set_axis_off()
    figure.savefig(output, dpi=110, bbox_inches="tight", pad_inches=0.05)


main()
