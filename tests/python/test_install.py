"""The package where users have it: installed by CMake, and by pip without a network."""

import os
import pathlib
import subprocess
import sys
import tempfile
import unittest
import zipfile

from program import SOURCE_DIR, need_package

BUILD_DIR = pathlib.Path(os.environ["VDWMESH_BUILD_DIR"])
# A ball of radius 3: 36 pi Å². The path of the module says which one was imported.
USE = "import vdwmesh; print(vdwmesh.__file__, round(vdwmesh.exact([[0, 0, 0]], [3.0]).area, 6))"


class InstallTest(unittest.TestCase):
    def setUp(self):
        folder = tempfile.TemporaryDirectory()
        self.addCleanup(folder.cleanup)
        self.folder = pathlib.Path(folder.name).resolve()
        self.environment = {**os.environ, "PYTHONPATH": ""}

    def run_ok(self, *command, **options):
        found = subprocess.run([str(word) for word in command], capture_output=True, text=True,
                               cwd=self.folder, **{"env": self.environment, **options})  # fmt: skip
        self.assertEqual(found.returncode, 0, found.stdout + found.stderr)
        return found.stdout

    def assert_works(self, python, inside, **options):
        path, area = self.run_ok(python, "-c", USE, **options).split()
        self.assertTrue(pathlib.Path(path).resolve().is_relative_to(inside), path)
        self.assertEqual(area, "113.097336")

    def test_cmake_installs_the_package_alone(self):
        self.run_ok("cmake", "--install", BUILD_DIR, "--component", "python", "--prefix", self.folder)
        package = next(self.folder.rglob("vdwmesh"))
        names = {path.name for path in package.iterdir()}
        self.assertTrue({"__init__.py", "py.typed", "_core.pyi", "errors.py"} <= names, names)
        self.assertFalse(any(path.is_symlink() for path in package.iterdir()))
        environment = {**self.environment, "PYTHONPATH": str(package.parent)}
        self.assert_works(sys.executable, self.folder, env=environment)

    def test_pip_installs_without_a_network(self):
        need_package("python3-pip", module="pip")
        need_package("python3-venv", module="ensurepip")
        venv = self.folder / "venv"
        self.run_ok(sys.executable, "-m", "venv", "--system-site-packages", venv)
        python = venv / "bin" / "python"
        self.run_ok(python, "-m", "pip", "install", "--no-index", SOURCE_DIR,
                    "--config-settings", f"build-dir={BUILD_DIR}")  # fmt: skip
        self.assert_works(python, venv)
        shown = self.run_ok(python, "-m", "pip", "show", "--files", "vdwmesh")
        self.assertIn("vdwmesh/py.typed", shown)
        checked = subprocess.run([python, "-m", "pip", "check"], capture_output=True, text=True,
                                 env=self.environment)  # fmt: skip
        self.assertNotIn("vdwmesh", checked.stdout)  # packages of Debian may lack theirs
        self.run_ok(python, "-m", "pip", "uninstall", "--yes", "vdwmesh")
        self.assertEqual(list(venv.rglob("vdwmesh")), [])

    def test_wheels_of_the_same_sources_are_the_same(self):
        code = (f"import sys; sys.path.insert(0, {str(SOURCE_DIR / 'python' / 'backend')!r}); "
                f"import vdwmesh_build; vdwmesh_build.build_wheel(sys.argv[1], {{'build-dir': {str(BUILD_DIR)!r}}})")  # fmt: skip
        wheels = []
        for name in ("a", "b"):
            (self.folder / name).mkdir()
            self.run_ok(sys.executable, "-B", "-c", code, self.folder / name)
            wheels.append(next((self.folder / name).iterdir()))
        self.assertEqual(wheels[0].read_bytes(), wheels[1].read_bytes())
        with zipfile.ZipFile(wheels[0]) as archive:
            self.assertIsNone(archive.testzip())


if __name__ == "__main__":
    unittest.main()
