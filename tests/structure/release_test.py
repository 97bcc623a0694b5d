#!/usr/bin/python3
"""`./run release --check` says what is missing: release_test.py SOURCE

A copy of what it reads becomes version 1.0.0, dated, committed and tagged; then each place that states the version is
changed in turn."""
import pathlib
import shutil
import subprocess
import sys
import tempfile

SOURCE = pathlib.Path(sys.argv[1])
STATING = ["CMakeLists.txt", "CHANGELOG.md", "clients/python/pyproject.toml", "clients/library/ringdown.h", "docs/reference/versions.md",
           "docs/reference/bank-format.md", "debian/changelog", "clients/library/CMakeLists.txt"]
OTHERS = ["clients/library/ringdown_scene.h", "clients/library/abi.txt", "tests/library/abi.py", "docs/reference/protocol.md"]


def git(root, *words):
    subprocess.run(["git", "-C", root, "-c", "user.name=a", "-c", "user.email=a@b", *words], check=True, capture_output=True)


def check(root):
    ran = subprocess.run([SOURCE / "packaging/release/check.py", root], capture_output=True, text=True)
    return ran.returncode, ran.stdout + ran.stderr


def as_released(text):
    for old, new in (("0.1.0 (unreleased)", "1.0.0 (2026-12-01)"), ("0.1.0", "1.0.0"), ("UNRELEASED", "unstable"),
                     ("libringdown.so.0", "libringdown.so.1"),
                     ("SOVERSION 0)", "SOVERSION 1)"), ("`libringdown.so.1` | 0 |", "`libringdown.so.1` | 1 |")):
        text = text.replace(old, new)
    return text


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
            expect(f"ok       {condition}" in said, f"a tree of 1.0.0 fails '{condition}'", said)
        expect(code == 1 and "git tag -a v1.0.0" in said, "the tag is not asked for", said)
        git(root, "tag", "-a", "v1.0.0", "-m", "1.0.0")
        code, said = check(root)
        expect("ok       commit is tagged" in said, "the tag is not found", said)
        expect(code == 1 and "packages are tried" in said, "packages are not asked for", said)
        for name in STATING[1:]:
            good = (root / name).read_text(encoding="utf-8")
            (root / name).write_text(good.replace("1.0.0", "1.0.1").replace("SOVERSION 1)", "SOVERSION 2)"), encoding="utf-8")
            _, said = check(root)
            expect(f"versions agree: {name} " in said, f"another version in {name} is not named", said)
            (root / name).write_text(good, encoding="utf-8")
    print("\n".join(faults) or "no faults")
    return 1 if faults else 0


sys.exit(main())
