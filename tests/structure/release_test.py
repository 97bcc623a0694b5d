#!/usr/bin/python3
"""`./run release --check` says what is missing: release_test.py SOURCE

A copy of what it reads is dated, committed and tagged; then each place that states the version is changed in turn."""
import pathlib
import re
import shutil
import subprocess
import sys
import tempfile

SOURCE = pathlib.Path(sys.argv[1])
VERSION = re.search(r"project\(ringdown VERSION ([0-9.]+)", (SOURCE / "CMakeLists.txt").read_text())[1]
STATING = ["CMakeLists.txt", "CHANGELOG.md", "clients/python/pyproject.toml", "clients/unity/package.json", "clients/unreal/Ringdown.uplugin",
           "clients/library/ringdown.h", "clients/library/CMakeLists.txt", "clients/library/ringdown.map", "docs/reference/versions.md",
           "docs/reference/bank-format.md", "debian/changelog", "debian/control"]
OTHERS = ["clients/library/ringdown_scene.h", "clients/library/abi.txt", "tests/library/abi.py", "docs/reference/protocol.md"]


def git(root, *words):
    subprocess.run(["git", "-C", root, "-c", "user.name=a", "-c", "user.email=a@b", *words], check=True, capture_output=True)


def check(root):
    ran = subprocess.run([SOURCE / "packaging/release/check.py", root], capture_output=True, text=True)
    return ran.returncode, ran.stdout + ran.stderr


def as_released(text):
    return text.replace("(unreleased)", "(2026-12-01)").replace("UNRELEASED", "unstable")


def with_others(text):
    return re.sub(r"(SOVERSION |RINGDOWN_|Package: libringdown)\d+\b", r"\g<1>99", text.replace(VERSION, "99.0.1"))


def main():
    faults = []

    def expect(condition, what, said):
        if not condition:
            faults.append(f"{what}:\n{said}")

    with tempfile.TemporaryDirectory() as home:
        root = pathlib.Path(home)
        for name in STATING + OTHERS:
            (root / name).parent.mkdir(parents=True, exist_ok=True)
            shutil.copy(SOURCE / name, root / name)
            if name in STATING:
                (root / name).write_text(as_released((SOURCE / name).read_text(encoding="utf-8")), encoding="utf-8")
        (root / ".gitignore").write_text("build\n")
        git(root, "init", "-q")
        git(root, "add", "-A")
        git(root, "commit", "-qm", "a release")
        code, said = check(root)
        for condition in ("versions agree", "version is stable", "changelog is dated"):
            expect(f"ok       {condition}" in said, f"a dated tree fails '{condition}'", said)
        expect(code == 1 and f"git tag -a v{VERSION}" in said, "the tag is not asked for", said)
        git(root, "tag", "-a", f"v{VERSION}", "-m", VERSION)
        code, said = check(root)
        expect("ok       commit is tagged" in said, "the tag is not found", said)
        expect(code == 1 and "packages are tried" in said, "packages are not asked for", said)
        for name in STATING[1:]:
            good = (root / name).read_text(encoding="utf-8")
            (root / name).write_text(with_others(good), encoding="utf-8")
            _, said = check(root)
            expect(f"versions agree: {name} " in said, f"another version in {name} is not named", said)
            (root / name).write_text(good, encoding="utf-8")
    print("\n".join(faults) or "no faults")
    return 1 if faults else 0


sys.exit(main())
