#!/usr/bin/env python3
"""Fills a tumbler with water while it is struck: the pitch falls from 1180 to 684 Hz.

    ringdown bake tumbler_of_water.toml --radiation -o tumbler.glb
    python3 fill_tumbler.py tumbler.glb [-o filling.wav] [--seconds 8]

The bank must know its levels (bake it with [fill] and levels = 16). Blows fall on the rim, half a second apart. The
level rises at a constant speed, in 50 steps a second, each of which retunes what rings.
"""

import argparse
import wave

import numpy as np
import ringdown

RATE_HZ = 48000
STEPS_PER_S = 50
BLOW_EACH_S = 0.5


def filling(low_m, high_m, seconds):
    """The level as events: a pause, the filling, and a pause."""
    steps = int(seconds * STEPS_PER_S)
    for step in range(steps + 1):
        yield {"time_s": 1 + step / STEPS_PER_S, "do": "fill", "object": "tumbler",
               "level_m": low_m + (high_m - low_m) * step / steps}


def blows(point_m, seconds):
    for number in range(int((seconds + 2) / BLOW_EACH_S)):
        yield number * BLOW_EACH_S + 0.1, "tumbler", point_m, (-0.002, 0, 0), 0.0002


def main():
    parser = argparse.ArgumentParser(description="Fills a tumbler with water while it is struck.")
    parser.add_argument("bank", help="a bank with levels")
    parser.add_argument("-o", "--output", default="filling.wav", help="default: filling.wav")
    parser.add_argument("--seconds", type=float, default=8, help="from empty to full; default: 8")
    options = parser.parse_args()
    bank = ringdown.Bank.open(options.bank)
    low_m, high_m = bank.levels_m
    rim_m = bank.points_m[np.argmax(bank.points_m[:, 2] + 0.1 * bank.points_m[:, 0])]
    empty = [{"time_s": 0, "do": "fill", "object": "tumbler", "level_m": low_m}]
    events = empty + list(filling(low_m, high_m, options.seconds)) + list(blows(rim_m, options.seconds))
    sound = ringdown.render(events, {"tumbler": bank}, sample_rate_hz=RATE_HZ)
    samples = np.clip(np.rint(32767 * sound / np.abs(sound).max() / 2), -32768, 32767).astype("<i2")
    with wave.open(options.output, "wb") as file:
        file.setnchannels(2)
        file.setsampwidth(2)
        file.setframerate(RATE_HZ)
        file.writeframes(samples.tobytes())


if __name__ == "__main__":
    main()
