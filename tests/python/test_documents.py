"""The examples of the documentation and of the docstrings give what they say."""

import doctest
import importlib.util
import pathlib
import unittest

import vdwmesh
from program import SOURCE_DIR


def modules():
    """All of the package that needs no other package."""
    names = sorted(path.stem for path in pathlib.Path(vdwmesh.__file__).parent.glob("*.py"))
    others = {"mdanalysis", "jax", "openmm"} | ({"torch"} if importlib.util.find_spec("torch") is None else set())
    names = [name for name in names if name not in others | {"__init__"}]
    return [importlib.import_module(f"vdwmesh.{name}") for name in names]


class DocumentsTest(unittest.TestCase):
    def test_docstrings(self):
        ran = [doctest.testmod(module) for module in modules()]
        self.assertEqual(sum(result.failed for result in ran), 0)
        self.assertGreater(sum(result.attempted for result in ran), 5)

    def test_tour(self):
        page = SOURCE_DIR / "docs" / "python.md"
        result = doctest.testfile(str(page), module_relative=False, globs={"vdwmesh": vdwmesh})
        self.assertEqual(result.failed, 0)
        self.assertGreater(result.attempted, 3)

    def test_every_function_says_what_it_takes(self):
        for name in vdwmesh.__all__:
            text = getattr(vdwmesh, name).__doc__
            if name != "__version__":
                self.assertTrue(text and text.strip(), name)


if __name__ == "__main__":
    unittest.main()
