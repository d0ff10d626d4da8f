"""Runs the program under test and keeps what it wrote; says what a test does where something is missing."""

import functools
import importlib
import json
import os
import pathlib
import shutil
import subprocess
import tempfile
import unittest

PROGRAM = os.environ["VDWMESH_PROGRAM"]
SOURCE_DIR = pathlib.Path(os.environ["VDWMESH_SOURCE_DIR"])
SHARED_DIR = pathlib.Path(os.environ.get("VDWMESH_SHARED", SOURCE_DIR.parent / "shared"))
UBIQUITIN = SOURCE_DIR / "data" / "ubiquitin.pdb"

SANITIZED = "VDWMESH_SANITIZED" in os.environ  # the program, which takes more time and memory so

DONE, BAD_INPUT, NO_BACKEND, LIMIT_HIT = 0, 1, 2, 3


# Options that help does not show, because few need them.
UNSEEN = {"--ascii", "--csv", "--sums", "--hetatm", "--preset", "--isovalue", "--blobbiness", "--crossings", "--seed", "--cgal-check", "--devices",
          "--camera", "--shading", "--antialias", "--rows", "--time-limit", "--page-triangles", "--edge-lengths",
          "--relative-edge", "--padding", "--progress", "--project", "--scan", "--shell", "--from", "--method",
          "--write", "--b-factor", "--rsa", "--max-distance", "--transparency", "--outline", "--ambient-occlusion", "--scale",
          "--mesh"}  # fmt: skip


def is_required(variable):
    """An unset variable, an empty one and "0" require nothing."""
    return os.environ.get(variable, "") not in ("", "0")


def missing(variable, what):
    """Ends the running test: it fails where the variable requires the thing, otherwise it skips."""
    if is_required(variable):
        raise AssertionError(f"{variable} is set, but {what}")
    raise unittest.SkipTest(what)


def need_package(package, module=None, program=None):
    """The imported module, or the path of the program, that comes with a Debian package.

    Where it is not there the running test skips and names the package; with
    VDWMESH_REQUIRE_PACKAGES=1 it fails. Call it in the test, in setUp or in setUpClass.
    """
    try:
        found = importlib.import_module(module) if module else shutil.which(program)
    except ImportError:
        found = None
    if found is None:
        missing("VDWMESH_REQUIRE_PACKAGES", f"{package} is not installed")
    return found


def need_shared(relative):
    """The path of a file or folder of the shared folder; VDWMESH_REQUIRE_SHARED=1 makes it a failure
    that it is not there."""
    path = SHARED_DIR / relative
    if not path.exists():
        missing("VDWMESH_REQUIRE_SHARED", f"{path} is not there")
    return path


def run(*arguments, **options):
    command = [PROGRAM, *map(str, arguments)]
    return subprocess.run(command, capture_output=True, text=True, timeout=300, **options)


def refuse_constant(name):
    raise ValueError(f"JSON has no {name}")


def parse_json(text):
    """Parses strictly: NaN and Infinity, which Python's reader would take, are errors."""
    return json.loads(text, parse_constant=refuse_constant)


def closed(schema):
    """The schema without keys that it does not name: readers must expect new ones, and tests must find them."""
    if isinstance(schema, list):
        return [closed(part) for part in schema]
    if not isinstance(schema, dict):
        return schema
    parts = {key: closed(part) for key, part in schema.items()}
    if "required" in schema and isinstance(schema.get("properties"), dict):
        parts.setdefault("additionalProperties", False)
    return parts


@functools.cache
def schema_validator(name="report"):
    """Checks documents against docs/NAME.schema.json, closed, which may refer to its neighbours."""
    jsonschema = need_package("python3-jsonschema", module="jsonschema")
    path = SOURCE_DIR / "docs" / f"{name}.schema.json"
    schema = json.loads(path.read_text())
    jsonschema.Draft202012Validator.check_schema(schema)
    resolver = jsonschema.RefResolver(path.as_uri(), schema)
    return jsonschema.Draft202012Validator(closed(schema), resolver=resolver)


# Goes with the process, and so do the folders in it.
_sessions = tempfile.TemporaryDirectory(prefix="vdwmesh-")


def ranks_environment():
    """The environment of one mpirun.

    Open MPI wants to be asked twice before root may start ranks. Ranks that wait for others must leave them the cores,
    also where there are no more ranks than cores, because several runs share these. Each run has a folder of its own
    for its sessions: runs of one user at the same time would share one, and the first that ends removes it, which may
    be just when another one makes its part of it and so cannot start ("ORTE_ERROR_LOG: Error in file session_dir.c").
    All ranks are on this host: by its loopback TCP works without a network, of which Open MPI 5 would complain.
    """
    return {**os.environ, "OMPI_ALLOW_RUN_AS_ROOT": "1", "OMPI_ALLOW_RUN_AS_ROOT_CONFIRM": "1",
            "OMPI_MCA_mpi_yield_when_idle": "1", "OMPI_MCA_btl_tcp_if_include": "lo",
            "OMPI_MCA_orte_tmpdir_base": tempfile.mkdtemp(dir=_sessions.name)}  # fmt: skip


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
        schema_validator().validate(document)
        return document

    def cut_file(self, source=UBIQUITIN):
        """A PDB file that ends within the line of its 300th atom, behind the last number needed."""
        text = source.read_text()
        return self.file("cut.pdb", text[: text.index("ATOM    300") + 60])

    def text_and_document(self, *arguments):
        """The report of one run, as text and as JSON."""
        path = self.folder / "report.json"
        text = self.run_ok(*arguments, "--json", path).stdout
        return text, parse_json(path.read_text())

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
