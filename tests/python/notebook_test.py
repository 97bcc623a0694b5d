"""The notebook docs/use/laboratory.ipynb runs cell by cell, as Jupyter would run it, and finds what its text says."""

import contextlib
import importlib.util
import io
import json
import os
import tempfile
import unittest
import warnings

from support import PROGRAMS, SOURCE, skip

NOTEBOOK = SOURCE / "docs" / "use" / "laboratory.ipynb"
for library in ("scipy", "matplotlib"):
    if not importlib.util.find_spec(library):
        skip(f"python3-{library} is not installed")
if not (PROGRAMS / "ringdown-bake").exists():
    skip("ringdown-bake is not built")


class NotebookTest(unittest.TestCase):
    def test_every_cell_runs(self):
        notebook = json.loads(NOTEBOOK.read_text())
        self.assertEqual(notebook["nbformat"], 4)
        cells = ["".join(cell["source"]) for cell in notebook["cells"] if cell["cell_type"] == "code"]
        self.assertEqual(len(cells), 10)
        self.assertTrue(all(not cell.get("outputs") for cell in notebook["cells"]), "outputs are committed")
        self.addCleanup(os.chdir, os.getcwd())
        os.chdir(SOURCE)
        os.environ["RINGDOWN_BAKE"] = str(PROGRAMS / "ringdown-bake")
        os.environ["RINGDOWN_PRESETS"] = str(SOURCE / "presets")
        names = {}
        folder = tempfile.TemporaryDirectory()
        self.addCleanup(folder.cleanup)
        tempfile.tempdir, before = folder.name, tempfile.tempdir
        self.addCleanup(setattr, tempfile, "tempdir", before)
        with contextlib.redirect_stdout(io.StringIO()), warnings.catch_warnings():
            warnings.simplefilter("ignore")  # about the kernel's sandbox
            for number, cell in enumerate(cells):
                exec(compile(cell, f"{NOTEBOOK.name}, cell {number}", "exec"), names)
        self.assertLess(names["difference"], 1e-9)
        self.assertAlmostEqual(names["stiffer"], 0.97, delta=0.001)
        self.assertAlmostEqual(names["fit"].x[1] / names["decay_true"], 1, delta=0.05)
        self.assertEqual((names["folder"] / "bar.png").read_bytes()[1:4], b"PNG")


if __name__ == "__main__":
    unittest.main()
