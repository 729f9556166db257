"""Links to all sections at the top of a page, in their order: gathered from the finished page, so that none is forgotten."""

import re
from html import escape, unescape

PLACE = "<!-- links to all sections -->"
"""Stands in the page where the links go."""
SECTION = re.compile(r'<section\b([^>]*)>\s*(?:<h[12][^>]*>(.*?)</h[12]>)?', re.DOTALL)
NAMED = re.compile(r'\b(id|data-nav)="([^"]*)"')
TAG = re.compile(r"<[^>]*>")


def linked(page: str) -> str:
    """The page with a link to every section that has an id: by the section's `data-nav`, else by its heading."""
    links = []
    for attributes, heading in SECTION.findall(page):
        named = dict(NAMED.findall(attributes))
        if "id" in named:
            words = unescape(named.get("data-nav") or TAG.sub("", heading)).strip() or named["id"]
            links.append(f'<a href="#{named["id"]}">{escape(words)}</a>')
    return page.replace(PLACE, " ".join(links), 1)
