#!/usr/bin/env python3
"""Bakes the surfaces of ugly_assets.py, each in a process of its own, and compares them with their truths.

usage: ugly_bakes.py PROGRAM FOLDER TABLE [NAME...]

PROGRAM is ringdown-bake. Assets and banks go to FOLDER, the table, in Markdown, to TABLE. The truth of an asset is its
sound body, baked until the estimated errors are far below those of the asset: mostly a geometry, meshed by another
program from its equations. Compared are the first 20 modes, in order. Exit code 1 when an asset bakes that is more than
1 % off in its mass or 3 % in its first frequency, when fewer than 21 bake, or when fewer than 95 % of the modes are as
near to the truth as their banks state.
"""
import os
import pathlib
import resource
import statistics
import subprocess
import sys
from dataclasses import dataclass

import ugly_assets

sys.path.append(str(pathlib.Path(__file__).resolve().parents[1] / "support"))

from bank_document import read_bank

LIMIT_S = 150  # of processor time, for each process of a bake
TRUTH_LIMIT_S = 60
PREVIEW_S = 10  # of processor time, that a preview should take at most
LIMIT_BYTES = 3 << 30  # of memory
MODES = 20
MATERIAL = "porcelain"
BAND_HZ = 20_000
SLACK = 3e-4  # of round bodies in 96 sides
FEWEST_BAKED = 21


@dataclass
class Bank:
    frequency_hz: list
    error: list
    mass_kg: float
    unknowns: int
    body: str

    @staticmethod
    def read(path):
        model, numbers = read_bank(path)
        ours = model["extras"]["ringdown"]
        modes = sorted(zip(numbers(model["frequencies"]), ours["frequencyErrors"]))
        mass = model["massProperties"]["mass"]
        return Bank([f for f, _ in modes], [e for _, e in modes], mass, ours["unknowns"], ours["body"])


@dataclass
class Run:
    bank: Bank  # or None
    said: str
    seconds: float  # of processor time
    mebibytes: float


def limit(seconds):
    resource.setrlimit(resource.RLIMIT_CPU, (seconds, seconds))
    resource.setrlimit(resource.RLIMIT_AS, (LIMIT_BYTES, LIMIT_BYTES))


def bake(program, path, to, limit_s, *options, material=MATERIAL):
    if os.path.exists(to):
        os.remove(to)
    command = [program, path, "--material", material, "-o", to, *options]
    one_thread = dict(os.environ, OMP_NUM_THREADS="1", OPENBLAS_NUM_THREADS="1")
    with open(to + ".log", "w", encoding="utf-8") as log:
        process = subprocess.Popen(
            command,
            env=one_thread,
            stdout=log,
            stderr=log,
            preexec_fn=lambda: limit(limit_s),
        )
        _, status, usage = os.wait4(process.pid, 0)
        process.returncode = os.waitstatus_to_exitcode(status)
    with open(to + ".log", encoding="utf-8") as log:
        said = log.read().strip()
    done = process.returncode == 0 and os.path.exists(to)
    seconds = usage.ru_utime + usage.ru_stime
    return Run(Bank.read(to) if done else None, said or f"not done in {limit_s} s", seconds, usage.ru_maxrss / 1024)


def truth_of(program, folder, name, top_hz):
    for ending in ("geo", "ply"):
        path = os.path.join(folder, f"{name}.truth.{ending}")
        if not os.path.exists(path):
            continue
        for error in (["--error", "0.3%"], ["--error", "1.5%"], []):
            options = ["--band", "20", str(top_hz), *error]
            run = bake(program, path, os.path.join(folder, f"{name}.truth.glb"), TRUTH_LIMIT_S, *options)
            if run.bank:
                return run.bank
    return None


