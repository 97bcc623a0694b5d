#!/usr/bin/python3
"""Counts how large classes are, by clang's syntax tree, and fails when one is too large.

usage: class_sizes.py BUILD_DIR [--all] [--no-limits]

BUILD_DIR holds compile_commands.json. For every class, struct and class template of the engine, the server, the
protocol, the clients and the packaging, four numbers are counted:

  methods    Member functions, including private, static and template ones. Constructors, destructors and operators do
             not count.
  functions  Free functions, also those in anonymous namespaces, that take the class by reference or pointer and stand
             in the folder where the class is declared. Operators and lambdas do not count. A class does not become
             smaller when its methods are moved out of it.
  size       The sum of methods and functions. At most kMaxSize.
  files      .cpp files in which methods of the class are defined. At most kMaxFiles.

All .cpp files are parsed as one translation unit, without the bodies of functions, so every header is read once: about
12 s and 0.8 GB. So that the files do not clash, the anonymous namespace of each file gets a name of its own.
"""

import argparse
import collections
import json
import pathlib
import re
import shlex
import sys

try:
    import clang.cindex as clang
    from clang.cindex import CursorKind, TypeKind
except ModuleNotFoundError:
    print("skipped: python3-clang is not installed")
    sys.exit(77)

kMaxSize = 30
kMaxOfPlainData = 36  # functions that take a struct of at most one method: what a folder works on
kMaxFiles = 2
# In C every function takes a handle, and every one that can fail the place of its refusal. This says nothing about them.
kOfEveryFunction = {"ringdown_error", "ringdown_mixer"}

kFolders = ("engine", "server", "protocol", "clients", "packaging")
kClasses = {CursorKind.CLASS_DECL, CursorKind.STRUCT_DECL, CursorKind.CLASS_TEMPLATE}
kFunctions = {CursorKind.FUNCTION_DECL, CursorKind.FUNCTION_TEMPLATE}
kOuterNames = {CursorKind.NAMESPACE, CursorKind.LINKAGE_SPEC, CursorKind.UNEXPOSED_DECL}

# Errors that one translation unit for all files brings with it: programs have a main() each, and two files may have a
# name of their own in common.
kExpectedErrors = re.compile(r"redefinition of 'main'|reference to '\w+' is ambiguous")


def full_name(cursor):
    names = []
    while cursor is not None and cursor.kind != CursorKind.TRANSLATION_UNIT:
        if cursor.spelling and not re.match(r"\(anonymous|file_\d+$", cursor.spelling):
            names.append(cursor.spelling)
        cursor = cursor.semantic_parent
    return "::".join(reversed(names)).removeprefix("ringdown::")


def usr_of(cursor):
    """clang's name for an entity; for a specialization, that of its template."""
    template = clang.conf.lib.clang_getSpecializedCursorTemplate(cursor)
    return (template or cursor).get_usr()


def is_operator(name):
    return re.match(r"operator\b", name) is not None


def is_method(cursor):
    if is_operator(cursor.spelling):
        return False
    if cursor.kind == CursorKind.FUNCTION_TEMPLATE:
        parent = cursor.semantic_parent
        return parent.kind in kClasses and cursor.spelling != parent.spelling.split("<")[0]
    return cursor.kind == CursorKind.CXX_METHOD


class Tally:
    """Counts what stands in the files below `root`."""

    def __init__(self, root):
        self.root = str(root) + "/"
        self.classes = {}  # USR: (name, file, line)
        self.methods = collections.defaultdict(set)  # class: USRs
        self.functions = {}  # USR: (folder, USRs of the classes that it takes)
        self.files = collections.defaultdict(set)  # class: .cpp files with definitions

    def path(self, cursor):
        """Below the root, or None when the file is not one of the project."""
        file = cursor.location.file
        if file is None or not file.name.startswith(self.root):
            return None
        path = file.name[len(self.root):]
        return path if path.split("/")[0] in kFolders else None

    def visit(self, cursor):
        for child in cursor.get_children():
            path = self.path(child)
            if not path:
                continue
            if child.kind in kOuterNames:
                self.visit(child)
            elif child.kind in kClasses and child.is_definition():
                self.visit_class(child, path)
            elif child.kind in kFunctions | {CursorKind.CXX_METHOD, CursorKind.CONSTRUCTOR, CursorKind.DESTRUCTOR}:
                self.visit_function(child, path)

    def visit_class(self, cursor, path):
        usr = cursor.get_usr()
        self.classes[usr] = (full_name(cursor), path, cursor.location.line)
        for child in cursor.get_children():
            if child.kind in kClasses and child.is_definition():
                self.visit_class(child, path)
            elif is_method(child):
                self.methods[usr].add(child.get_usr())
            elif child.kind == CursorKind.FRIEND_DECL:
                self.visit(child)

    def visit_function(self, cursor, path):
        parent = cursor.semantic_parent
        if parent is not None and parent.kind in kClasses:  # defined outside of its class
            if path.endswith(".cpp"):
                self.files[parent.get_usr()].add(path)
            return
        if is_operator(cursor.spelling):
            return
        taken = set()
        for parameter in cursor.get_children():
            if parameter.kind != CursorKind.PARM_DECL:
                continue
            type_ = parameter.type.get_canonical()
            if type_.kind in (TypeKind.LVALUEREFERENCE, TypeKind.RVALUEREFERENCE, TypeKind.POINTER):
                taken.add(usr_of(type_.get_pointee().get_declaration()))
        if taken:
            self.functions[cursor.get_usr()] = (str(pathlib.PurePath(path).parent), taken)

    def rows(self):
        """The largest class first: name, place, methods, functions, size, files."""
        functions = collections.Counter()
        for folder, taken in self.functions.values():
            for usr in taken:
                known = self.classes.get(usr)
                if known and str(pathlib.PurePath(known[1]).parent) == folder:
                    functions[usr] += 1
        rows = []
        for usr, (name, path, line) in self.classes.items():
            methods, taking = len(self.methods[usr]), functions[usr]
            rows.append((name, f"{path}:{line}", methods, taking, methods + taking, sorted(self.files[usr])))
        return sorted(rows, key=lambda row: (-row[4], row[0]))


