#!/usr/bin/python3
"""Takes pictures with ringdown-viewer: plot_viewer_scenes.py VIEWER

Writes docs/figures/viewer-scenes.png, every preset scene at a moment when something happens, and docs/figures/viewer.png,
the whole window. Needs a display (or xvfb-run), ringdownd beside VIEWER, and Debian's python3-pil. Takes
two minutes, for scenes are played.
"""
import pathlib
import subprocess
import sys
import tempfile

from PIL import Image, ImageDraw

ROOT = pathlib.Path(__file__).resolve().parents[2]
PICTURES = ROOT / "docs/figures"
MOMENTS_S = {  # of the scene
    "demo": 5.5,
    "chimes": 4.35,
    "wind-chimes": 3.6,
    "dominoes": 1.5,
    "marble-rain": 4,
    "coin": 3.8,
    "cutlery": 4.9,
    "glass-tower": 0.8,
    "bell-and-clapper": 1.2,
    "vibraphone": 5,
    "xylophone": 5.2,
    "turning-plate": 3,
    "gongs": 7.35,
    "rolling-balls": 2.8,
}
COLUMNS = 4
TAKEN, SHOWN = (640, 400), (400, 250)
NAME_HEIGHT = 18
WINDOW, WINDOW_SCENE, WINDOW_AT_S = (1280, 800), "glass-tower", 1
MOST_BYTES = 400_000


def take(viewer, scene, at_s, size, options=()):
    with tempfile.TemporaryDirectory() as folder:
        path = pathlib.Path(folder) / "picture.png"
        command = [viewer, "--screenshot", path, "--scene", ROOT / f"presets/scenes/{scene}.toml", "--at", at_s]
        command += ["--size", *size, "--theme", "dark", *options]
        subprocess.run([str(word) for word in command], check=True)
        with Image.open(path) as picture:
            return picture.convert("RGB")


def sheet(viewer):
    scenes = sorted(path.stem for path in (ROOT / "presets/scenes").glob("*.toml"))
    if unknown := [scene for scene in scenes if scene not in MOMENTS_S]:
        sys.exit(f"say in MOMENTS_S when to look at {', '.join(unknown)}")
    width, height = SHOWN[0], SHOWN[1] + NAME_HEIGHT
    rows = -(-len(MOMENTS_S) // COLUMNS)
    whole = Image.new("RGB", (COLUMNS * width, rows * height), "#14171a")
    draw = ImageDraw.Draw(whole)
    for place, (scene, at_s) in enumerate(MOMENTS_S.items()):
        row, column = divmod(place, COLUMNS)
        picture = take(viewer, scene, at_s, TAKEN, ["--only", "scene"])
        whole.paste(picture.resize(SHOWN, Image.Resampling.LANCZOS), (column * width, row * height))
        draw.text((column * width + 6, row * height + SHOWN[1] + 3), f"{scene}, {at_s:g} s", fill="#b8bec4")
    return whole


def write(picture, path):
    picture.quantize(256, method=Image.Quantize.MAXCOVERAGE, kmeans=3, dither=Image.Dither.NONE).save(path, optimize=True)
    if path.stat().st_size > MOST_BYTES:
        sys.exit(f"{path} has {path.stat().st_size} bytes, more than {MOST_BYTES}")


def main():
    if len(sys.argv) != 2:
        sys.exit(__doc__)
    viewer = sys.argv[1]
    write(sheet(viewer), PICTURES / "viewer-scenes.png")
    write(take(viewer, WINDOW_SCENE, WINDOW_AT_S, WINDOW), PICTURES / "viewer.png")


if __name__ == "__main__":
    main()
