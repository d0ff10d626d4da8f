"""Examples of README and the reference pages are run as they stand, on small files that have the names in them.

RUN names the pages whose blocks without a language are lists of examples, a command a line. Any other such block
has to be in ELSEWHERE, with what runs it instead, so that no document shows a command that nobody runs.
Commands within a line of prose are run where they need no file (`--sample`). What the commands print is not compared
here: blocks that quote it are compared by test_documents.py. The notes in docs/notes record what was measured, and are
not run.
"""

import gzip
import os
import pathlib
import re
import subprocess
import tarfile

import binary_cif
from documented import CODE, FENCE
from program import (PROGRAM, SOURCE_DIR, UBIQUITIN, ProgramTest, is_required, need_package, parse_json,
                     ranks_environment)  # fmt: skip

RUN = ("README.md", "docs/batch.md", "docs/exact_mesh.md", "docs/pictures.md", "docs/scale.md", "docs/verbs.md")
PROSE = ("README.md", "docs/concepts.md", "docs/index.md", "docs/install.md", "docs/pictures.md", "docs/start.md",
         "docs/python.md", "docs/distances.md", "docs/excluded_surface.md", "docs/refinement.md", "data/README.md",
         *sorted(str(p.relative_to(SOURCE_DIR)) for p in (SOURCE_DIR / "docs" / "tasks").glob("*.md")))  # fmt: skip

BLOCK = re.compile(r"^```(\w*)\n(.*?)^```$", re.MULTILINE | re.DOTALL)
PAGE = "a drawing, no command"
# Page and first words of a block, and what runs it, or why nothing can.
ELSEWHERE = {
    ("README.md", "scripts/demo.sh"): "a person, from a fresh clone; .ci/run is scripts/test.sh",
    ("README.md", "$ vdwmesh report"): "test_documents.py",
    ("CONTRIBUTING.md", "cmake --preset release"): "scripts/build.sh and scripts/run-ctest.sh, as .ci/run calls them",
    ("docs/architecture.md", "file"): PAGE,
    ("docs/certificates.md", "$ vdwmesh exact"): "test_documents.py",
    ("docs/exact_mesh.md", "exact_mesh_table"): "a person: the table of peers is no part of the project",
    ("docs/excluded_surface.md", ". - ~"): PAGE,
    ("docs/excluded_surface.md", "$ vdwmesh report"): "test_documents.py",
    ("docs/install.md", "apt install"): "scripts/try-packages.sh",
    ("docs/install.md", "scripts/build-packages.sh"): "scripts/release-check.sh",
    ("docs/install.md", "python3 -m venv"): "test_install.py of tests/python, with pip into a folder",
    ("docs/install.md", "podman build"): "scripts/try-container.sh, by buildah",
    ("docs/install.md", "scripts/demo.sh"): "a person, from a fresh clone; test_libraries.py installs",
    ("docs/install.md", "source PREFIX"): "test_manual.py, from the build tree",
    ("docs/library.md", "scripts/build.sh release"): "test_libraries.py",
    ("docs/library.md", "file"): PAGE,
    ("docs/robustness.md", "$ vdwmesh report 6ZU5"): "a person, on a machine with the entry; test_options.py with smaller ones",
    ("docs/scale.md", "#!/bin/bash"): "a cluster with Slurm",
    ("docs/scale.md", "mpirun -n 2 --bind-to socket"): "a machine of two sockets; test_ranks.py without binding",
    ("docs/start.md", "scripts/demo.sh"): "test_documents.py says what",
    ("docs/tasks/elements.md", "tetgen"): "test_foreign.py, with meshes of its own",
    ("docs/tasks/thesis.md", "vdwmesh-bench thesis"): "test_documents.py says what",
    ("docs/tasks/virus.md", "mpirun"): "test_documents.py says what",
}  # fmt: skip
# Single lines of pages in RUN.
LINES_ELSEWHERE = {"vdwmesh-bench thesis": "test_documents.py and test_bench.py"}

