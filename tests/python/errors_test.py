"""Wrong values are InputError, which is an Error and a ValueError; wrong types are TypeError. Nothing else is raised."""

import inspect
import math
import unittest

from support import BANKS, SOURCE

import numpy as np
import ringdown

GLASS = BANKS / "wine-glass.glb"
DOMINOES = SOURCE / "presets" / "scenes" / "dominoes.toml"


class ErrorsTest(unittest.TestCase):
    def setUp(self):
        self.bank = ringdown.Bank.open(GLASS)
        self.mixer = ringdown.Mixer()
        self.glass = self.mixer.add(self.bank, "glass")

    def test_wrong_values_are_input_errors(self):
        self.assertTrue(issubclass(ringdown.InputError, ringdown.Error))
        self.assertTrue(issubclass(ringdown.InputError, ValueError))
        mixer, glass, point, blow = self.mixer, self.glass, (0, 0, 0), (0, 0, 0.01)
        plain = ringdown.Mixer()
        for call in (
            lambda: ringdown.Bank.open("/nowhere.glb"),
            lambda: ringdown.Bank.open("a\0b"),
            lambda: ringdown.Bank.open("/"),
            lambda: ringdown.Bank.parse(b"no bank"),
            lambda: ringdown.Mixer(head="/nowhere.sofa"),
            lambda: ringdown.Mixer(head=SOURCE / "README.md"),
            lambda: ringdown.Mixer(1),
            lambda: ringdown.Mixer(limiter_db=3),
            lambda: ringdown.Mixer(threads=2**40),
            lambda: ringdown.Mixer(ambisonic_order=-1),
            lambda: mixer.strike(-1, point, blow),
            lambda: mixer.strike(2**70, point, blow),
            lambda: mixer.strike(99, point, blow),
            lambda: mixer.strike(glass, (0, 0), blow),
            lambda: mixer.strike(glass, (0, 0, 0, 0), blow),
            lambda: mixer.strike(glass, point, np.zeros(2)),
            lambda: mixer.strike(glass, (0, 0, math.nan), blow),
            lambda: mixer.strike(glass, (0, 0, 100), blow),
            lambda: mixer.strike(glass, point, blow, frame=2**70),
            lambda: mixer.excite(0, glass, (0, 0, 100), blow),
            lambda: mixer.excite(4, glass, point, blow),
            lambda: mixer.hold(glass, (0, 0, 100)),
            lambda: mixer.listener(point, (1, 0, 0)),
            lambda: mixer.listener(point, (1, 1, 0, 0)),
            lambda: mixer.add(self.bank, "a b"),
            lambda: mixer.add(self.bank, "a\0b"),
            lambda: mixer.remove(7),
            lambda: mixer.render(-1),
            lambda: mixer.render(10, inputs=np.zeros((9, 1))),
            lambda: mixer.render_into(np.zeros((9, 3), np.float32)),
            lambda: mixer.render_into(np.zeros((9, 2), np.float32), np.zeros((9, 4), np.float32)),
            lambda: setattr(mixer, "sample_rate_hz", 1),
            lambda: self.bank.far_field(0, [[1, 0]]),
            lambda: self.bank.far_field(0, [0, 0, 0]),
            lambda: self.bank.far_field(-1, [1, 0, 0]),
            lambda: self.bank.far_field(10**6, [1, 0, 0]),
            lambda: ringdown.Scene(plain, "/nowhere.toml"),
            lambda: ringdown.Scene(plain, DOMINOES, frame=2**70),
            lambda: ringdown.render([(0, "bell", point, blow)], {"glass": self.bank}),
            lambda: ringdown.render([(0, "glass")], {"glass": self.bank}),
            lambda: ringdown.render([(math.inf, "glass", point, blow)], {"glass": self.bank}),
            lambda: ringdown.render([(-1, "glass", point, blow)], {"glass": self.bank}),
            lambda: ringdown.render([], {}, seconds=-1),
            lambda: ringdown.render([], {}, seconds=1, block_frames=0),
            lambda: ringdown.render_scene("/nowhere.toml"),
            lambda: ringdown.bake("/nowhere.stl", "steel", program="/nowhere/ringdown-bake"),
        ):
            with self.assertRaises(ringdown.InputError, msg=inspect.getsource(call)) as caught:
                call()
            self.assertEqual(caught.exception.kind, "bad_input")
            self.assertGreater(len(str(caught.exception)), 10)

    def test_wrong_types_are_type_errors(self):
        mixer, glass, point, blow = self.mixer, self.glass, (0, 0, 0), (0, 0, 0.01)
        for call in (
            lambda: ringdown.Bank.open(3),
            lambda: ringdown.Bank.parse("text"),
            lambda: ringdown.Mixer("48000"),
            lambda: mixer.add("glass.glb"),
            lambda: mixer.strike("glass", point, blow),
            lambda: mixer.strike(0.5, point, blow),
            lambda: mixer.strike(glass, "000", blow),
            lambda: mixer.strike(glass, ("0", "0", "0"), blow),
            lambda: mixer.strike(glass, 0.0, blow),
            lambda: mixer.strike(glass, point),
            lambda: mixer.strike(glass, point, blow, where=3),
            lambda: mixer.gain(glass, "loud"),
            lambda: mixer.render(1.5),
            lambda: ringdown.Scene(None, DOMINOES),
            lambda: ringdown.render([("0", "glass", point, blow)], {"glass": self.bank}),
            lambda: ringdown.render([{"frame": 0.5, "object": "glass"}], {"glass": self.bank}),
        ):
            with self.assertRaises(TypeError, msg=inspect.getsource(call)):
                call()

    def test_what_is_impossible_now_is_an_error_that_is_no_input_error(self):
        scene = ringdown.Scene(self.mixer, DOMINOES)
        with self.assertRaises(ringdown.Error) as caught:
            ringdown.Scene(self.mixer, DOMINOES)
        self.assertNotIsInstance(caught.exception, ValueError)
        self.assertEqual(caught.exception.kind, "refused")
        scene.clear()

    def test_sentences_name_the_arguments_of_python(self):
        for name, call in {
            "contact_time_s": lambda: self.mixer.strike(self.glass, (0, 0, 0), (0, 0, 1), 3),
            "impulse_ns": lambda: self.mixer.strike(self.glass, (0, 0, 0), (0, 0, math.nan)),
            "point_m": lambda: self.mixer.strike(self.glass, (0, math.inf, 0), (0, 0, 1)),
            "velocity_m_s": lambda: self.mixer.mallet(self.glass, (0, 0, 0), (0, 0, 1e9)),
            "ramp_s": lambda: self.mixer.gain(self.glass, 1, -1),
            "rotation_wxyz": lambda: self.mixer.pose(self.glass, (0, 0, 0), (7, 0, 0, 0)),
            "damping_ns_m": lambda: self.mixer.hold(self.glass, (0, 0, 0), -1),
            "input": lambda: self.mixer.excite(4, self.glass, (0, 0, 0), (0, 0, 1)),
        }.items():
            with self.assertRaisesRegex(ringdown.InputError, "^" + name):
                call()


if __name__ == "__main__":
    unittest.main()
