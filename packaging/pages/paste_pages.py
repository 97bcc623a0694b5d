#!/usr/bin/python3
"""Pastes the commands of README.md and docs/use into a system that has only the packages: paste_pages.py SOURCE FOLDER [PAGE...]

SOURCE has README.md, docs and clients. Each page, or those that are named (start, tuning ...), runs in a folder of its own below
FOLDER, which has presets and clients as a source folder has them, and the files that the page takes for granted. A command
must exit with 0, each file that it names after -o and the like must come out, and a daemon must live until the next one and
then end well. Prints every command with its outcome, and why the others are left out; exits with 1 if anything failed.
fresh_debian.sh pages calls it."""
import os
import pathlib
import re
import shutil
import signal
import subprocess
import sys
import time

COMMAND = re.compile(r"(\./run|ringdown[a-z-]*|oscsend|jack_connect|python3|cc|export|sleep|apt|xvfb-run|systemctl|make|sbatch|env/bin/pip|"
                     r"cp|cmake|tar|ringdown-\S*/bin/ringdown) ")
WRITES = re.compile(r"(?:-o|--output|--report|--events|--export-modes|--export-residual|--screenshot) ([\w./-]+)")
DAEMON = re.compile(r"(ringdownd|ringdown-viewer) ")
LEFT_OUT = [
    (r"^\./run|^export|^cmake|build/release", "builds from the source; fresh_debian.sh readme pastes it"),
    (r"^apt ", "the packages are installed already"),
    (r"^tar |^ringdown-1", "fresh_debian.sh tar tries the archive"),
    (r"/pip |-m venv", "tests/python/install_test.py runs it"),
    (r"^systemctl", "a system in a folder has no systemd"),
    (r"^make|^sbatch", "needs a batch system or a source folder"),
    (r"ardour:|studio:", "needs another program or computer"),
    (r"ringdown-bullet|xylophone\.osc", "the example is in no package"),
    (r"compare my-", "needs recordings of one's own"),
]
BELL = "cp presets/banks/bronze-bell.glb bell.glb"
SLAT = "cp presets/objects/box.geo ."
BEFORE = {  # what a page takes for granted; TOML FILE is the first block of TOML on the page
    "breaking": ["ringdownd --connect &"],
    "contacts": ["ringdownd --object bar=xylophone-key --object plate=steel-plate --object bowl=porcelain-bowl --object cymbal=crash-cymbal --connect &"],
    "film": ["ringdown scene export demo --animate 30 --plain -o fall.glb --seconds 2"],
    "gltf-scenes": ["ringdown scene export demo -o room.glb"],
    "laboratory": [BELL, SLAT, "cp presets/objects/glass-slat.toml bar.toml", "(echo radiation = true; cat bar.toml) >bell.toml"],
    "library": ["sed -n '/^```c$/,/^```$/p' $SOURCE/docs/use/library.md | sed '/^```/d' >bell.c"],
    "listening": ["ringdownd --object bell=bronze-bell --connect &"],
    "many-objects": ["mkdir objects", "cp presets/objects/box.geo presets/objects/glass-slat.toml presets/objects/brick.toml objects"],
    "meshes": ["STL cup.stl"],
    "midi": ["TOML notes.toml", "sed -i '/^scale\\|^mapping\\|^banks/d' notes.toml"],
    "previews": [BELL],
    "recordings": ["ringdown render --strike wine-glass -o cup.wav", "cp presets/banks/wine-glass.glb baked-cup.glb"],
    "start": ["TOML presets/objects/tile.toml"],
}
LONGEST_S = 900  # of a command
LIFE_S = 3  # of a daemon in the foreground


def commands_of(text):
    """The commands in indented blocks and in those of a shell, with their continuation lines."""
    fence, commands, joined = None, [], ""
    for line in text.splitlines():
        if line.startswith("```"):
            fence = None if fence else line[3:] or "text"
            continue
        if fence in ("sh", "bash"):
            line = "    " + line
        elif fence or not line.startswith("    "):
            continue
        joined += line.strip().removesuffix("\\")
        if not line.rstrip().endswith("\\"):
            if COMMAND.match(joined + " "):
                commands.append(re.sub(r"\s+#\s.*", "", joined))
            joined = ""
    return commands


def box_stl():
    """A block of 80 x 60 x 8 mm."""
    corner = [[80 * (n & 1), 60 * (n >> 1 & 1), 8 * (n >> 2)] for n in range(8)]
    lines = ["solid cup"]
    for a, b, c, d in ((0, 2, 3, 1), (4, 5, 7, 6), (0, 1, 5, 4), (2, 6, 7, 3), (0, 4, 6, 2), (1, 3, 7, 5)):
        for triangle in ((a, b, c), (a, c, d)):
            lines += ["facet normal 0 0 0", "outer loop", *("vertex {} {} {}".format(*corner[n]) for n in triangle), "endloop", "endfacet"]
    return "\n".join([*lines, "endsolid cup"]) + "\n"


