#!/usr/bin/env python3
"""Draws a sound file: waveform above, spectrogram below, one time axis.

usage: plot_wave.py SOUND.wav PICTURE.png

Reads WAV of 32-bit float, 16-bit or 32-bit integer samples. Needs Debian's python3-numpy and python3-matplotlib.
"""
import struct
import sys

import matplotlib

matplotlib.use("Agg")
import matplotlib.pyplot as plt
import numpy as np


def read_wav(path):
    """-> (sample rate [Hz], samples: frames x channels in -1 ... 1)"""
    with open(path, "rb") as file:
        data = file.read()
    if data[:4] != b"RIFF" or data[8:12] != b"WAVE":
        sys.exit(f"{path} is not a WAV file")
    position, layout, samples = 12, None, None
    while position + 8 <= len(data):
        name, size = data[position : position + 4], struct.unpack_from("<I", data, position + 4)[0]
        if name == b"fmt ":
            layout = list(struct.unpack_from("<HHIIHH", data, position + 8))
            if layout[0] == 0xFFFE:  # extensible: the format stands in its sub-format
                layout[0] = struct.unpack_from("<H", data, position + 8 + 24)[0]
        elif name == b"data":
            samples = data[position + 8 : position + 8 + size]
        position += 8 + size + size % 2
    if layout is None or samples is None:
        sys.exit(f"{path} has no samples")
    tag, channels, rate, _, _, bits = layout
    kinds = {(3, 32): ("<f4", 1.0), (1, 16): ("<i2", 2.0**15), (1, 32): ("<i4", 2.0**31)}
    if (tag, bits) not in kinds:
        sys.exit(f"{path} has {bits}-bit samples of format {tag}; only 32-bit float, 16- and 32-bit integers are read")
    kind, scale = kinds[tag, bits]
    return rate, np.frombuffer(samples, kind).reshape(-1, channels) / scale


def main():
    if len(sys.argv) != 3:
        sys.exit(__doc__)
    rate, samples = read_wav(sys.argv[1])
    time = np.arange(len(samples)) / rate
    figure, (wave, spectrum) = plt.subplots(
        2, 1, sharex=True, figsize=(11, 6.5), height_ratios=(1, 2), layout="constrained"
    )
    for channel, (name, colour) in enumerate([("left", "#0072b2"), ("right", "#d55e00")][: samples.shape[1]]):
        wave.plot(time, samples[:, channel], linewidth=0.4, color=colour, label=name, alpha=0.8)
    wave.set_ylabel("amplitude")
    wave.legend(loc="upper right")
    mono = samples.mean(axis=1)
    with np.errstate(divide="ignore"):  # digital silence is black
        _, _, _, image = spectrum.specgram(
            mono, NFFT=2048, Fs=rate, noverlap=1536, cmap="magma", vmin=-150, vmax=-40
        )
    spectrum.set_facecolor("black")
    spectrum.set_ylim(50, min(20000, rate / 2))
    spectrum.set_yscale("log")
    spectrum.set_yticks([100, 200, 500, 1000, 2000, 5000, 10000, 20000])
    spectrum.get_yaxis().set_major_formatter(matplotlib.ticker.FormatStrFormatter("%d"))
    spectrum.set_ylabel("frequency [Hz]")
    spectrum.set_xlabel("time [s]")
    figure.colorbar(image, ax=spectrum, label="power density [dB/Hz]")
    figure.savefig(sys.argv[2], dpi=110)


if __name__ == "__main__":
    main()
