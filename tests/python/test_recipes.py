"""The recipes of docs/batch.md, run as they stand there. Each leaves all.jsonl, whose figures are those of
one call of vdwmesh batch."""

import json
import os
import pathlib
import re
import shutil
import subprocess

import program
from program import SOURCE_DIR, ProgramTest, need_package

DATA = SOURCE_DIR / "data"
PYTHON = "/usr/bin/python3"


def recipes():
    """The code of each recipe, by what its first word of prose says."""
    text = (SOURCE_DIR / "docs" / "batch.md").read_text().split("## Recipes")[1]
    names = "A Slurm array|GNU parallel|Dask|MPI|Snakemake|Foldcomp"
    found = re.findall(rf"^({names})\b.*?```(?:sh|python)\n(.*?)```", text, re.S | re.M)
    return dict(found)


class Recipes(ProgramTest):
    def setUp(self):
        super().setUp()
        structures = self.folder / "structures"
        structures.mkdir()
        for i in range(3):
            for name in ("bpti.pdb", "ubiquitin.pdb"):
                (structures / f"{i}{name}").write_bytes((DATA / name).read_bytes())
        whole = self.run_ok("batch", "structures", "--probe", "1.4", cwd=self.folder).stdout
        self.expected = [json.loads(line) for line in whole.splitlines()]
        self.assertEqual(len(self.expected), 6)

    def run_recipe(self, name, *command, **variables):
        recipe = recipes()[name]
        self.assertLessEqual(len([line for line in recipe.splitlines() if line.strip()]), 12)
        path = self.folder / "recipe"
        path.write_text(recipe)
        environment = {**program.ranks_environment(), "HOME": str(self.folder), "OMP_NUM_THREADS": "1",
                       "PATH": f"{pathlib.Path(program.PROGRAM).parent}:{os.environ['PATH']}", **variables}
        result = subprocess.run([*command, path], cwd=self.folder, env=environment, text=True,
                                capture_output=True, timeout=120)
        self.assertEqual(result.returncode, 0, result.stderr)
        return [json.loads(line) for line in (self.folder / "all.jsonl").read_text().splitlines()]

    def test_slurm_array(self):
        self.assertEqual(self.run_recipe("A Slurm array", "sh", "-e"), self.expected)

    def test_gnu_parallel(self):
        need_package("parallel", program="parallel")
        self.assertEqual(self.run_recipe("GNU parallel", "sh", "-e"), self.expected)

    def test_mpi(self):
        need_package("python3-mpi4py", module="mpi4py")
        command = ("mpirun", "--oversubscribe", "-n", "3", PYTHON, "-m", "mpi4py.futures")
        self.assertEqual(self.run_recipe("MPI", *command), self.expected)

    def test_dask(self):
        need_package("python3-dask", module="dask")
        rows = self.run_recipe("Dask", PYTHON)
        self.assertEqual(rows, [{key: row[key] for key in ("name", "area", "volume")}
                                for row in self.expected])

    def test_snakemake(self):
        need_package("snakemake", program="snakemake")
        command = (PYTHON, shutil.which("snakemake"), "--cores", "2", "--snakefile")
        self.assertEqual(self.run_recipe("Snakemake", *command), self.expected)

    def test_foldcomp(self):
        """Foldcomp is no package of Debian. What stands in for it does what Foldcomp's README shows: open()
        in a with statement gives pairs of a name and PDB text."""
        stand_in = self.folder / "stand_in"
        stand_in.mkdir()
        (stand_in / "foldcomp.py").write_text(FOLDCOMP)
        path = f"{stand_in}:{os.environ.get('PYTHONPATH', '')}"
        rows = self.run_recipe("Foldcomp", PYTHON, PYTHONPATH=path)
        expected = [{key: row[key] for key in ("name", "area", "volume")} for row in self.expected]
        for row in expected:
            row["name"] = pathlib.Path(row["name"]).name
        self.assertEqual(rows, expected)


FOLDCOMP = """
import contextlib, pathlib

@contextlib.contextmanager
def open(path):
    assert path == "structures.fcz"
    yield ((file.name, file.read_text()) for file in sorted(pathlib.Path("structures").iterdir()))
"""

if __name__ == "__main__":
    program.unittest.main()
