#!/usr/bin/env python3
"""lint.py [--since COMMIT] [--files N]

Checks the C++ files that have changed since a commit, the latest first and at most N of them: each compiles by itself,
without precompiled headers and unity builds, and clang-tidy finds nothing in the lines that have changed (.clang-tidy has
the list of its checks). Without --since this is the last commit that the upstream branch has, or, where that is the newest
one, the newest commit that is more than a day older. Needs clang-22 and clang-tidy-22, and exits with 77 without them.
"""
import argparse
import concurrent.futures
import json
import os
import re
import shlex
import shutil
import subprocess
import sys

# Of designated initialisers, of what <algorithm> of g++ 12 uses, and of a header that is compiled by itself.
QUIET = ("-Wno-missing-field-initializers", "-Wno-deprecated-declarations", "-Wno-pragma-once-outside-header")
FOLDERS = ("engine", "protocol", "server", "clients", "packaging")


def git(*words):
    done = subprocess.run(["git", *words], capture_output=True, text=True)
    return done.stdout.strip() if done.returncode == 0 else ""


def last_landing():
    base = git("merge-base", "HEAD", "origin/HEAD")
    if base and base != git("rev-parse", "HEAD"):
        return base
    a_day_before = int(git("log", "-1", "--format=%ct")) - 86400
    return git("rev-list", "-1", f"--before={a_day_before}", "HEAD") or git("rev-list", "--max-parents=0", "HEAD")


def changed_lines(base):
    """{file: [[first, last], ...]}, the lines that were added since, and in no file that exists no longer."""
    lines, name = {}, None
    for row in git("diff", "-U0", "--no-renames", base, "--", *FOLDERS).splitlines():
        if row.startswith("+++ "):
            name = row[6:] if row.startswith("+++ b/") and row.endswith((".cpp", ".h")) else None
        added = re.match(r"@@ -\S+ \+(\d+)(?:,(\d+))? @@", row)
        if name and added and added[2] != "0":
            first = int(added[1])
            lines.setdefault(name, []).append([first, first + int(added[2] or 1) - 1])
    return lines


def latest_first(files, base):
    order = dict.fromkeys(git("diff", "--name-only", "HEAD").splitlines())
    order.update(dict.fromkeys(git("log", "--format=", "--name-only", f"{base}..HEAD").splitlines()))
    return [name for name in order if name in files]


def options_for(name, commands):
    """The options by which a file is compiled, for a header those of its .cpp or of a neighbour; None if there is none."""
    twin = name[: name.rfind(".")] + ".cpp"
    entry = commands.get(twin)
    folder = os.path.dirname(name)
    while entry is None and folder and name.endswith(".h"):
        entry = next((commands[other] for other in sorted(commands) if other.startswith(folder + "/")), None)
        folder = os.path.dirname(folder)
    if entry is None:
        return None
    words = shlex.split(entry["command"])
    words = words[next(i for i, word in enumerate(words) if word.endswith("++")) + 1 : words.index("-o")]
    return [word for word in words if not re.match(r"-(W|f|O|g)|--param", word)]


def check(name, options, filter_):
    tidy = ["clang-tidy-22", "--quiet", f"--line-filter={filter_}", name, "--", "-x", "c++", "-Wall", "-Wextra", *QUIET, *options]
    done = subprocess.run(tidy, capture_output=True, text=True)
    found = [row for row in done.stdout.splitlines() if re.search(r": (warning|error):", row)]
    return name, found, done.stdout


def main():
    words = argparse.ArgumentParser(usage=__doc__)
    words.add_argument("--since", default="")
    words.add_argument("--files", type=int, default=24)
    given = words.parse_args()
    if not shutil.which("clang-tidy-22"):
        print("skipped: this needs clang-tidy-22")
        return 77
    base = given.since or last_landing()
    lines = changed_lines(base)
    files = latest_first(lines, base)[: given.files]
    with open("build/lint/compile_commands.json") as file:
        commands = {os.path.relpath(entry["file"]): entry for entry in json.load(file)}
    tasks = [(name, options) for name in files if not name.endswith("-inl.h") and (options := options_for(name, commands))]
    filter_ = json.dumps([{"name": name, "lines": lines[name]} for name in files])
    bad = 0
    with concurrent.futures.ThreadPoolExecutor(os.cpu_count()) as pool:
        for name, found, text in pool.map(lambda task: check(*task, filter_), tasks):
            bad += bool(found)
            if found:
                print(text)
    print(f"lint: {len(tasks)} of {len(lines)} files changed since {base[:12]}, {bad} with findings")
    return 1 if bad else 0


if __name__ == "__main__":
    sys.exit(main())
