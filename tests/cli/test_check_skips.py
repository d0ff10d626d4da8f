"""The check that no test vanishes, on outputs as GoogleTest, unittest and ctest write them."""

import contextlib
import io
import pathlib
import sys
import tempfile
import unittest
from xml.sax.saxutils import escape

sys.path.insert(0, str(pathlib.Path(__file__).resolve().parents[1]))
import check_skips

GOOGLE = """\
[==========] Running 4 tests from 2 test suites.
[ RUN      ] Suite.Passes
[       OK ] Suite.Passes (0 ms)
[ RUN      ] Suite.Skips
a line of the test's own
/a/b.cpp:5: Skipped
two
lines
[  SKIPPED ] Suite.Skips (0 ms)
[ RUN      ] Backends/Suite.Skips/cuda
/a/b.cpp:5: Skipped

[  SKIPPED ] Backends/Suite.Skips/cuda (3 ms)
[  PASSED  ] 1 test.
[  SKIPPED ] 2 tests, listed below:
[  SKIPPED ] Suite.Skips
[  SKIPPED ] Backends/Suite.Skips/cuda
"""
PYTHON = """\
test_a (test_m.C.test_a)
A line of documentation. ... skipped "why 'not'"
test_b (test_m.C.test_b) ...
  test_b (test_m.C.test_b) (i=0, f='x y') ... skipped 'part'
  test_b (test_m.C.test_b) (i=1, f='x y') ... skipped 'part'
test_c (test_m.C.test_c) ... ok
setUpClass (test_m.D) ... skipped 'whole'

----------------------------------------------------------------------
Ran 3 tests in 0.010s

OK (skipped=4)
"""


def case(name, output, status="run", inner=""):
    return f'<testcase name="{name}" status="{status}">{inner}<system-out>{escape(output)}</system-out></testcase>'


class CheckSkips(unittest.TestCase):
    def setUp(self):
        folder = tempfile.TemporaryDirectory()
        self.addCleanup(folder.cleanup)
        self.folder = pathlib.Path(folder.name)

    def skips(self, *cases):
        path = self.folder / "tests.xml"
        path.write_text(f"<testsuite>{''.join(cases)}</testsuite>")
        return [tuple(skip) for skip in check_skips.skips_of(path)]

    def status(self, allowed, *cases):
        self.skips(*cases)
        table = self.folder / "allowed.csv"
        table.write_text("test,message,reason\n" + allowed)
        with contextlib.redirect_stdout(io.StringIO()):
            return check_skips.main(self.folder / "tests.xml", table)

    def test_googletest(self):
        self.assertEqual(self.skips(case("p", GOOGLE)),
                         [("p/Suite.Skips", "two\nlines"), ("p/Backends/Suite.Skips/cuda", "")])

    def test_unittest(self):
        self.assertEqual(self.skips(case("cli.m", PYTHON)), [
            ("cli.m/test_m.C.test_a", "why 'not'"),
            ("cli.m/test_m.C.test_b", "part"), ("cli.m/test_m.C.test_b", "part"),
            ("cli.m/test_m.D.setUpClass", "whole")])

    def test_what_ctest_did_not_run(self):
        inner = '<skipped message="SKIP_RETURN_CODE=77"/>'
        self.assertEqual(self.skips(case("c", "another compiler\n", "notrun", inner)),
                         [("c", "SKIP_RETURN_CODE=77 another compiler")])
        self.assertEqual(self.skips(case("c", "", "disabled")), [("c", "disabled")])

    def test_programs_without_tests_and_disabled_tests(self):
        for output in ("[==========] Running 0 tests from 0 test suites.\n", "Ran 0 tests in 0.000s\n",
                       "  YOU HAVE 1 DISABLED TEST\n", "  YOU HAVE 2 DISABLED TESTS\n"):
            with self.subTest(output=output):
                self.assertEqual(len(self.skips(case("p", output))), 1)

    def test_a_count_that_does_not_fit_the_names(self):
        self.assertEqual(len(self.skips(case("p", "[  SKIPPED ] 1 test, listed below:\n"))), 1)
        self.assertEqual(len(self.skips(case("p", "OK (skipped=1)\n"))), 1)

    def test_only_what_is_listed_is_allowed_and_only_for_its_reason(self):
        self.assertEqual(self.status("", case("p", "[       OK ] Suite.Passes (0 ms)\n")), 0)
        self.assertEqual(self.status("", case("p", GOOGLE)), 1)
        self.assertEqual(self.status("p/*,*,reason\n", case("p", GOOGLE)), 0)
        self.assertEqual(self.status("p/*,no device*,reason\n", case("p", GOOGLE)), 1)
        self.assertEqual(self.status("p/Backends/*,*,reason\n", case("p", GOOGLE)), 1)

    def test_a_row_without_a_reason_is_refused(self):
        with self.assertRaises(SystemExit):
            self.status("p/*,*,\n", case("p", GOOGLE))

    def test_the_list_itself_can_be_read(self):
        self.assertTrue(check_skips.read_allowed(check_skips.ALLOWED))


if __name__ == "__main__":
    unittest.main()
