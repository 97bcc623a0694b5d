#!/usr/bin/env python3
"""Spectrograms of two-way contacts, and where on the plane of speed and force a vibraphone's bar can be bowed.

    docs/figures/plot_contacts.py build/bench/bin/ringdown docs/figures/contacts.png
"""
import json
import pathlib
import struct
import subprocess
import sys
import tempfile

import matplotlib

matplotlib.use("Agg")
import matplotlib.pyplot as plt
import numpy as np

BANKS = pathlib.Path(__file__).resolve().parents[2] / "presets/banks"
RATE = 48000

# name, objects, score, seconds
SCORES = [
    ("vibraphone bar: bowed at its end, faster, lifted", {"bar": "vibraphone-key"},
     "0 /object/bar/bow 0.1736 0 0  0 0 1  0.1 1\n3 /object/bar/bow 0.1736 0 0  0 0 1  0.4 2\n"
     "5 /object/bar/bow 0.1736 0 0  0 0 1  0.4 0\n", 7),
    ("wine glass: its rim rubbed", {"glass": "wine-glass"},
     "0 /object/glass/bow {rim}  0 1 0  0.05 1\n5 /object/glass/bow {rim}  0 1 0  0.05 0\n", 7),
    ("steel plate: bowed at its edge, harder and harder", {"plate": "steel-plate"},
     "0 /object/plate/bow {edge}  0 0 1  0.2 0.5\n2 /object/plate/bow {edge}  0 0 1  0.2 3\n"
     "4 /object/plate/bow {edge}  0 0 1  0.2 15\n6 /object/plate/bow {edge}  0 0 1  0.2 0\n", 7),
    ("porcelain bowl dropped on a steel plate, then the plate is struck", {"plate": "steel-plate", "bowl": "porcelain-bowl"},
     "0 /object/plate/couple {edge}  bowl {foot}  0 0 -1  3 0.002 1e9\n"
     "3 /object/plate/strike {edge}  0 0 -0.2 0.001\n", 7),
]


def points(bank):
    """All sample points of a preset's bank."""
    data = (BANKS / (bank + ".glb")).read_bytes()
    size = struct.unpack("<I", data[12:16])[0]
    scene = json.loads(data[20:20 + size])
    mesh = scene["accessors"][scene["meshes"][0]["primitives"][0]["attributes"]["POSITION"]]
    return np.array([mesh["min"], mesh["max"]])


def word(values):
    return " ".join(f"{v:.5g}" for v in values)


def osc(score):
    """The lines `time address arguments` as an OSC score."""
    def text(word):
        data = word.encode() + b"\0"
        return data + bytes(-len(data) % 4)

    score_bytes = b""
    for line in score.splitlines():
        time, address, *arguments = line.split()
        tags, values = ",", b""
        for argument in arguments:
            try:
                values += struct.pack(">f", float(argument))
                tags += "f"
            except ValueError:
                values += text(argument)
                tags += "s"
        message = text(address) + text(tags) + values
        bundle = b"#bundle\0" + struct.pack(">Q", int(float(time) * 2**32)) + struct.pack(">i", len(message)) + message
        score_bytes += struct.pack(">i", len(bundle)) + bundle
    return score_bytes


def render(program, objects, score, seconds):
    with tempfile.TemporaryDirectory() as folder:
        path, out = pathlib.Path(folder) / "score", pathlib.Path(folder) / "out.wav"
        path.write_bytes(osc(score))
        command = [program, "render", "--events", path, "-o", out, "--seconds", str(seconds), "--limiter", "off"]
        for name, bank in objects.items():
            command += ["--object", f"{name}={bank}"]
        subprocess.run([str(part) for part in command], check=True, stdout=subprocess.DEVNULL)
        data = out.read_bytes()
        return np.frombuffer(data[data.index(b"data") + 8:], np.float32).reshape(-1, 2)[:, 0].astype(float)


def pitch_and_level(sound):
    """The loudest partial of the last half second, and its share of the power."""
    tail = sound[-RATE // 2:] * np.hanning(RATE // 2)
    power = np.abs(np.fft.rfft(tail, 4 * len(tail))) ** 2
    top = int(np.argmax(power))
    return top * RATE / (4 * len(tail)), power[max(0, top - 12):top + 13].sum() / power.sum(), np.sqrt(np.mean(tail ** 2))


def main():
    program, target = sys.argv[1], sys.argv[2]
    rim, edge, foot = points("wine-glass"), points("steel-plate"), points("porcelain-bowl")
    places = {
        "rim": word([rim[1][0], 0, rim[1][2]]),
        "edge": word([edge[1][0], 0, 0.5 * (edge[0][2] + edge[1][2])]),
        "foot": word([0, 0, foot[0][2]]),
    }
    figure, axes = plt.subplots(3, 2, figsize=(11, 10), constrained_layout=True)
    for axis, (name, objects, score, seconds) in zip(axes.flat, SCORES):
        sound = render(program, objects, score.format(**places), seconds)
        axis.specgram(sound + 1e-9 * np.random.default_rng(1).standard_normal(len(sound)), NFFT=4096, Fs=RATE,
                      noverlap=3072, vmin=-170, vmax=-50, cmap="magma")
        axis.set(title=name, ylim=(0, 8000), xlabel="s", ylabel="Hz")
        axis.title.set_fontsize(9)
        print(name, "peak", np.abs(sound).max())
    speeds, forces = np.geomspace(0.02, 1.5, 9), np.geomspace(0.05, 20, 9)
    regions = []
    for force in forces:
        for speed in speeds:
            score = f"0 /object/bar/bow 0.1736 0 0 0 0 1 {speed:.4g} {force:.4g}\n"
            regions.append((speed, force, *pitch_and_level(render(program, {"bar": "vibraphone-key"}, score, 3))))
    regions = np.array(regions)
    shape = (len(forces), len(speeds))
    for axis, column, title in ((axes[2, 0], regions[:, 2], "bowed bar after 3 s: pitch of the loudest partial, Hz"),
                                (axes[2, 1], 20 * np.log10(regions[:, 4] + 1e-9), "bowed bar after 3 s: level, dB")):
        image = axis.pcolormesh(speeds, forces, column.reshape(shape), shading="nearest", cmap="viridis")
        axis.set(xscale="log", yscale="log", xlabel="speed, m/s", ylabel="force, N", title=title)
        axis.title.set_fontsize(9)
        figure.colorbar(image, ax=axis)
    figure.savefig(target, dpi=70)
    np.savetxt(sys.stdout, regions, fmt="%.4g", header="speed force pitch share level")


if __name__ == "__main__":
    main()
