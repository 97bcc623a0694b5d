#!/usr/bin/python3
"""`./run package source` makes the same bytes each time, and what it packs is configured without git:
source_package_test.py SOURCE"""
import hashlib
import os
import pathlib
import subprocess
import sys
import tarfile
import tempfile

SOURCE = pathlib.Path(sys.argv[1])


def main():
    if not (SOURCE / ".git").exists():
        print("skipped: this source tree is no git repository")
        return 77
    with tempfile.TemporaryDirectory() as home:
        clone = pathlib.Path(home) / "clone"
        subprocess.run(["git", "clone", "-q", "--shared", SOURCE, clone], check=True)
        sums = set()
        for _ in range(2):
            said = subprocess.run([clone / "run", "package", "source"], check=True, capture_output=True, text=True).stdout.strip()
            sums.add(hashlib.sha256((clone / said).read_bytes()).hexdigest())
        if len(sums) != 1:
            print("two packages of one commit differ")
            return 1
        with tarfile.open(clone / said) as archive:
            archive.extractall(home)
        tree = pathlib.Path(home) / pathlib.Path(said).name.removesuffix(".tar.gz")
        tools = pathlib.Path(home) / "tools"  # all programs but git
        tools.mkdir()
        for folder in ("/usr/bin", "/bin"):
            for program in pathlib.Path(folder).iterdir():
                if not program.name.startswith("git") and not (tools / program.name).exists():
                    (tools / program.name).symlink_to(program)
        ran = subprocess.run(["cmake", "--preset", "release", "-DRINGDOWN_ONLY_PLAYER=ON"], cwd=tree, capture_output=True, text=True,
                             env={**os.environ, "PATH": str(tools)})
        if ran.returncode:
            print(ran.stdout, ran.stderr)
        return ran.returncode


sys.exit(main())
