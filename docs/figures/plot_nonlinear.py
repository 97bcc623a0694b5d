#!/usr/bin/env python3
"""Spectrograms of thin presets, struck softly, harder and hard, each as loud as the others.

    docs/figures/plot_nonlinear.py build/bench/bin/ringdown docs/figures/nonlinear.png
"""
import sys

import numpy as np
from PIL import Image
from plot_contacts import RATE, plt, render

WINDOW = 4096
# preset, where it is struck [m], blows [N s], their length [s], the band whose loudest line is printed [Hz] or 0 for the
# centroid above 20 Hz, and what the picture shows [s, Hz]
ROWS = (
    ("thunder-sheet", "0.15 0.08 0.00025", (0.001, 0.01, 0.05), 0.001, 0, 2.5, 4000),
    ("opera-gong", "0.02 0.01 0", (0.005, 0.05, 0.3), 0.002, (300, 450), 2.5, 2000),
    ("crash-cymbal", "0.12 0.05 -0.005", (0.002, 0.02, 0.1), 0.002, 0, 2.5, 3000),
    ("tam-tam", "0.12 0.05 0.004", (0.02, 0.2, 1.5), 0.006, 0, 4, 1500),
)
STRUCK_AT_S = 0.1
PRINTED_AT_S = (0, 0.2, 0.6, 1.0, 2.0)  # after the blow


def pitch_hz(band_hz, sound):
    points = 8 * WINDOW
    frequencies = np.fft.rfftfreq(points, 1 / RATE)
    power = np.abs(np.fft.rfft(sound * np.hanning(len(sound)), points)) ** 2
    if not band_hz:
        power[frequencies < 20] = 0
        return power @ frequencies / power.sum()
    return frequencies[np.where((frequencies > band_hz[0]) & (frequencies < band_hz[1]), power, 0).argmax()]


def main():
    program, target = sys.argv[1], sys.argv[2]
    figure, axes = plt.subplots(len(ROWS), 3, figsize=(11, 3.1 * len(ROWS)), constrained_layout=True)
    for (preset, place, impulses_ns, contact_s, band_hz, seconds, top_hz), row in zip(ROWS, axes):
        for axis, impulse_ns in zip(row, impulses_ns):
            score = f"{STRUCK_AT_S} /object/it/strike {place} 0 0 {-impulse_ns} {contact_s}\n"
            sound = render(program, {"it": preset}, score, seconds)
            peak = np.abs(sound).max()
            starts = [round((STRUCK_AT_S + contact_s + t) * RATE) for t in PRINTED_AT_S]
            pitches = [pitch_hz(band_hz, sound[s:s + WINDOW]) for s in starts]
            print(f"{preset}, {impulse_ns} N s: peak {peak:.3g}, {np.round(pitches)} Hz")
            noise = 1e-7 * np.random.default_rng(1).standard_normal(len(sound))
            axis.specgram(sound / peak + noise, NFFT=WINDOW, Fs=RATE, noverlap=3072, vmin=-130, vmax=-40, cmap="magma")
            axis.set(title=f"{preset}, {impulse_ns} N s", ylim=(0, top_hz), xlabel="s", ylabel="Hz")
    figure.savefig(target, dpi=70)
    Image.open(target).convert("P", palette=Image.Palette.ADAPTIVE, colors=64).save(target, optimize=True)


if __name__ == "__main__":
    main()
