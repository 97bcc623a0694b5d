"""Bakes meshes and materials to banks by the program ringdown-bake, in a separate process."""

import os
import re
import shutil
import signal
import subprocess
import tempfile
import warnings
from pathlib import Path
from typing import Any, Callable, List, Optional, Union

from ._core import Bank
from .errors import Error, InputError

PathLike = Union[str, "os.PathLike[str]"]
Progress = Callable[[float, str], None]

PATIENCE_S = 10.0  # for a program that was asked to stop
BAD_INPUT = (2, 3)  # exit codes for wrong options and wrong files
KINDS = {130: "cancelled"}  # other exit codes; any other: failed


def bake(
    mesh: PathLike,
    material: Optional[str] = None,
    *,
    out: Optional[PathLike] = None,
    progress: Optional[Progress] = None,
    program: Optional[PathLike] = None,
    **options: Any,
) -> Bank:
    """Bakes an object's shape and material into a bank, which takes seconds to hours, and returns it.

    mesh: a surface (.stl .obj .ply .glb), a geometry (.geo .step .brep), a mesh (.msh .vtk ...) or an object file (.toml),
    which names its material. material: the name of one, "steel" for example. out: where to keep the bank (.glb).
    progress: called with the fraction done and the stage; an exception that it raises ends the bake, as Ctrl-C does.
    program: the program, default: $RINGDOWN_BAKE, or ringdown-bake in $PATH.

    options: the program's own, with _ for -: mesh_size=0.004, band=(20, 10000), preview=True,
    set={"length": 250}. If the program fails, Error has its sentence. Its warnings become Python warnings.
    """
    with tempfile.TemporaryDirectory(prefix="ringdown-") as folder:
        bank = Path(out) if out is not None else Path(folder) / "bank.glb"
        command = [_program(program), os.fspath(mesh), "--output", os.fspath(bank), "--quiet", "--progress-lines"]
        if material is not None:
            command += ["--material", material]
        for name, value in options.items():
            command += _arguments("--" + name.replace("_", "-"), value)
        with open(Path(folder) / "complaints", "w+", encoding="utf-8", errors="replace") as complaints:
            code = _run(command, complaints, progress)
            complaints.seek(0)
            sentences = [_without_program(line) for line in complaints.read().splitlines() if line.strip()]
        if code != 0:
            sentence = sentences[-1] if sentences else f"ringdown-bake ended with {code} and said nothing"
            raise InputError(sentence) if code in BAD_INPUT else Error(sentence, KINDS.get(code, "failed"))
        for sentence in sentences:
            warnings.warn(sentence, stacklevel=2)
        return Bank.open(bank)


def _program(given: Optional[PathLike]) -> str:
    found = os.fspath(given) if given is not None else os.environ.get("RINGDOWN_BAKE") or shutil.which("ringdown-bake")
    if not found:
        raise InputError(
            "there is no ringdown-bake in $PATH: install the package ringdown-bake, or set RINGDOWN_BAKE to the program"
        )
    return found


def _arguments(option: str, value: Any) -> List[str]:
    if value is None or value is False:
        return []
    if value is True:
        return [option]
    if isinstance(value, dict):
        return [word for name, number in value.items() for word in (option, f"{name}={number}")]
    if isinstance(value, (list, tuple)) and value and all(isinstance(item, os.PathLike) for item in value):
        return [word for item in value for word in (option, os.fspath(item))]
    if isinstance(value, (list, tuple)):
        return [option, *map(str, value)]
    return [option, str(value)]


def _run(command: List[str], complaints: Any, progress: Optional[Progress]) -> int:
    try:
        child = subprocess.Popen(
            command, stdin=subprocess.DEVNULL, stdout=subprocess.PIPE, stderr=complaints, text=True, errors="replace"
        )
    except OSError as failure:
        raise InputError(f"{command[0]} cannot be started: {failure.strerror}") from failure
    assert child.stdout is not None
    try:
        for line in child.stdout:
            done = re.fullmatch(r"([0-9.]+) (.+)\n", line)
            if progress is not None and done:
                progress(float(done[1]), done[2])
        return child.wait()
    except BaseException:  # KeyboardInterrupt above all: no child stays behind
        _stop(child)
        raise
    finally:
        child.stdout.close()


def _stop(child: "subprocess.Popen[str]") -> None:
    for number in (signal.SIGINT, signal.SIGKILL):
        if child.poll() is not None:
            return
        child.send_signal(number)
        try:
            child.communicate(timeout=PATIENCE_S)
        except subprocess.TimeoutExpired:
            continue


def _without_program(line: str) -> str:
    return line.partition(": ")[2] if line.startswith("ringdown-bake: ") else line
