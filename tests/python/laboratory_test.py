"""What a laboratory asks of a Bank: all that its file says, as arrays and tables, and frequency responses."""

import copy
import math
import os
import pickle
import sys
import tempfile
import types
import unittest
from unittest import mock

from support import BANKS

import bank_document
import numpy as np
import ringdown

BELL = BANKS / "bronze-bell.glb"


class FactsTest(unittest.TestCase):
    def setUp(self):
        self.bank = ringdown.Bank.open(BELL)
        self.model, _ = bank_document.read_bank(BELL)
        self.extras = self.model["extras"]["ringdown"]

    def test_errors_are_those_of_the_file(self):
        np.testing.assert_array_equal(self.bank.frequency_errors, self.extras["frequencyErrors"])
        np.testing.assert_array_equal(self.bank.shape_errors, self.extras["shapeErrors"])
        np.testing.assert_array_equal(self.bank.level_errors_db, self.extras["radiation"]["errors"])

    def test_losses_are_those_of_the_file_and_add_up_to_the_decays(self):
        losses = self.bank.losses
        for part, key in zip(losses, ("material", "heat", "air", "support")):
            np.testing.assert_array_equal(part, self.extras["losses"].get(key, np.zeros(len(part))))
        np.testing.assert_allclose(sum(losses), self.bank.decays_per_s, rtol=1e-5)

    def test_undamped_frequencies_are_of_the_equation_without_damping(self):
        turn = 2 * math.pi
        squares = (turn * self.bank.frequencies_hz) ** 2 + self.bank.decays_per_s**2
        np.testing.assert_allclose(self.bank.undamped_frequencies_hz, np.sqrt(squares) / turn, rtol=1e-14)

    def test_mass_and_inertia_are_those_of_the_file(self):
        mass = self.model["massProperties"]
        self.assertEqual(self.bank.mass_kg, mass["mass"])
        np.testing.assert_array_equal(self.bank.inertia_kg_m2, mass["inertiaDiagonal"])
        x, y, z, w = mass["inertiaOrientation"]
        np.testing.assert_allclose(self.bank.axes_wxyz, (w, x, y, z), rtol=0, atol=1e-12)
        self.assertFalse(self.bank.held)

    def test_provenance_says_how_it_was_made(self):
        about = self.bank.provenance
        for key in ("element", "unknowns", "bandLow", "bandHigh", "largestResidual"):
            self.assertEqual(about[key], self.extras[key], key)
        self.assertRegex(about["generator"], "^Ringdown ")
        self.assertEqual(about["air"], self.extras["radiation"]["air"])

    def test_a_copy_and_a_pickle_are_the_same_bank(self):
        for other in (pickle.loads(pickle.dumps(self.bank)), copy.deepcopy(self.bank)):
            self.assertEqual((other.name, other.material), (self.bank.name, self.bank.material))
            self.assertEqual(other.provenance, self.bank.provenance)
            for name in ("frequencies_hz", "decays_per_s", "shapes", "points_m", "triangles", "frequency_errors"):
                np.testing.assert_array_equal(getattr(other, name), getattr(self.bank, name), name)
            np.testing.assert_array_equal(other.far_field(0, [1, 2, 3]), self.bank.far_field(0, [1, 2, 3]))

    def test_a_broken_pickle_is_an_error(self):
        with self.assertRaises(ringdown.InputError):
            ringdown.Bank.__new__(ringdown.Bank).__setstate__((b"no bank", "bell"))


class TablesTest(unittest.TestCase):
    bank = ringdown.Bank.open(BELL)

    def test_a_library_that_is_missing_is_named_in_one_sentence(self):
        for name, method in (("pandas", self.bank.to_dataframe), ("xarray", self.bank.to_xarray)):
            with mock.patch.dict(sys.modules, {name: None}):
                with self.assertRaisesRegex(ImportError, rf"needs the Python library {name}, which is not installed"):
                    method()

    def test_a_data_frame_has_one_row_for_each_mode(self):
        try:
            import pandas
        except ImportError:  # a stand-in that keeps what it is given
            pandas = types.ModuleType("pandas")
            pandas.DataFrame = Frame
        with mock.patch.dict(sys.modules, {"pandas": pandas}):
            table = self.bank.to_dataframe()
        self.assertEqual(table.index.name, "mode")
        for column in ("frequency_hz", "decay_per_s", "material_per_s", "thermoelastic_per_s", "air_per_s"):
            self.assertEqual(len(table[column]), len(self.bank.frequencies_hz))
        np.testing.assert_array_equal(table["support_per_s"], self.bank.losses.support)

    def test_a_data_set_names_its_dimensions(self):
        try:
            import xarray
        except ImportError:
            xarray = types.ModuleType("xarray")
            xarray.Dataset = Dataset
        with mock.patch.dict(sys.modules, {"xarray": xarray}):
            data = self.bank.to_xarray()
        self.assertEqual(tuple(data["shapes"].dims), ("mode", "point", "axis"))
        np.testing.assert_array_equal(data["shapes"].values, self.bank.shapes)
        self.assertEqual(data.attrs["mass_kg"], self.bank.mass_kg)


