#!/usr/bin/python3
"""Writes the scores of scenes: presets/scenes/filling.osc and bottles.osc."""
import pathlib
import struct

SCENES = pathlib.Path(__file__).resolve().parents[2] / "presets/scenes"
# filling: water rises in the glass.
LEVELS_M, FROM_S, TO_S, STEPS = (0.07, 0.16), 1, 9, 200
# bottles: each is slapped, then each is blown.
BOTTLES = {"do": 1, "re": 8 / 9, "mi": 4 / 5, "fa": 3 / 4, "sol": 2 / 3, "la": 3 / 5, "ti": 8 / 15, "high-do": 1 / 2}  # sizes
SLAPS_S, BLOWS_S, BREATH_S = (3.2, 0.3), (6, 0.6), 0.5  # the first and the step to the next; how long a breath lasts
SLAP_NS, BREATH_PA = 0.0005, 300  # a slap is of one pressure, whatever the size of the mouth


def text(string):
    """As OSC has it: with a zero at the end, padded to four bytes."""
    return string.encode() + bytes(4 - len(string) % 4)


def bundle(time_s, address, number):
    message = text(address) + text(",f") + struct.pack(">f", number)
    content = b"#bundle\0" + struct.pack(">Qi", round(time_s * 2**32), len(message)) + message
    return struct.pack(">i", len(content)) + content


def filling():
    low, high = LEVELS_M
    for step in range(STEPS + 1):
        share = step / STEPS
        yield FROM_S + share * (TO_S - FROM_S), "/object/glass/fill", low + share * (high - low)


def bottles():
    for number, (name, size) in enumerate(BOTTLES.items()):
        first_s, step_s = SLAPS_S
        yield first_s + number * step_s, f"/object/{name}/slap", SLAP_NS * size**2
    for number, name in enumerate(BOTTLES):
        first_s, step_s = BLOWS_S
        yield first_s + number * step_s, f"/object/{name}/blow", BREATH_PA
        yield first_s + number * step_s + BREATH_S, f"/object/{name}/blow", 0


def main():
    for score in (filling, bottles):
        (SCENES / f"{score.__name__}.osc").write_bytes(b"".join(bundle(*event) for event in score()))


if __name__ == "__main__":
    main()
