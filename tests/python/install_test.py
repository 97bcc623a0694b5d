"""`pip install --no-build-isolation` in a virtual environment, without a network, gives a module that plays."""

import importlib.util
import os
import shutil
import subprocess
import sys
import unittest

from support import BANKS, BUILD, SOURCE, skip

for name, package in {
    "ensurepip": "python3-venv",
    "setuptools": "python3-setuptools",
    "wheel": "python3-wheel",
    "pybind11": "python3-pybind11",
}.items():
    if not importlib.util.find_spec(name):
        skip(f"{package} is not installed")

# A folder whose name stays, so that ccache knows the files again.
FOLDER = BUILD / "python-install"
PLAY = """
import pathlib, sys
import ringdown
assert pathlib.Path(ringdown.__file__).is_relative_to({folder!r}), ringdown.__file__
assert (pathlib.Path(ringdown.__file__).parent / "py.typed").exists()
bank = ringdown.Bank.open({bank!r})
sound = ringdown.render([(0, "coin", bank.points_m[0], (0, 0, 0.001))], {{"coin": bank}}, seconds=0.1)
assert sound.shape == (4800, 2) and abs(sound).max() > 0
assert len(ringdown.render_scene({scene!r}, 0.05)) == 2400
print("ringdown", ringdown.__version__)
"""


class InstallTest(unittest.TestCase):
    def run_it(self, *command, **environment):
        clean = {name: value for name, value in os.environ.items() if name != "PYTHONPATH"}
        done = subprocess.run(list(map(str, command)), capture_output=True, text=True, env={**clean, **environment})
        self.assertEqual(done.returncode, 0, done.stdout + done.stderr)
        return done.stdout

    def test_installs_and_plays(self):
        shutil.rmtree(FOLDER, ignore_errors=True)
        others = shutil.ignore_patterns("build", "*.egg-info", "__pycache__")
        shutil.copytree(SOURCE / "clients" / "python", FOLDER / "source", ignore=others)
        self.run_it(sys.executable, "-m", "venv", "--system-site-packages", FOLDER / "env")
        compiler = "ccache c++" if shutil.which("ccache") else "c++"
        self.run_it(
            FOLDER / "env/bin/pip", "install", "--no-build-isolation", "--no-index", "--disable-pip-version-check",
            FOLDER / "source",
            RINGDOWN_INCLUDE_DIR=str(SOURCE / "clients" / "library"), RINGDOWN_LIBRARY_DIR=str(BUILD / "lib"),
            CC=compiler, CXX=compiler, CFLAGS="-O0 -g0",
        )
        play = PLAY.format(
            folder=str(FOLDER / "env"), bank=str(BANKS / "coin.glb"), scene=str(SOURCE / "presets/scenes/coin.toml")
        )
        self.assertRegex(self.run_it(FOLDER / "env/bin/python", "-c", play), r"^ringdown \d+\.\d+\.\d+\n$")
        shutil.rmtree(FOLDER)

    def test_says_what_is_missing(self):
        done = subprocess.run(
            [sys.executable, "setup.py", "--version"],
            cwd=SOURCE / "clients" / "python", capture_output=True, text=True,
            env={"PATH": "/nowhere", "PYTHONDONTWRITEBYTECODE": "1"},
        )
        self.assertNotEqual(done.returncode, 0)
        self.assertIn("install the package libringdown-dev", done.stderr)


if __name__ == "__main__":
    unittest.main()