class SofaTest(unittest.TestCase):
    bank = ringdown.Bank.open(BELL)
    at, push = bank.points_m[3], (1, 0, 0)

    def test_a_library_that_is_missing_is_named_in_one_sentence(self):
        with mock.patch.dict(sys.modules, {"netCDF4": None}):
            with self.assertRaisesRegex(ImportError, "netCDF4, which is not installed"):
                self.bank.to_sofa("/nowhere/bell.sofa", self.at, self.push, [500])

    def test_holds_the_pressure_at_each_receiver(self):
        try:
            import netCDF4
        except ImportError:
            self.skipTest("python3-netcdf4 is not installed")
        frequencies_hz = np.array([400.0, 1000.0, 2500.0])
        with tempfile.TemporaryDirectory() as folder:
            path = os.path.join(folder, "bell.sofa")
            self.bank.to_sofa(path, self.at, self.push, frequencies_hz, step_deg=30, distance_m=2)
            self.assertEqual(os.listdir(folder), ["bell.sofa"])
            with netCDF4.Dataset(path) as file:
                self.assertEqual((file.SOFAConventions, file.SOFAConventionsVersion, file.DataType),
                                 ("FreeFieldDirectivityTF", "1.1", "TF"))
                receivers = file["ReceiverPosition"][:, :, 0].data
                self.assertEqual(file["ReceiverPosition"].Units, "degree, degree, metre")
                np.testing.assert_array_equal(file["N"][:], frequencies_hz)
                heard = file["Data.Real"][0].data + 1j * file["Data.Imag"][0].data
        self.assertEqual(heard.shape, (62, 3))  # five rings of twelve, and the poles
        for receiver in (0, 17, 61):
            azimuth, elevation, distance = np.radians(receivers[receiver]) * (1, 1, 180 / math.pi)
            place = self.bank.center_of_mass_m + distance * np.array(
                (math.cos(elevation) * math.cos(azimuth), math.cos(elevation) * math.sin(azimuth), math.sin(elevation)))
            np.testing.assert_allclose(heard[receiver],
                                       self.bank.pressure_frf(self.at, self.push, place, frequencies_hz), rtol=1e-9)

    def test_a_file_that_cannot_be_written_is_an_error(self):
        try:
            import netCDF4  # noqa: F401
        except ImportError:
            self.skipTest("python3-netcdf4 is not installed")
        with self.assertRaises(ringdown.Error):
            self.bank.to_sofa("/nowhere/bell.sofa", self.at, self.push, [500.0], step_deg=90)


class Frame(dict):
    def __init__(self, columns):
        super().__init__(columns)
        self.index = types.SimpleNamespace(name=None)


class Dataset(dict):
    def __init__(self, variables, coords, attrs):
        super().__init__({name: types.SimpleNamespace(dims=dims, values=values)
                          for name, (dims, values) in variables.items()})
        self.coords, self.attrs = coords, attrs


