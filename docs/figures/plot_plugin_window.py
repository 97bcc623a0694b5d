#!/usr/bin/python3
"""Takes a picture of the plug-in's window: plot_plugin_window.py PLUGIN_WINDOW_TEST

Writes docs/figures/plugin-window.png: the window of the CLAP plug-in just after a click on the object, as the test of
that name sees it. Needs Xvfb and Debian's python3-pil.
"""
import os
import pathlib
import subprocess
import sys
import tempfile

from PIL import Image

PICTURE = pathlib.Path(__file__).resolve().parents[2] / "docs/figures/plugin-window.png"
CLICK = "*AClickStrikesTheObjectWhereItIsSeenAndSetsTheStrikePoint/clap"
MOST_BYTES = 400_000


def main():
    if len(sys.argv) != 2:
        sys.exit(__doc__)
    with tempfile.TemporaryDirectory() as folder:
        path = pathlib.Path(folder) / "window.ppm"
        settings = {**os.environ, "RINGDOWN_WINDOW_PICTURE": str(path)}
        subprocess.run([sys.argv[1], f"--gtest_filter={CLICK}", "--gtest_brief=1"], check=True, env=settings)
        with Image.open(path) as picture:
            small = picture.convert("RGB").quantize(256, method=Image.Quantize.MAXCOVERAGE, kmeans=3, dither=Image.Dither.NONE)
    small.save(PICTURE, optimize=True)
    if PICTURE.stat().st_size > MOST_BYTES:
        sys.exit(f"{PICTURE} has {PICTURE.stat().st_size} bytes, more than {MOST_BYTES}")


if __name__ == "__main__":
    main()
