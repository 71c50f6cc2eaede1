"""Checks that every link, picture and anchor of a built book has a target in the book: links.py FOLDER."""

import sys
from html.parser import HTMLParser
from pathlib import Path
from urllib.parse import unquote, urlsplit

# A page with all pages, and the page for missing ones. Their links are those of the other pages, from another folder.
NOT_PAGES = {"print.html", "404.html"}


class Page(HTMLParser):
    """The links of a page, and the anchors that others can link to."""

    def __init__(self, path: Path) -> None:
        super().__init__()
        self.links: list[str] = []
        self.names: set[str] = set()
        self.feed(path.read_text(encoding="utf-8"))

    def handle_starttag(self, tag: str, attrs: list) -> None:
        """Collects the target of a link, or the name of an anchor."""
        for name, value in attrs:
            if name in ("href", "src") and value:
                self.links.append(value)
            elif name in ("id", "name") and value:
                self.names.add(value)


book = Path(sys.argv[1]).resolve()
pages = {path: Page(path) for path in sorted(book.rglob("*.html"))}
broken = []
count = 0
for path, page in pages.items():
    for link in page.links if path.name not in NOT_PAGES else []:
        parts = urlsplit(link)
        if parts.scheme or parts.netloc:
            continue
        count += 1
        target = (path.parent / unquote(parts.path)).resolve() if parts.path else path
        is_there = target.is_relative_to(book) and target.is_file()
        if is_there and parts.fragment and target in pages:
            is_there = unquote(parts.fragment) in pages[target].names
        if not is_there:
            broken.append(f"{path.relative_to(book)}: {link}")
if broken:
    sys.exit("links without a target:\n" + "\n".join(broken))
print(f"{count} links of {len(pages)} pages have a target")
assert count > 1000
assert len(pages) > 50
