"""The checker itself, on sources that break each rule."""

import pathlib
import tempfile
import unittest

import check_sources
import comment_names

TABLE = "| `src/one/` | `vdwmesh::one` | things | `shown` |\n"


class CheckSources(unittest.TestCase):
    def setUp(self):
        folder = tempfile.TemporaryDirectory()
        self.addCleanup(folder.cleanup)
        self.root = pathlib.Path(folder.name)
        for name in ("src/one", "cuda", "apps", "cmake", "docs"):
            (self.root / name).mkdir(parents=True)
        self.write("src/one/shown.hpp", "namespace vdwmesh {\nstruct Shown {};\n}\n")
        self.write("cmake/VdwmeshInstall.cmake", "set(one_headers shown)\n")
        self.write("docs/architecture.md", TABLE)

    def write(self, path, text):
        (self.root / path).write_text(text)

    def faults(self):
        return [*check_sources.double_definitions(self.root), *check_sources.wrong_headers(self.root)]

    def test_finds_nothing_in_sound_sources(self):
        self.assertEqual(self.faults(), [])

    def test_finds_a_type_of_two_definitions(self):
        self.write("cuda/other.cuh", "namespace vdwmesh {\n\nclass Shown final : public Base {};\n}\n")
        self.assertEqual(self.faults(), ["vdwmesh::Shown is defined more than once: "
                                         "cuda/other.cuh:3, src/one/shown.hpp:2"])  # fmt: skip

    def test_finds_a_constant_of_two_definitions(self):
        for path in ("cuda/a.cuh", "cuda/b.cuh"):
            self.write(path, "namespace vdwmesh {\ninline constexpr int kMost = 3;\n}\n")
        self.assertEqual(len(self.faults()), 1)

    def test_takes_other_scopes_for_other_types(self):
        self.write("cuda/other.cuh",
                   "namespace vdwmesh::inner {\nstruct Shown {};\n}\n"
                   "namespace vdwmesh {\nnamespace {\nstruct Shown {};\n}\n"
                   "struct Outer {\n  struct Shown {};\n};\n"
                   "struct Shown;  // struct Shown {\n"
                   "inline void f() {\n  struct Shown {};\n}\n}\n")  # fmt: skip
        self.assertEqual(self.faults(), [])

    def test_finds_headers_that_are_not_for_users(self):
        self.write("src/one/hidden.hpp", "")
        self.write("src/one/shown.hpp", '#include "one/hidden.hpp"\n')
        self.assertEqual(self.faults(),
                         ["one/shown.hpp is installed and includes one/hidden.hpp, which is not"])

    def test_finds_headers_that_are_not_documented_or_not_installed(self):
        self.write("docs/architecture.md", TABLE.replace("shown", "other"))
        self.assertEqual(self.faults(),
                         ["one/shown.hpp is installed, but docs/architecture.md does not list it",
                          "docs/architecture.md lists one/other.hpp, but it is not installed"])  # fmt: skip


HEADER = """#pragma once

struct Options {
  int limit = 0;  // at most `most`
};
enum class Kind { round, flat };

// Hands over up to `most` of them to `other`.
void deliver(const Options& options, int most);

void give_back(int other);
"""


class CommentNames(unittest.TestCase):
    def setUp(self):
        folder = tempfile.TemporaryDirectory()
        self.addCleanup(folder.cleanup)
        self.root = pathlib.Path(folder.name)
        self.write("src/one/shown.hpp", HEADER)
        self.write("docs/report.schema.json", '{"properties": {"grid_nodes": {}}}')

    def write(self, path, text):
        (self.root / path).parent.mkdir(parents=True, exist_ok=True)
        (self.root / path).write_text(text)

    def faults(self, comment="", after="void take();\n"):
        text = '#include "one/shown.hpp"\n\nnamespace {\n' + comment + after + "}\n"
        self.write("apps/user.cpp", text)
        return [fault for fault in comment_names.Tree(self.root).wrong_names() if "apps" in fault]

    def test_finds_a_parameter_that_the_declaration_has_not(self):
        self.assertEqual([*comment_names.Tree(self.root).wrong_names()], [
            "src/one/shown.hpp:4: no `most` in what the comment is about",
            "src/one/shown.hpp:8: no `other` in what the comment is about"])  # fmt: skip

    def test_finds_names_that_nobody_has(self):
        for comment in ("`missing`", "`Options::missing`", "`gone.hpp`", "`--gone`", "find_opposite()",
                        "Kind::sharp", "`vdwmesh gone`", "`Options::limit - least`"):  # fmt: skip
            self.assertEqual(len(self.faults(f"// As {comment}.\n")), 1, comment)

    def test_finds_parameters_and_members_of_others(self):
        self.assertEqual(len(self.faults("// Up to `most`.\n")), 1)
        self.assertEqual(len(self.faults("// Up to `limit`.\n")), 1)
        self.assertEqual(len(self.faults("// Up to `count`.\n", "void a();\nvoid b() {\n\n}\n\n"
                                         "// Up to `count`.\nvoid c(int count);\n")), 1)  # fmt: skip
        self.assertEqual(len(self.faults("", "void a(int b);  // of `c`\nvoid d(int c);\n\n")), 0)
        self.assertEqual(len(self.faults("", "void a(int b);  // of `c`\n\nvoid d(int c);\n")), 1)

    def test_takes_names_that_exist(self):
        for comment in ("`Kind`", "`Options::limit`", "`deliver`", "deliver()", "`Kind::flat`",
                        "`one/shown.hpp`", "`grid_nodes`", "`std::vector`", "a call(i), `i` below",
                        "`--limit`", "`vdwmesh study`", "`taken[i] + 1`", "`taken\n// + 2`"):  # fmt: skip
            after = 'void call(int taken) {\n\n  // `taken`\n}\nauto x = {"--limit", "study"};\n'
            self.assertEqual(self.faults(f"// As {comment}.\n", after), [], comment)

    def test_takes_all_names_of_the_file_where_a_blank_line_follows(self):
        self.assertEqual(self.faults("// Of `count`.\n\n", "void a();\n\nvoid b(int count);\n"), [])

    def test_finds_sources_without_a_comment_at_their_top(self):
        self.write("src/one/bare.cpp", "int a;  // one\n")
        self.write("src/one/short.cpp", "// One.\nint a;\n")
        self.write("cuda/long.cu", "// One.\n" + "int a;\n" * 60)
        self.assertEqual([*comment_names.Tree(self.root).bare_sources()], [
            "src/one/bare.cpp: begins with 0 lines of comment, 1 are needed",
            "cuda/long.cu: begins with 1 lines of comment, 2 are needed"])  # fmt: skip


if __name__ == "__main__":
    unittest.main()
