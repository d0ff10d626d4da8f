"""house.py: what it counts, on a house of three files."""

import pathlib
import tempfile
import unittest

import house


class Counts(unittest.TestCase):
    def setUp(self):
        folder = tempfile.TemporaryDirectory()
        self.addCleanup(folder.cleanup)
        self.root = pathlib.Path(folder.name)
        for name, text in {
            "src/one/a.hpp": "// A head.\nstruct Row {\n};\n",
            "src/one/b.hpp": '#include "one/a.hpp"\nclass Row {\n};\nstruct Declared;\n',
            "src/one/c.cpp": '#include "one/b.hpp"\n#include <vector>\n  struct Inner {\n  };\n',
            "docs/page.md": "one\ntwo\n",
            "docs/notes/note.md": "three\n",
        }.items():
            (self.root / name).parent.mkdir(parents=True, exist_ok=True)
            (self.root / name).write_text(text)

    def test_each_figure(self):
        self.assertEqual(dict(house.House(self.root).figures()), {
            "lines": 11, "comment_percent": 9.1, "types_per_1000_lines": 272.7, "type_names_in_several_files": 1,
            "headers_a_source_pulls": 2, "include_depth": 3, "files_of_largest_folder": 3, "lines_of_pages": 2})  # fmt: skip

    def test_headers_that_include_each_other_end(self):
        (self.root / "src/one/a.hpp").write_text('#include "one/b.hpp"\n')
        found = house.House(self.root)
        self.assertEqual(found.pulled("src/one/c.cpp"), {"src/one/a.hpp", "src/one/b.hpp"})


if __name__ == "__main__":
    unittest.main()
