"""Bank, Mixer and Scene: arrays without copies, sound by closed forms, and a sentence for everything that is wrong."""

import ast
import gc
import inspect
import math
import re
import sys
import threading
import unittest
import weakref

from support import BANKS, SOURCE

import numpy as np
import ringdown

GLASS = BANKS / "wine-glass.glb"
PLATE = BANKS / "steel-plate.glb"
DOMINOES = SOURCE / "presets" / "scenes" / "dominoes.toml"


class BankTest(unittest.TestCase):
    def test_has_what_the_file_says(self):
        bank = ringdown.Bank.open(PLATE)
        self.assertEqual(bank.name, "steel-plate")
        self.assertEqual(bank.material[0], "steel")
        self.assertEqual(bank.material.youngs_modulus_pa, 210e9)
        self.assertEqual(bank.material.density_kg_m3, 7800)
        self.assertAlmostEqual(bank.mass_kg, 0.25 * 0.18 * 0.003 * 7800, places=5)
        np.testing.assert_allclose(bank.center_of_mass_m, bank.points_m.mean(axis=0), atol=0.01)
        modes, points = len(bank.frequencies_hz), len(bank.points_m)
        self.assertEqual(bank.shapes.shape, (modes, points, 3))
        self.assertEqual(bank.decays_per_s.shape, (modes,))
        self.assertEqual(bank.levels_pa().shape, (modes,))
        self.assertLess(bank.triangles.max(), points)
        of_the_material = 2e-4 * math.pi * bank.frequencies_hz  # eta omega / 2; heat, air and cords take more
        self.assertTrue((bank.decays_per_s >= 0.999 * of_the_material).all())

    def test_arrays_are_views_that_cannot_be_written_to(self):
        bank = ringdown.Bank.open(GLASS)
        for name in ("frequencies_hz", "decays_per_s", "shapes", "points_m", "triangles", "center_of_mass_m"):
            first, second = getattr(bank, name), getattr(bank, name)
            self.assertEqual(first.ctypes.data, second.ctypes.data, name)
            self.assertFalse(first.flags.owndata or first.flags.writeable, name)
            with self.assertRaises(ValueError):
                first.flags.writeable = True

    def test_arrays_keep_the_bank_alive(self):
        bank = ringdown.Bank.open(GLASS)
        shapes = bank.shapes[3:]
        before = shapes.copy()
        self.assertIs(shapes.base.base if isinstance(shapes.base, np.ndarray) else shapes.base, bank)
        del bank
        gc.collect()
        np.testing.assert_array_equal(shapes, before)

    def test_bytes_give_the_same_bank(self):
        for glb in (GLASS.read_bytes(), bytearray(GLASS.read_bytes()), memoryview(GLASS.read_bytes())):
            bank = ringdown.Bank.parse(glb)
            np.testing.assert_array_equal(bank.shapes, ringdown.Bank.open(str(GLASS)).shapes)

    def test_levels_are_the_mean_of_the_far_field(self):
        bank = ringdown.Bank.open(GLASS)
        self.assertTrue(bank.has_radiation)
        random = np.random.default_rng(1)
        directions = random.normal(size=(4000, 3))
        field = bank.far_field(0, directions)
        self.assertEqual(field.dtype, np.complex64)
        rms = math.sqrt((np.abs(field) ** 2).mean())
        omega = 2 * math.pi * bank.frequencies_hz[0]
        self.assertLess(abs(1.2041 * omega * rms / bank.levels_pa()[0] - 1), 0.05)
        np.testing.assert_allclose(bank.far_field(0, 7 * directions[0]), field[:1], rtol=1e-4)

    def test_failures_are_sentences(self):
        with self.assertRaisesRegex(ringdown.Error, "nowhere.glb") as caught:
            ringdown.Bank.open("/nowhere.glb")
        self.assertEqual(caught.exception.kind, "bad_input")
        with self.assertRaisesRegex(ringdown.Error, "broken"):
            ringdown.Bank.parse(GLASS.read_bytes()[:1000], "broken")
        bank = ringdown.Bank.open(GLASS)
        with self.assertRaises(ringdown.Error):
            bank.far_field(100000, [1, 0, 0])
        with self.assertRaises(ValueError):
            bank.far_field(0, [[1, 0]])
        for wrong in (3, None, [1.0]):
            with self.assertRaises(TypeError):
                ringdown.Bank.open(wrong)
        with self.assertRaises(ValueError):
            ringdown.Bank.open("a\0b")


