"""bake(): the bank of a bar, whose notes are known, and a process that never stays behind."""

import contextlib
import math
import os
import sys
import tempfile
import time
import unittest
import warnings
from pathlib import Path

from support import PROGRAMS, SOURCE, skip

import bank_document
import numpy as np
import ringdown
from ringdown import baking

PROGRAM = PROGRAMS / "ringdown-bake"
ROD = SOURCE / "presets" / "objects" / "steel-rod.toml"
if not PROGRAM.exists():
    skip("ringdown-bake is not built")

# Stands in for ringdown-bake: says its number and where it is, and waits for what REACTION does about SIGINT.
FAKE = """#!{python}
import os, signal, sys, time
signal.signal(signal.SIGINT, {reaction})
open({notes!r}, "w").write(str(os.getpid()))
print("0.250 modes", flush=True)
time.sleep(60)
"""


def bending_hz(length_m, diameter_m):
    """The lowest bending mode of a free round rod of steel: Euler and Bernoulli."""
    return 22.3733 / (2 * math.pi * length_m**2) * diameter_m / 4 * math.sqrt(210e9 / 7800)


class BakeTest(unittest.TestCase):
    def setUp(self):
        self.folder = Path(self.enterContext(tempfile.TemporaryDirectory()))

    def enterContext(self, context):  # unittest has it from Python 3.11 on
        stack = contextlib.ExitStack()
        self.addCleanup(stack.close)
        return stack.enter_context(context)

    def bake(self, *arguments, **options):
        with warnings.catch_warnings():
            warnings.simplefilter("ignore")  # about the kernel's sandbox
            return ringdown.bake(*arguments, program=options.pop("program", PROGRAM), **options)

    def test_bakes_a_rod_as_mechanics_says(self):
        seen = []
        out = self.folder / "rod.glb"
        bank = self.bake(ROD, out=out, progress=lambda *done: seen.append(done), preview=True, no_cache=True)
        self.assertLess(abs(bank.frequencies_hz.min() / bending_hz(0.3, 0.012) - 1), 0.02)
        self.assertEqual(bank.material.name, "steel")
        self.assertIn("modes", [stage for _, stage in seen])
        self.assertTrue(all(0 <= fraction <= 1 for fraction, _ in seen))
        model, numbers = bank_document.read_bank(out)
        np.testing.assert_allclose(bank.frequencies_hz, numbers(model["frequencies"]), rtol=1e-6)
        np.testing.assert_allclose(bank.decays_per_s, numbers(model["decayRates"]), rtol=1e-6)

    def test_passes_options_on_and_keeps_no_file_unasked(self):
        folder, tempfile.tempdir = tempfile.tempdir, str(self.folder)
        self.addCleanup(setattr, tempfile, "tempdir", folder)
        size = {"length": 200, "diameter": 20}
        bank = self.bake(ROD, "brass", set=size, band=(20, 9000), preview=True, name="rod", keep=None)
        self.assertEqual((bank.name, bank.material.name), ("rod", "brass"))
        self.assertLess(bank.frequencies_hz.max(), 9000)
        speed = math.sqrt(bank.material.youngs_modulus_pa / bank.material.density_kg_m3 / (210e9 / 7800))
        self.assertLess(abs(bank.frequencies_hz.min() / (speed * bending_hz(0.2, 0.02)) - 1), 0.05)
        self.assertEqual(list(self.folder.iterdir()), [])

    def test_failures_are_the_programs_sentences(self):
        for arguments, options, sentence, kind in (
            (("/nowhere.toml",), {}, "^cannot open /nowhere.toml", "bad_input"),
            ((ROD,), {"frob": 3}, "--frob", "bad_input"),
            ((ROD, "cheese"), {}, "cheese", "bad_input"),
            ((ROD,), {"program": "/nowhere/ringdown-bake"}, "cannot be started", "bad_input"),
            ((ROD,), {"program": "/bin/false"}, "said nothing", "failed"),
        ):
            with self.assertRaisesRegex(ringdown.Error, sentence) as caught:
                self.bake(*arguments, **options)
            self.assertEqual(caught.exception.kind, kind)

    def fake(self, reaction):
        program = self.folder / "fake-bake"
        notes = self.folder / "notes"
        program.write_text(FAKE.format(python=sys.executable, reaction=reaction, notes=str(notes)))
        program.chmod(0o755)
        return program, notes

    def interrupt(self, reaction):
        def stop(fraction, stage):
            self.assertEqual((fraction, stage), (0.25, "modes"))
            raise KeyboardInterrupt

        program, notes = self.fake(reaction)
        began = time.monotonic()
        with self.assertRaises(KeyboardInterrupt):
            self.bake(ROD, program=program, progress=stop)
        self.assertLess(time.monotonic() - began, 50, "it waited for the program's own end")
        with self.assertRaises(ProcessLookupError):
            os.kill(int(notes.read_text()), 0)

    def test_an_interrupt_ends_the_program(self):
        self.interrupt("lambda *_: sys.exit(130)")

    def test_a_program_that_ignores_it_is_killed(self):
        patience, baking.PATIENCE_S = baking.PATIENCE_S, 0.2
        try:
            self.interrupt("signal.SIG_IGN")
        finally:
            baking.PATIENCE_S = patience


if __name__ == "__main__":
    unittest.main()
