"""A score of many events in 100 objects, and a scene: the samples of `ringdown render`, bit for bit.

10,000 events. The command reads the score as OSC, which strike.py writes.
"""

import random
import struct
import subprocess
import tempfile
import unittest
from pathlib import Path

from support import BANKS, PROGRAMS, SOURCE

import numpy as np
import ringdown
import strike

OBJECTS, SECONDS, RATE_HZ = 100, 2, 48000
EVENTS = 10000
NAMES = ("coin", "block", "glass-slat", "wrench", "spoon")


def single(number):
    """The nearest number that OSC carries: 32 bits."""
    return float(np.float32(number))


def osc_score(events):
    """A score file: each event a bundle after its length, at a time since the beginning."""
    file = b""
    for frame, message in events:
        time = round(frame / RATE_HZ * 2**32)
        bundle = b"#bundle\0" + struct.pack(">Q", time) + struct.pack(">i", len(message)) + message
        file += struct.pack(">i", len(bundle)) + bundle
    return file


def samples_of(wave_file):
    """The samples of a WAV file of 32-bit floats, frames x 2."""
    data, at = wave_file.read_bytes(), 12
    while True:
        name, size = data[at : at + 4], struct.unpack_from("<I", data, at + 4)[0]
        if name == b"data":
            return np.frombuffer(data, "<f4", size // 4, at + 8).reshape(-1, 2)
        at += 8 + size + size % 2


class Composer:
    """Each event as Python's and as OSC's, from the same numbers."""

    def __init__(self, banks):
        self.random, self.banks = random.Random(1), banks

    def number(self, low, high):
        return single(self.random.uniform(low, high))

    def vector(self, most):
        return tuple(self.number(-most, most) for _ in range(3))

    def event(self):
        frame = self.random.randrange(int(0.9 * SECONDS * RATE_HZ))
        o = self.random.randrange(OBJECTS)
        point = tuple(float(x) for x in self.random.choice(self.banks[o % len(self.banks)].points_m))
        impulse, contact_s = self.vector(0.02), self.number(0, 0.002)
        one = {"frame": frame, "object": f"o{o}"}
        do = self.random.choice(["strike"] * 6 + ["strike_vertex", "gain", "pan", "ring", "click", "contact", "clear", "choke", "change"])
        if do == "change":
            return self.change(one, o, point)
        if do == "strike":
            one.update(point_m=point, impulse_ns=impulse, contact_time_s=contact_s)
            arguments = ("strike", *point, *impulse, contact_s)
        elif do == "strike_vertex":
            one.update(vertex=o % 10, impulse_ns=impulse, contact_time_s=contact_s)
            arguments = ("strike_vertex", o % 10, *impulse, contact_s)
        elif do == "gain":
            one.update(gain=self.number(0, 1), ramp_s=self.number(0, 0.1))
            arguments = ("gain", one["gain"], one["ramp_s"])
        elif do == "pan":
            one.update(pan=self.number(-1, 1))
            arguments = ("pan", one["pan"])
        elif do == "ring":
            one.update(first=o % 5, count=2, amplitude=self.number(0, 0.02))
            arguments = ("ring", o % 5, 2, one["amplitude"])
        elif do == "click":
            one.update(impulse_ns=impulse, contact_time_s=contact_s)
            arguments = ("click", *impulse, contact_s)
        elif do == "contact":
            one.update(point_m=point, force_n=self.vector(2), slip_m_s=self.number(0, 1))
            one.update(roll_m_s=0.0, number=0, roughness_m=single(2e-6), correlation_m=single(5e-5))
            one.update(slope=single(-2.4))
            surface = (one["roughness_m"], one["correlation_m"], one["slope"])
            arguments = ("contact", *point, *one["force_n"], one["slip_m_s"], 0.0, 0, *surface)
        elif do == "choke":
            one.update(within_s=self.number(0, 0.2))
            arguments = ("choke", one["within_s"])
        else:
            one.update(ramp_s=self.number(0, 0.05))
            arguments = ("clear", one["ramp_s"])
        return {"do": do, **one}, frame, strike.message(f"/object/o{o}/{arguments[0]}", *arguments[1:])

    def change(self, one, o, point):
        """One of the changes that split a block."""
        if o % 3 == 0:
            damping = self.number(0, 5)
            one.update(do="hold", point_m=point, damping_ns_m=damping)
            message = strike.message(f"/object/o{o}/hold", *point, damping)
        elif o % 3 == 1:
            stiffness = self.number(0.5, 2)
            one.update(do="material", stiffness=stiffness)
            message = strike.message(f"/object/o{o}/material", 1.0, 1.0, 1.0, stiffness, 1.0)
        else:
            on = self.random.random() < 0.3
            one.update(do="mute", on=on)
            message = strike.message(f"/object/o{o}/mute", int(on))
        return one, one["frame"], message


class ScoreTest(unittest.TestCase):
    def rendered(self, folder, *arguments):
        output = Path(folder) / "expected.wav"
        done = subprocess.run(
            [PROGRAMS / "ringdown", "render", "--limiter=-1", "--fade=0", "-o", output, *map(str, arguments)],
            capture_output=True, text=True,
        )
        self.assertEqual((done.returncode, done.stderr), (0, ""))
        return samples_of(output)

    def assert_same(self, mine, theirs):
        self.assertGreater(np.abs(theirs).max(), 0.01)
        self.assertEqual(mine.shape, theirs.shape)
        difference = np.flatnonzero((mine.view(np.uint32) != theirs.view(np.uint32)).any(axis=1))
        self.assertEqual(difference.size, 0, f"the first frames that differ: {difference[:5]}")

    def test_of_many_events_in_100_objects_gives_the_samples_of_ringdown_render(self):
        paths = [BANKS / f"{name}.glb" for name in NAMES]
        banks = [ringdown.Bank.open(path) for path in paths]
        composer = Composer(banks)
        events = sorted((composer.event() for _ in range(EVENTS)), key=lambda event: event[1])
        with tempfile.TemporaryDirectory() as folder:
            score = Path(folder) / "score.osc"
            score.write_bytes(osc_score((frame, message) for _, frame, message in events))
            objects = [word for o in range(OBJECTS) for word in ("--object", f"o{o}={paths[o % len(paths)]}")]
            theirs = self.rendered(folder, "--events", score, "--seconds", SECONDS, "--block", 256, *objects)
        mine = ringdown.render(
            (event for event, _, _ in events),
            {f"o{o}": banks[o % len(banks)] for o in range(OBJECTS)},
            seconds=SECONDS, block_frames=256,
        )
        self.assert_same(np.ascontiguousarray(mine), theirs)

    def test_a_scene_gives_the_samples_of_ringdown_render(self):
        scene = SOURCE / "presets" / "scenes" / "coin.toml"
        with tempfile.TemporaryDirectory() as folder:
            theirs = self.rendered(folder, "--scene", scene, "--seconds", 1, "--block", 1000)
        shares = []
        mine = ringdown.render_scene(scene, 1, block_frames=1000, progress=shares.append)
        self.assert_same(np.ascontiguousarray(mine), theirs)
        self.assertEqual((shares[-1], shares), (1, sorted(shares)))

    def test_events_that_make_no_sense_are_refused(self):
        coin = {"coin": BANKS / "coin.glb"}
        for wrong in (
            [(0, "coin", (0, 0, 0))],
            [(-1, "coin", (0, 0, 0), (0, 0, 1))],
            [(float("nan"), "coin", (0, 0, 0), (0, 0, 1))],
            [(0, "bell", (0, 0, 0), (0, 0, 1))],
            [{"object": "coin", "do": "gain", "gain": 1}],
            [{"time_s": 0, "frame": 0, "object": "coin", "do": "gain", "gain": 1}],
            [{"time_s": 0, "object": "coin", "do": "render", "frames": 1}],
        ):
            with self.assertRaises(ValueError):
                ringdown.render(wrong, coin)
        with self.assertRaises(ValueError):
            ringdown.render([], coin)
        with self.assertRaises(TypeError):
            ringdown.render([{"time_s": 0, "object": "coin", "do": "gain", "volume": 1}], coin)

        class Stop(Exception):
            pass

        def stop(_):
            raise Stop

        with self.assertRaises(Stop):
            ringdown.render([], coin, seconds=1, progress=stop)


if __name__ == "__main__":
    unittest.main()