class Page:
    def __init__(self, name, text, source, folder):
        self.name, self.text, self.source, self.folder = name, text, source, folder
        self.daemon, self.failed = None, 0

    def run(self):
        for command in BEFORE.get(self.name, []):
            self.paste(command, "prepared")
        for command in commands_of(self.text):
            reason = next((why for pattern, why in LEFT_OUT if re.search(pattern, command)), None)
            if reason:
                print(f"left out  {self.name}: {command}: {reason}")
            else:
                self.paste(command.replace("NAME", "bronze-bell"), "ok")
        if self.daemon:
            self.report(self.end_daemon(), "ok", "the daemon ends")
        return self.failed

    def report(self, fault, outcome, command, seconds=0.0):
        self.failed += bool(fault)
        print(f"{'FAILED' if fault else outcome:<9} {self.name}: {command}: {fault or f'{seconds:.1f} s'}", flush=True)

    def paste(self, command, outcome):
        begin = time.monotonic()
        kind, _, file = command.partition(" ")
        if kind in ("TOML", "STL"):
            block = re.search(r"^```toml\n(.*?)^```", self.text, re.M | re.S)
            fault = None if (self.folder / file).write_text(block[1] if kind == "TOML" else box_stl()) else "is empty"
        elif DAEMON.match(command + " ") and "--screenshot" not in command:
            fault = self.live(command)
        else:
            fault = self.end(command)
        self.report(fault, outcome, command, time.monotonic() - begin)

    def start(self, command):
        with (self.folder / "daemon.log").open("w") as log:
            return subprocess.Popen(["bash", "-c", "exec " + command], cwd=self.folder, stdout=log, stderr=log, start_new_session=True)

    def live(self, command):
        """A daemon or a window: in the background until another daemon comes, else for some seconds."""
        background = command.endswith("&")
        if command.startswith("ringdownd"):
            fault = self.end_daemon()
            if fault:
                return fault
        process = self.start(command.rstrip("& "))
        time.sleep(LIFE_S)
        if process.poll() is not None:
            return f"ends at once with {process.returncode}: {self.last_line('daemon.log')}"
        if background:
            self.daemon = process
            return None
        return self.ended(process)

    def ended(self, process):
        process.send_signal(signal.SIGTERM)
        try:
            code = process.wait(60)
        except subprocess.TimeoutExpired:
            process.kill()
            return "does not end"
        return None if code in (0, -signal.SIGTERM) else f"ends with {code}: {self.last_line('daemon.log')}"

    def end_daemon(self):
        process, self.daemon = self.daemon, None
        if process is None:
            return None
        return f"the daemon has ended with {process.returncode}" if process.poll() is not None else self.ended(process)

    def end(self, command):
        named = [self.folder / name for name in WRITES.findall(command)]
        for path in named:
            if path.is_file():
                path.unlink()
        with (self.folder / "log").open("w") as log:
            try:
                code = subprocess.run(["bash", "-c", command], cwd=self.folder, stdout=log, stderr=log, timeout=LONGEST_S,
                                      env={**os.environ, "SOURCE": str(self.source)}).returncode
            except subprocess.TimeoutExpired:
                return f"takes more than {LONGEST_S} s"
        if code:
            return f"exit {code}: {self.last_line()}"
        missing = [path.name for path in named if not self.made(path)]
        return f"makes no {', '.join(missing)}" if missing else None

    def made(self, path):
        """A folder, a file, or numbered files that are not empty."""
        files = path.iterdir() if path.is_dir() else path.parent.glob(f"{path.stem}*{path.suffix}")
        return any(file.stat().st_size > 0 for file in files)

    def last_line(self, log="log"):
        lines = (self.folder / log).read_text(errors="replace").strip().splitlines()
        return lines[-1] if lines else "no word"


def main():
    source, home = (pathlib.Path(word).resolve() for word in sys.argv[1:3])
    pages = {"README": source / "README.md", **{path.stem: path for path in sorted((source / "docs/use").glob("*.md"))}}
    unknown = set(sys.argv[3:]) - set(pages)
    if unknown:
        sys.exit(f"there is no page {', '.join(sorted(unknown))} in {source}/docs/use")
    failed = 0
    for name in sys.argv[3:] or pages:
        folder = home / name
        shutil.rmtree(folder, ignore_errors=True)
        folder.mkdir(parents=True)
        shutil.copytree(os.environ.get("RINGDOWN_PRESETS", "/usr/share/ringdown/presets"), folder / "presets")
        (folder / "clients").symlink_to(source / "clients")
        failed += Page(name, pages[name].read_text(), source, folder).run()
    print(f"{failed} failed")
    return 1 if failed else 0


sys.exit(main())
