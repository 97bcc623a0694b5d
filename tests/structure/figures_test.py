#!/usr/bin/python3
"""README and the benchmarks' page state what the committed log of the mixer says: figures_test.py SOURCE"""
import importlib.util
import pathlib
import re
import shutil
import subprocess
import sys
import tempfile

SOURCE = pathlib.Path(sys.argv[1])
LOG, PAGES = "docs/how/logs/mixer.csv", ["README.md", "docs/how/benchmarks.md"]

if not importlib.util.find_spec("matplotlib"):
    print("matplotlib is not installed: skipped")
    sys.exit(77)
with tempfile.TemporaryDirectory() as folder:
    tree = pathlib.Path(folder)
    for name in [LOG, *PAGES]:
        (tree / name).parent.mkdir(parents=True, exist_ok=True)
        shutil.copy(SOURCE / name, tree / name)
    readme = tree / "README.md"
    readme.write_text(re.sub(r"\d+ to \d+ times as many", "0 to 0 times as many", readme.read_text()))
    subprocess.run(["/usr/bin/python3", "-B", SOURCE / "docs/figures/plot_mixer.py", tree / LOG, tree / "mixer.png", "--publish", tree],
                   check=True)
    for name in [LOG, *PAGES]:
        assert (tree / name).read_text() == (SOURCE / name).read_text(), f"{name}: publish the log again"
