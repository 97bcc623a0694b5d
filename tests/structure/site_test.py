#!/usr/bin/python3
"""Makes the site with one preset and reads it as a visitor without a network: site_test.py SOURCE RINGDOWN FOLDER

Every link leads to a file and its heading, nothing is loaded from elsewhere, no Markdown is left over, and the search
finds a section by its words."""
import html.parser
import pathlib
import re
import shutil
import subprocess
import sys
import urllib.parse

SKIPPED = 77


class Page(html.parser.HTMLParser):
    def __init__(self, path):
        super().__init__()
        self.path, self.ids, self.links, self.loaded, self.text, self.tags, self.open = path, set(), [], [], [], set(), []
        self.feed(path.read_text(encoding="utf-8"))

    def handle_starttag(self, tag, attributes):
        self.tags.add(tag)
        self.open.append(tag)
        for name, value in attributes:
            if name == "id":
                self.ids.add(value)
            elif name == "href" and tag == "a":
                self.links.append(value)
            elif name in ("src", "href"):
                self.loaded.append(value)

    def handle_endtag(self, tag):
        while self.open and self.open.pop() != tag:
            pass

    def handle_data(self, data):
        if not {"pre", "code", "script", "style"} & set(self.open):
            self.text.append(data)


def faults_of(folder):
    pages = {path: Page(path) for path in folder.rglob("*.html")}
    for path, page in pages.items():
        name = path.relative_to(folder)
        for link in page.loaded:
            if re.match(r"[a-z]+:|//", link) or not (path.parent / link).is_file():
                yield f"{name} loads {link}"
        for link in page.links:
            if re.match(r"https?:", link):
                continue
            target, _, anchor = urllib.parse.unquote(link).partition("#")
            file = (path.parent / target).resolve() if target else path
            if not file.exists():
                yield f"{name} links to {link}, which does not exist"
            elif anchor and anchor not in pages[file].ids:
                yield f"{name} links to {link}, which has no such heading"
        for data in page.text:
            if re.search(r"\]\(|\|--|^```|^- \w", data):
                yield f"{name} has Markdown left over: {data.strip()[:80]}"
    front = pages[folder / "index.html"]
    if not {"img", "audio"} <= front.tags:
        yield "the first page has no picture or no sound"
    sounds = [folder / link for link in pages[folder / "CHANGELOG.html"].loaded if link.endswith(".flac")]
    if len(sounds) != 3 or any(sound.stat().st_size < 100_000 for sound in sounds):
        yield f"the page of changes has not three sounds but {sounds}"
    for page in ("gallery.md", "docs/use/presets.md"):
        if not any(link.endswith("presets/coin.html") for link in pages[(folder / page).with_suffix(".html")].links):
            yield f"{page} does not lead to the coin that can be played"


def search(folder, words):
    script = (folder / "sections.js").read_text() + (folder / "search.js").read_text()
    script += f";console.log(findSections(sections, {words!r}).map(found => found.address).join('\\n'))"
    return subprocess.run(["node", "-"], input=script, check=True, capture_output=True, text=True).stdout.split()


def main():
    source, ringdown, folder = map(pathlib.Path, sys.argv[1:4])
    try:
        import markdown  # noqa: F401
    except ImportError:
        print("skipped: python3-markdown is not installed")
        return SKIPPED
    subprocess.run(["/usr/bin/python3", "-B", source / "packaging/site/make_site.py", ringdown, folder, "coin"], check=True)
    faults = list(faults_of(folder.resolve()))
    if shutil.which("node"):
        for words, page, heading in (("contact pulse", "docs/how/physics.md", "5-a-strike"), ("singing bowl", "docs/use/presets.md", "the-presets")):
            address = page.replace(".md", ".html#") + heading
            if address not in search(folder, words):
                faults.append(f"a search for '{words}' does not find {address}")
        if search(folder, "zyxwv"):
            faults.append("a search finds what does not exist")
    print("\n".join(faults) or "no faults")
    return 1 if faults else 0


sys.exit(main())
