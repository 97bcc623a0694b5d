"""What ringdown-bake exports: matrices whose modes scipy finds again, mode shapes at all nodes, and the residual, with
which Bank.frf() is the direct solution of the finite elements. The body is a bar, meshed coarsely on purpose: the
matrices say what its coarse mesh does."""

import base64
import math
import struct
import tempfile
import unittest
import warnings
from pathlib import Path
from xml.etree import ElementTree

from support import PROGRAMS, SOURCE, skip

import numpy as np

try:
    import scipy.io
    import scipy.sparse
    import scipy.sparse.linalg
except ModuleNotFoundError:
    skip("python3-scipy is not installed")
import ringdown

PROGRAM = PROGRAMS / "ringdown-bake"
ROD = SOURCE / "presets" / "objects" / "steel-rod.toml"
if not PROGRAM.exists():
    skip("ringdown-bake is not built")


def bake(folder, name, **options):
    with warnings.catch_warnings():
        warnings.simplefilter("ignore")  # about the kernel's sandbox
        return ringdown.bake(
            ROD, program=PROGRAM, out=folder / f"{name}.glb", no_cache=True, element="tet10", mesh_size=0.008,
            set={"length": 120, "diameter": 12}, band=(20, 40000), shape_error="0.1%",
            export_modes=[folder / f"{name}{ending}" for ending in (".npz", ".vtu", ".unv")], export_matrices=folder / name, **options)


class Matrices:
    def __init__(self, prefix):
        read = lambda part: scipy.io.mmread(f"{prefix}-{part}.mtx").tocsc()
        self.stiffness, self.mass = read("K"), read("M")
        self.springs = read("H") if Path(f"{prefix}-H.mtx").exists() else None
        table = np.loadtxt(f"{prefix}-nodes.csv", delimiter=",", skiprows=1)
        self.nodes_m, self.moves = table[:, 1:4], table[:, 4] == 1
        self.rows = np.repeat(self.moves, 3)

    def pencil(self):
        stiffness = self.stiffness if self.springs is None else self.stiffness + self.springs
        return stiffness[self.rows][:, self.rows], self.mass[self.rows][:, self.rows]


