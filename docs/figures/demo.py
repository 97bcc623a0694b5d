#!/usr/bin/env python3
"""Renders the demo scene and writes its picture and its sound, docs/figures/demo.png and demo.ogg: demo.py RINGDOWN

RINGDOWN is the program. Needs what plot_wave.py needs, and libsndfile, which encodes Ogg Vorbis.
"""
import ctypes
import pathlib
import subprocess
import sys
import tempfile

FIGURES = pathlib.Path(__file__).resolve().parent
SCENE = FIGURES.parents[1] / "presets/scenes/demo.toml"
READ, WRITE, OGG_VORBIS, SET_QUALITY = 0x10, 0x20, 0x200060, 0x1300  # of sndfile.h
PIECE = 4096  # frames; the Vorbis encoder takes no whole file at once


class Info(ctypes.Structure):
    _fields_ = [("frames", ctypes.c_int64)] + [
        (name, ctypes.c_int) for name in ("rate", "channels", "format", "sections", "seekable")
    ]


def to_ogg(wav, ogg, quality=0.7):
    sndfile = ctypes.CDLL("libsndfile.so.1")
    sndfile.sf_open.restype = ctypes.c_void_p
    source = Info()
    file = ctypes.c_void_p(sndfile.sf_open(str(wav).encode(), READ, ctypes.byref(source)))
    samples = (ctypes.c_float * (source.frames * source.channels))()
    sndfile.sf_readf_float(file, samples, ctypes.c_int64(source.frames))
    sndfile.sf_close(file)
    kind = Info(rate=source.rate, channels=source.channels, format=OGG_VORBIS)
    file = ctypes.c_void_p(sndfile.sf_open(str(ogg).encode(), WRITE, ctypes.byref(kind)))
    sndfile.sf_command(file, SET_QUALITY, ctypes.byref(ctypes.c_double(quality)), 8)
    for first in range(0, source.frames, PIECE):
        count = min(PIECE, source.frames - first)
        piece = ctypes.byref(samples, first * source.channels * ctypes.sizeof(ctypes.c_float))
        if sndfile.sf_writef_float(file, piece, ctypes.c_int64(count)) != count:
            sys.exit(f"cannot write {ogg}")
    sndfile.sf_close(file)


def main():
    if len(sys.argv) != 2:
        sys.exit(__doc__)
    with tempfile.TemporaryDirectory() as folder:
        wav = pathlib.Path(folder) / "demo.wav"
        subprocess.run([sys.argv[1], "render", "--scene", SCENE, "--tail", "0", "-o", wav], check=True)
        subprocess.run([sys.executable, FIGURES / "plot_wave.py", wav, FIGURES / "demo.png"], check=True)
        to_ogg(wav, FIGURES / "demo.ogg")


main()
