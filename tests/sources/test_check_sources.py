"""The checker itself, on sources that break each rule."""

import pathlib
import tempfile
import unittest

import check_sources

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


if __name__ == "__main__":
    unittest.main()
