"""The code of docs/use/python.md runs as it stands there, and the examples do what they say."""

import contextlib
import importlib.util
import io
import os
import re
import subprocess
import sys
import tempfile
import unittest
import warnings
import wave
from pathlib import Path

from support import BANKS, PROGRAMS, SOURCE

import numpy as np
import ringdown

EXAMPLES = SOURCE / "clients" / "python" / "examples"


def in_a_folder(test):
    """A folder that has the presets, as the source folder has."""
    folder = tempfile.TemporaryDirectory()
    test.addCleanup(folder.cleanup)
    test.addCleanup(os.chdir, os.getcwd())
    os.chdir(folder.name)
    Path("presets").symlink_to(SOURCE / "presets")
    return Path(folder.name)


class PageTest(unittest.TestCase):
    def test_the_pages_code_runs(self):
        folder = in_a_folder(self)
        text = (SOURCE / "docs/use/python.md").read_text()
        blocks = re.findall(r"^```python\n(.*?)^```", text, flags=re.S | re.M)
        self.assertGreater(len(blocks), 5)
        names, output = {}, io.StringIO()
        os.environ["RINGDOWN_BAKE"] = str(PROGRAMS / "ringdown-bake")
        os.environ["RINGDOWN_PRESETS"] = str(SOURCE / "presets")
        with contextlib.redirect_stdout(output), warnings.catch_warnings():
            warnings.simplefilter("ignore")  # about the kernel's sandbox
            for block in blocks:
                exec(compile(block, "docs/use/python.md", "exec"), names)
        said = output.getvalue()
        self.assertIn("(96000, 2) float32", said)
        self.assertIn("bad_input - ", said)
        with wave.open(str(folder / "bell.wav")) as file:
            samples = np.frombuffer(file.readframes(96000), "<i2").reshape(-1, 2)
        self.assertGreater(np.abs(samples[:24000]).max(), 100)
        self.assertLess(np.abs(samples[72000:].astype(float)).max(), np.abs(samples[24000:48000]).max())
        self.assertGreater(names["plate"].frequencies_hz.min(), 20)


    def test_the_code_of_the_page_on_breaking_runs(self):
        in_a_folder(self)
        text = (SOURCE / "docs/use/breaking.md").read_text()
        (block,) = re.findall(r"^```python\n(.*?)^```", text, flags=re.S | re.M)
        names, output = {}, io.StringIO()
        with contextlib.redirect_stdout(output):
            exec(compile(block, "docs/use/breaking.md", "exec"), names)
        self.assertGreater(len(output.getvalue().splitlines()), 20)
        self.assertGreater(np.abs(names["sound"]).max(), 1e-3)


class ExampleTest(unittest.TestCase):
    def test_a_material_is_found_in_a_recording(self):
        spec = importlib.util.spec_from_file_location("fit_material", EXAMPLES / "fit_material.py")
        example = importlib.util.module_from_spec(spec)
        spec.loader.exec_module(example)
        bank = ringdown.Bank.open(BANKS / "steel-rod.glb")
        ratio, loss_factor = example.fit(bank, *example.own_recording(bank))
        self.assertLess(abs(ratio / (0.8 * 210e9 / 7800) - 1), 1e-3)
        self.assertLess(abs(loss_factor / (20 * 2e-4) - 1), 0.05)

    def test_a_file_is_read_as_well(self):
        folder = in_a_folder(self)
        rate_hz, bank = 44100, ringdown.Bank.open(BANKS / "steel-rod.glb")
        mixer = ringdown.Mixer(rate_hz)
        mixer.strike(mixer.add(bank), bank.points_m[0], (0.1, 0.2, 0.2))
        with wave.open(str(folder / "rod.wav"), "wb") as file:
            file.setparams((2, 2, rate_hz, 0, "NONE", ""))
            file.writeframes((32767 * mixer.render(2 * rate_hz)).astype("<i2").tobytes())
        said = self.run_example("fit_material.py", BANKS / "steel-rod.glb", folder / "rod.wav")
        self.assertRegex(said, r"E = (209|210|211)(\.\d)? GPa")

    def test_pictures_are_drawn(self):
        if not importlib.util.find_spec("matplotlib"):
            self.skipTest("python3-matplotlib is not installed")
        folder = in_a_folder(self)
        self.run_example("plot_bank.py", BANKS / "coin.glb", "-o", folder / "coin.png", "--mode", 1)
        self.run_example("plot_scene.py", SOURCE / "presets/scenes/coin.toml", "--seconds", 0.5, "-o", folder / "scene.png")
        for picture in ("coin.png", "scene.png"):
            self.assertEqual((folder / picture).read_bytes()[1:4], b"PNG")

    def run_example(self, name, *arguments):
        done = subprocess.run(
            [sys.executable, "-B", EXAMPLES / name, *map(str, arguments)], capture_output=True, text=True
        )
        self.assertEqual((done.returncode, done.stderr), (0, ""))
        return done.stdout


if __name__ == "__main__":
    unittest.main()
