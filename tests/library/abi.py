#!/usr/bin/python3
"""The binary interface of the C libraries, as a table: abi.py SOURCE [--write | --against TABLE | --symbols LIBRARY...]

Reads the C headers with clang and compares functions, enumerators, sizes of structs and offsets of members (64-bit Linux)
with clients/library/abi.txt. A program that was compiled for the table must run with the headers as they are: no line
may change or go, except that a struct that begins with `size` may grow at its end. What is new must be in the table, too;
--write brings it there, if nothing else has changed. --against compares with another table, such as the last release's,
and allows what is new. --symbols compares the functions with those that the built libraries export."""
import pathlib
import subprocess
import sys

try:
    import clang.cindex as clang
    from clang.cindex import CursorKind
except ModuleNotFoundError:
    print("skipped: python3-clang is not installed")
    sys.exit(77)

HEADERS = ("ringdown.h", "ringdown_scene.h")


def table_of(folder):
    """Lines: function NAME: TYPE | enum NAME = VALUE | struct NAME: SIZE bytes | member STRUCT.NAME: OFFSET TYPE."""
    lines = []
    for header in HEADERS:
        unit = clang.Index.create().parse(str(folder / header), args=["-x", "c", "-std=c99", "-I", str(folder)])
        faults = [str(fault) for fault in unit.diagnostics if fault.severity >= clang.Diagnostic.Error]
        if faults:
            sys.exit("\n".join(faults))
        for cursor in unit.cursor.get_children():
            if not cursor.location.file or pathlib.Path(cursor.location.file.name).name != header:
                continue
            if cursor.kind == CursorKind.FUNCTION_DECL:
                lines.append(f"function {cursor.spelling}: {cursor.type.spelling}")
            elif cursor.kind == CursorKind.ENUM_DECL:
                lines += [f"enum {child.spelling} = {child.enum_value}" for child in cursor.get_children()]
            elif cursor.kind == CursorKind.STRUCT_DECL and cursor.is_definition():
                lines.append(f"struct {cursor.spelling}: {cursor.type.get_size()} bytes")
                lines += [f"member {cursor.spelling}.{child.spelling}: {cursor.type.get_offset(child.spelling) // 8} "
                          f"{child.type.get_canonical().spelling}" for child in cursor.get_children()
                          if child.kind == CursorKind.FIELD_DECL]
    return lines


def breaks(old, new):
    """What keeps a program of the old table from running with the new one."""
    now = dict(line.split(": ", 1) if ": " in line else line.split(" = ", 1) for line in new)
    for line in old:
        if line in new:
            continue
        name, what = line.split(": ", 1) if ": " in line else line.split(" = ", 1)
        kind, _, short = name.partition(" ")
        may_grow = kind == "struct" and f"member {short}.size: 0 unsigned long" in new
        if name not in now:
            yield f"{name} is gone"
        elif not (may_grow and int(now[name].split()[0]) > int(what.split()[0])):
            yield f"{name} was {what}, is {now[name]}"


def exported(library):
    out = subprocess.run(["nm", "-D", "--defined-only", library], check=True, capture_output=True, text=True).stdout
    return {line.split()[-1].split("@")[0] for line in out.splitlines() if " T " in line}


def main():
    folder = pathlib.Path(sys.argv[1]) / "clients/library"
    how, rest = sys.argv[2] if len(sys.argv) > 2 else "", sys.argv[3:]
    new = table_of(folder)
    if how == "--symbols":
        declared = {line.split()[1].rstrip(":") for line in new if line.startswith("function ")}
        shown = set().union(*map(exported, rest))
        faults = [f"{name} is declared, but no library exports it" for name in sorted(declared - shown)]
        faults += [f"{name} is exported, but no header declares it" for name in sorted(shown - declared)]
    else:
        table = pathlib.Path(rest[0]) if how == "--against" else folder / "abi.txt"
        old = table.read_text().splitlines() if table.exists() else []
        faults = [f"{fault}: programs of libringdown as it is would break" for fault in breaks(old, new)]
        if not faults and how == "--write":
            table.write_text("\n".join(new) + "\n")
        elif not faults and not how and old != new:
            faults = [f"{line} is not in {table}; call tests/library/abi.py . --write" for line in new if line not in old] or [
                f"the order of {table} differs; call tests/library/abi.py . --write"]
    print("\n".join(faults) or f"{len(new)} lines of the binary interface hold")
    return 1 if faults else 0


sys.exit(main())
