#!/usr/bin/env python3
"""examples_compile.py SOURCE_FOLDER BUILD_FOLDER

Compiles the examples in the comments of headers: rows of code that are indented by three spaces, at least one of which ends
in ";". Each becomes a function in the namespace of its header. `...` stands for whatever one does there, names that the
example does not declare for what its reader has, and calls of PLACEHOLDERS for what its reader does. Everything else must
exist as it is written: types, functions, members, arguments. Needs clang-22, and exits with 77 without it.
"""
import json
import os
import re
import shlex
import shutil
import subprocess
import sys

# Calls and types that an example leaves to its reader.
PLACEHOLDERS = set("""Answer Answers Bank Done Fail draw handle last_line leave load parse play read_bank read_part receive_and_answer refuse reply
report save send sleep_a_little square state_file steady_now_s work""".split())
PRELUDE = """#include <chrono>
using namespace std::chrono_literals;
struct Anything { Anything() = default; template <class T> Anything(const T&) {} };
"""
# The folders of a group are one translation unit, so that clang reads what their headers include once.
GROUPS = (("engine", "protocol", "server"), ("clients/viewer", "clients/plugin", "clients/cli/picture"))
# What tells of an example that no longer fits. A name that a reader has may also be that of a namespace or a member; then
# clang stops at it, and says no more of what depends on it.
FAULTS = r"no member named|no matching|unknown type name '[A-Z]|use of undeclared|expected|too (few|many) arguments|no viable"


def blocks_of(path):
    """(first line, rows) of each example in a file"""
    block, first = [], 0
    with open(path, encoding="utf-8") as file:
        rows = file.read().split("\n") + [""]
    for number, row in enumerate(rows, 1):
        code = re.match(r"\s*//   (\s*\S.*)$", row)
        if code:
            first = first if block else number
            block.append(code[1])
        elif block:
            if any(re.search(r";\s*(//.*)?$", line) for line in block):
                yield first, block
            block = []


def as_code(rows):
    """The rows with `...` taken out, or nothing where they are prose or another language."""
    text = "\n".join(re.sub(r"\s*(?<!:)//.*", "", row) for row in rows)
    if re.search(r"^\s*(- |\[|[a-z]+ [a-z]+ [a-z]+ |DefineConstant|of the|a geometry|TetGen|callback:)", text, re.M):
        return None
    text = re.sub(r"^\s*\.\.\..*$", "", text, flags=re.M)
    text = re.sub(r"\.\.\.(\w.*\.\.\.|[^;{}()]*)$", "{}", text, flags=re.M)
    return re.sub(r",?\s*\.\.\.", "", text)


def main():
    source, build = sys.argv[1:]
    if not shutil.which("clang++-22"):
        print("skipped: this needs clang++-22")
        return 77
    os.chdir(source)
    files = subprocess.run(["git", "ls-files", *sum(GROUPS, ())], capture_output=True, text=True).stdout.split()
    with open(os.path.join(build, "compile_commands.json")) as file:
        flags = " ".join(entry["command"] for entry in json.load(file) if "/tests/" not in entry["file"])
    flags = sorted({"-I" + word if word[0] == "/" else word for word in shlex.split(flags) if re.match(r"-I|/usr/include/", word)} | {"-I/usr/include/eigen3", "-I/usr/include/imgui", "-I/usr/share/dpf/distrho"})
    bad = count = 0
    for group in GROUPS:
        folders = tuple(f"{folder}/" for folder in group)
        headers = [name for name in files if name.startswith(folders) and re.search(r"(?<!-inl)\.h$", name)]
        text = ""
        for name in headers:
            with open(name, encoding="utf-8") as file:
                spaces = re.findall(r"^namespace (ringdown[\w:]*) \{", file.read(), re.M)
            for first, rows in blocks_of(name):
                code = as_code(rows)
                if code is None or not spaces:
                    continue
                count += 1
                result = "Anything" if "return" in code else "void"
                text += f'namespace {spaces[-1]} {{ {result} example_{count}() {{\n#line {first} "{name}"\n{code}\n}} }}\n'
        unit = os.path.join(build, "examples.cpp")
        with open(unit, "w", encoding="utf-8") as file:
            file.write("".join(f'#include "{name}"\n' for name in headers) + PRELUDE + text)
        words = ["clang++-22", "-std=c++20", "-fsyntax-only", "-ferror-limit=0", "-fno-spell-checking", "-w", "-I.", *flags, unit]
        for row in subprocess.run(words, capture_output=True, text=True).stderr.splitlines():
            error = re.match(r"(\S+?):(\d+):(\d+): (?:fatal )?error: (.*)", row)
            if not error or not (re.match(FAULTS, error[4]) or error[1] not in headers):
                continue
            unknown = re.match(r"(?:use of undeclared identifier|unknown type name) '(\w+)'", error[4])
            if unknown and error[1] in headers:
                with open(error[1], encoding="utf-8") as file:
                    line = file.read().split("\n")[int(error[2]) - 1]
                is_call = re.search(r"(?<![\w.>])" + unknown[1] + r"(\(|<|::)", line)
                if unknown[1] in PLACEHOLDERS or not (is_call or unknown[1][0].isupper()):
                    continue
            print(row)
            bad += 1
    print(f"{count} examples, {bad} errors")
    return 1 if bad else 0


if __name__ == "__main__":
    sys.exit(main())
