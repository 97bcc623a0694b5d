"""What the plotting scripts share: their command line, and a page's table of results by machine."""
import argparse
import re


def put_into_table(page, name, head, row):
    """Between `<!-- begin: NAME ... -->` and `<!-- end: NAME -->`: `row` in place of an older one of the same machine."""
    with open(page) as file:
        text = file.read()
    start = re.search(f"<!-- begin: {re.escape(name)}.*?-->", text).end()
    end = text.index(f"<!-- end: {name} -->")
    machine = row.split("|")[1].strip()
    kept = [line for line in text[start:end].splitlines() if line.startswith("|") and not re.match(r"\|(---| machine )", line)]
    kept = [line for line in kept if line.split("|")[1].strip() != machine] + [row]
    with open(page, "w") as file:
        file.write(text[:start] + "\n" + head + "\n" + "\n".join(kept) + "\n" + text[end:])


def command(doc, read, draw, name, head, row):
    """The command line of a plotting script: CSV PICTURE [--table PAGE]."""
    parser = argparse.ArgumentParser(description=doc, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("csv")
    parser.add_argument("picture")
    parser.add_argument("--table", help="a page with the marks of the table")
    arguments = parser.parse_args()
    rows = read(arguments.csv)
    if not rows:
        parser.exit(1, f"{arguments.csv} has no rows\n")
    draw(rows, arguments.picture)
    if arguments.table:
        put_into_table(arguments.table, name, head, row(rows))
