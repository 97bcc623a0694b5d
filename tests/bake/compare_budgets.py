#!/usr/bin/env python3
"""Holds what `ringdown bake FOLDER` printed against the budgets of its objects, at the pace of this machine.

usage: compare_budgets.py LOG

A processor that is shared with other work counts up to twice the seconds for the same bake, so the pace is the median of
seconds over budget. An object is over when it exceeds its budget and takes more than twice what the others take of
theirs. Prints each such object and the pace. Exit code 1 when there is one, or no object with a budget.
"""
import re
import statistics
import sys

ALLOWED = 2


def main():
    if len(sys.argv) != 2:
        print(__doc__.split("\n\n")[1], file=sys.stderr)
        return 2
    with open(sys.argv[1], encoding="utf-8") as log:
        lines = re.findall(r"^(\S+): baked, .* s, (\S+) s of processor time \(budget (\S+) s\)", log.read(), re.M)
    shares = {name: float(seconds) / float(budget) for name, seconds, budget in lines}
    if not shares:
        print("no object with a budget was baked")
        return 1
    pace = statistics.median(shares.values())
    over = {name: share for name, share in shares.items() if share > max(1, ALLOWED * pace)}
    for name, share in over.items():
        print(f"{name} takes {share:.2f} of its budget, where {ALLOWED * pace:.2f} is allowed")
    print(f"{len(shares)} budgets compared, {len(over)} exceeded; the median is {pace:.2f} of a budget")
    return 1 if over else 0


if __name__ == "__main__":
    sys.exit(main())
