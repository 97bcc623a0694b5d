#!/usr/bin/python3
"""Makes the project's site, static pages that need no network: make_site.py RINGDOWN FOLDER [PRESET...]

RINGDOWN is the program. The pages are those of the source tree's own folder and all of docs/, by Python's markdown; a gallery in which every preset (or those that are named) has a page of `ringdown picture`; and a
search in the text of all sections. What a page links to is copied. A link to nothing is an error. The page of changes has
sounds, which the commands in its lists render.
"""
import html
import json
import os
import pathlib
import re
import shlex
import shutil
import subprocess
import sys
import unicodedata

import markdown
from markdown.extensions.toc import TocExtension

ROOT = pathlib.Path(__file__).resolve().parents[2]
HERE = pathlib.Path(__file__).resolve().parent
TOP_PAGES = ["README.md", "CHANGELOG.md", "CONTRIBUTING.md", "SECURITY.md", "CODE_OF_CONDUCT.md"]
MENU = [("Ringdown", "README.md"), ("Gallery", "gallery.md"), ("Start", "docs/use/start.md"), ("Documentation", "docs/README.md"),
        ("Protocol", "docs/reference/protocol.md"), ("Changes", "CHANGELOG.md")]


def address_of(page):
    """Where a Markdown file, relative to the source tree, stands on the site."""
    if page.name == "README.md":
        return page.parent / "index.html"
    return page.with_suffix(".html")


def anchor_of(heading, _separator=None):
    """As code hosts make it: lower case, blanks as hyphens, punctuation dropped."""
    kept = (c for c in heading.lower() if c in " -_" or unicodedata.category(c)[0] in "LN")
    return "".join(kept).replace(" ", "-")


def converted(text):
    """Markdown as HTML, with an anchor for each heading."""
    spaced = re.sub(r"(<!-- (?:begin:.*|end) -->)\n", r"\1\n\n", text)
    return markdown.markdown(spaced, extensions=["tables", "fenced_code", "sane_lists", TocExtension(slugify=anchor_of)])


