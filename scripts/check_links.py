#!/usr/bin/python3
"""Checks that each link of the HTML pages in a folder leads to a file of the folder, and to an anchor that is there."""

import sys
from html.parser import HTMLParser
from pathlib import Path
from urllib.parse import unquote, urlsplit


class Page(HTMLParser):
    """The links and the anchors of one page."""

    def __init__(self, path):
        super().__init__()
        self.links, self.anchors = [], set()
        self.feed(path.read_text(encoding="utf-8"))

    def handle_starttag(self, tag, attrs):
        attributes = dict(attrs)
        self.anchors.update(attributes[key] for key in ("id", "name") if attributes.get(key))
        self.links += [attributes[key] for key in ("href", "src") if attributes.get(key)]


def main(folder):
    pages = {path.resolve(): Page(path) for path in folder.rglob("*.html")}
    broken = 0
    # 404.html has absolute links; print.html and toc.html repeat those of the other pages.
    for path, page in pages.items():
        if path.name in ("404.html", "print.html", "toc.html"):
            continue
        for link in page.links:
            parts = urlsplit(link)
            if parts.scheme or parts.netloc:
                continue
            target = (path.parent / unquote(parts.path)).resolve() if parts.path else path
            anchor_is_missing = target in pages and parts.fragment and parts.fragment not in pages[target].anchors
            if not target.exists() or anchor_is_missing:
                print(f"{path.relative_to(folder.resolve())}: broken link {link}", file=sys.stderr)
                broken += 1
    print(f"{len(pages)} pages, {broken} broken links")
    return 1 if broken or not pages else 0


if __name__ == "__main__":
    sys.exit(main(Path(sys.argv[1])))
