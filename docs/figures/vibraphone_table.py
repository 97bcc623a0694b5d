#!/usr/bin/env python3
"""Checks the tuned bars of presets/banks/vibraphone twice and prints the table of docs/how/logs/vibraphone.tsv.

usage: vibraphone_table.py BIN OBJECTS BANKS

BIN is the folder of the programs. Each bar is baked again by elements of another order on another, finer mesh, which the
tuner never saw; and each bank is struck, rendered by `ringdown render`, and its pitch measured from the wave: the peak of the
spectrum of a long Gaussian window, between bins by a parabola through its logarithm, which for that window is exact.
Needs Debian's python3-numpy.
"""
import os
import struct
import subprocess
import sys
import tempfile
import tomllib

import numpy as np

NAMES = "C Cs D Ds E F Fs G Gs A As B".split()
RATE, SECONDS = 48000, 6
FINER = ["--element", "tet20", "--mesh-size", "0.0078"]


def score(path, point, impulse):
    """One strike at time 0, in scsynth's format."""
    def text(word):
        word = word.encode() + b"\0"
        return word + b"\0" * (-len(word) % 4)

    message = text("/object/bar/strike") + text(",ffffff") + struct.pack(">6f", *point, *impulse)
    bundle = b"#bundle\0" + struct.pack(">Q", 1) + struct.pack(">i", len(message)) + message
    with open(path, "wb") as file:
        file.write(struct.pack(">i", len(bundle)) + bundle)


def read_left(path):
    with open(path, "rb") as file:
        data = file.read()
    at = data.index(b"data")
    channels = struct.unpack_from("<H", data, data.index(b"fmt ") + 10)[0]
    return np.frombuffer(data, "<f4", -1, at + 8)[::channels].astype(float)


def peak(wave, near_hz, reach):
    """Frequency [Hz] of the strongest partial no more than this share away from near_hz."""
    count = min(len(wave), RATE * SECONDS)
    window = np.exp(-0.5 * ((np.arange(count) - count / 2) / (count / 8)) ** 2)
    spectrum = np.abs(np.fft.rfft(wave[:count] * window, 4 * count))
    bin_hz = RATE / (4 * count)
    low, high = int(near_hz * (1 - reach) / bin_hz), int(near_hz * (1 + reach) / bin_hz)
    top = low + int(np.argmax(spectrum[low:high]))
    a, b, c = np.log(spectrum[top - 1 : top + 2])
    return (top + 0.5 * (a - c) / (a - 2 * b + c)) * bin_hz


def cents(frequency, target):
    return 1200 * np.log2(frequency / target)


def finer(program, item, folder, top_hz):
    bank = os.path.join(folder, "finer.glb")
    subprocess.run([program, item, "-q", "-o", bank, "--band", "60", str(top_hz), "--keep", "60"] + FINER, check=True)
    return bank


def measure(bin_folder, name, objects, banks, folder):
    target = 440 * 2 ** ((12 * (int(name[-1]) + 1) + NAMES.index(name[:-1]) - 69) / 12)
    item, bank = os.path.join(objects, name + ".toml"), os.path.join(banks, name + ".glb")
    with open(item, "rb") as file:
        parameters = tomllib.load(file)["parameters"]
    fine = finer(os.path.join(bin_folder, "ringdown-bake"), item, folder, 11 * target)
    found = []
    for source in (bank, fine):
        osc, sound = os.path.join(folder, "bar.osc"), os.path.join(folder, "bar.wav")
        score(osc, (0.4 * parameters["length"] / 1000, 0, parameters["thickness"] / 1000), (0, 0, -1e-4))
        subprocess.run([os.path.join(bin_folder, "ringdown"), "render", "--events", osc, "--object", "bar=" + source,
                        "--seconds", str(SECONDS), "-o", sound], check=True, stdout=subprocess.DEVNULL)
        found.append(read_left(sound))
    return parameters, target, found


def main():
    bin_folder, objects, banks = sys.argv[1:4]
    names = [f"{note}{octave}" for octave in range(0, 9) for note in NAMES
             if os.path.exists(os.path.join(objects, f"{note}{octave}.toml"))]
    print("note\ttarget Hz\tlength mm\tarch mm\tfrom the wave, cents\tother bake, cents\tf2/f1\tother f2/f1\tf3/f1\tkB")
    worst = [0.0, 0.0]
    with tempfile.TemporaryDirectory() as folder:
        for name in names:
            parameters, target, waves = measure(bin_folder, name, objects, banks, folder)
            off = [cents(peak(wave, target, 0.1), target) for wave in waves]
            ratio = [peak(wave, 4 * target, 0.02) / peak(wave, target, 0.1) for wave in waves]
            worst = [max(w, abs(o)) for w, o in zip(worst, off)]
            third = [peak(wave, 10 * target, 0.003) / peak(wave, target, 0.1) for wave in waves]
            size = os.path.getsize(os.path.join(banks, name + ".glb")) / 1000
            columns = [name.replace("s", "#"), f"{target:.2f}", f"{parameters['length']:.2f}", f"{parameters['arch_depth']:.3f}",
                       f"{off[0]:+.2f}", f"{off[1]:+.2f}", f"{ratio[0]:.4f}", f"{ratio[1]:.4f}", f"{third[0]:.3f}", f"{size:.0f}"]
            print("\t".join(columns), flush=True)
    print(f"Largest deviation: {worst[0]:.2f} cents from the wave, {worst[1]:.2f} in the other bake.", file=sys.stderr)


if __name__ == "__main__":
    main()
