#!/usr/bin/env python3
"""Bakes every preset afresh, one by one, and compares with the banks that are committed.

usage: check_presets.py BIN PRESETS FOLDER

Prints for each object the seconds of processor time, its size and the largest relative difference of a frequency; with
a key `budget_s` in the object's file the time is held against it. Exit code 1 when a bake fails, a frequency differs by
more than 1e-6, or a bake takes longer than its budget.
"""
import json
import os
import resource
import struct
import subprocess
import sys
import tomllib

TOLERANCE = 1e-6


def frequencies(path):
    """Of a bank, sorted [Hz]."""
    with open(path, "rb") as file:
        data = file.read()
    size = struct.unpack_from("<I", data, 12)[0]
    document, binary = json.loads(data[20 : 20 + size]), data[28 + size :]
    model = document["extensions"]["KHR_audio_rigid_bodies"]["modalModels"][0]
    accessor = document["accessors"][model["frequencies"]]
    view = document["bufferViews"][accessor["bufferView"]]
    start = view.get("byteOffset", 0) + accessor.get("byteOffset", 0)
    return sorted(struct.unpack_from(f"<{accessor['count']}f", binary, start))


def objects_below(folder):
    for root, _, files in sorted(os.walk(folder)):
        for name in sorted(files):
            if name.endswith(".toml"):
                yield os.path.relpath(os.path.join(root, name), folder)[: -len(".toml")]


def bake(program, source, target):
    """-> (exit code, seconds of processor time)"""
    before = resource.getrusage(resource.RUSAGE_CHILDREN)
    code = subprocess.run([program, "-q", "--no-cache", source, "-o", target]).returncode
    after = resource.getrusage(resource.RUSAGE_CHILDREN)
    return code, after.ru_utime + after.ru_stime - before.ru_utime - before.ru_stime


def difference(fresh, kept):
    if len(fresh) != len(kept):
        return float("inf")
    return max(abs(a / b - 1) for a, b in zip(fresh, kept))


def main():
    if len(sys.argv) != 4:
        sys.exit(__doc__)
    bin_folder, presets, out = sys.argv[1:4]
    faults, total = 0, 0.0
    print(f"{'object':24} {'seconds':>8} {'budget':>8} {'kB':>6}  largest difference")
    for name in objects_below(os.path.join(presets, "objects")):
        source, target = os.path.join(presets, "objects", name + ".toml"), os.path.join(out, name + ".glb")
        os.makedirs(os.path.dirname(target), exist_ok=True)
        code, seconds = bake(os.path.join(bin_folder, "ringdown-bake"), source, target)
        total += seconds
        if code != 0:
            faults += 1
            print(f"{name:24} FAILED with exit code {code}", flush=True)
            continue
        with open(source, "rb") as file:
            budget = tomllib.load(file).get("budget_s")
        kept = os.path.join(presets, "banks", name + ".glb")
        worst = difference(frequencies(target), frequencies(kept)) if os.path.exists(kept) else float("inf")
        faulty = worst > TOLERANCE or (budget is not None and seconds > budget)
        faults += faulty
        print(f"{name:24} {seconds:8.2f} {budget if budget is not None else '-':>8} {os.path.getsize(target) / 1000:6.0f}"
              f"  {worst:.1e}{'  FAULT' if faulty else ''}", flush=True)
    print(f"{total:.0f} s of processor time, {faults} faults")
    sys.exit(faults > 0)


if __name__ == "__main__":
    main()