class FreeBarTest(unittest.TestCase):
    @classmethod
    def setUpClass(cls):
        cls.holder = tempfile.TemporaryDirectory()
        cls.folder = Path(cls.holder.name)
        residual = cls.folder / "bar-residual.npy"
        bake(cls.folder, "bar", export_residual=residual)
        cls.bank = ringdown.Bank.open(cls.folder / "bar.glb", residual=residual)
        cls.matrices, cls.modes = Matrices(cls.folder / "bar"), np.load(cls.folder / "bar.npz")

    @classmethod
    def tearDownClass(cls):
        cls.holder.cleanup()

    def test_scipy_finds_the_banks_frequencies(self):
        stiffness, mass = self.matrices.pencil()
        wanted = np.sort(self.modes["undamped_hz"])
        middle = (2 * math.pi * wanted[len(wanted) // 2]) ** 2
        squares = scipy.sparse.linalg.eigsh(stiffness, len(wanted) + 6, mass, sigma=-0.01 * middle,
                                            which="LM", return_eigenvectors=False, tol=1e-13)
        found = np.sort(np.sqrt(np.maximum(squares, 0)) / (2 * math.pi))[6:]
        self.assertLess(np.abs(found / wanted - 1).max(), 1e-9)
        # A bank's file has frequencies as 32-bit floats.
        np.testing.assert_allclose(self.bank.undamped_frequencies_hz, self.modes["undamped_hz"], rtol=1e-7)
        np.testing.assert_allclose(self.bank.frequencies_hz, self.modes["frequencies_hz"], rtol=1e-7)

    def test_rigid_motions_cost_no_energy_and_have_the_bodys_mass(self):
        along = np.tile((0.0, 0.0, 1.0), len(self.matrices.nodes_m))
        largest = abs(self.matrices.stiffness).max()
        self.assertLess(np.abs(self.matrices.stiffness @ along).max(), 1e-9 * largest)
        self.assertAlmostEqual(along @ self.matrices.mass @ along / self.bank.mass_kg, 1, places=9)

    def test_shapes_at_all_nodes_solve_the_equations(self):
        np.testing.assert_array_equal(self.modes["nodes_m"], self.matrices.nodes_m)
        shapes = self.modes["shapes"].reshape(len(self.modes["undamped_hz"]), -1).T
        np.testing.assert_allclose(shapes.T @ self.matrices.mass @ shapes, np.eye(shapes.shape[1]), atol=1e-8)
        squares = (2 * math.pi * self.modes["undamped_hz"]) ** 2
        force = self.matrices.stiffness @ shapes
        self.assertLess(np.abs(force - self.matrices.mass @ shapes * squares).max(), 1e-6 * np.abs(force).max())

    def node(self, *direction):
        """The node farthest towards a direction, where the bank's surface has a place nearby."""
        return int(np.argmax(self.matrices.nodes_m @ np.array(direction)))

    def direct(self, at, push, to, see, hz):
        stiffness, mass = self.matrices.pencil()
        force = np.zeros(stiffness.shape[0])
        force[3 * at : 3 * at + 3] = push
        moved = scipy.sparse.linalg.splu((stiffness - (2 * math.pi * hz) ** 2 * mass).tocsc()).solve(force)
        return moved[3 * to : 3 * to + 3] @ see

    def test_responses_are_those_of_the_direct_solution(self):
        nodes, plain = self.matrices.nodes_m, ringdown.Bank.open(self.folder / "bar.glb")
        at, to = self.node(-1, 0.1, 0.2), self.node(1, 0.3, 0.05)
        push, see = np.array((0.6, 0.0, 0.8)), np.array((0.0, 0.6, 0.8))
        resonances = np.unique(np.round(np.sort(self.modes["undamped_hz"])))[:5]
        starts = np.r_[resonances[0] / 3, resonances[:-1]]
        frequencies = np.r_[starts**0.6 * resonances**0.4, starts**0.3 * resonances**0.7]
        errors, without = [], []
        for hz in frequencies:
            direct = self.direct(at, push, to, see, hz)
            for bank, kept in ((self.bank, errors), (plain, without)):
                kept.append(abs(bank.frf(nodes[at], push, nodes[to], see, [hz])[0] / direct - 1))
        self.assertTrue(self.bank.has_residual and not plain.has_residual)
        self.assertEqual(len(errors), 10)
        self.assertLess(max(errors), 0.01, (frequencies, errors))
        self.assertGreater(max(without), 0.03)  # the modes above the band matter

    def test_below_the_lowest_mode_the_residual_completes_the_flexibility(self):
        """Driven at one point, where the modes above the band count most."""
        at, push = self.node(-1, 0.1, 0.2), np.array((1.0, 0.0, 0.0))
        hz = 0.5 * self.modes["undamped_hz"].min()
        direct = self.direct(at, push, at, push, hz)
        there = self.matrices.nodes_m[at]
        self.assertLess(abs(self.bank.frf(there, push, there, push, [hz])[0] / direct - 1), 0.01)


class ModeFilesTest(unittest.TestCase):
    """Files for other programs, read by their formats' descriptions; the .npz, which the equations prove, is the oracle."""

    @classmethod
    def setUpClass(cls):
        cls.holder = tempfile.TemporaryDirectory()
        cls.folder = Path(cls.holder.name)
        cls.bank = bake(cls.folder, "bar", keep=4)
        cls.modes = np.load(cls.folder / "bar.npz")

    @classmethod
    def tearDownClass(cls):
        cls.holder.cleanup()

    def fills_the_body(self, nodes, tetrahedra):
        a, b, c, d = (nodes[tetrahedra[:, i]] for i in range(4))
        volumes = np.einsum("ni,ni->n", np.cross(b - a, c - a), d - a) / 6
        self.assertGreater(volumes.min(), 0)
        # Straight parts leave out the segments of the round rod between the nodes of its rim.
        rim = (nodes[:, 0] < -0.06 + 1e-9) & (np.linalg.norm(nodes[:, 1:], axis=1) > 0.006 - 1e-6)
        angle = 2 * math.pi / np.count_nonzero(rim)
        filled = volumes.sum() * self.bank.material.density_kg_m3 / self.bank.mass_kg
        self.assertAlmostEqual(filled, math.sin(angle) / angle, delta=0.003)
        self.assertEqual(len(np.unique(tetrahedra)), len(nodes))  # every node is a corner

    def test_vtk(self):
        piece = ElementTree.parse(self.folder / "bar.vtu").getroot().find("UnstructuredGrid/Piece")
        arrays = {}
        for array in piece.iter("DataArray"):
            data = base64.b64decode(array.text)
            (size,) = struct.unpack_from("<Q", data)
            self.assertEqual(size, len(data) - 8)
            kind = {"Float64": "<f8", "Float32": "<f4", "Int32": "<i4", "Int64": "<i8", "UInt8": "u1"}[array.get("type")]
            arrays[array.get("Name")] = np.frombuffer(data[8:], kind).reshape(-1, int(array.get("NumberOfComponents")))
        np.testing.assert_array_equal(arrays["points"], self.modes["nodes_m"])
        self.assertEqual(int(piece.get("NumberOfPoints")), len(arrays["points"]))
        cells = int(piece.get("NumberOfCells"))
        self.assertEqual(set(arrays["types"].ravel()), {10})
        np.testing.assert_array_equal(arrays["offsets"].ravel(), 4 * np.arange(1, cells + 1))
        self.fills_the_body(arrays["points"], arrays["connectivity"].reshape(cells, 4))
        fields = [name for name in arrays if name.startswith("mode ")]
        self.assertEqual(len(fields), 4)
        for name, shape, hz in zip(fields, self.modes["shapes"], self.modes["frequencies_hz"]):
            np.testing.assert_allclose(arrays[name], shape, rtol=1e-6, atol=1e-5)
            self.assertAlmostEqual(float(name.split(", ")[1].split()[0]), hz, places=2)

    def test_universal_file(self):
        sets = (self.folder / "bar.unv").read_text().split("    -1\n")[1::2]
        sets = [text.splitlines() for text in sets]
        self.assertEqual([int(lines[0]) for lines in sets], [164, 2411, 2412, 55, 55, 55, 55])
        nodes = np.array([line.split() for line in sets[1][2::2]], float)
        np.testing.assert_allclose(nodes, self.modes["nodes_m"], rtol=1e-15)
        elements = np.array([line.split() for line in sets[2][2::2]], int)
        self.assertEqual({line.split()[1] for line in sets[2][1::2]}, {"111"})  # linear tetrahedra
        self.fills_the_body(nodes, elements - 1)
        for number, (lines, shape, hz) in enumerate(zip(sets[3:], self.modes["shapes"], self.modes["undamped_hz"])):
            self.assertEqual(lines[6].split(), ["1", "2", "2", "8", "2", "3"])  # a normal mode, real, three components
            self.assertEqual(lines[7].split(), ["2", "4", "1", str(number + 1)])
            self.assertAlmostEqual(float(lines[8][:13]) / hz, 1, places=5)
            self.assertEqual([int(line) for line in lines[9::2]], list(range(1, len(nodes) + 1)))
            read = np.array([[line[i : i + 13] for i in (0, 13, 26)] for line in lines[10::2]], float)
            np.testing.assert_allclose(read, shape, rtol=1e-5, atol=1e-12)

    def test_wrong_requests_are_refused_before_the_bake(self):
        for options, sentence in (({"export_modes": self.folder / "bar.txt"}, "must end in .vtu"),
                                  ({"export_residual": self.folder / "bar.npz"}, "must end in .npy")):
            with self.assertRaisesRegex(ringdown.InputError, sentence):
                ringdown.bake(ROD, program=PROGRAM, out=self.folder / "new.glb", **options)
            self.assertFalse((self.folder / "new.glb").exists())


class HeldBarTest(unittest.TestCase):
    def test_what_holds_the_body_is_exported(self):
        with tempfile.TemporaryDirectory() as name:
            folder = Path(name)
            bank = bake(folder, "held", support=SUPPORT)
            matrices, modes = Matrices(folder / "held"), np.load(folder / "held.npz")
            self.assertTrue(bank.held)
            self.assertGreater(np.count_nonzero(~matrices.moves), 3)
            stiffness, mass = matrices.pencil()
            wanted = np.sort(modes["undamped_hz"])[:12]
            squares = scipy.sparse.linalg.eigsh(stiffness, 12, mass, sigma=0, return_eigenvectors=False, tol=1e-13)
            self.assertLess(np.abs(np.sort(np.sqrt(squares)) / (2 * math.pi) / wanted - 1).max(), 1e-9)
            self.assertEqual(np.abs(modes["shapes"][:, ~matrices.moves]).max(), 0)


SUPPORT = 'kind = "clamped", plane = [-0.06, 0, 0, 1, 0, 0]'


if __name__ == "__main__":
    unittest.main()
