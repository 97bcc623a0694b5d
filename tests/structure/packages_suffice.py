#!/usr/bin/env python3
"""The packages that packages.txt lists for the player, and for all programs, are enough to configure and build them.

packages_suffice.py SOURCE BUILD

SOURCE is the source tree, BUILD a tree built by ninja with all programs in it. What a configuration of the player finds, what
the programs include and what they link must belong to those packages or to what they depend on. (A configuration of all
programs finds optional packages too.) What debian/control builds with must be listed, too. Exits with 77 where dpkg is not at
hand.
"""
import pathlib
import re
import shutil
import subprocess
import sys
import tempfile

PLAYER = ["bin/ringdownd", "bin/ringdown"]
BAKERS = [f"bin/ringdown-{name}" for name in ("bake", "mesher", "check", "compare", "fit", "frf", "picture", "tune", "viewer")]


def said_by(*command, **options):
    return subprocess.run(command, stdout=subprocess.PIPE, text=True, check=True, **options).stdout


def listed(source, end):
    """Package names of packages.txt before the line that begins with end."""
    names = []
    for line in (source / "packages.txt").read_text().splitlines():
        if line.startswith(end):
            return names
        names += line.split("#")[0].replace(" or ", " ").split()
    raise SystemExit(f"packages.txt has no line that begins with '{end}'")


def with_dependencies(names):
    """Names of the installed packages that apt installs with these."""
    needs, provided = {}, {}
    for line in said_by("dpkg-query", "-W", "-f", "${Package}\t${Pre-Depends}, ${Depends}\t${Provides}\n").splitlines():
        package, depends, provides = line.split("\t")
        needs[package] = re.findall(r"(?:^|[,|])\s*([a-z0-9][a-z0-9.+-]*)", depends)
        for name in re.findall(r"(?:^|,)\s*([a-z0-9][a-z0-9.+-]*)", provides):
            provided.setdefault(name, []).append(package)
    found, waiting = set(), list(names)
    while waiting:
        name = waiting.pop()
        for package in [name] if name in needs else provided.get(name, []):
            if package not in found:
                found.add(package)
                waiting += needs[package]
    return found


def found_by_configuring(source):
    """Files of the system that cmake finds for the player alone."""
    with tempfile.TemporaryDirectory() as tree:
        said_by("cmake", "-S", source, "-B", tree, "--preset", "release", "-DRINGDOWN_ONLY_PLAYER=ON")
        cache = (pathlib.Path(tree) / "CMakeCache.txt").read_text()
    folders = re.findall(r"^\w+_DIR:PATH=(/usr/.*)", cache, re.M)
    libraries = re.findall(r"^(?:pkgcfg_lib_|\w+_LIBRARY).*:FILEPATH=(/usr/.*)", cache, re.M)
    modules = re.findall(r"^\w+_MODULE_NAME:INTERNAL=(.+)", cache, re.M)
    return folders + libraries + [f"{said_by('pkg-config', '--variable=pcfiledir', m).strip()}/{m}.pc" for m in modules]


def found_by_building(build, programs):
    """Headers and libraries of the system that the programs are built with."""
    made = [f for f in said_by("ninja", "-C", build, "-t", "inputs", *programs).split("\n") if re.search(r"\.(o|gch)$", f)]
    dependencies = said_by("ninja", "-C", build, "-t", "deps", *made)
    headers = set(re.findall(r"^    (/usr/\S+)$", dependencies, re.M))
    if len(headers) < 100:
        raise SystemExit(f"{build} holds no record of what {', '.join(programs)} include: build them first")
    links = said_by("ninja", "-C", build, "-t", "commands", *programs)
    return sorted(headers) + sorted(set(re.findall(r"/usr/\S+\.(?:so|a)\b", links)))


def owners(files):
    """File -> packages that own it."""
    asked = subprocess.run(["dpkg", "-S", *files], stdout=subprocess.PIPE, stderr=subprocess.DEVNULL, text=True).stdout
    found = {}
    for line in asked.splitlines():
        packages, _, path = line.partition(": /")
        found["/" + path] = {package.split(":")[0] for package in packages.split(", ")}
    return found


def report(source, end, files):
    """Prints which packages own these files and are not listed before end. Returns whether there are any."""
    enough = with_dependencies(listed(source, end))
    missing = {}
    for path, packages in owners(files).items():
        if not packages & enough:
            missing.setdefault(" or ".join(sorted(packages)), path)
    for package, path in sorted(missing.items()):
        print(f"packages.txt does not list {package} before '{end}', but {path} is needed there")
    return bool(missing)


def unlisted_of_debian(source):
    """Prints which packages debian/control builds with and packages.txt does not list. Returns whether there are any."""
    field = re.search(r"^Build-Depends:(.*(?:\n .*)*)", (source / "debian/control").read_text(), re.M)[1]
    needed = {re.sub(r"-compat|\(.*\)", "", name).strip() for name in re.split(r"[,|]", field)}
    missing = needed - set((source / "packages.txt").read_text().split())
    for package in sorted(missing):
        print(f"debian/control builds with {package}, which packages.txt does not list")
    return bool(missing)


def main():
    source, build = map(pathlib.Path, sys.argv[1:3])
    if not shutil.which("dpkg-query"):
        return 77
    faults = [
        report(source, "# all programs", found_by_configuring(source) + found_by_building(build, PLAYER)),
        report(source, "# tests", found_by_building(build, PLAYER + BAKERS)),
        unlisted_of_debian(source),
    ]
    return int(any(faults))


sys.exit(main())
