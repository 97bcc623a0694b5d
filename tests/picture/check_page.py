#!/usr/bin/python3
"""Reads what `ringdown info` drew as other programs would, and prints what it finds: check_page.py FILE.png|FILE.html"""
import base64
import html.parser
import json
import sys
import xml.dom.minidom

VOID = {"meta", "br", "input", "img", "link", "hr"}


class Page(html.parser.HTMLParser):
    def __init__(self):
        super().__init__()
        self.open, self.rows, self.cells, self.scripts, self.title = [], 0, [], [], ""
        self.outside, self.unclosed, self.tags = [], 0, set()

    def handle_starttag(self, tag, attributes):
        self.tags.add(tag)
        if tag not in VOID:
            self.open.append(tag)
        for key, value in attributes:
            if key.startswith("on") or (key in ("src", "href", "xlink:href") and not value.startswith("#")):
                self.outside.append(f"{tag} {key}={value}")

    def handle_startendtag(self, tag, attributes):
        self.handle_starttag(tag, attributes)
        if tag not in VOID:
            self.open.pop()

    def handle_endtag(self, tag):
        if not self.open or self.open.pop() != tag:
            self.unclosed += 1
        if tag == "tr":
            self.rows += 1

    def handle_data(self, data):
        inside = self.open[-1] if self.open else ""
        if inside == "td":
            self.cells.append(data)
        elif inside == "script":
            self.scripts.append(data)
        elif inside == "title":
            self.title += data


def page(path):
    text = open(path, encoding="utf-8").read()
    reader = Page()
    reader.feed(text)
    reader.close()
    svg = text[text.index("<svg"):text.index("</svg>") + 6]
    xml.dom.minidom.parseString(svg)
    data = json.loads(reader.scripts[0])
    print("title", reader.title)
    print("rows", reader.rows)
    print("faults", reader.unclosed + len(reader.open), "outside", len(reader.outside), *reader.outside)
    if data:
        for name in ("points", "triangles", "places", "shapes"):
            print(name, len(base64.b64decode(data[name], validate=True)))
    for cell in reader.cells:
        print("cell", cell)


def picture(path):
    from PIL import Image
    image = Image.open(path).convert("RGB")
    colours = image.getcolors(1 << 24)
    white = sum(count for count, colour in colours if colour == (255, 255, 255))
    print("size", *image.size)
    print("colours", len(colours))
    print("white %", round(100 * white / (image.size[0] * image.size[1])))


page(sys.argv[1]) if sys.argv[1].endswith(".html") else picture(sys.argv[1])