class MixerTest(unittest.TestCase):
    def setUp(self):
        self.bank = ringdown.Bank.open(GLASS)
        self.mixer = ringdown.Mixer(limiter_db=None)
        self.glass = self.mixer.add(self.bank, "glass")

    def blow(self, mixer=None, factor=1.0, frame=None):
        mixer = mixer or self.mixer
        mixer.strike(self.glass, self.bank.points_m[7], [0, 0, -0.01 * factor], frame=frame)

    def test_a_mode_sounds_at_its_frequency_and_decays_as_it_should(self):
        self.mixer.ring(self.glass, 0, 1, 0.1)
        sound = self.mixer.render(48000)[:, 0].astype(float)
        mode = int(np.argmin(self.bank.frequencies_hz))
        n = np.arange(48000)
        turned = sound * np.exp(-2j * np.pi * self.bank.frequencies_hz[mode] / 48000 * n)
        early, late = turned[:12000].mean(), turned[36000:].mean()
        self.assertAlmostEqual(abs(late / early), math.exp(-0.75 * self.bank.decays_per_s[mode]), delta=0.01)
        self.assertLess(abs(np.angle(late / early)), 0.05)

    def test_blows_add_up(self):
        self.blow(factor=0.25, frame=100)
        self.blow(factor=0.75, frame=100)
        both = self.mixer.render(4000)
        other = ringdown.Mixer(limiter_db=None)
        other.add(self.bank)
        self.blow(other, frame=100)
        one = other.render(4000)
        self.assertFalse(one[:100].any())
        np.testing.assert_allclose(both, one, atol=1e-5 * np.abs(one).max())

    def test_every_layout_gets_the_same_samples(self):
        class Fake(np.ndarray):
            pass

        layouts = [
            np.empty((3000, 2), np.float32, order="F"),
            np.empty((3000, 2), np.float32),
            np.empty((6000, 4), np.float32)[::2, ::3],
            np.empty((3000, 2), np.float32)[::-1, ::-1],
            np.empty((3000, 2), np.float32, order="F").view(Fake),
            np.frombuffer(bytearray(24001), np.float32, 6000, 1).reshape(3000, 2),
        ]
        sounds = []
        for array in layouts:
            mixer = ringdown.Mixer()
            mixer.add(self.bank)
            self.blow(mixer)
            mixer.render_into(array)
            sounds.append(np.array(array))
        self.assertGreater(np.abs(sounds[0]).max(), 0)
        for sound in sounds[1:]:
            np.testing.assert_array_equal(sound, sounds[0])

    def test_refuses_arrays_that_do_not_fit(self):
        locked = np.zeros((10, 2), np.float32)
        locked.flags.writeable = False
        for array in (np.zeros((10, 2)), np.zeros(10, np.float32), np.zeros((10, 3), np.float32), locked, np.float32([1])):
            with self.assertRaises(ValueError):
                self.mixer.render_into(array)
        for frames in (-1, 2**62):
            with self.assertRaises(ValueError):
                self.mixer.render(frames)
        with self.assertRaises(ValueError):
            self.mixer.render(10, inputs=np.zeros((9, 1)))
        self.assertEqual(self.mixer.render(0).shape, (0, 2))
        self.assertEqual(self.mixer.now, 0)

    def test_failures_are_sentences_and_change_nothing(self):
        for call in (
            lambda: self.mixer.strike(99, (0, 0, 0), (0, 0, 1)),
            lambda: self.mixer.strike(self.glass, (0, 0, math.nan), (0, 0, 1)),
            lambda: self.mixer.strike(self.glass, (1000, 0, 0), (0, 0, 1)),
            lambda: self.mixer.strike(self.glass, (0, 0, 0), (0, 0, 1), contact_time_s=-1),
            lambda: self.mixer.strike_vertex(self.glass, 10**6, (0, 0, 1)),
            lambda: self.mixer.gain(self.glass, -1),
            lambda: self.mixer.add(self.bank, "no name with blanks"),
            lambda: self.mixer.material(self.glass, stiffness=0),
            lambda: self.mixer.hold(self.glass, (0, 0, 0), number=8),
            lambda: ringdown.Mixer(7),
            lambda: ringdown.Mixer(limiter_db=1),
            lambda: ringdown.Mixer(head="/nowhere.sofa"),
        ):
            with self.assertRaises(ringdown.Error) as caught:
                call()
            self.assertGreater(len(str(caught.exception)), 10)
        for call in (
            lambda: self.mixer.add("glass.glb"),
            lambda: self.mixer.strike("glass", (0, 0, 0), (0, 0, 1)),
        ):
            with self.assertRaises(TypeError):
                call()
        self.assertFalse(self.mixer.render(1000).any())
        self.assertEqual(self.mixer.status.objects, 1)

    def test_controls_do_what_they_say(self):
        level = {}
        for name, change in {
            "plain": lambda m, g: None,
            "half": lambda m, g: m.gain(g, 0.5),
            "left": lambda m, g: m.pan(g, -1),
            "mute": lambda m, g: m.mute(g),
            "held": lambda m, g: m.hold(g, self.bank.points_m[7], 100.0),
            "dead": lambda m, g: m.material(g, beta=100.0),
        }.items():
            mixer = ringdown.Mixer(limiter_db=None)
            glass = mixer.add(self.bank)
            change(mixer, glass)
            mixer.render(2048)
            self.blow(mixer)
            level[name] = np.sqrt((mixer.render(24000)[12000:] ** 2).mean(axis=0))
        np.testing.assert_allclose(level["half"], level["plain"] / 2, rtol=1e-3)
        self.assertEqual(level["left"][1], 0)
        self.assertFalse(level["mute"].any())
        self.assertLess(level["held"].max(), 0.5 * level["plain"].max())
        self.assertLess(level["dead"].max(), 0.5 * level["plain"].max())

    def test_a_listener_hears_what_is_near_louder_and_later_what_is_far(self):
        def peak_and_onset(distance_m):
            mixer = ringdown.Mixer(limiter_db=None, travel_time=True)
            glass = mixer.add(self.bank)
            mixer.listener((0, 0, 0))
            mixer.pose(glass, (distance_m, 0, 0))
            mixer.render(9600)
            self.blow(mixer)
            sound = np.abs(mixer.render(4800)).max(axis=1)
            return sound.max(), int(np.argmax(sound > 0.05 * sound.max()))

        near, far = peak_and_onset(2), peak_and_onset(8)
        self.assertAlmostEqual(near[0] / far[0], 4, delta=0.5)
        self.assertAlmostEqual((far[1] - near[1]) / 48000, 6 / 343.2, delta=0.001)

    def test_ambisonics_and_inputs(self):
        mixer = ringdown.Mixer(ambisonic_order=1)
        glass = mixer.add(self.bank)
        mixer.excite(0, glass, self.bank.points_m[7], (0, 0, 1))
        push = np.zeros((4800, 1))
        push[:48] = 1
        sphere = np.empty((4800, 4), np.float32, order="F")
        stereo = np.empty((4800, 2), np.float32)
        mixer.render_into(stereo, sphere, push)
        self.assertGreater(np.abs(sphere[:, 0]).max(), 0)
        self.assertGreater(np.abs(stereo).max(), 0)
        self.assertEqual(mixer.render_ambisonics(256).shape, (256, 4))
        with self.assertRaises(ValueError):
            self.mixer.render_into(stereo, sphere)

    def test_a_pickup_feels_the_sum_of_shapes_times_velocity(self):
        mixer = ringdown.Mixer(limiter_db=None)
        glass = mixer.add(self.bank)
        at, to, along, blow = 7, 20, np.array([0, 0.6, 0.8]), np.array([0.01, 0.002, 0])
        mixer.pickup(glass, self.bank.points_m[to], along, bus=2, gain=1e3)
        mixer.strike_vertex(glass, at, blow, contact_time_s=0, frame=100)
        felt = mixer.render_pickups(4800)
        self.assertEqual(felt.shape, (4800, 8))
        shapes, omega = self.bank.shapes, 2 * np.pi * self.bank.frequencies_hz
        decay, t = self.bank.decays_per_s, np.maximum(np.arange(4800) - 100, 0)[:, None] / 48000
        motion = np.exp(-decay * t) * (np.cos(omega * t) - decay / omega * np.sin(omega * t))
        velocity = motion @ ((shapes[:, to] @ along) * (shapes[:, at] @ blow))
        velocity[:100] = 0
        np.testing.assert_allclose(felt[:, 1], 1e3 * velocity, atol=1e-5 * 1e3 * np.abs(velocity).max())
        self.assertFalse(np.delete(felt, 1, axis=1).any())
        sound, motion = np.empty((256, 2), np.float32), np.empty((256, 8), np.float32)
        mixer.render_into(sound, pickups=motion)
        self.assertTrue(sound.any() and motion[:, 1].any())
        mixer.pickup(glass, (0, 0, 0), (0, 0, 0), bus=2)
        self.assertFalse(mixer.render_pickups(256).any())

    def test_the_rest_of_the_events(self):
        self.mixer.strike_vertex(self.glass, 3, (0, 0, 0.01))
        self.mixer.click(self.glass, (0, 0, 0.01))
        self.mixer.contact(self.glass, self.bank.points_m[7], (0, 0, -1), 0.3, roughness_m=1e-5)
        point = self.bank.points_m[7]
        self.mixer.bow(self.glass, point, (1, 0, 0), 0.2, 0.5, width_m=0.002)
        self.mixer.mallet(self.glass, point, (0, 0, -1), mass_kg=0.05)
        self.mixer.couple(self.glass, point, self.mixer.add(self.bank), point, (0, 0, 1), weight_n=1)
        with self.assertRaises(ringdown.Error):
            self.mixer.couple(self.glass, point, self.glass, point, (0, 0, 1))
        self.mixer.listener_air(30, 20)
        self.mixer.solo(self.glass)
        self.assertGreater(np.abs(self.mixer.render(4800)).max(), 0)
        status = self.mixer.status
        self.assertGreaterEqual(status.strikes, 1)
        self.assertGreater(status.ringing_modes, 0)
        self.mixer.choke(self.glass, 0.05)
        self.mixer.render(4800)
        self.mixer.strike(self.glass, point, (0, 0, 0.01))
        self.assertGreater(np.abs(self.mixer.render(4800)).max(), 0, "it rings again")
        self.mixer.clear(self.glass)
        self.mixer.listener_off()
        self.mixer.render(24000)
        self.assertLess(np.abs(self.mixer.render(4800)).max(), 1e-4)
        self.mixer.sample_rate_hz = 96000
        self.assertEqual(self.mixer.sample_rate_hz, 96000)
        self.mixer.remove(self.glass)
        with self.assertRaises(ringdown.Error):
            self.mixer.remove(self.glass)

    def test_rendering_lets_other_threads_go_on_and_is_refused_to_a_second_one(self):
        stop = threading.Event()

        def render():
            while not stop.is_set():
                try:
                    self.mixer.render(48000)
                except ringdown.Error:
                    pass  # the other one was first

        thread = threading.Thread(target=render)
        thread.start()
        refused = False
        try:
            for _ in range(100000):  # it never happens where render() keeps Python's lock
                self.blow()
                try:
                    self.mixer.render(1)
                except ringdown.Error as error:
                    refused = "another thread" in str(error)
                    break
        finally:
            stop.set()
            thread.join()
        self.assertTrue(refused)


