"""check_links.py finds what it is for, and nothing else."""

import pathlib
import tempfile
import unittest

import check_links


class LinksTest(unittest.TestCase):
    def faults(self, **files):
        """Of documents, by name without the suffix."""
        with tempfile.TemporaryDirectory() as folder:
            root = pathlib.Path(folder).resolve()
            (root / "docs").mkdir()
            for name, text in files.items():
                (root / f"{name.replace('__', '/')}.md").write_text(text)
            return list(check_links.wrong_links(root))

    def test_files_and_headings_that_are_there(self):
        self.assertEqual(self.faults(a="[b](docs/b.md) [c](docs/b.md#two-words) [d](#here)\n# Here\n",
                                     docs__b="# One\n## Two words\n[up](../a.md#here)\n"), [])  # fmt: skip

    def test_files_that_are_not(self):
        self.assertEqual(self.faults(a="# A\n\n[b](b.md)"), ["a.md:3: b.md leads to no file"])
        self.assertEqual(self.faults(a="![b](docs/b.png)"), ["a.md:1: docs/b.png leads to no file"])
        self.assertEqual(self.faults(a="see [b][1]\n\n[1]: b.md\n"), ["a.md:3: b.md leads to no file"])
        self.assertEqual(self.faults(docs__b="[a](a.md)", a=""), ["docs/b.md:1: a.md leads to no file"])
        self.assertEqual(self.faults(a="[b](../..)"), ["a.md:1: ../.. leads out of the project"])

    def test_headings_that_are_not(self):
        self.assertEqual(self.faults(a="[x](#b)\n# A\n"), ["a.md:1: #b leads to no heading"])
        self.assertEqual(self.faults(a="[x](docs/b.md#c)", docs__b="```\n# c\n```\n"),
                         ["a.md:1: docs/b.md#c leads to no heading"])  # fmt: skip

    def test_names_of_headings(self):
        self.assertEqual(check_links.headings("# A `b_c`, d–e & f\n## A\n## A\n### [G](h.md)!\n"),
                         {"a-b_c-de--f", "a", "a-1", "g"})  # fmt: skip

    def test_what_is_no_link(self):
        self.assertEqual(self.faults(a="`[a](b)`\n```\n[a](b)\n```\n[a](https://b/c) [d](#d)\n# d\n"), [])

    def test_paths_of_the_glossary(self):
        with tempfile.TemporaryDirectory() as folder:
            root = pathlib.Path(folder)
            for part in ("docs", "src/room"):
                (root / part).mkdir(parents=True)
            (root / "src/room/a.hpp").touch()
            (root / "docs/glossary.md").write_text(
                "| a | b `no/path` | `room/a.hpp` |\n| b | c | `room` |\n| c | d | `TypeName` |\n| d | e | `room/b.hpp` |\n")
            self.assertEqual(list(check_links.wrong_paths(root)), ["docs/glossary.md:4: there is no src/room/b.hpp"])

    def test_a_project_without_links_is_no_success(self):
        self.assertEqual(len(self.faults(a="# A\n")), 1)


if __name__ == "__main__":
    unittest.main()
