#!/usr/bin/python3
"""Writes presets/scenes/filling.osc: for the scene filling, water that rises in the glass from 1 s to 9 s."""
import pathlib
import struct

SCORE = pathlib.Path(__file__).resolve().parents[2] / "presets/scenes/filling.osc"
LEVELS_M, FROM_S, TO_S, STEPS = (0.07, 0.16), 1, 9, 200


def text(string):
    """As OSC has it: with a zero at the end, padded to four bytes."""
    return string.encode() + bytes(4 - len(string) % 4)


def bundle(time_s, address, number):
    message = text(address) + text(",f") + struct.pack(">f", number)
    content = b"#bundle\0" + struct.pack(">Qi", round(time_s * 2**32), len(message)) + message
    return struct.pack(">i", len(content)) + content


def main():
    low, high = LEVELS_M
    with open(SCORE, "wb") as score:
        for step in range(STEPS + 1):
            share = step / STEPS
            score.write(bundle(FROM_S + share * (TO_S - FROM_S), "/object/glass/fill", low + share * (high - low)))


if __name__ == "__main__":
    main()
