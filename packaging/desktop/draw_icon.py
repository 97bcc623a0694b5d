#!/usr/bin/python3
"""Draws the icon: draw_icon.py [--check]

A blow that rings down: a sine wave that decays, on a dark tile. Writes icons/ringdown.svg and, by the same figures,
icons/ringdown-SIZE.png beside this file. --check writes nothing and says what is no longer as this script draws it.
"""
import io
import math
import pathlib
import sys

from PIL import Image, ImageChops, ImageDraw

FOLDER = pathlib.Path(__file__).resolve().parent / "icons"
SIZES = (16, 32, 48, 64, 128, 256)
SIDE, CORNER, STROKE = 256, 52, 15
TILE, WAVE, DOT = "#1b3a57", "#fde725", "#ff8a3d"
START = (40, 128)


def wave():
    """Points of the curve, from the blow on."""
    points = []
    for n in range(181):
        t = n / 180
        points.append((START[0] + 178 * t, START[1] - 88 * math.exp(-2.6 * t) * math.sin(2 * math.pi * 3.5 * t)))
    return points


def svg():
    path = "M" + " L".join(f"{x:.1f},{y:.1f}" for x, y in wave())
    return (f'<svg xmlns="http://www.w3.org/2000/svg" viewBox="0 0 {SIDE} {SIDE}">\n'
            f'<rect width="{SIDE}" height="{SIDE}" rx="{CORNER}" fill="{TILE}"/>\n'
            f'<path d="{path}" fill="none" stroke="{WAVE}" stroke-width="{STROKE}" stroke-linecap="round" '
            f'stroke-linejoin="round"/>\n'
            f'<circle cx="{START[0]}" cy="{START[1]}" r="17" fill="{DOT}"/>\n</svg>\n')


def png(size):
    """Drawn eight times as large, then averaged. In small icons the line is thicker."""
    scale = 8 * size / SIDE
    stroke = max(STROKE, 26 - size / 8)
    image = Image.new("RGBA", (8 * size, 8 * size))
    pen = ImageDraw.Draw(image)
    pen.rounded_rectangle([0, 0, 8 * size - 1, 8 * size - 1], CORNER * scale, fill=TILE)

    def disc(place, radius, colour):
        x, y = place[0] * scale, place[1] * scale
        pen.ellipse([x - radius * scale, y - radius * scale, x + radius * scale, y + radius * scale], fill=colour)

    points = wave()
    for (x0, y0), (x1, y1) in zip(points, points[1:]):
        steps = max(1, round(math.hypot(x1 - x0, y1 - y0)))
        for k in range(steps + 1):
            disc((x0 + (x1 - x0) * k / steps, y0 + (y1 - y0) * k / steps), stroke / 2, WAVE)
    disc(START, max(17, stroke), DOT)
    return image.resize((size, size), Image.BOX)


def check():
    faults = [] if (FOLDER / "ringdown.svg").read_text() == svg() else ["ringdown.svg"]
    for size in SIZES:
        file = FOLDER / f"ringdown-{size}.png"
        drawn = Image.open(file).convert("RGBA")
        if drawn.size != (size, size) or ImageChops.difference(drawn, png(size)).getextrema() != ((0, 0),) * 4:
            faults.append(file.name)
    return faults


def main():
    if sys.argv[1:] == ["--check"]:
        faults = check()
        sys.exit(f"not as drawn: {', '.join(faults)}; call packaging/desktop/draw_icon.py" if faults else 0)
    FOLDER.mkdir(exist_ok=True)
    (FOLDER / "ringdown.svg").write_text(svg())
    for size in SIZES:
        bytes_ = io.BytesIO()
        png(size).save(bytes_, "PNG", optimize=True)
        (FOLDER / f"ringdown-{size}.png").write_bytes(bytes_.getvalue())


main()
