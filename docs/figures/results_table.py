"""A page's table of results by machine, between its marks."""
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
