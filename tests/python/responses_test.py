"""`ringdown frf` and `ringdown picture --directivity` write what Bank says, in forms that other programs read."""

import csv
import io
import subprocess
import tempfile
import unittest
from pathlib import Path

from support import BANKS, PROGRAMS, skip

import numpy as np
import ringdown

BELL, RODS = BANKS / "bronze-bell.glb", BANKS / "steel-rod.glb"
for program in ("ringdown", "ringdown-frf", "ringdown-picture"):
    if not (PROGRAMS / program).exists():
        skip(f"{program} is not built")


def run(*words, code=0):
    done = subprocess.run([PROGRAMS / "ringdown", *map(str, words)], capture_output=True, text=True)
    assert done.returncode == code, done.stdout + done.stderr
    return done.stdout + done.stderr


def table(text):
    rows = list(csv.reader(io.StringIO(text)))
    return {name: np.array(column, float) for name, column in zip(rows[0], zip(*rows[1:]))}


class ResponsesTest(unittest.TestCase):
    def setUp(self):
        holder = tempfile.TemporaryDirectory()
        self.addCleanup(holder.cleanup)
        self.folder = Path(holder.name)
        self.bank = ringdown.Bank.open(BELL)
        self.at, self.to = ((0.1, 0.0, 0.05), (-0.02, 0.1, 0.03))

    def places(self):
        text = lambda v: ",".join(map(str, v))
        return ("--at", text(self.at), "--direction", "1,2,0", "--to", text(self.to), "--to-direction", "0,0,-1")

    def test_a_table_is_what_python_says(self):
        for kind in ("receptance", "mobility", "accelerance"):
            run("frf", BELL, "-o", self.folder / "a.csv", *self.places(), "--kind", kind, "--count", 50)
            got = table((self.folder / "a.csv").read_text())
            expected = self.bank.frf(self.at, (1, 2, 0), self.to, (0, 0, -1), got["frequency_hz"], kind)
            np.testing.assert_allclose(got["real"] + 1j * got["imag"], expected, rtol=1e-5)
            np.testing.assert_allclose(got["magnitude"], np.abs(expected), rtol=1e-5)
            np.testing.assert_allclose(np.exp(1j * np.radians(got["phase_deg"])), expected / np.abs(expected), atol=1e-4)
            self.assertTrue((np.diff(got["frequency_hz"]) > 0).all())

    def test_a_table_of_pressure_is_what_python_says(self):
        run("frf", BELL, "-o", self.folder / "a.csv", "--at", "0.1,0,0.05", "--direction", "1,0,0", "--air", "0,2,0.5")
        got = table((self.folder / "a.csv").read_text())
        expected = self.bank.pressure_frf((0.1, 0, 0.05), (1, 0, 0), (0, 2, 0.5), got["frequency_hz"])
        np.testing.assert_allclose(got["real"] + 1j * got["imag"], expected, rtol=1e-5)

    def test_a_table_of_radiated_energy_is_what_python_says(self):
        words = ("--at", "0.1,0,0.05", "--direction", "1,0,0", "--energy")
        run("frf", BELL, "-o", self.folder / "a.csv", *words)
        got = table((self.folder / "a.csv").read_text())
        expected = self.bank.energy_spectrum((0.1, 0, 0.05), (1, 0, 0), got["frequency_hz"])
        np.testing.assert_allclose(got["energy"], expected, rtol=1e-5)
        run("frf", BELL, "-o", self.folder / "a.png", *words)
        self.assertEqual((self.folder / "a.png").read_bytes()[1:4], b"PNG")

    def test_the_table_has_each_mode_and_the_band(self):
        run("frf", BELL, "-o", self.folder / "a.csv", "--band", 300, 3000, "--count", 20)
        hz = table((self.folder / "a.csv").read_text())["frequency_hz"]
        self.assertEqual((hz[0], hz[-1]), (300, 3000))
        for mode in self.bank.frequencies_hz[(self.bank.frequencies_hz > 300) & (self.bank.frequencies_hz < 3000)]:
            self.assertLess(np.abs(hz / mode - 1).min(), 1e-9)

    def test_dataset_58_holds_the_response(self):
        run("frf", BELL, "-o", self.folder / "a.uff", *self.places(), "--band", 200, 2000, "--count", 10)
        lines = (self.folder / "a.uff").read_text().splitlines()
        self.assertEqual(lines.count("    -1"), 4)
        begin = lines.index("    58")
        function, spacing = lines[begin + 6], lines[begin + 7].split()
        self.assertEqual(function.split()[0], "4")  # a frequency response
        self.assertEqual((spacing[0], spacing[2]), ("6", "0"))  # complex doubles, uneven
        rows = lines[begin + 12 : -1]
        self.assertEqual(len(rows), int(spacing[1]))
        numbers = np.array([[float(row[:13]), float(row[13:33]), float(row[33:53])] for row in rows])
        expected = self.bank.frf(self.at, (1, 2, 0), self.to, (0, 0, -1), numbers[:, 0], "mobility")
        far = np.abs(numbers[:, 0][:, None] / self.bank.frequencies_hz - 1).min(axis=1) > 0.01  # six digits of frequency
        np.testing.assert_allclose((numbers[:, 1] + 1j * numbers[:, 2])[far], expected[far], rtol=1e-2)

    def test_pictures_are_drawn(self):
        run("frf", BELL, "-o", self.folder / "a.png", *self.places())
        self.assertEqual((self.folder / "a.png").read_bytes()[1:4], b"PNG")
        run("frf", RODS, "-o", self.folder / "a.svg", "--kind", "accelerance")
        drawing = (self.folder / "a.svg").read_text()
        self.assertIn("<svg", drawing)
        self.assertGreater(len(drawing), 20000)

    def test_wrong_requests_are_one_sentence(self):
        for words, code, sentence in (
            ((BELL, "-o", "a.txt"), 2, "must end in"),
            ((BELL, "-o", "a.csv", "--kind", "speed"), 2, "accelerance"),
            ((BELL, "-o", "a.csv", "--band", 300, 200), 2, "lower first"),
            ((BELL, "-o", "a.csv", "--to", "0,0,0", "--air", "1,0,0"), 2, "--air"),
            ((BELL, "-o", "a.uff", "--energy"), 2, ".csv"),
            ((BELL, "-o", "a.csv", "--at", "9,9,9"), 3, "off the object"),
            ((RODS, "-o", "a.csv", "--residual", "/nowhere.npy"), 3, "/nowhere.npy"),
        ):
            said = run("frf", *words, code=code)
            self.assertIn(sentence, said)
            self.assertFalse(Path("a.csv").exists())


