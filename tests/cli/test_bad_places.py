"""Names that lead to no file, files that change or never end, and places that cannot be written."""

import os
import pathlib
import unittest

import program
from bad import outcome, structures
from program import BAD_INPUT, LIMIT_HIT, UBIQUITIN, ProgramTest

# Files of the kernel: their size is given as one page, and less can be read.
SHORTER_THAN_THEY_SAY = pathlib.Path("/sys/kernel/mm/transparent_hugepage/enabled")
NOBODY = 65534


def as_nobody():
    os.setgid(NOBODY)
    os.setuid(NOBODY)


class Places(ProgramTest):
    def refused(self, path, *options, code=BAD_INPUT, says=()):
        """As a structure, and as a mesh where its name allows; within bounded room and time."""
        arguments = ("report", path, *options)
        result = outcome.run_bounded(arguments, self.folder, path)
        self.assertEqual(result.problems, [])
        self.assertEqual(result.code, code, result.message)
        for word in says:
            self.assertIn(word, result.message)

    def refused_mesh(self, path, says=()):
        ball = self.file("ball.xyzr", "0 0 0 1\n")
        result = outcome.run_bounded(("compare", path, ball), self.folder, path)
        self.assertEqual((result.problems, result.code), ([], BAD_INPUT), result.message)
        for word in says:
            self.assertIn(word, result.message)

    def link(self, name, target):
        path = self.folder / name
        path.symlink_to(target)
        return path

    def test_no_file(self):
        self.refused(self.folder / "a.pdb", says=("No such file",))
        self.refused_mesh(self.folder / "a.ply", says=("No such file",))
        self.refused(self.link("b.pdb", "nowhere"), says=("No such file",))
        self.refused(self.link("c.pdb", "c.pdb"), says=("symbolic links",))
        self.refused(self.folder / ("x" * 300 + ".pdb"), says=("too long",))
        self.refused(UBIQUITIN / "a.pdb", says=("Not a directory",))

    def test_a_folder(self):
        for name in ("a.pdb", "a.cif.gz", "a.xyzr"):
            (self.folder / name).mkdir()
            self.refused(self.folder / name, says=("directory",))
        for name in ("a.ply", "a.glb"):
            (self.folder / name).mkdir()
            self.refused_mesh(self.folder / name)

    def test_no_permission(self):
        path = self.file("a.pdb", "ATOM\n")
        path.chmod(0)
        self.folder.chmod(0o777)
        options = {}
        if os.geteuid() == 0:
            if not os.access(program.PROGRAM, os.X_OK, effective_ids=False):
                self.skipTest("nobody may not run the program")
            options = {"preexec_fn": as_nobody}
        try:
            result = program.run("exact", path, **options)
        except PermissionError as error:
            self.skipTest(f"nobody may not run the program: {error}")
        self.assertEqual(result.returncode, BAD_INPUT)
        self.assertIn("Permission denied", result.stderr)
        self.folder.chmod(0o555)
        result = program.run("exact", UBIQUITIN, "--json", self.folder / "a.json", **options)
        self.folder.chmod(0o755)
        self.assertEqual(result.returncode, BAD_INPUT)
        self.assertIn("permission", result.stderr)

    def test_what_another_user_may_not_do(self):
        """A sticky folder's files, a folder that may not be entered, a file without permission to write."""
        if os.geteuid() != 0:
            self.skipTest("needs root, to make the files of another user")
        self.folder.chmod(0o777)
        sticky, closed = self.folder / "sticky", self.folder / "closed"
        for folder, mode in ((sticky, 0o1777), (closed, 0o600)):
            folder.mkdir()
            folder.chmod(mode)
        (sticky / "theirs.json").write_text("theirs")
        (sticky / "theirs.json").chmod(0o666)
        locked = self.file("locked.json", "locked")
        os.chown(locked, NOBODY, NOBODY)
        locked.chmod(0o400)
        for path, says in ((sticky / "theirs.json", "replace"), (closed / "a.json", "ermission"),
                           (locked, "replace")):  # fmt: skip
            with self.subTest(path=path.name):
                try:
                    result = program.run("exact", UBIQUITIN, "--json", path, preexec_fn=as_nobody)
                except PermissionError as error:
                    self.skipTest(f"nobody may not run the program: {error}")
                self.assertEqual(result.returncode, BAD_INPUT, result.stderr)
                self.assertIn(f"--json {path}", result.stderr)
                self.assertIn(says, result.stderr)
        self.assertEqual((sticky / "theirs.json").read_text(), "theirs")
        self.assertEqual(locked.read_text(), "locked")

    def test_names_that_no_file_can_have(self):
        name = self.folder / ("x" * 300)
        for arguments in (("exact", UBIQUITIN, "--radii", name), ("study", UBIQUITIN, "-o", name),
                          ("exact", UBIQUITIN, "--json", name / "a.json")):  # fmt: skip
            with self.subTest(arguments=arguments):
                self.assert_refused(BAD_INPUT, *arguments, says=("too long",))

    def test_devices(self):
        self.refused(self.link("a.pdb", "/dev/null"), says=("is empty",))
        self.refused(self.link("z.pdb", "/dev/zero"), "--memory-limit", "512M", code=LIMIT_HIT,
                     says=("MiB",))

    def test_a_file_that_shrinks(self):
        if not SHORTER_THAN_THEY_SAY.exists():
            self.skipTest("this kernel has no file that is shorter than it says")
        self.refused(self.link("a.xyzr", SHORTER_THAN_THEY_SAY), says=("changed",))
        self.refused_mesh(self.link("a.off", SHORTER_THAN_THEY_SAY), says=("changed",))

    def test_a_gzip_bomb(self):
        for extension in ("pdb", "cif"):
            path = self.folder / f"bomb.{extension}.gz"
            path.write_bytes(BOMB)
            self.refused(path, "--memory-limit", "512M", code=LIMIT_HIT, says=("MiB",))
        # Unpacked whole where the memory is there.
        self.refused(self.folder / "bomb.pdb.gz", "--memory-limit", "16G", says=("is empty",))

    def test_a_gigabyte_of_blanks(self):
        path = self.folder / "blanks.pdb"
        blanks = b" " * 2**24
        try:
            with path.open("wb") as file:
                for _ in range(64):
                    file.write(blanks)
        except OSError as error:
            self.skipTest(f"no room for a gigabyte: {error}")
        self.refused(path, "--memory-limit", "16G", says=("is empty",))
        self.refused(path, "--memory-limit", "512M", code=LIMIT_HIT, says=("MiB",))

    def test_outputs_that_are_full(self):
        mesh = self.link("a.ply", "/dev/full")
        for arguments in (("mesh", UBIQUITIN, "-o", mesh), ("exact", UBIQUITIN, "--json", "/dev/full"),
                          ("exact", UBIQUITIN, "--per-atom", "/dev/full"),
                          ("render", UBIQUITIN, "-o", self.link("a.png", "/dev/full"))):
            with self.subTest(verb=arguments[0], output=arguments[3]):
                self.assert_refused(BAD_INPUT, *arguments, says=("No space left",))

    def test_a_study_that_cannot_be_written(self):
        self.assert_refused(BAD_INPUT, "study", UBIQUITIN, "-o", self.file("taken", ""),
                            says=("taken",))


BOMB = structures.bomb(b"")


if __name__ == "__main__":
    unittest.main()
