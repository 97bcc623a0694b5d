#!/usr/bin/env python3
"""Compares what `ringdown check mesh` says that a bake takes with what it takes, for the surfaces of ugly_assets.py.

usage: ugly_checks.py FOLDER_OF_PROGRAMS FOLDER [NAME...]

Prints a line for each asset: what was said and what came, of unknowns, modes, processor seconds with those of the mesh,
and MiB. Exit code 1 when unknowns, seconds or MiB are more than a factor of two off.
"""
import os
import re
import subprocess
import sys

import ugly_assets
import ugly_bakes

MOST_OFF = 2
SHORT_S = 1  # bakes that take less are not compared in seconds


def said_of(program, path, cache):
    command = [program, "mesh", path, "--material", ugly_bakes.MATERIAL]
    environment = dict(os.environ, OMP_NUM_THREADS="1", OPENBLAS_NUM_THREADS="1", XDG_CACHE_HOME=cache)
    text = subprocess.run(command, env=environment, capture_output=True, text=True, check=False).stdout
    found = re.search(r"([\d.e+]+) modes, ([\d.e+]+) s of .* after ([\d.e+-]+) s .*, ([\d.e+-]+) GiB", text)
    if not found:
        return None
    modes, solve_s, mesh_s, gib = map(float, found.groups())
    return float(re.search(r"(\d+) unknowns", text).group(1)), modes, solve_s + mesh_s, 1024 * gib


def came_of(run):
    log = run.said
    modes = int(re.search(r"(\d+) modes,", log).group(1))
    modes += sum(int(re.search(rf"(\d+) {why}", log).group(1)) for why in ("below", "inaudible", "unimportant"))
    return run.bank.unknowns, modes, run.seconds, run.mebibytes


def main(arguments):
    if len(arguments) < 2:
        sys.exit(__doc__)
    programs, folder = arguments[:2]
    names, faults = arguments[2:] or list(ugly_assets.ASSETS), []
    ugly_assets.main([folder, *names])
    for name in names:
        path = os.path.join(folder, name + ".ply")
        cache = os.path.join(folder, "cache-" + str(os.getpid()))  # empty, so that the mesh is made
        said = said_of(os.path.join(programs, "ringdown-check"), path, cache)
        program = os.path.join(programs, "ringdown-bake")
        run = ugly_bakes.bake(program, path, path + ".glb", ugly_bakes.LIMIT_S, "--no-cache")
        if not said or not run.bank:
            print(name, "is refused" if not said and not run.bank else "is refused by one of the two")
            faults += [name] if said or run.bank else []
            continue
        came = came_of(run)
        pairs = zip(("unknowns", "modes", "s", "MiB"), said, came)
        print(name, *(f"{what} {a:.3g} {b:.3g}" for what, a, b in pairs), sep="\t", flush=True)
        ratios = [max(said[n] / came[n], came[n] / said[n]) for n in (0, 2, 3) if n != 2 or came[n] >= SHORT_S]
        faults += [name] if max(ratios) > MOST_OFF else []
    print("off by more than a factor of two:", ", ".join(faults) or "none")
    sys.exit(1 if faults else 0)


if __name__ == "__main__":
    main(sys.argv[1:])
