#!/usr/bin/env python3
"""Spectrograms of the preset thunder sheet, struck softly, harder and hard, each as loud as the others.

    docs/figures/plot_nonlinear.py build/bench/bin/ringdown docs/figures/nonlinear.png
"""
import sys

import numpy as np
from plot_contacts import RATE, plt, render

IMPULSES_NS = (0.001, 0.05, 0.5)
CENTROIDS_AT_S = (0.12, 0.3, 0.6, 1.0)


def centroid_hz(sound):
    power = np.abs(np.fft.rfft(sound * np.hanning(len(sound)))) ** 2
    return power @ np.fft.rfftfreq(len(sound), 1 / RATE) / power.sum()


def main():
    program, target = sys.argv[1], sys.argv[2]
    figure, axes = plt.subplots(1, 3, figsize=(11, 3.6), constrained_layout=True)
    for axis, impulse_ns in zip(axes, IMPULSES_NS):
        score = f"0.1 /object/sheet/strike 0.15 0.08 0.00025 0 0 {-impulse_ns} 0.001\n"
        sound = render(program, {"sheet": "thunder-sheet"}, score, 2.5)
        peak = np.abs(sound).max()
        centroids = [centroid_hz(sound[int(t * RATE):int(t * RATE) + 8192]) for t in CENTROIDS_AT_S]
        print(f"{impulse_ns} N s: peak per N s {peak / impulse_ns:.3f}, centroids {np.round(centroids)} Hz")
        noise = 1e-7 * np.random.default_rng(1).standard_normal(len(sound))
        axis.specgram(sound / peak + noise, NFFT=4096, Fs=RATE, noverlap=3072, vmin=-130, vmax=-40, cmap="magma")
        axis.set(title=f"{impulse_ns} N s", ylim=(0, 4000), xlabel="s", ylabel="Hz")
    figure.savefig(target, dpi=70)


if __name__ == "__main__":
    main()
