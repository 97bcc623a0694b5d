"""The table of directions through `import ringdown`: sides.py TABLE BANK OUT writes the samples of eight channels.

One after the other: left and right, ambisonic channels 0 to 3, and the left and right ear of libmysofa's head.
"""

import sys

import numpy as np
import ringdown

SLOT, STRIKE = 12288, 4096  # frames of a case, and when its object is struck


def play(cases, bank, **settings):
    mixer = ringdown.Mixer(limiter_db=None, **settings)
    for number, (name, *numbers) in enumerate(cases):
        thing = mixer.add(bank, name)
        mixer.listener(numbers[:3], numbers[3:7], frame=number * SLOT)
        mixer.pose(thing, numbers[7:10], numbers[10:14], frame=number * SLOT)
        mixer.strike(thing, (0.5, 0.5, 0.5), (0, 0, 0.02), 0, frame=number * SLOT + STRIKE)
    stereo = np.zeros((len(cases) * SLOT, 2), np.float32, order="F")
    field = np.zeros((len(stereo), 4), np.float32, order="F") if "ambisonic_order" in settings else None
    mixer.render_into(stereo, field)
    return [stereo] if field is None else [stereo, field]


table, bank_file, out = sys.argv[1:]
rows = [line.split() for line in open(table) if line.strip() and not line.startswith("#")]
given = [(row[0], *map(float, row[1:15])) for row in rows]
bank = ringdown.Bank.open(bank_file)
channels = play(given, bank, ambisonic_order=1) + play(given, bank, head="")
with open(out, "wb") as file:
    for sound in channels:
        file.write(sound.T.astype("<f4").tobytes())
