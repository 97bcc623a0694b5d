#!/usr/bin/python3
"""What desktops are told of Ringdown: desktop_test.py SOURCE BUILD

The entries and the metadata pass Debian's validators, the icons are as their script draws them, a file manager tells
scenes from other files, and opening a bank or a scene starts what it should. Checks without their program are left out
with a word; exits with 77 if no validator is there."""
import os
import pathlib
import shutil
import subprocess
import sys
import tempfile

SKIPPED = 77
SOURCE, BUILD = map(pathlib.Path, sys.argv[1:3])
DESKTOP = SOURCE / "packaging/desktop"


def said_by(*command, **options):
    ran = subprocess.run(command, stdout=subprocess.PIPE, stderr=subprocess.STDOUT, text=True, **options)
    return ran.returncode, ran.stdout


def entries_are_valid():
    for file in (DESKTOP / "ringdown-viewer.desktop", BUILD / "packaging/ringdown-open.desktop"):
        code, text = said_by("desktop-file-validate", file)
        if code or text:
            yield f"{file.name}: {text}"


def metadata_are_valid():
    code, text = said_by("appstreamcli", "validate", "--no-net", BUILD / "packaging/io.github.ringdown.ringdown.metainfo.xml")
    if code:
        yield text


def icons_are_as_drawn():
    code, text = said_by(DESKTOP / "draw_icon.py", "--check")
    if code:
        yield text


def scenes_are_told_from_other_files():
    with tempfile.TemporaryDirectory() as home:
        packages = pathlib.Path(home) / "mime/packages"
        packages.mkdir(parents=True)
        shutil.copyfile("/usr/share/mime/packages/freedesktop.org.xml", packages / "freedesktop.org.xml")
        shutil.copyfile(DESKTOP / "ringdown.mime.xml", packages / "ringdown.xml")
        subprocess.run(["update-mime-database", packages.parent], check=True, stderr=subprocess.DEVNULL)
        expected = {path: "application/x-ringdown-scene+toml" for path in (SOURCE / "presets/scenes").glob("*.toml")}
        expected |= {path: "application/toml" for path in (SOURCE / "presets/objects").glob("*.toml")}
        expected[SOURCE / "presets/banks/coin.glb"] = "model/gltf-binary"
        _, text = said_by("gio", "info", "-a", "standard::content-type", *expected, env={**os.environ, "XDG_DATA_HOME": home})
        types = [line.split()[-1] for line in text.splitlines() if "standard::content-type" in line]
        for path, found in zip(expected, types, strict=True):
            if found != expected[path]:
                yield f"{path.name} is {found}, not {expected[path]}"


def opened(file, answers):
    """What the opener starts, with programs of wood in place of the real ones; `answers`: whether a daemon runs."""
    with tempfile.TemporaryDirectory() as home:
        log = pathlib.Path(home) / "log"
        for name in ("ringdown", "ringdownd", "ringdown-viewer", "xdg-open"):
            program = pathlib.Path(home) / name
            program.write_text(f'#!/bin/sh\necho "{name} $*" >>"{log}"\n[ "$1" != send ] || exit {0 if answers else 5}\n'
                               f'[ {name} != ringdownd ] || exec sleep 60\n[ {name} != ringdown-viewer ] || sleep 0.2\n')
            program.chmod(0o755)
        environment = {**os.environ, "PATH": f"{home}:{os.environ['PATH']}", "XDG_CACHE_HOME": f"{home}/cache"}
        code, text = said_by(DESKTOP / "ringdown-open", file, env=environment, timeout=20)  # a daemon that stayed would outlive it
        assert code == 0, text
        return log.read_text().replace(home, "HOME")


def opening_starts_what_it_should():
    bank, scene = SOURCE.resolve() / "presets/banks/coin.glb", SOURCE.resolve() / "presets/scenes/demo.toml"
    page = "HOME/cache/ringdown/pages/coin.html"
    ask = "ringdown send /version --timeout 0.5\n"
    for file, answers, expected in (
            (bank, False, [f"ringdown picture {bank} -o {page}", f"xdg-open {page}"]),
            (scene, True, [ask.strip(), f"ringdown-viewer --scene {scene}"]),
            (scene, False, [ask.strip(), f"ringdownd --scene {scene} --root {scene.parent} --connect", "ringdown-viewer "])):
        lines = opened(file, answers).splitlines()
        if sorted(lines) != sorted(expected):
            yield f"opening {file.name} starts {lines}"


def main():
    checks = {"desktop-file-validate": entries_are_valid, "appstreamcli": metadata_are_valid, "gio": scenes_are_told_from_other_files,
              "python3": icons_are_as_drawn, "sh": opening_starts_what_it_should}
    faults, left_out = [], []
    for program, check in checks.items():
        if shutil.which(program):
            faults += check()
        else:
            left_out.append(program)
    if left_out:
        print(f"skipped: {', '.join(left_out)} is not installed")
    print("\n".join(faults) or "no faults")
    return 1 if faults else SKIPPED if left_out else 0


sys.exit(main())
