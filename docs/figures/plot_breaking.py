#!/usr/bin/env python3
"""A pane under a blow: whole, and as it breaks.

    docs/figures/plot_breaking.py build/bench/bin/ringdown docs/figures/breaking.png
"""
import pathlib
import sys

import numpy as np

from plot_contacts import RATE, plt, render

BLOW = "0.03 0.02 0.0015 0 0 -0.05 0.0001"
SHOWN = [("whole", "strike"), ("broken", "break")]


def main():
    program, output = pathlib.Path(sys.argv[1]), sys.argv[2]
    figure, axes = plt.subplots(2, 2, figsize=(11, 6), height_ratios=(1, 2), constrained_layout=True)
    for (title, verb), (wave, picture) in zip(SHOWN, axes.T):
        score = f"0 /object/pane/arm\n0.1 /object/pane/{verb} {BLOW}\n"
        heard = render(program, {"pane": "window-pane"}, score, 1.1)
        time_ms = 1000 * (np.arange(len(heard)) / RATE - 0.1)
        wave.plot(time_ms, heard, linewidth=0.5)
        wave.set(title=f"window-pane, {title}", xlim=(-5, 40), xlabel="ms", yticks=[])
        picture.specgram(heard + 1e-9, NFFT=1024, Fs=RATE, noverlap=896, vmin=-150, vmax=-60)
        picture.set(ylim=(0, 20000), xlabel="s", ylabel="Hz")
    figure.savefig(output, dpi=90)


if __name__ == "__main__":
    main()