class ResponseTest(unittest.TestCase):
    """By the sum over the modes, written in numpy; a force and its response stand at sample points and between them."""

    def setUp(self):
        self.bank = ringdown.Bank.open(BELL)
        self.frequencies_hz = np.geomspace(30, 15000, 40)
        self.from_point, self.to_point = 3, len(self.bank.points_m) // 2
        self.push, self.see = np.array((1.0, 2.0, -0.5)), np.array((0.3, -1.0, 0.2))

    def frf(self, at, push, to, see, kind="receptance"):
        return self.bank.frf(at, push, to, see, self.frequencies_hz, kind)

    def unit(self, vector):
        return vector / np.linalg.norm(vector)

    def by_the_sum(self, pushed, seen, a, b):
        bank, push, see = self.bank, self.unit(self.push), self.unit(self.see)
        omega = 2 * math.pi * self.frequencies_hz[:, None]
        undamped = (2 * math.pi * bank.undamped_frequencies_hz) ** 2
        modes = (pushed @ push) * (seen @ see) / (undamped - omega**2 + 2j * omega * bank.decays_per_s)
        w, x, y, z = bank.axes_wxyz
        axes = np.array([[1 - 2 * (y * y + z * z), 2 * (x * y - w * z), 2 * (x * z + w * y)],
                         [2 * (x * y + w * z), 1 - 2 * (x * x + z * z), 2 * (y * z - w * x)],
                         [2 * (x * z - w * y), 2 * (y * z + w * x), 1 - 2 * (x * x + y * y)]])
        inverse = axes @ np.diag(1 / bank.inertia_kg_m2) @ axes.T
        center = bank.center_of_mass_m
        rigid = push @ see / bank.mass_kg + np.cross(b - center, see) @ inverse @ np.cross(a - center, push)
        return modes.sum(axis=1) - rigid / omega[:, 0] ** 2

    def test_is_the_sum_of_modes_and_rigid_motion(self):
        bank = self.bank
        a, b = bank.points_m[self.from_point].astype(float), bank.points_m[self.to_point].astype(float)
        expected = self.by_the_sum(bank.shapes[:, self.from_point].astype(float),
                                   bank.shapes[:, self.to_point].astype(float), a, b)
        np.testing.assert_allclose(self.frf(a, self.push, b, self.see), expected, rtol=1e-6)
        omega = 2 * math.pi * self.frequencies_hz
        np.testing.assert_allclose(self.frf(a, self.push, b, self.see, "mobility"), 1j * omega * expected, rtol=1e-6)
        np.testing.assert_allclose(self.frf(a, self.push, b, self.see, "accelerance"), -omega**2 * expected, rtol=1e-6)

    def test_between_sample_points_shapes_are_linear(self):
        bank = self.bank
        corners, weights = bank.triangles[7], np.array((0.2, 0.3, 0.5))
        at = weights @ bank.points_m[corners].astype(float)
        to = bank.points_m[self.to_point].astype(float)
        pushed = np.einsum("k,mki->mi", weights, bank.shapes[:, corners].astype(float))
        expected = self.by_the_sum(pushed, bank.shapes[:, self.to_point].astype(float), at, to)
        np.testing.assert_allclose(self.frf(at, self.push, to, self.see), expected, rtol=1e-4)

    def test_force_and_response_may_change_places(self):
        a, b = self.bank.points_m[self.from_point], self.bank.points_m[self.to_point] + np.float32(1e-3)
        there, back = self.frf(a, self.push, b, self.see), self.frf(b, self.see, a, self.push)
        self.assertLess(np.abs(there / back - 1).max(), 1e-11)

    def test_slowly_the_body_moves_as_a_whole(self):
        center = self.bank.center_of_mass_m
        pole = self.bank.points_m[np.argmax(self.bank.points_m[:, 2])]
        hz = np.array([1e-3])
        moved = self.bank.frf(pole, (0, 0, 1), pole, (0, 0, 1), hz, "accelerance")
        turned = np.cross(pole - center, (0, 0, 1))
        self.assertLess(np.abs(turned).max(), 0.02)  # the top lies near the axis
        self.assertAlmostEqual(moved[0].real * self.bank.mass_kg, 1, delta=0.02)

    def test_pressure_is_that_of_the_far_field_at_a_resonance(self):
        bank = self.bank
        mode = int(np.argmin(bank.frequencies_hz))
        omega = 2 * math.pi * bank.undamped_frequencies_hz[mode]
        air = bank.provenance["air"]
        at = bank.points_m[np.argmax(np.abs(bank.shapes[mode, :, 0]))]
        far_m = 200.0
        heard = bank.pressure_frf(at, (1, 0, 0), (far_m, 0, 0), [omega / (2 * math.pi)])[0]
        share = bank.shapes[mode, np.argmax(np.abs(bank.shapes[mode, :, 0])), 0]
        velocity = share / (2 * bank.decays_per_s[mode])
        field = bank.far_field(mode, (1, 0, 0))[0]
        self.assertAlmostEqual(abs(heard) / abs(air["density"] * omega * velocity * field / far_m), 1, delta=0.05)

    def test_radiated_energy_is_the_airs_share_of_what_the_blow_gives(self):
        bank = self.bank
        at = bank.points_m[self.from_point]
        given = (bank.shapes[:, self.from_point] @ np.array((1.0, 0, 0))) ** 2 / 2
        mode = int(np.argmax(np.where(bank.frequencies_hz < 3000, given * bank.losses.air / bank.decays_per_s, 0)))
        middle, decay = bank.frequencies_hz[mode], bank.decays_per_s[mode]
        alone = np.abs(bank.frequencies_hz / middle - 1) < 1e-3  # the pair of a round body rings together
        widths = np.sinh(np.linspace(-4.4, 4.4, 4001))  # other modes lie farther away
        offsets = decay / (2 * math.pi) * widths
        energies = bank.energy_spectrum(at, (1, 0, 0), middle + offsets)
        total = np.sum((energies[1:] + energies[:-1]) / 2 * np.diff(offsets))
        inside = 2 / math.pi * math.atan(widths[-1])  # of a resonance
        expected = inside * (given * bank.losses.air / bank.decays_per_s)[alone].sum()
        self.assertAlmostEqual(total / expected, 1, delta=0.03)

    def test_wrong_values_are_input_errors(self):
        bank, up = self.bank, (0, 0, 1)
        at = bank.points_m[0]
        for call in (lambda: bank.frf(at, (0, 0, 0), at, up, [100]), lambda: bank.frf(at, up, at, up, [0.0]),
                     lambda: bank.frf((9, 9, 9), up, at, up, [100]), lambda: bank.frf(at, up, at, up, [100], "speed"),
                     lambda: bank.pressure_frf(at, up, bank.center_of_mass_m, [100]),
                     lambda: ringdown.Bank.open(BANKS / "steel-rod.glb", residual=BELL)):
            with self.assertRaises(ringdown.InputError):
                call()

    def test_the_answer_has_the_shape_of_the_frequencies(self):
        at = self.bank.points_m[0]
        self.assertEqual(self.bank.frf(at, (0, 0, 1), at, (0, 0, 1), np.ones((2, 3))).shape, (2, 3))


if __name__ == "__main__":
    unittest.main()
