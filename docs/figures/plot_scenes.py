#!/usr/bin/env python3
"""Draws many sound files on one sheet: for each the waveform above and the spectrogram below, two scenes in a row.

usage: plot_scenes.py PICTURE.png SOUND.wav ...

The title of each is the name of its file. Needs Debian's python3-numpy and python3-matplotlib.

To draw docs/figures/scenes.png:
    for f in presets/scenes/*.toml; do bin/ringdown render --scene $f -o /tmp/$(basename $f .toml).wav; done
    docs/figures/plot_scenes.py docs/figures/scenes.png /tmp/{wind-chimes,dominoes,marble-rain,coin}.wav ...
"""
import pathlib
import sys

import matplotlib

matplotlib.use("Agg")
import matplotlib.pyplot as plt
import numpy as np

from plot_wave import read_wav


def draw(wave, spectrum, path):
    rate, samples = read_wav(path)
    mono = samples.mean(axis=1)
    for channel, colour in zip(samples.T, ("#0072b2", "#d55e00")):
        wave.plot(np.arange(len(mono)) / rate, channel, linewidth=0.3, color=colour, alpha=0.8, rasterized=True)
    wave.set_title(pathlib.Path(path).stem)
    wave.set_ylim(-1, 1)
    wave.set_yticks([-1, 0, 1])
    wave.tick_params(labelbottom=False)
    with np.errstate(divide="ignore"):  # digital silence is black
        spectrum.specgram(mono, NFFT=2048, Fs=rate, noverlap=1024, cmap="magma", vmin=-140, vmax=-40)
    spectrum.set_facecolor("black")
    spectrum.set_yscale("log")
    spectrum.set_ylim(80, min(20000, rate / 2))
    spectrum.set_yticks([100, 1000, 10000], ["100", "1k", "10k"])
    spectrum.set_xlim(0, len(mono) / rate)
    wave.set_xlim(spectrum.get_xlim())


def main():
    if len(sys.argv) < 3:
        sys.exit(__doc__)
    picture, *sounds = sys.argv[1:]
    rows = (len(sounds) + 1) // 2
    figure, axes = plt.subplots(
        2 * rows, 2, figsize=(12, 2.9 * rows), height_ratios=(1, 1.8) * rows, layout="constrained", squeeze=False
    )
    for place in range(2 * rows):
        row, column = divmod(place, 2)
        pair = axes[2 * row : 2 * row + 2, column]
        if place < len(sounds):
            draw(*pair, sounds[place])
        else:
            for empty in pair:
                empty.set_visible(False)
    for column in range(2):
        axes[-1, column].set_xlabel("time [s]")
    figure.supylabel("amplitude; frequency [Hz]")
    figure.savefig(picture, dpi=80)


if __name__ == "__main__":
    main()