ATOM_COLUMNS = ("group_PDB", "id", "type_symbol", "label_atom_id", "label_alt_id", "label_comp_id", "label_asym_id",
                "label_entity_id", "label_seq_id", "Cartn_x", "Cartn_y", "Cartn_z", "occupancy", "auth_asym_id",
                "auth_seq_id", "pdbx_PDB_model_num")  # fmt: skip


def blocks(page):
    """Those without a language, and those that test_documents.py does not run."""
    found = BLOCK.findall((SOURCE_DIR / page).read_text())
    return [text for language, text in found if language in ("", "shell")]


def what_runs(page, block):
    return [reason for (of, words), reason in ELSEWHERE.items() if of == page and block.lstrip().startswith(words)]


def pages():
    found = {*SOURCE_DIR.glob("*.md"), *(SOURCE_DIR / "docs").glob("*.md"), *(SOURCE_DIR / "docs" / "tasks").glob("*.md"), *(SOURCE_DIR / "bench").glob("*.md"),
             *(SOURCE_DIR / "data").glob("*.md")}  # fmt: skip
    return sorted(str(path.relative_to(SOURCE_DIR)) for path in found)


def examples(page):
    """Lines of all examples of a page, without the words behind #."""
    text = "".join(block for block in blocks(page) if not what_runs(page, block))
    lines = [re.sub(r"\s+#.*", "", line) for line in text.splitlines()]
    return [line for line in lines if line and not any(line.startswith(words) for words in LINES_ELSEWHERE)]


def sampled(page):
    """Commands within lines of prose that need no file and leave nothing to the reader, such as FILE."""
    text = re.sub(r"\s+", " ", FENCE.sub("", (SOURCE_DIR / page).read_text()))
    for plain in CODE.findall(text):
        if plain.startswith("vdwmesh ") and "--sample" in plain and not re.search(r"\b[A-Z]{3,}\b|…", plain):
            yield plain


def cif(atoms):
    """mmCIF of lines of a PDB file, with two copies as its assembly."""
    rows = [f"ATOM {i} {line[12:16].strip()[0]} {line[12:16].strip()} . {line[17:20]} A 1 {int(line[22:26])} {line[30:38]} "
            f"{line[38:46]} {line[46:54]} 1.00 A {int(line[22:26])} 1" for i, line in enumerate(atoms, 1)]  # fmt: skip
    operators = "".join(f"{i} 1 0 0 {shift} 0 1 0 0 0 0 1 0\n" for i, shift in ((1, 0), (2, 40)))
    names = "".join(f"_pdbx_struct_oper_list.{name}\n" for name in (
        "id", *(f"{part}[{row}]{column}" for row in (1, 2, 3)
                for part, column in (("matrix", "[1]"), ("matrix", "[2]"), ("matrix", "[3]"), ("vector", "")))))  # fmt: skip
    return ("data_X\n_pdbx_struct_assembly.id 1\n_pdbx_struct_assembly_gen.assembly_id 1\n"
            "_pdbx_struct_assembly_gen.oper_expression 1,2\n_pdbx_struct_assembly_gen.asym_id_list A\n"
            f"loop_\n{names}{operators}loop_\n" + "".join(f"_atom_site.{name}\n" for name in ATOM_COLUMNS)
            + "\n".join(rows) + "\n")  # fmt: skip


