#!/usr/bin/env python3
"""Compares the frequencies of the banks in two folders and in the folders below them; with --of-fresh only of those that FRESH has.

usage: compare_banks.py [--of-fresh] KEPT FRESH

FRESH has all modes of the band, KEPT perhaps the most important ones only, which depend on what modes radiate. Prints each
bank with a frequency that FRESH has not within 1e-5, or that is in one of the folders only. Exit code 1 when there is one.
"""
import math
import os
import pathlib
import sys

sys.path.append(str(pathlib.Path(__file__).resolve().parents[1] / "support"))

from bank_document import read_bank

TOLERANCE = 1e-5  # gmsh puts nodes on curves of booleans a little differently each time: 1.3e-6 of a frequency was seen


def frequencies(path):
    """Of a bank's modes without damping, which differs with what they radiate; sorted [Hz]."""
    model, numbers = read_bank(path)
    damped, decays = (numbers(model[key]) for key in ("frequencies", "decayRates"))
    return sorted(math.hypot(f, d / (2 * math.pi)) for f, d in zip(damped, decays))


def banks_below(folder):
    return {
        os.path.relpath(os.path.join(root, name), folder)
        for root, _, files in os.walk(folder)
        for name in files
        if name.endswith(".glb")
    }


def difference(kept, fresh):
    """A sentence, or nothing when they agree."""
    if not (os.path.exists(kept) and os.path.exists(fresh)):
        return "is in one of the folders only"
    left, worst = frequencies(fresh), 0
    for frequency in frequencies(kept):
        if not left:
            return "has more modes than were found anew"
        nearest = min(range(len(left)), key=lambda i: abs(left[i] - frequency))
        worst = max(worst, abs(left.pop(nearest) / frequency - 1))
    return f"has frequencies that differ by {worst:.1e}" if worst > TOLERANCE else ""


def main():
    of_fresh, folders = "--of-fresh" in sys.argv, [word for word in sys.argv[1:] if word != "--of-fresh"]
    if len(folders) != 2:
        sys.exit(__doc__)
    kept, fresh = folders
    names, faults = sorted(banks_below(fresh) if of_fresh else banks_below(kept) | banks_below(fresh)), 0
    for name in names:
        sentence = difference(os.path.join(kept, name), os.path.join(fresh, name))
        if sentence:
            faults += 1
            print(f"{name} {sentence}")
    print(f"{len(names)} banks compared, {faults} differ")
    sys.exit(faults > 0)


if __name__ == "__main__":
    main()