class SceneTest(unittest.TestCase):
    def test_bodies_fall_and_keep_the_mixer_alive(self):
        mixer = ringdown.Mixer()
        scene = ringdown.Scene(mixer, DOMINOES)
        with self.assertRaises(ringdown.Error):
            ringdown.Scene(mixer, DOMINOES)
        mixer_there = weakref.ref(mixer)
        numbers, before, turned = scene.poses()
        self.assertEqual(before.shape, (len(numbers), 3))
        np.testing.assert_allclose((turned**2).sum(axis=1), 1, atol=1e-9)
        for frame in range(512, 48000, 512):
            scene.advance(frame)
            mixer.render(512)
        self.assertGreater(np.abs(scene.poses()[1] - before).max(), 0.01)
        self.assertIn(scene.find_body("block-2"), numbers)
        mixer.strike(scene.find_object("block-2"), [0, 0, 0], [0, 0, 0.01])
        for find in (scene.find_body, scene.find_object):
            with self.assertRaisesRegex(ringdown.Error, "nothing"):
                find("nothing")
        del mixer
        gc.collect()
        self.assertIsNotNone(mixer_there())
        with self.assertRaises(ringdown.Error):
            scene.push(int(numbers[-1]), (0, 0, math.inf))
        for number in numbers:
            try:
                scene.push(int(number), (0, 0, 0.001))
                break
            except ringdown.Error as error:
                self.assertIn("fixed", str(error))
        else:
            self.fail("no body can be pushed")
        with self.assertRaisesRegex(ringdown.Error, "push"):
            scene.push(10**6, (0, 0, 1))
        scene.pause()
        scene.clear()
        self.assertEqual(len(scene.poses()[0]), 0)

    def test_refuses_what_is_no_scene_or_no_mixer(self):
        with self.assertRaisesRegex(ringdown.Error, "nowhere"):
            ringdown.Scene(ringdown.Mixer(), "/nowhere.toml")
        for wrong in (None, 3, ringdown.Bank.open(GLASS)):
            with self.assertRaises(TypeError):
                ringdown.Scene(wrong, DOMINOES)