class Examples(ProgramTest):
    def setUp(self):
        super().setUp()
        atoms = [line for line in UBIQUITIN.read_text().splitlines() if line.startswith("ATOM")][:60]
        haem = "HETATM  900 FE   HEM A 200      40.000  30.000  10.000  1.00  0.00          FE"
        pdb = "\n".join((*atoms, haem, "END", ""))
        for name in ("1UBQ", "4PTI", "ubiquitin"):
            self.file(f"{name}.pdb", pdb)
        others = (f"{line[:21]}{chain}{line[22:30]}{float(line[30:38]) + 10 * i:8.3f}{line[38:]}"
                  for i, chain in enumerate("BCD", 1) for line in atoms)  # fmt: skip
        self.file("4HHB.pdb", "\n".join((*atoms, *others, haem, "END", "")))
        for name in ("4HHB", "6ZU5", "big", "capsid"):
            (self.folder / f"{name}.cif.gz").write_bytes(gzip.compress(cif(atoms).encode()))
        self.file("1A63.pqr", "".join(f"ATOM {i} C UNK {i} {i}.0 0 0 0.1 1.7\n" for i in range(1, 9)))
        for name in ("theirs.stl", "mesh.stl", "theirs.ply"):
            self.run_ok("mesh", "1UBQ.pdb", "--spacing", "1", "-o", name, "--quiet", cwd=self.folder)
        (self.folder / "FOLDER").mkdir()
        (self.folder / "FOLDER" / "a.pdb").write_text(pdb)
        self.file("list.txt", "1UBQ.pdb\n" * 16)
        with tarfile.open(self.folder / "afdb.tar", "w") as archive:
            archive.add(self.folder / "1UBQ.pdb", "1UBQ.pdb")

    def add_binary_cif(self):
        need_package("python3-gemmi", module="gemmi")
        need_package("python3-msgpack", module="msgpack")
        path = self.folder / "x.cif"
        path.write_bytes(gzip.decompress((self.folder / "4HHB.cif.gz").read_bytes()))
        (self.folder / "x.bcif.gz").write_bytes(gzip.compress(binary_cif.of_cif(path)))

    def run_line(self, line):
        """The command as it stands, but for the number of processes, and one of the kinds of INPUT."""
        command = line.replace("FOLDER|LIST|TAR", "FOLDER").replace("mpirun -n 8", "mpirun -n 2")
        command = command.replace("mpirun", "mpirun --oversubscribe")
        result = subprocess.run(
            ["bash", "-euo", "pipefail", "-c", command], cwd=self.folder, capture_output=True, text=True, timeout=300,
            env=dict(ranks_environment(), PATH=f"{pathlib.Path(PROGRAM).parent}:{os.environ['PATH']}"))  # fmt: skip
        self.assertEqual(result.returncode, 0, f"{line}\n{result.stderr}")

    def can_run(self, line):
        """Without a renderer or ranks their lines are left out, but not where they are required."""
        if " render " in line or "--picture" in line:
            pictures = parse_json(self.run_ok("info", "--json", "-").stdout)["pictures"]
            return pictures["device"] is not None or is_required("VDWMESH_REQUIRE_EGL")
        return "mpirun" not in line or "VDWMESH_RANKS_PROGRAM" in os.environ

    def test_examples(self):
        for page in RUN:
            lines = examples(page)
            self.assertTrue(lines, page)
            for rows in self.folder.glob("rows.*"):  # a batch would go on behind those of another page
                rows.unlink()
            for line in filter(self.can_run, lines):
                with self.subTest(page=page, line=line):
                    if "bcif" in line:
                        self.add_binary_cif()
                    self.run_line(line)

    def test_commands_in_prose(self):
        found = {line for page in PROSE for line in sampled(page)}
        self.assertGreater(len(found), 4)
        for line in filter(self.can_run, sorted(found)):
            with self.subTest(line=line):
                self.run_line(line)

    def test_every_block_is_run_somewhere(self):
        used = set()
        for page in pages():
            for block in blocks(page):
                reasons = what_runs(page, block)
                if page not in RUN:
                    self.assertTrue(reasons, f"{page} shows what nothing runs:\n{block}")
                used |= {key for key in ELSEWHERE if key[0] == page and block.lstrip().startswith(key[1])}
        self.assertEqual(set(ELSEWHERE) - used, set(), "no such blocks")

    def test_a_command_that_fails_is_found(self):
        for line in ("vdwmesh exact none.pdb", "vdwmesh exact 1UBQ.pdb --frobnicate"):
            with self.assertRaises(AssertionError):
                self.run_line(line)
        self.assertEqual(what_runs("docs/verbs.md", "vdwmesh report 4HHB.pdb\n"), [])
