"""What the plotting scripts share: their command line, and the log, page and README that take a benchmark's results."""
import argparse
import csv
import io
import re
import subprocess
from pathlib import Path


def write(path, text):
    beside = path.with_name(path.name + ".new")
    beside.write_text(text)
    beside.replace(path)


def place_of(text, name):
    """Where the lines between `<!-- begin: NAME ... -->` and `<!-- end: NAME -->` begin and end."""
    return re.search(f"<!-- begin: {re.escape(name)}.*?-->", text).end(), text.index(f"<!-- end: {name} -->")


def put_between(page, name, table):
    text = page.read_text()
    start, end = place_of(text, name)
    write(page, text[:start] + "\n" + table + "\n" + text[end:])


def put_into_table(page, name, head, row):
    """`row` in place of an older one of the same machine."""
    text = page.read_text()
    start, end = place_of(text, name)
    machine = row.split("|")[1].strip()
    kept = [line for line in text[start:end].splitlines() if line.startswith("|") and not re.match(r"\|(---| machine )", line)]
    kept = [line for line in kept if line.split("|")[1].strip() != machine] + [row]
    put_between(page, name, head + "\n" + "\n".join(kept))


def put_into_readme(readme, cells):
    """`cells`: the second cell of a row of README, by the row's first."""
    text = readme.read_text()
    for first, second in cells.items():
        text, count = re.subn(rf"(?m)^(\| {re.escape(first)} \|)[^|]*\|", rf"\1 {second} |", text)
        if count != 1:
            raise SystemExit(f"{readme}: {count} rows begin with {first}")
    write(readme, text)


def revision_of(tree):
    return subprocess.check_output(["git", "-C", tree, "describe", "--always", "--dirty"], text=True).strip()


def log_with_revision(path, tree):
    """The rows as they were written, with the revision of the source tree unless the file tells it."""
    with open(path, newline="") as file:
        rows = list(csv.DictReader(file))
    if "revision" in rows[0]:
        return rows
    return [{**row, "revision": revision_of(tree)} for row in rows]


def as_csv(rows):
    text = io.StringIO()
    writer = csv.DictWriter(text, rows[0].keys(), lineterminator="\n")
    writer.writeheader()
    writer.writerows(rows)
    return text.getvalue()


def command(doc, read, draw, name, head, row, readme_cells=lambda rows: {}):
    """The command line of a plotting script: CSV PICTURE [--publish TREE]. `name`: "mixer" or "modal"."""
    parser = argparse.ArgumentParser(description=doc, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("csv")
    parser.add_argument("picture")
    parser.add_argument("--publish", type=Path, metavar="TREE", help="the source tree whose log, page and README take the results")
    arguments = parser.parse_args()
    rows = read(arguments.csv)
    if not rows:
        parser.exit(1, f"{arguments.csv} has no rows\n")
    draw(rows, arguments.picture)
    tree = arguments.publish
    if not tree:
        return
    log = log_with_revision(arguments.csv, tree)
    write(tree / f"docs/how/logs/{name}.csv", as_csv(log))
    put_into_table(tree / "docs/how/benchmarks.md", f"{name} results", head, row(rows, log[0]["revision"]))
    put_into_readme(tree / "README.md", readme_cells(rows))