@dataclass
class Comparison:
    true: list  # error of each mode, relative
    stated: list
    doubt: list  # of the truth

    def __init__(self, bank, truth):
        count = min(MODES, len(bank.frequency_hz), len(truth.frequency_hz))
        self.true = [abs(f / t - 1) for f, t in zip(bank.frequency_hz[:count], truth.frequency_hz[:count])]
        self.stated = bank.error[:count]
        self.doubt = [SLACK + e for e in truth.error[:count]]

    def covered(self):
        return sum(t <= s + d for t, s, d in zip(self.true, self.stated, self.doubt))


HEAD = (
    "| asset | what is wrong | mass kg | truth | first Hz | truth | median error %: true | stated | within | unknowns "
    "| seconds | MiB | preview s |\n|--|--|--|--|--|--|--|--|--|--|--|--|--|"
)


def row_of(name, wrong, run, truth, comparison, preview):
    end = f"{run.seconds:.0f} | {run.mebibytes:.0f} | {f'{preview.seconds:.1f}' if preview.bank else 'none'} |"
    start = f"| `{name}` | {wrong} |"
    if not run.bank:
        return f"{start} {run.said.splitlines()[-1]} | | | | | | | | {end}"
    bank = run.bank
    text = f"{start} {bank.mass_kg:.4g} |"
    if not truth:
        return f"{text} none | {bank.frequency_hz[0]:.1f} | | | | | {bank.unknowns} | {end}"
    true, stated = (100 * statistics.median(e) for e in (comparison.true, comparison.stated))
    return (
        f"{text} {truth.mass_kg:.4g} | {bank.frequency_hz[0]:.1f} | {truth.frequency_hz[0]:.1f} | {true:.2g} | {stated:.2g} "
        f"| {comparison.covered()} of {len(comparison.true)} | {bank.unknowns} | {end}"
    )


def main(arguments):
    if len(arguments) < 3:
        sys.exit(__doc__)
    program, folder, table = arguments[:3]
    names = arguments[3:] or list(ugly_assets.ASSETS)
    ugly_assets.main([folder, *names])
    os.makedirs(os.path.dirname(table) or ".", exist_ok=True)
    faults, slow_previews, baked, ratios, covered, compared = [], [], 0, [], 0, 0
    with open(table, "w", encoding="utf-8") as out:
        print(HEAD, file=out)
        for name in names:
            path = os.path.join(folder, name)
            run = bake(program, path + ".ply", path + ".glb", LIMIT_S, "--no-cache")
            preview = bake(program, path + ".ply", path + ".preview.glb", LIMIT_S, "--no-cache", "--preview")
            slow_previews += [name] if preview.seconds > PREVIEW_S or not preview.bank else []
            truth = comparison = None
            if run.bank:
                baked += 1
                last = run.bank.frequency_hz[: MODES + 1][-1]
                truth = truth_of(program, folder, name, min(BAND_HZ, 1.03 * last))
            if truth:
                comparison = Comparison(run.bank, truth)
                covered += comparison.covered()
                compared += len(comparison.true)
                ratios.append(statistics.median(s / max(t, SLACK) for t, s in zip(comparison.true, comparison.stated)))
                if abs(run.bank.mass_kg / truth.mass_kg - 1) > 0.01 or comparison.true[0] > 0.03:
                    faults.append(f"{name} is wrong")
            row = row_of(name, ugly_assets.ASSETS[name]().wrong, run, truth, comparison, preview)
            print(row, file=out, flush=True)
            print(row, flush=True)
    print(f"{baked} of {len(names)} baked; {covered} of {compared} modes are within their stated error")
    print(f"previews of more than {PREVIEW_S} s of processor time: {', '.join(slow_previews) or 'none'}")
    if ratios:
        print(f"median stated over true: {statistics.median(ratios):.2g} in the median body, {max(ratios):.2g} at most")
    if covered < 0.95 * compared:
        faults.append("the stated errors are too small")
    if len(names) == len(ugly_assets.ASSETS) and baked < FEWEST_BAKED:
        faults.append("too few bake")
    for fault in faults:
        print(fault)
    sys.exit(1 if faults else 0)


if __name__ == "__main__":
    main(sys.argv[1:])
