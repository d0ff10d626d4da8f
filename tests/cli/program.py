"""Runs the program under test and keeps what it wrote."""

import functools
import json
import os
import pathlib
import subprocess
import tempfile
import unittest

PROGRAM = os.environ["VDWMESH_PROGRAM"]
SOURCE_DIR = pathlib.Path(os.environ["VDWMESH_SOURCE_DIR"])
SHARED_DIR = pathlib.Path(os.environ.get("VDWMESH_SHARED", SOURCE_DIR.parent / "shared"))
UBIQUITIN = SOURCE_DIR / "data" / "ubiquitin.pdb"

SANITIZED = "VDWMESH_SANITIZED" in os.environ  # the program, which takes more time and memory so

DONE, BAD_INPUT, NO_BACKEND, LIMIT_HIT = 0, 1, 2, 3


def run(*arguments, **options):
    command = [PROGRAM, *map(str, arguments)]
    return subprocess.run(command, capture_output=True, text=True, timeout=300, **options)


def refuse_constant(name):
    raise ValueError(f"JSON has no {name}")


def parse_json(text):
    """Parses strictly: NaN and Infinity, which Python's reader would take, are errors."""
    return json.loads(text, parse_constant=refuse_constant)


@functools.cache
def schema_validator():
    """Of the report; None without python3-jsonschema."""
    try:
        import jsonschema
    except ImportError:
        return None
    schema = json.loads((SOURCE_DIR / "docs" / "report.schema.json").read_text())
    jsonschema.Draft202012Validator.check_schema(schema)
    return jsonschema.Draft202012Validator(schema)


class ProgramTest(unittest.TestCase):
    """Each test has an empty folder of its own."""

    maxDiff = None

    def setUp(self):
        folder = tempfile.TemporaryDirectory()
        self.addCleanup(folder.cleanup)
        self.folder = pathlib.Path(folder.name)

    def file(self, name, text):
        path = self.folder / name
        path.write_text(text)
        return path

    def files(self):
        return sorted(path.name for path in self.folder.iterdir())

    def run_ok(self, *arguments, **options):
        result = run(*arguments, **options)
        self.assertEqual(result.returncode, DONE, result.stderr)
        return result

    def report(self, *arguments, **options):
        """The JSON report of a run that must succeed, checked against the schema."""
        document = parse_json(self.run_ok(*arguments, "--json", "-", **options).stdout)
        if schema_validator():
            schema_validator().validate(document)
        return document

    def assert_refused(self, code, *arguments, says=(), **options):
        """One line on standard error that names what is in `says`; nothing on standard output."""
        result = run(*arguments, **options)
        self.assertEqual(result.returncode, code, result.stderr)
        self.assertEqual(result.stdout, "")
        self.assertRegex(result.stderr, r"\Avdwmesh: [^\n]+\n\Z")
        for word in says:
            self.assertIn(word, result.stderr)
        return result

    def assert_close(self, value, expected, relative):
        """Fails on NaN."""
        self.assertTrue(
            abs(value - expected) <= relative * abs(expected), f"{value} is not {expected}"
        )
