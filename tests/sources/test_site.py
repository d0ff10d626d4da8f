"""docs/site: the documentation as HTML pages, all of whose links, anchors and pictures are there."""

import pathlib
import sys
import tempfile
import unittest

SOURCES = pathlib.Path(__file__).parents[2]
sys.path[:0] = [str(SOURCES / "docs" / "site"), str(SOURCES / "tests" / "cli")]
from program import need_package  # noqa: E402


class Site(unittest.TestCase):
    def setUp(self):
        need_package("python3-markdown", module="markdown")
        folder = tempfile.TemporaryDirectory()
        self.addCleanup(folder.cleanup)
        self.folder = pathlib.Path(folder.name).resolve()

    def build_pages(self, **pages):
        """The site of a project that has these pages in docs/, without .md."""
        import build_site
        import check_site

        sources = self.folder / "sources"
        (sources / "docs").mkdir(parents=True)
        for name, text in pages.items():
            (sources / "docs" / f"{name}.md").write_text(text)
        listing = sources / "pages.csv"
        listing.write_text("section,source,title\n" + "".join(f"S,docs/{name}.md,T\n" for name in pages))
        site = self.folder / "site"
        build_site.Site(site, "1", sources, listing).build()
        return site, check_site.faults(site)

    def test_all_links_of_the_documentation_lead_somewhere(self):
        import build_site
        import check_site

        site = self.folder / "site"
        build_site.Site(site, "").build()
        self.assertEqual(check_site.faults(site), [])
        pages = list(site.rglob("*.html"))
        self.assertGreater(len(pages), 30)
        for page in pages:
            self.assertNotRegex(page.read_text(), r"<p>[^<]*```|<p>\|", f"{page}: a block that is none")

    def test_names_of_headers_lead_to_their_reference(self):
        import build_site

        sources = self.folder / "sources"
        (sources / "docs").mkdir(parents=True)
        (sources / "docs" / "index.md").write_text("# A\n\n`a/vertex_map.hpp`, `other.hpp`, `a/vertex_map.cpp`\n")
        listing = sources / "pages.csv"
        listing.write_text("section,source,title\nReference,docs/index.md,T\n")
        api = self.folder / "api"
        api.mkdir()
        for name in ("index.html", "vertex__map_8hpp.html"):
            (api / name).write_text('<div id="projectname">vdwmesh<span>')
        build_site.Site(self.folder / "site", "1", sources, listing).build(api)
        text = (self.folder / "site" / "index.html").read_text()
        self.assertIn('<a href="api/vertex__map_8hpp.html"><code>a/vertex_map.hpp</code></a>', text)
        self.assertIn("<code>other.hpp</code>, <code>a/vertex_map.cpp</code>", text)
        reference = (self.folder / "site" / "api" / "index.html").read_text()
        self.assertIn('<div id="projectname"><a href="../index.html">vdwmesh</a><span>', reference)

    def test_pages_of_folders_look_like_the_others(self):
        import build_site

        sources = self.folder / "sources"
        (sources / "docs" / "data").mkdir(parents=True)
        (sources / "docs" / "data" / "a.csv").write_text("1\n")
        (sources / "docs" / "index.md").write_text("# A\n\n[files](data)\n")
        (sources / "pages.csv").write_text("section,source,title\nS,docs/index.md,T\n")
        build_site.Site(self.folder / "site", "1", sources, sources / "pages.csv").build()
        text = (self.folder / "site" / "files" / "docs" / "data" / "index.html").read_text()
        for part in ('<a href="a.csv">a.csv</a>', 'href="../../../style.css"', "<h1>docs/data</h1>"):
            self.assertIn(part, text)

    def test_finds_missing_anchors(self):
        _, faults = self.build_pages(index="# A\n\n[there](b.md#no)\n", b="# B\n\n## Yes\n")
        self.assertEqual(faults, ["index.html: links to b.html#no, and there is no such anchor"])

    def test_finds_what_is_not_in_the_site(self):
        site, faults = self.build_pages(index="# A\n\n[there](b.md#yes)\n", b="# B\n\n## Yes\n")
        self.assertEqual(faults, [])
        import check_site

        (site / "b.html").write_text('<a href="index.html"></a><img src="http://a.b/c.png" alt="c"><a href="gone.html"></a>')
        (site / "style.css").write_text("")
        found = "\n".join(check_site.faults(site))
        for fault in ("index.html: loads style.css", "b.html: loads http://a.b/c.png", "b.html: links to gone.html"):
            self.assertIn(fault, found)

    def test_refuses_links_to_nothing_and_pages_that_are_not_listed(self):
        import build_site

        with self.assertRaisesRegex(build_site.SiteError, r"docs/index.md links to gone.md, which is not there"):
            self.build_pages(index="[gone](gone.md)")
        (self.folder / "sources" / "docs" / "other.md").write_text("# Other\n")
        site = build_site.Site(self.folder / "site", "", self.folder / "sources", self.folder / "sources" / "pages.csv")
        with self.assertRaisesRegex(build_site.SiteError, "does not list docs/other.md"):
            site.build()

    def test_reads_pages_as_github_does(self):
        text = "# A\nBelow:\n- one\n  more\n- two\n\nThen:\n```sh with words\nls *.x\n```\n## Näh & so: `x_y`, 2\n[here](#näh--so-x_y-2)\n"
        site, faults = self.build_pages(index=text)
        self.assertEqual(faults, [])
        page = (site / "index.html").read_text()
        self.assertIn('<code class="language-sh">ls *.x\n</code>', page)
        self.assertEqual(page.split("<main")[1].count("<li>"), 2)


if __name__ == "__main__":
    unittest.main()