class HintsTest(unittest.TestCase):
    """The stubs say what the modules have."""

    def check(self, stub, module):
        tree = ast.parse((SOURCE / "clients/python/ringdown" / stub).read_text())
        for node in (n for n in tree.body if isinstance(n, ast.ClassDef)):
            native = getattr(module, node.name)
            written = {}
            for function in (n for n in node.body if isinstance(n, ast.FunctionDef)):
                arguments = function.args
                names = [a.arg for a in arguments.posonlyargs + arguments.args + arguments.kwonlyargs if a.arg != "self"]
                if not any(getattr(d, "attr", "") == "setter" for d in function.decorator_list):
                    written[function.name] = names
            constants = {n.target.id for n in node.body if isinstance(n, ast.AnnAssign)}
            real = {name for name in vars(native) if not name.startswith("_")}
            self.assertEqual({name for name in written if not name.startswith("_")} | constants, real, node.name)
            for name, names in written.items():
                member = inspect.getattr_static(native, name)
                text = inspect.getdoc(getattr(native, name)) or ""
                self.assertTrue(text, f"{node.name}.{name} has no docstring")
                if isinstance(member, property):
                    continue
                for argument in names:
                    self.assertIn(f"{argument}:", text, f"{node.name}.{name}")

    def test_core(self):
        self.check("_core.pyi", sys.modules["ringdown._core"])

    def test_scene(self):
        from ringdown import _scene

        self.check("_scene.pyi", _scene)

    def test_defaults_are_the_protocols(self):
        page = (SOURCE / "docs/reference/protocol.md").read_text()
        for address, name, method, argument in (
            ("strike", "contact_time", ringdown.Mixer.strike, "contact_time_s"),
            ("click", "contact_time", ringdown.Mixer.click, "contact_time_s"),
            ("ring", "amplitude", ringdown.Mixer.ring, "amplitude"),
            ("contact", "roughness", ringdown.Mixer.contact, "roughness_m"),
            ("contact", "correlation", ringdown.Mixer.contact, "correlation_m"),
            ("contact", "slope", ringdown.Mixer.contact, "slope"),
        ):
            part = page.split(f"### `/object/{{object}}/{address}`")[1].split("###")[0]
            stated = float(re.search(rf"- `{name}`:.*default (-?[0-9.e-]+)", part)[1])
            ours = float(re.search(rf"{argument}: float = (-?[0-9.e-]+)", method.__doc__)[1])
            self.assertEqual(ours, stated, f"{address} {name}")

    def test_versions_agree(self):
        text = (SOURCE / "clients/python/pyproject.toml").read_text()
        self.assertIn(f'version = "{ringdown.__version__}"', text)
        with self.assertRaises(AttributeError):
            ringdown.nothing