class DirectivityTest(unittest.TestCase):
    def setUp(self):
        holder = tempfile.TemporaryDirectory()
        self.addCleanup(holder.cleanup)
        self.folder, self.bank = Path(holder.name), ringdown.Bank.open(BELL)

    def directions(self, got):
        return np.stack((got["x"], got["y"], got["z"]), axis=1)

    def mean(self, got, squares):
        """Over the sphere, by the midpoint rule on its rings."""
        weights = np.cos(np.radians(got["elevation_deg"]))
        return np.sum(weights * squares) / weights.sum()

    def test_a_modes_levels_are_those_of_its_far_field(self):
        run("picture", BELL, "-o", self.folder / "a.csv", "--directivity", 2)
        got = table((self.folder / "a.csv").read_text())
        self.assertEqual(len(got["level_db"]), 37 * 72)
        squares = np.abs(self.bank.far_field(2, self.directions(got))) ** 2
        levels = 10 * np.log10(np.maximum(squares / self.mean(got, squares), 1e-20))
        heard = levels > -40
        np.testing.assert_allclose(got["level_db"][heard], levels[heard], atol=0.05)
        angles = np.radians(got["azimuth_deg"]), np.radians(got["elevation_deg"])
        np.testing.assert_allclose(got["y"], np.sin(angles[0]) * np.cos(angles[1]), atol=1e-8)

    def test_a_band_adds_its_modes_up_by_energy(self):
        at = self.bank.points_m[5]
        run("picture", BELL, "-o", self.folder / "a.csv", "--directivity", "300-4000", "--at", ",".join(map(str, at)))
        got = table((self.folder / "a.csv").read_text())
        normal = np.zeros(3)
        for triangle in self.bank.triangles[(self.bank.triangles == 5).any(axis=1)]:
            a, b, c = self.bank.points_m[triangle].astype(float)
            normal += np.cross(b - a, c - a)
        squares = 0
        for mode in np.flatnonzero((self.bank.frequencies_hz >= 300) & (self.bank.frequencies_hz <= 4000)):
            share = self.bank.shapes[mode, 5] @ normal * self.bank.frequencies_hz[mode]
            squares = squares + share**2 * np.abs(self.bank.far_field(mode, self.directions(got))) ** 2
        levels = 10 * np.log10(squares / self.mean(got, squares))
        np.testing.assert_allclose(got["level_db"], levels, atol=0.05)

    def test_balloons_are_drawn(self):
        run("picture", BELL, "-o", self.folder / "a.png", "--directivity", 0)
        self.assertEqual((self.folder / "a.png").read_bytes()[1:4], b"PNG")

    def test_wrong_requests_are_one_sentence(self):
        for words, code, sentence in (
            (("--directivity", "100000"), 2, "number of a mode"),
            (("--directivity", "loud"), 2, "number of a mode"),
            (("--directivity", "300-200"), 2, "LOW-HIGH"),
            (("--directivity", "0.1-0.2"), 3, "no mode lies"),
            (("--directivity", "0", "--small"), 2, "--small"),
        ):
            self.assertIn(sentence, run("picture", BELL, "-o", self.folder / "a.png", *words, code=code))


if __name__ == "__main__":
    unittest.main()