class Site:
    def __init__(self, ringdown, folder, presets):
        self.ringdown, self.folder, self.presets = ringdown, folder, presets
        self.sections, self.broken = [], []

    def write(self, address, title, body):
        """Puts a page into its frame."""
        up = os.path.relpath(".", address.parent)
        menu = " ".join(f'<a href="{up}/{address_of(pathlib.Path(page))}">{name}</a>' for name, page in MENU)
        file = self.folder / address
        file.parent.mkdir(parents=True, exist_ok=True)
        file.write_text(f"""<!DOCTYPE html>
<html lang="en">
<head>
<meta charset="utf-8">
<meta name="viewport" content="width=device-width">
<title>{html.escape(title)}</title>
<link rel="stylesheet" href="{up}/site.css">
</head>
<body>
<nav>{menu} <input id="search" type="search" placeholder="Search" aria-label="Search"></nav>
<div id="found" data-up="{up}"></div>
<main>
{body}
</main>
<script src="{up}/sections.js"></script>
<script src="{up}/search.js"></script>
</body>
</html>
""", encoding="utf-8")

    def target_of(self, page, link):
        """A link of a Markdown file as the site has it; copies what is no page."""
        if re.match(r"[a-z]+:", link) or link.startswith("#"):
            return link
        path, hash_, anchor = link.partition("#")
        target = pathlib.Path(os.path.normpath(page.parent / path))
        source = ROOT / target
        if not source.exists() or target.parts[0] == "..":
            self.broken.append(f"{page} links to {link}")
            return link
        if target.suffix == ".md":
            target = address_of(target)
        elif source.is_file():
            (self.folder / target).parent.mkdir(parents=True, exist_ok=True)
            shutil.copyfile(source, self.folder / target)
        else:
            shutil.copytree(source, self.folder / target, dirs_exist_ok=True)
        return os.path.relpath(target, address_of(page).parent) + hash_ + anchor

    def with_sounds(self, body):
        """Runs the commands in lists of a page at the top that render a file, and puts a player behind each."""
        def heard(item):
            sound = f"sounds/{item[3]}"
            (self.folder / "sounds").mkdir(exist_ok=True)
            command = [self.ringdown, *shlex.split(item[2])[1:], self.folder / sound]
            subprocess.run(command, check=True, stdout=subprocess.DEVNULL)
            return f'{item[1]}<audio controls preload="none" src="{sound}"></audio>'
        return re.sub(r"(<li>[^<]*<code>(ringdown render [^<]*-o) ([\w.-]+)</code>)", heard, body)

    def add_page(self, page):
        body = converted((ROOT / page).read_text(encoding="utf-8"))
        # A sound that the text links to can be heard beside the link.
        body = re.sub(r'(<p>.*?<a href="([^"]+\.(?:ogg|flac|wav))">)', r'<audio controls preload="none" src="\2"></audio>\n\1', body)
        body = re.sub(r'(href|src)="([^"]*)"', lambda m: f'{m[1]}="{self.target_of(page, html.unescape(m[2]))}"', body)
        up = os.path.relpath(".", address_of(page).parent)
        for name in self.presets:
            body = re.sub(rf'<img [^>]*presets/{re.escape(name)}\.png"[^>]*>',
                          lambda m, name=name: f'<a href="{up}/presets/{name}.html">{m[0]}</a>', body)
        if page.name == "CHANGELOG.md":
            body = self.with_sounds(body)
        title = re.search(r"<h1[^>]*>(.*?)</h1>", body, re.S)
        title = re.sub(r"<[^>]+>", "", title[1]) if title else page.stem
        self.write(address_of(page), html.unescape(title), body)
        self.add_sections(address_of(page), body)

    def add_sections(self, address, body):
        """For the search: each heading with the text up to the next one."""
        parts = re.split(r'<h[1-6] id="([^"]*)">(.*?)</h[1-6]>', body, flags=re.S)
        for anchor, heading, text in zip(parts[1::3], parts[2::3], parts[3::3]):
            plain = [" ".join(html.unescape(re.sub(r"<[^>]+>", " ", part)).split()) for part in (heading, text)]
            self.sections.append([f"{address}#{anchor}", *plain])

    def add_gallery(self):
        sentences = dict(re.findall(r"`([\w-]+)`: ([^|]*?) \|", (ROOT / "docs/use/presets.md").read_text(encoding="utf-8")))
        (self.folder / "presets").mkdir(exist_ok=True)
        cards = ""
        for name in self.presets:
            subprocess.run([self.ringdown, "picture", ROOT / f"presets/banks/{name}.glb", "-o", self.folder / f"presets/{name}.html"],
                           check=True)
            picture = self.target_of(pathlib.Path("gallery.md"), f"docs/figures/presets/{name}.png")
            cards += (f'<a class="card" href="presets/{name}.html"><img src="{picture}" alt="" loading="lazy">'
                      f"<b>{name}</b> {html.escape(sentences.get(name, ''))}</a>\n")
        body = ('<h1 id="gallery">Gallery</h1>\n<p>Each object turns, and sounds where you click or touch it, '
                f'as <code>ringdown render</code> computes it.</p>\n<div class="cards">\n{cards}</div>\n')
        self.write(pathlib.Path("gallery.html"), "Gallery", body)
        self.sections += [[f"presets/{name}.html", name, sentences.get(name, "")] for name in self.presets]


def main():
    ringdown, folder = sys.argv[1], pathlib.Path(sys.argv[2])
    presets = sys.argv[3:] or sorted(path.stem for path in (ROOT / "presets/banks").glob("*.glb"))
    part = folder.with_name(folder.name + ".part")
    shutil.rmtree(part, ignore_errors=True)
    part.mkdir(parents=True)
    site = Site(ringdown, part, presets)
    pages = [pathlib.Path(name) for name in TOP_PAGES] + sorted(p.relative_to(ROOT) for p in (ROOT / "docs").rglob("*.md"))
    for page in pages:
        site.add_page(page)
    site.add_gallery()
    if site.broken:
        sys.exit("the site is not made:\n" + "\n".join(site.broken))
    (part / "sections.js").write_text("const sections = " + json.dumps(site.sections, ensure_ascii=False) + ";\n", encoding="utf-8")
    for name in ("site.css", "search.js"):
        shutil.copyfile(HERE / name, part / name)
    shutil.rmtree(folder, ignore_errors=True)
    part.rename(folder)
    print(f"{folder}: {len(pages)} pages, {len(presets)} presets; open {folder}/index.html")


if __name__ == "__main__":
    main()
