#!/usr/bin/env python3
"""Draws a bank: how long and how loud its modes ring, the shape of one on the object, and where that one is heard.

    python3 plot_bank.py bell.glb [-o bell.png] [--mode 2]

Modes are counted from the lowest frequency.
"""

import argparse

import matplotlib.pyplot as plt
import numpy as np
import ringdown


def draw_modes(axes, bank):
    level_db = 20 * np.log10(bank.levels_pa() / bank.levels_pa().max())
    dots = axes.scatter(bank.frequencies_hz, 6.91 / bank.decays_per_s, c=np.maximum(level_db, -60), s=12)
    axes.set(xscale="log", yscale="log", xlabel="frequency [Hz]", ylabel="T60 [s]", title=bank.name)
    axes.figure.colorbar(dots, ax=axes, label="level [dB]")


def draw_shape(axes, bank, mode):
    shape, points_m = bank.shapes[mode], bank.points_m
    moved_m = points_m + 0.1 * np.ptp(points_m, axis=0).max() / np.abs(shape).max() * shape
    if len(bank.triangles):
        skin = axes.plot_trisurf(*moved_m.T, triangles=bank.triangles, cmap="viridis", linewidth=0)
        skin.set_array(np.linalg.norm(shape, axis=1)[bank.triangles].mean(axis=1))
    else:
        axes.scatter(*moved_m.T, c=np.linalg.norm(shape, axis=1))
    axes.set_box_aspect(np.maximum(np.ptp(moved_m, axis=0), 0.05 * np.ptp(moved_m, axis=0).max()))
    axes.set(title=f"{bank.frequencies_hz[mode]:.1f} Hz", xticks=[], yticks=[], zticks=[])


def draw_directions(axes, bank, mode):
    angles = np.linspace(0, 2 * np.pi, 181)
    for name, directions in (
        ("x, y", [np.cos(angles), np.sin(angles), 0 * angles]),
        ("x, z", [np.cos(angles), 0 * angles, np.sin(angles)]),
    ):
        axes.plot(angles, np.abs(bank.far_field(mode, np.stack(directions, axis=1))), label=name)
    axes.set(title="sound pressure by direction", yticklabels=[])
    axes.legend(loc="lower left")


def main():
    parser = argparse.ArgumentParser(description="Draws a bank.")
    parser.add_argument("bank")
    parser.add_argument("-o", "--output", help="a picture; default: a window")
    parser.add_argument("--mode", type=int, default=0)
    options = parser.parse_args()
    bank = ringdown.Bank.open(options.bank)
    mode = np.argsort(bank.frequencies_hz)[options.mode]
    figure = plt.figure(figsize=(13, 4), layout="constrained")
    draw_modes(figure.add_subplot(131), bank)
    draw_shape(figure.add_subplot(132, projection="3d"), bank, mode)
    if bank.has_radiation:
        draw_directions(figure.add_subplot(133, projection="polar"), bank, mode)
    if options.output:
        figure.savefig(options.output)
    else:
        plt.show()


if __name__ == "__main__":
    main()
