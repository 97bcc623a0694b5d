#!/usr/bin/env python3
"""Draws the sound of a scene, its waveform and its spectrogram.

    python3 plot_scene.py dominoes.toml [-o dominoes.png] [--seconds 3]
"""

import argparse

import matplotlib.pyplot as plt
import numpy as np
import ringdown

RATE_HZ = 48000


def main():
    parser = argparse.ArgumentParser(description="Draws the sound of a scene.")
    parser.add_argument("scene")
    parser.add_argument("-o", "--output", help="a picture; default: a window")
    parser.add_argument("--seconds", type=float, help="default: as long as the file says")
    options = parser.parse_args()
    sound = ringdown.render_scene(options.scene, options.seconds, sample_rate_hz=RATE_HZ)
    figure, (above, below) = plt.subplots(2, 1, sharex=True, figsize=(10, 6), layout="constrained")
    above.plot(np.arange(len(sound)) / RATE_HZ, sound, linewidth=0.5)
    above.set(ylabel="left and right", title=options.scene)
    below.specgram(sound.mean(axis=1) + 1e-9, NFFT=2048, Fs=RATE_HZ, noverlap=1024, vmin=-160)
    below.set(xlabel="time [s]", ylabel="frequency [Hz]", yscale="log", ylim=(50, 20000))
    if options.output:
        figure.savefig(options.output)
    else:
        plt.show()


if __name__ == "__main__":
    main()
