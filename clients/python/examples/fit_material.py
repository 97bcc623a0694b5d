#!/usr/bin/env python3
"""Fits a material to a recording of one blow: Young's modulus over density from the notes, damping from the decays.

    python3 fit_material.py rod.glb                  a recording that the script makes itself, of a material that it knows
    python3 fit_material.py rod.glb recording.wav    your own (16 bits); the bank has the shape and any homogeneous material

All notes of a shape are proportional to sqrt(E / rho), and a mode of angular frequency omega decays as exp(-d t) with
d = eta omega / 2 if only the material takes energy, whose loss factor is eta. `ringdown fit` does this with errors, for
close modes, and takes off what air, heat and supports take.
"""

import sys
import wave

import numpy as np
import ringdown


def fit(bank, sound, rate_hz):
    """E / rho [m^2/s^2] and the loss factor of one blow, which `sound` begins with."""
    # The notes: peaks of the spectrum that stand out from 100 Hz around them, down to 40 dB below the loudest. The window
    # falls from the blow on.
    spectrum = np.abs(np.fft.rfft(sound * np.hanning(2 * len(sound))[len(sound) :]))
    width = 100 * len(sound) // rate_hz
    around = np.lib.stride_tricks.sliding_window_view(np.pad(spectrum, width, mode="edge"), 2 * width + 1)
    stands_out = (spectrum == around.max(axis=1)) & (spectrum > 3 * around.min(axis=1))
    peaks_hz = np.fft.rfftfreq(len(sound), 1 / rate_hz)[stands_out & (spectrum > 1e-2 * spectrum.max())]

    # The ratio to the bank's notes, within an octave up or down, that brings most peaks to modes; then the exact one.
    def distances(ratio):
        return np.log(peaks_hz[:, None] / (ratio * bank.frequencies_hz))

    ratios = np.exp2(np.arange(-1, 1, 0.001))
    ratio = max(ratios, key=lambda r: np.exp(-((np.abs(distances(r)).min(axis=1) / 0.002) ** 2)).sum())
    nearest = np.abs(distances(ratio)).argmin(axis=1)
    matches = np.abs(distances(ratio))[np.arange(len(nearest)), nearest] < 0.005
    peaks_hz, modes_hz = peaks_hz[matches], bank.frequencies_hz[nearest[matches]]
    ratio = (peaks_hz @ modes_hz) / (modes_hz @ modes_hz)

    # The decays: each note's energy in windows of 5 ms, down to 40 dB. Of energies that fall by a factor q from window to
    # window, the mean window is q / (1 - q).
    window = np.hanning(rate_hz // 200)
    turns = np.exp(-2j * np.pi * np.outer(peaks_hz, np.arange(len(sound)) / rate_hz)) * sound
    windows = turns[:, : len(sound) // len(window) * len(window)].reshape(len(peaks_hz), -1, len(window))
    energy = np.abs(windows @ window) ** 2
    energy[np.minimum.accumulate(energy, axis=1) < 1e-4 * energy[:, :1]] = 0
    mean = energy @ np.arange(energy.shape[1]) / energy.sum(axis=1)
    decays_per_s = np.log(1 + 1 / mean) / 2 * rate_hz / len(window)
    baked = bank.material.youngs_modulus_pa / bank.material.density_kg_m3
    return baked * ratio**2, np.median(decays_per_s / (np.pi * peaks_hz))


def own_recording(bank):
    """Two seconds of the bank's shape in another material: 0.8 times as stiff, twenty times as lossy, without air and heat."""
    mixer = ringdown.Mixer(limiter_db=None)
    thing = mixer.add(bank)
    mixer.material(thing, stiffness=0.8, beta=20, heat=0, air=0)
    mixer.strike(thing, bank.points_m[0], (0.003, 0.01, 0.01), contact_time_s=2e-4)
    sound = mixer.render(2 * 48000).mean(axis=1)
    return sound + 1e-6 * np.random.default_rng(1).normal(size=len(sound)), 48000


def read(path):
    with wave.open(path) as file:
        samples = np.frombuffer(file.readframes(file.getnframes()), "<i2")
        return samples.reshape(-1, file.getnchannels()).mean(axis=1) / 32768, file.getframerate()


if __name__ == "__main__":
    the_bank = ringdown.Bank.open(sys.argv[1])
    ratio_pa, loss_factor = fit(the_bank, *(read(sys.argv[2]) if len(sys.argv) > 2 else own_recording(the_bank)))
    print(f"E / rho = {ratio_pa:.5g} m^2/s^2, loss factor = {loss_factor:.3g}")
    if the_bank.material:
        print(f"with the bank's density: E = {ratio_pa * the_bank.material.density_kg_m3 / 1e9:.4g} GPa")
