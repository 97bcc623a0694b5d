#!/usr/bin/python3
"""Whether this tree can be released: check.py [SOURCE]   (./run release --check)

Prints one line for each condition, "ok" or "missing" with what to do, and exits with 1 while anything is missing:
versions that agree, a dated changelog, generated pages as the programs write them, the binary interface of the C
libraries, the project's home, packages that were built and tried, and the tag."""
import pathlib
import re
import subprocess
import sys

ROOT = pathlib.Path(sys.argv[1] if len(sys.argv) > 1 else __file__).resolve()
ROOT = ROOT if ROOT.is_dir() else ROOT.parents[2]


def text_of(name):
    return (ROOT / name).read_text(encoding="utf-8")


def found(pattern, name):
    match = re.search(pattern, text_of(name), re.M)
    return match[1] if match else None


def git(*words):
    return subprocess.run(["git", "-C", ROOT, *words], capture_output=True, text=True).stdout.strip()


VERSION = found(r"^project\(ringdown VERSION ([0-9.]+)", "CMakeLists.txt")
MAJOR = VERSION.split(".")[0]


def versions_agree():
    places = {
        "CHANGELOG.md": r"^## ([0-9.]+) ",
        "debian/changelog": r"^ringdown \(([0-9.]+)\)",
        "clients/python/pyproject.toml": r'^version = "(.*)"',
        "clients/unity/package.json": r'"version": "([0-9.]+)",',
        "clients/unreal/Ringdown.uplugin": r'"VersionName": "(.*)"',
        "clients/library/ringdown.h": r'library\'s version, "([0-9.]+)"',
        "docs/reference/versions.md": r"`kVersion`\) \| [^|]* \| ([0-9.]+) \|",
        "docs/reference/bank-format.md": r'"generator": "ringdown ([0-9.]+)"',
    }
    for name, pattern in places.items():
        if found(pattern, name) != VERSION:
            yield f"{name} says {found(pattern, name)}, CMakeLists.txt {VERSION}"
    numbers = {
        "clients/library/CMakeLists.txt": r"^set\(RINGDOWN_SOVERSION (\d+)\)",
        "clients/library/ringdown.h": r"libringdown\.so\.(\d+) add",
        "clients/library/ringdown.map": r"^RINGDOWN_(\d+) \{",
        "debian/control": r"^Package: libringdown(\d+)$",
        "docs/reference/versions.md": r"`libringdown\.so\.\d+` \| (\d+) \|",
    }
    for name, pattern in numbers.items():
        if found(pattern, name) != MAJOR:
            yield f"{name} gives the C libraries the number {found(pattern, name)}, version {VERSION} {MAJOR}"


def version_is_stable():
    if int(MAJOR) < 1:
        yield f"version {VERSION} promises nothing; a release that people can rely on is 1.0.0 or later"


def changelog_is_dated():
    heading = found(r"^## (.*)", "CHANGELOG.md")
    if not re.fullmatch(r"[0-9.]+ \(\d{4}-\d\d-\d\d\)", heading):
        yield f"the heading '{heading}' of CHANGELOG.md needs a date: ## {VERSION} (YYYY-MM-DD)"
    if found(r"^ringdown \(.*\) (\S+);", "debian/changelog") == "UNRELEASED":
        yield "debian/changelog says UNRELEASED: dch -r"


def generated_pages_are_current():
    program = ROOT / "build/release/bin/ringdown"
    if not program.exists():
        yield "build/release/bin/ringdown is not built, so that generated pages cannot be compared: ./run build"
        return
    said = subprocess.run([program, "protocol", "--markdown"], capture_output=True, text=True).stdout
    if said != text_of("docs/reference/protocol.md"):
        yield "docs/reference/protocol.md is not what the programs say: ./run docs"
    version = subprocess.run([program, "--version"], capture_output=True, text=True).stdout
    if f"ringdown {VERSION}\n" not in version:
        yield f"build/release/bin/ringdown is not version {VERSION}: ./run build"


def binary_interface_holds():
    last = git("describe", "--tags", "--abbrev=0", "--match", "v*", "HEAD^")
    tables = [[]]
    if last and last.split(".")[0] == f"v{MAJOR}":
        table = ROOT / "build/last-abi.txt"
        table.parent.mkdir(exist_ok=True)
        table.write_text(git("show", f"{last}:clients/library/abi.txt") + "\n")
        tables.append(["--against", table])
    for words in tables:
        ran = subprocess.run([ROOT / "tests/library/abi.py", ROOT, *words], capture_output=True, text=True)
        if ran.returncode != 0:
            yield ran.stdout.strip()


def home_is_known():
    if not found(r'HOMEPAGE_URL "(https://[^"]+)"', "CMakeLists.txt"):
        yield "CMakeLists.txt has no HOMEPAGE_URL, without which the metadata for software centres have no screenshots"


def packages_are_tried():
    folder = ROOT / "build/package"
    packages = list(folder.glob(f"*_{VERSION}_*.deb"))
    if not packages:
        yield f"no packages of version {VERSION} are in build/package: ./run package"
        return
    for suite in ("bookworm", "trixie"):
        tried = folder / f"tried-{suite}"
        if not tried.exists() or tried.stat().st_mtime < max(package.stat().st_mtime for package in packages):
            yield f"the packages were not tried in a fresh {suite}: SUITE={suite} ./run package, as root with mmdebstrap"


def commit_is_tagged():
    if git("status", "--porcelain"):
        yield "there are changes that are not committed"
    if f"v{VERSION}" not in git("tag", "--points-at", "HEAD").split():
        yield f"the commit has no tag: git tag -a v{VERSION}"


def main():
    missing = 0
    for condition in (versions_agree, version_is_stable, changelog_is_dated, generated_pages_are_current, binary_interface_holds,
                      home_is_known, packages_are_tried, commit_is_tagged):
        faults = list(condition())
        missing += len(faults)
        name = condition.__name__.replace("_", " ")
        print("\n".join(f"missing  {name}: {fault}" for fault in faults) or f"ok       {name}")
    print(f"{missing} missing" if missing else f"version {VERSION} can be released")
    return 1 if missing else 0


sys.exit(main())