def sources_of(command):
    """The files that a command compiles: one, or those that the file of a unity build includes."""
    if "/Unity/unity_" not in command["file"]:
        return [command["file"]]
    return re.findall(r'^#include "(.*)"', pathlib.Path(command["file"]).read_text(), flags=re.M)


def parse_everything(root, build):
    commands = json.loads((build / "compile_commands.json").read_text())
    folders = tuple(f"{root}/{folder}/" for folder in kFolders)
    commands = [c for c in commands if any(source.startswith(folders) for source in sources_of(c))]
    # A header of GLFW and one of Highway ask for these.
    arguments = ["-xc++", "-std=c++20", "-w", "-ferror-limit=0", "-DGLFW_INCLUDE_NONE", "-DHWY_COMPILE_ONLY_STATIC"]
    for command in commands:
        words = shlex.split(command["command"])
        for word, value in zip(words, words[1:]):
            if word == "-isystem" and value not in arguments:
                arguments += [word, value]
            elif word.startswith(("-I", "-D")) and word not in arguments:
                arguments.append(word)
    everything = str(build / "everything.cpp")  # exists in memory only
    files = sorted({source for command in commands for source in sources_of(command) if source.startswith(folders)})
    # The plug-in's window comes last: it brings the macros of X11, and OpenGL's own header, which epoxy's must precede.
    files.sort(key=lambda file: "/plugin/window/" in file)
    texts = [(everything, "".join(f'#include "{file}"\n' for file in files))]
    for number, file in enumerate(files):
        named = re.sub(r"^namespace \{", f"inline namespace file_{number} {{", pathlib.Path(file).read_text(), flags=re.M)
        texts.append((file, named))
    return clang.Index.create().parse(everything, args=arguments, unsaved_files=texts,
                                      options=clang.TranslationUnit.PARSE_SKIP_FUNCTION_BODIES)


def main():
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("build", type=pathlib.Path)
    parser.add_argument("--all", action="store_true", help="show every class, not only the 20 largest")
    parser.add_argument("--no-limits", action="store_true", help="only show the table")
    args = parser.parse_args()
    root = pathlib.Path(__file__).resolve().parents[2]
    unit = parse_everything(root, args.build.resolve())
    tally = Tally(root)
    tally.visit(unit.cursor)
    rows = tally.rows()
    print(f"{'size':>4} {'methods':>7} {'functions':>9} {'files':>5}  class")
    for name, place, methods, functions, size, files in rows if args.all else rows[:20]:
        print(f"{size:4} {methods:7} {functions:9} {len(files):5}  {name}  {place}")
    wrong = []
    for name, place, methods, functions, size, files in rows:
        if name in kOfEveryFunction:
            continue
        most = kMaxSize if methods > 1 else kMaxOfPlainData
        if size > most:
            wrong.append(f"{place}: {name} has {methods} methods and {functions} functions that take it; "
                         f"the most is {most}")
        if len(files) > kMaxFiles:
            wrong.append(f"{place}: methods of {name} are defined in {len(files)} files; the most is {kMaxFiles}: "
                         + ", ".join(files))
    print(f"{len(rows)} classes, {len(wrong)} beyond a limit")
    print("\n".join(wrong))
    errors = [str(d) for d in unit.diagnostics if d.severity >= clang.Diagnostic.Error]
    errors = [error for error in errors if not kExpectedErrors.search(error)]
    for error in errors[:20]:
        print("not parsed:", error)
    return 0 if args.no_limits or not (wrong or errors) else 1


if __name__ == "__main__":
    sys.exit(main())
