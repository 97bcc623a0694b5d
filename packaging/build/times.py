#!/usr/bin/env python3
"""What a build cost, by target, beside what it cost when packaging/build/seconds.tsv was written.

times.py STEPS MEASURES [--tests] [--check | --write]

STEPS and MEASURES are files of packaging/build/step: the steps of the build, and packaging/build/measure.cpp, compiled
several times beside it. Links are not among them. Seconds are processor seconds, user and system. --check fails if the
sum is a quarter above the table's, in units of measure.cpp. --write replaces the rows of these steps in the table.
"""
import collections
import pathlib
import re
import statistics
import sys

TABLE = pathlib.Path(__file__).with_name("seconds.tsv")
MEASURE = "measure.cpp"
TESTS = 0.95  # cost of the player by the tests' options: those of its files that are not COLD take 0.89 of the time at -O2


def rows(path):
    """Step -> seconds; a step that ran twice counts twice."""
    found = collections.Counter()
    for line in pathlib.Path(path).read_text().splitlines():
        *seconds, made = line.split()
        found[made] += sum(map(float, seconds))
    return found


def target_of(made):
    """The target of a compiled file; None for what is linked, which ccache does not see."""
    inside = re.search(r"CMakeFiles/([^/]+)\.dir/", made)
    return inside and inside.group(1)


def by_target(steps):
    sums = collections.Counter()
    for made, seconds in steps.items():
        if target_of(made):
            sums[target_of(made)] += seconds
    return sums


def main():
    steps = rows(sys.argv[1])
    measure = statistics.median(
        sum(map(float, line.split()[:-1])) for line in pathlib.Path(sys.argv[2]).read_text().splitlines()
    )
    table = rows(TABLE)
    speed = measure / table[MEASURE]  # of the machine that wrote the table, over this one's
    if "--tests" in sys.argv:
        speed *= TESTS
    now, then = by_target(steps), by_target(table)
    print(f"{'seconds':>8} {'table':>8}  target")
    for target, seconds in now.most_common():
        print(f"{seconds:8.1f} {then[target] * speed:8.1f}  {target}")
    total, expected = sum(now.values()), speed * sum(then[target] for target in now)
    print(f"{total:8.1f} {expected:8.1f}  in all, of processor time ({measure:.1f} s for {MEASURE})")
    if "--write" in sys.argv:
        rows_now = {made: seconds for made, seconds in table.items() if target_of(made) not in now}
        rows_now |= {made: seconds / speed for made, seconds in steps.items()}
        text = "".join(f"{seconds:.1f} {made}\n" for made, seconds in sorted(rows_now.items()) if seconds >= 0.05)
        TABLE.write_text(text)
    if "--check" in sys.argv and total > 1.25 * expected:
        print(f"building has become {total / expected - 1:.0%} more expensive than {TABLE.name} says, and more than a "
              "quarter is refused: make it cheaper, or say why in the commit that writes the table anew (--write)")
        return 1
    return 0


sys.exit(main())
