"""docs/api/filter.py: comments of a header as Doxygen reads them."""

import pathlib
import sys
import unittest

sys.path.insert(0, str(pathlib.Path(__file__).parents[2] / "docs" / "api"))
import filter as api_filter  # noqa: E402


class ApiFilter(unittest.TestCase):
    def check(self, text, expected):
        self.assertEqual("\n".join(api_filter.converted(text.split("\n"))), expected)

    def test_takes_the_first_comment_for_the_file(self):
        self.check("// Things.\n//\n// More.\n#pragma once", "/// \\file\n/// Things.\n///\n/// More.\n#pragma once")

    def test_takes_comments_above_and_behind_declarations(self):
        self.check("\n// Sum.\nint f(int a);\nint b;  // Å", "\n/// Sum.\nint f(int a);\n/// Sum.\nint b;  ///< Å")
        self.check("int a;  // one\n        // two", "int a;  ///< one\n        ///< two")

    def test_leaves_comments_that_document_nothing(self):
        for text in ("\n// Apart.\n\nint a;", "\n// Why.\n#if X", "\n// Why.\nnamespace a {", "}  // namespace"):
            self.check(text, text)

    def test_repeats_a_comment_for_its_paragraph_overloads_and_variables(self):
        self.check("\n// Å\nconst int a;\nstruct B {\n  int c;\n};\n\nint d;",
                   "\n/// Å\nconst int a;\n/// Å\nstruct B {\n  int c;\n};\n\nint d;")  # fmt: skip
        self.check("\n  // F.\n  void f(int);\n  void f();\n  void g();",
                   "\n  /// F.\n  void f(int);\n  /// F.\n  void f();\n  void g();")  # fmt: skip
        self.check("  double a = 0, b;  // Å", "  double a = 0;  ///< Å\n  double b;  ///< Å")

    def test_escapes_what_doxygen_would_read(self):
        self.check("\n// <a> 2 * b, `*c*`, D. Knuth @ #e\nint f();",
                   "\n/// \\<a\\> 2 \\* b, `*c*`, D.\\ Knuth \\@ \\#e\nint f();")  # fmt: skip


if __name__ == "__main__":
    unittest.main()
