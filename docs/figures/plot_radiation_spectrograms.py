#!/usr/bin/env python3
"""Spectrograms of a blow to three presets: levels of modes by frequency alone (above), and by maps of radiation (below).

    docs/figures/plot_radiation_spectrograms.py build/bench/bin docs/figures/radiation-spectrograms.png

The folder holds ringdown and ringdown-bake, which bakes the three without radiation: a minute.
"""
import pathlib
import subprocess
import sys
import tempfile

import numpy as np
from plot_contacts import RATE, plt, render

OBJECTS = pathlib.Path(__file__).resolve().parents[2] / "presets/objects"
BLOWS = {  # place [m] and impulse [N s]
    "wine-glass": "0.034 0 0.15  -0.001 0 0",
    "hand-bell": "0.05 0 0.001  -0.02 0 0",
    "steel-plate": "0.08 0.05 0.0015  0 0 -0.05",
}


def main():
    programs, target = pathlib.Path(sys.argv[1]), sys.argv[2]
    figure, axes = plt.subplots(2, 3, figsize=(12, 6.5), constrained_layout=True, sharex=True, sharey=True)
    with tempfile.TemporaryDirectory() as folder:
        for column, (name, blow) in zip(axes.T, BLOWS.items()):
            alike = pathlib.Path(folder) / f"{name}.glb"
            subprocess.run([programs / "ringdown-bake", OBJECTS / f"{name}.toml", "-q", "-o", alike], check=True)
            score = f"0.1 /object/it/strike {blow} 0.0003\n"
            for axis, (bank, how) in zip(column, ((alike, "by frequency alone"), (name, "by its maps"))):
                sound = render(programs / "ringdown", {"it": bank}, score, 2.5)
                peak = np.abs(sound).max()
                print(f"{name}, {how}: peak {20 * peak:.2f} Pa")
                noise = 1e-7 * np.random.default_rng(1).standard_normal(len(sound))
                axis.specgram(sound / peak + noise, NFFT=2048, Fs=RATE, noverlap=1536, vmin=-150, vmax=-40, cmap="magma")
                axis.set(title=f"{name}, {how}: peak {20 * peak:.1f} Pa", ylim=(0, 20000))
                axis.title.set_fontsize(9)
    for axis in axes[1]:
        axis.set_xlabel("s")
    for axis in axes[:, 0]:
        axis.set_ylabel("Hz")
    figure.savefig(target, dpi=70)


if __name__ == "__main__":
    main()
