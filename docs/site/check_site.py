#!/usr/bin/env python3
"""Looks at every page of the documentation as HTML: do links, anchors and pictures lead somewhere?

    check_site.py SITE_FOLDER

Prints a line for each fault and ends with status 1 if there are any. Addresses of other sites are not
looked up, but pages may load nothing from them. Pages by Doxygen (`api/`) are targets and not looked at.
"""

import html.parser
import pathlib
import sys
import urllib.parse


class PageParser(html.parser.HTMLParser):
    """What a page links to, what it loads, and its anchors."""

    def __init__(self):
        super().__init__()
        self.links, self.loads, self.anchors = [], [], []

    def handle_starttag(self, tag, attributes):
        attributes = dict(attributes)
        self.anchors += [attributes[name] for name in ("id", "name") if tag != "meta" and attributes.get(name)]
        if tag == "a" and "href" in attributes:
            self.links.append(attributes["href"])
        elif "src" in attributes or (tag == "link" and "href" in attributes):
            self.loads.append(attributes.get("src") or attributes["href"])
            if tag == "img" and not attributes.get("alt"):
                self.links.append("?picture without a text")


def parsed(path):
    parser = PageParser()
    parser.feed(path.read_text())
    return parser


def faults(site):
    """Lines that say which page has which fault."""
    pages = {
        path: parsed(path) for path in sorted(site.rglob("*.html")) if path.relative_to(site).parts[0] != "api"
    }
    if not pages:
        return [f"{site} has no pages"]
    found = []
    for path, page in pages.items():
        name = path.relative_to(site)
        found += [f"{name}: two anchors #{a}" for a in sorted(set(page.anchors)) if page.anchors.count(a) > 1]
        for address in page.loads:
            parts = urllib.parse.urlsplit(address)
            target = path.parent / urllib.parse.unquote(parts.path)
            if parts.scheme or not target.is_file() or not target.stat().st_size:
                found.append(f"{name}: loads {address}, which is not in the site")
        for address in page.links:
            parts = urllib.parse.urlsplit(address)
            if parts.scheme in ("http", "https", "mailto"):
                continue
            target = (path.parent / urllib.parse.unquote(parts.path)).resolve() if parts.path else path
            if parts.scheme or parts.query or not target.is_file():
                found.append(f"{name}: links to {address}, which is not in the site")
            elif parts.fragment:
                other = pages.get(target) or parsed(target)
                if urllib.parse.unquote(parts.fragment) not in other.anchors:
                    found.append(f"{name}: links to {address}, and there is no such anchor")
    return found


def main():
    found = faults(pathlib.Path(sys.argv[1]).resolve())
    print("\n".join(found) or "check_site: all links lead somewhere")
    sys.exit(1 if found else 0)


if __name__ == "__main__":
    main()
