#!/usr/bin/python3
"""Makes an archive of the programs that runs from any folder, without root: make_tar.py BUILD FOLDER

Installs what was built in the tree BUILD (programs, plug-ins, C libraries, presets, documentation), puts the system's
libraries that these link into lib/ringdown with their licences, and packs FOLDER/ringdown-VERSION-PROCESSOR.tar.gz, whose
name it prints. A DT_RPATH relative to each file leads to the libraries: the loader follows it for the libraries'
own needs, too. Left out are libraries that must be the system's own: those of the C and C++ compilers, of JACK, which
must fit the server that runs, and of OpenGL, which fit the graphics card. Only ringdown-mesher, which draws nothing, has
OpenGL's in lib/ringdown/opengl, because gmsh links them."""
import gzip
import os
import pathlib
import platform
import re
import shutil
import subprocess
import sys
import tarfile

ROOT = pathlib.Path(__file__).resolve().parents[2]
COMPONENTS = ["ringdown", "ringdown-presets", "ringdown-doc", "ringdown-bake", "ringdown-viewer", "ringdown-plugin", "libringdown1",
              "libringdown-dev"]
NEEDS_A_FIXED_PLACE = ["share/applications", "share/metainfo", "share/mime", "share/icons", "libexec", "lib/systemd"]
OF_THE_SYSTEM = re.compile(r"(ld-linux.*|lib(c|m|dl|rt|util|pthread|resolv|stdc\+\+|gcc_s|jack))\.so\..*")
OPENGL = re.compile(r"lib(GL|GLX|GLdispatch|OpenGL|EGL)\.so\..*")


def said_by(*command, **options):
    return subprocess.run([str(word) for word in command], check=True, capture_output=True, text=True, **options).stdout


def installed(build, stage):
    for component in COMPONENTS:
        said_by("cmake", "--install", build, "--component", component, "--prefix", stage, "--strip")
    for name in NEEDS_A_FIXED_PLACE:
        shutil.rmtree(stage / name, ignore_errors=True)
    shutil.copy(ROOT / "debian/copyright", stage / "share/doc/ringdown/copyright")


def binaries_below(stage):
    """Programs and libraries, without the links to them."""
    for path in sorted(stage.rglob("*")):
        if path.is_file() and not path.is_symlink():
            with path.open("rb") as file:
                if file.read(4) == b"\x7fELF":
                    yield path


def libraries_of(binary, own):
    """Name -> file of all libraries of the system that a binary links, directly or not, and that go with it."""
    found = {}
    for line in said_by("ldd", binary, env={**os.environ, "LD_LIBRARY_PATH": str(own)}).splitlines():
        match = re.match(r"\s*(\S+) => (.*?) \(0x", line)
        if "not found" in line:
            sys.exit(f"{binary} links a library that is not here: {line.strip()}")
        if match and not OF_THE_SYSTEM.fullmatch(match[1]) and not match[2].startswith(str(own)):
            found[match[1]] = pathlib.Path(match[2]).resolve()
    return found


def needs_of(binaries, own, with_opengl):
    """As libraries_of() for all binaries, less what only libraries that are left out link."""
    found = {}
    for binary in binaries:
        found |= libraries_of(binary, own)
    if not with_opengl:
        found = {name: file for name, file in found.items() if not OPENGL.fullmatch(name)}
    needed, waiting = {}, list(binaries)
    while waiting:
        for name in re.findall(r"\(NEEDED\).*\[(.*)\]", said_by("readelf", "-dW", waiting.pop())):
            if name in found and name not in needed:
                needed[name] = found[name]
                waiting.append(found[name])
    return needed


def package_of(file):
    for path in (file, pathlib.Path("/") / file.relative_to("/usr") if file.is_relative_to("/usr") else file):
        asked = subprocess.run(["dpkg", "-S", str(path)], capture_output=True, text=True)
        if asked.returncode == 0:
            return asked.stdout.split(":")[0]
    sys.exit(f"no package has {file}, so its licence is not known")


def add_libraries(libraries, stage, folder):
    place, licences = stage / folder, stage / "share/doc/ringdown/libraries"
    place.mkdir()
    licences.mkdir(exist_ok=True)
    table = []
    for name, file in sorted(libraries.items()):
        shutil.copyfile(file, place / name)
        package = package_of(file)
        shutil.copyfile(f"/usr/share/doc/{package}/copyright", licences / package)
        table.append(f"{name}\t{package}\t{said_by('dpkg-query', '-W', '-f', '${Version}', package)}\n")
    with (licences / "versions.tsv").open("a") as file:
        file.writelines(table)


def pack(stage, archive, seconds):
    """The same bytes for the same files."""
    def plain(entry):
        entry.uid = entry.gid = 0
        entry.uname = entry.gname = ""
        entry.mtime = seconds
        entry.mode = 0o755 if entry.isdir() or entry.mode & 0o100 else 0o644
        return entry

    part = archive.with_name(archive.name + ".part")
    with part.open("wb") as file, gzip.GzipFile("", "wb", 6, file, mtime=seconds) as packed, \
            tarfile.open(fileobj=packed, mode="w", format=tarfile.GNU_FORMAT) as tar:
        for path in [stage, *sorted(stage.rglob("*"))]:
            tar.add(path, arcname=path.relative_to(stage.parent), recursive=False, filter=plain)
    part.rename(archive)


def main():
    build, folder = (pathlib.Path(word).resolve() for word in sys.argv[1:3])
    version = re.search(r"^project\(ringdown VERSION ([0-9.]+)", (ROOT / "CMakeLists.txt").read_text(), re.M)[1]
    stage = folder / f"ringdown-{version}-{platform.machine()}"
    shutil.rmtree(stage, ignore_errors=True)
    installed(build, stage)
    binaries = list(binaries_below(stage))
    mesher = stage / "bin/ringdown-mesher"
    shared = needs_of(binaries, stage / "lib", False)
    add_libraries(shared, stage, "lib/ringdown")
    opengl = needs_of([mesher], stage / "lib", True)
    add_libraries({name: file for name, file in opengl.items() if name not in shared}, stage, "lib/ringdown/opengl")
    for binary in binaries:
        places = ["lib/ringdown", "lib", *(["lib/ringdown/opengl"] if binary == mesher else [])]
        ways = [os.path.relpath(stage / place, binary.parent) for place in places]
        said_by("patchelf", "--force-rpath", "--set-rpath", ":".join(f"$ORIGIN/{way}" for way in ways), binary)
    seconds = int(said_by("dpkg-parsechangelog", "-l", ROOT / "debian/changelog", "-S", "Timestamp"))
    archive = folder / f"{stage.name}.tar.gz"
    pack(stage, archive, seconds)
    shutil.rmtree(stage)
    print(os.path.relpath(archive))


main()