class BreakingTest(unittest.TestCase):
    PANE = BANKS / "window-pane.glb"
    POINT, BLOW = (0.03, 0.02, 0.0015), (0, 0, -0.05)

    def test_a_bank_says_what_it_breaks_into(self):
        bank = ringdown.Bank.open(self.PANE)
        pattern = bank.patterns[0]
        self.assertAlmostEqual(sum(piece.mass_kg for piece in pattern.pieces) / bank.mass_kg, 1, places=6)
        self.assertTrue(all(piece.object is None for piece in pattern.pieces))
        points, triangles = bank.piece_mesh(0, 3)
        self.assertEqual(points.shape[1], 3)
        self.assertLess(triangles.max(), len(points))
        self.assertEqual(ringdown.Bank.open(PLATE).patterns, ())
        with self.assertRaisesRegex(ringdown.InputError, "piece is 9999"):
            bank.piece_mesh(0, 9999)

    def test_pieces_have_half_of_the_blow_and_ring(self):
        mixer = ringdown.Mixer()
        pane = mixer.add(ringdown.Bank.open(self.PANE))
        with self.assertRaisesRegex(ringdown.Error, "arm it first"):
            mixer.break_(pane, self.POINT, self.BLOW)
        count = mixer.arm(pane)
        self.assertEqual(len(mixer.pieces(pane)), count)
        self.assertGreaterEqual(mixer.stress_pa(pane, self.POINT, self.BLOW), 0)
        pieces = mixer.break_(pane, self.POINT, self.BLOW, 1e-4, frame=480)
        self.assertEqual(len(pieces), count)
        momentum = sum(np.multiply(piece.mass_kg, piece.velocity_m_s) for piece in pieces)
        np.testing.assert_allclose(momentum, (0, 0, -0.025), atol=1e-8)
        self.assertEqual(mixer.pieces(pane), pieces)
        sound = mixer.render(4800)
        self.assertEqual(np.abs(sound[:400]).max(), 0)
        self.assertGreater(np.abs(sound[960:]).max(), 1e-4)
        mixer.mend(pane)
        with self.assertRaisesRegex(ringdown.Error, "arm it first"):
            mixer.pieces(pane)

    def test_an_imparted_motion_sounds_as_a_mode_that_is_struck(self):
        bank = ringdown.Bank.open(PLATE)
        lowest = int(np.argmin(bank.frequencies_hz))
        sounds = []
        for phase_rad in (0, 2 * math.pi):
            mixer = ringdown.Mixer(limiter_db=None)
            mixer.impart(mixer.add(bank), 0, 1.0, phase_rad)
            sounds.append(mixer.render(9600)[:, 0])
        np.testing.assert_allclose(sounds[0], sounds[1], atol=1e-6 * np.abs(sounds[0]).max())
        time_s = np.arange(9600) / 48000
        decay, omega = bank.decays_per_s[lowest], 2 * math.pi * bank.frequencies_hz[lowest]
        waves = np.exp(-decay * time_s) * np.array([np.sin(omega * time_s), np.cos(omega * time_s)])
        share, *_ = np.linalg.lstsq(waves.T, sounds[0], rcond=None)  # of its radiation, which has a phase
        self.assertLess(np.abs(sounds[0] - share @ waves).max(), 0.01 * np.abs(share).max())


if __name__ == "__main__":
    unittest.main()
