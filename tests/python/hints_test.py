"""The module's type hints: mypy finds no fault in them, and they name what the compiled modules have."""

import importlib.util
import os
import subprocess
import sys
import tempfile
import unittest

from support import BUILD, SOURCE, skip

if not importlib.util.find_spec("mypy"):
    skip("mypy is not installed")

# What pybind11 adds to each class, and names that stand for types in the hints alone.
NOT_COMPARED = r"ringdown\._(core|scene)\.(Bank|Mixer|Scene|Bank\.__init__|Doubles|Floats|Numbers|Path)"


class Hints(unittest.TestCase):
    def run_tool(self, *command: str) -> None:
        with tempfile.TemporaryDirectory() as folder:
            with open(os.path.join(folder, "allowed"), "w") as allowed:
                allowed.write(NOT_COMPARED + "\n")
            environment = dict(os.environ, MYPYPATH=str(BUILD / "python"), MYPY_CACHE_DIR=folder)
            result = subprocess.run([sys.executable, "-m", *command], cwd=folder, env=environment,
                                    capture_output=True, text=True)
        self.assertEqual(result.returncode, 0, result.stdout + result.stderr)

    def test_mypy_finds_no_fault_in_the_module(self) -> None:
        self.run_tool("mypy", "--strict", str(SOURCE / "clients" / "python" / "ringdown"))

    def test_mypy_finds_no_fault_in_what_uses_the_module(self) -> None:
        examples = SOURCE / "clients" / "python" / "examples"
        self.run_tool("mypy", "--ignore-missing-imports", *map(str, sorted(examples.glob("*.py"))))

    def test_the_hints_are_those_of_the_compiled_modules(self) -> None:
        self.run_tool("mypy.stubtest", "ringdown._core", "ringdown._scene", "--allowlist", "allowed")


if __name__ == "__main__":
    unittest.main()
