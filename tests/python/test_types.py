"""The types of the Python layer, as users' type checkers see them."""

import pathlib
import subprocess
import sys
import tempfile
import unittest

from program import SOURCE_DIR, need_package

USE = """
import vdwmesh

molecule = vdwmesh.read("x.pdb")
union = vdwmesh.exact(molecule, probe=1.4, topology=True)
reveal_type(union.area)
reveal_type(union.atom_area)
vdwmesh.exact(molecule, probes=1.4)
"""


class TypesTest(unittest.TestCase):
    def mypy(self, *arguments):
        need_package("mypy", module="mypy")
        with tempfile.TemporaryDirectory() as cache:
            # Newer versions understand what older ones are told to ignore.
            import mypy.version

            older = [] if mypy.version.__version__.startswith("1.0.") else ["--no-warn-unused-ignores"]
            return subprocess.run([sys.executable, "-m", "mypy", "--strict", *older, "--cache-dir", cache, *arguments],
                                  capture_output=True, text=True, cwd=SOURCE_DIR / "python")  # fmt: skip

    def test_the_package_is_strict(self):
        found = self.mypy("vdwmesh")
        self.assertEqual(found.returncode, 0, found.stdout + found.stderr)

    def test_users_are_told(self):
        with tempfile.TemporaryDirectory() as folder:
            path = pathlib.Path(folder) / "use.py"
            path.write_text(USE)
            found = self.mypy(str(path)).stdout
        self.assertIn('Revealed type is "builtins.float"', found)
        self.assertRegex(found, r"numpy\.(float64|floating\[numpy\._typing\._64Bit\])")
        self.assertIn('No overload variant of "exact"', found)


if __name__ == "__main__":
    unittest.main()
