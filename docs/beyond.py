#!/usr/bin/env python3
"""For mdBook: links of pages to files beyond docs/, which are not in the book, become their places in the repository."""

import json
import posixpath
import re
import sys

LINK = re.compile(r"\[([^\]]*)\]\(((?:\.\./)+[^)#]*)(?:#[^)]*)?\)")


def rewrite(items: list) -> None:
    """Rewrites the pages of a book, and those below them."""
    for item in items:
        # Others are headings and lines.
        if not isinstance(item, dict) or "Chapter" not in item:
            continue
        chapter = item["Chapter"]
        folder = posixpath.dirname(posixpath.join("docs", chapter["source_path"] or ""))

        def place(link: re.Match, folder: str = folder) -> str:
            target = posixpath.normpath(posixpath.join(folder, link[2]))
            if target.startswith("docs/"):
                return link[0]
            # What is called as its file is.
            is_name = target.endswith(link[1].strip("`"))
            return f"`{target}`" if is_name else f"{link[1]} (`{target}`)"

        chapter["content"] = LINK.sub(place, chapter["content"])
        rewrite(chapter["sub_items"])


# It is asked first which outputs it is for: for all.
if sys.argv[1:2] != ["supports"]:
    _, book = json.load(sys.stdin)
    rewrite(book["items"])
    json.dump(book, sys.stdout)
