"""Man pages and completions, as they are installed: they say and offer what --help does."""

import os
import pathlib
import re
import select
import subprocess
import time

from program import SOURCE_DIR, ProgramTest, need_package, run

MANUAL = pathlib.Path(os.environ["VDWMESH_MANUAL_DIR"])
VERBS = ("mesh", "report", "exact", "interface", "compare", "render", "study", "batch", "pockets", "view", "info")
RANKS_VERBS = ("mesh", "exact")
PLAIN_TEXT = {"LC_ALL": "C.UTF-8", "MANWIDTH": "2000", "PATH": os.environ["PATH"]}


def has_ranks():
    return (MANUAL / "man1" / "vdwmesh-mpi.1").exists()


def page_of(verb, program="vdwmesh"):
    return MANUAL / "man1" / f"{program}-{verb}.1"


def plain(text):
    return re.sub(r"\s+", " ", text)


def entries(verb):
    """Names of every option of --help-all with its value, and what it means, in one line each."""
    text = run(verb, "--help-all").stdout
    found = re.findall(r"^  (\S.*(?:\n {32}.*)*)", text, re.M)
    for entry in found:
        names, meaning = re.match(r"(\S+(?: \S+)*)(?:  +|\n +)(.*)", entry, re.S).groups()
        yield plain(names), plain(meaning)


def options_of(verb):
    return {name for names, _ in entries(verb) for name in re.findall(r"--[a-z-]+", names)}


def accepted(verb, option):
    """The names that --help lists at the end: ": a, b or c [default]"."""
    meaning = next(meaning for names, meaning in entries(verb) if option in names.split())
    return re.split(r", | or ", re.search(r": ([\w-]+(?:(?:, | or )[\w-]+)+)(?: \[|$)", meaning)[1])


class ManPages(ProgramTest):
    def rendered(self, path):
        """The page as a terminal shows it, on lines that are long enough for everything."""
        man = need_package("man-db", program="man")
        shown = subprocess.run([man, "--warnings", "--local-file", path], capture_output=True, text=True,
                               env=PLAIN_TEXT)  # fmt: skip
        self.assertEqual((shown.returncode, shown.stderr), (0, ""), path)
        return plain(shown.stdout)

    def test_every_verb_has_a_page_and_troff_no_complaint(self):
        pages = {"vdwmesh.1", *(page_of(verb).name for verb in VERBS)}
        if has_ranks():
            pages |= {"vdwmesh-mpi.1", *(page_of(verb, "vdwmesh-mpi").name for verb in RANKS_VERBS)}
        self.assertEqual({path.name for path in (MANUAL / "man1").iterdir()}, pages)
        groff = need_package("groff", program="groff")
        for page in sorted(pages):
            checked = subprocess.run([groff, "-k", "-man", "-ww", "-z", "-Tutf8", MANUAL / "man1" / page],
                                     capture_output=True, text=True, env=PLAIN_TEXT)  # fmt: skip
            self.assertEqual((checked.returncode, checked.stderr), (0, ""), page)

    def test_pages_say_what_help_says(self):
        for verb in VERBS:
            page = self.rendered(page_of(verb))
            found = list(entries(verb))
            self.assertTrue(found)
            for names, meaning in found:
                with self.subTest(verb=verb, option=names):
                    self.assertIn(f" {names} {meaning} ", page)
            for section in ("NAME", "SYNOPSIS", "OPTIONS", "EXIT STATUS", "EXAMPLES", "SEE ALSO"):
                self.assertIn(f" {section} ", page, verb)

    def test_the_page_of_the_program_lists_the_verbs(self):
        page = self.rendered(MANUAL / "man1" / "vdwmesh.1")
        for name, summary in re.findall(r"^  (\w+) {2,}(\S.*)$", self.run_ok("--help").stdout, re.M):
            self.assertIn(f" {name} {summary} ", page)
        version = self.run_ok("--version").stdout.split()[1]
        self.assertIn(f"vdwmesh {version}", page)

    def test_examples_run(self):
        """In the order of --help, because later examples use files of earlier ones."""
        (self.folder / "FOLDER").mkdir()
        (self.folder / "FOLDER" / "1UBQ.pdb").write_bytes((SOURCE_DIR / "data" / "ubiquitin.pdb").read_bytes())
        commands = [command for page in ("vdwmesh", *(f"vdwmesh-{verb}" for verb in VERBS))
                    for command in re.findall(r" (vdwmesh (?:%s) \S.*?)(?=  )" % "|".join(VERBS),
                                              self.examples(page))]  # fmt: skip
        self.assertGreaterEqual(len(commands), len(VERBS))
        for command in commands:
            with self.subTest(command=command):
                self.run_ok(*command.split()[1:], cwd=self.folder)

    def examples(self, page):
        man = need_package("man-db", program="man")
        text = subprocess.run([man, "--local-file", MANUAL / "man1" / f"{page}.1"], capture_output=True,
                              text=True, env=PLAIN_TEXT).stdout  # fmt: skip
        return text.partition("EXAMPLES")[2].partition("SEE ALSO")[0].replace("\n", "  ")


class Bash(ProgramTest):
    """The function is called as bash calls it, with the words and the place of the cursor."""

    def complete(self, *words, program="vdwmesh"):
        script = ('source "$1"; shift; COMP_WORDS=("$@"); COMP_CWORD=$(($# - 1)); '
                  f"_{program.replace('-', '_')}_words; printf '%s\\n' \"${{COMPREPLY[@]}}\"")  # fmt: skip
        found = subprocess.run(["bash", "--norc", "-c", script, "bash", MANUAL / "bash" / program, program, *words],
                               capture_output=True, text=True, cwd=self.folder)  # fmt: skip
        self.assertEqual((found.returncode, found.stderr), (0, ""))
        return found.stdout.split()

    def test_verbs(self):
        self.assertEqual(self.complete("re"), ["report", "render"])
        self.assertEqual(set(self.complete("")),
                         {*VERBS, "--help", "--version"})  # fmt: skip
        self.assertEqual(self.complete("info", ""), [])
        if has_ranks():
            self.assertEqual(set(self.complete("", program="vdwmesh-mpi")),
                             {*RANKS_VERBS, "--help", "--version"})  # fmt: skip

    def test_options_are_those_of_help(self):
        for verb in VERBS:
            self.assertEqual(set(self.complete(verb, "-")), options_of(verb) | {"--help"}, verb)
        self.assertEqual(self.complete("mesh", "a.pdb", "--edge-length-"), ["--edge-length-of"])

    def test_names_are_those_of_help(self):
        checked = 0
        for verb in VERBS:
            for names, meaning in entries(verb):
                option = names.split()[0].rstrip(",")
                if " NAME" not in names or option == "--sample" or option == "--assembly":
                    continue
                self.assertEqual(set(self.complete(verb, option, "")) - {"ent", "cif"},
                                 set(accepted(verb, names.split()[0])) - {"ent", "cif"}, (verb, option))  # fmt: skip
                checked += 1
        self.assertGreater(checked, 40)

    def test_usual_texts(self):
        self.assertEqual(self.complete("exact", "--sample", ""), ["ubiquitin", "bpti"])
        self.assertEqual(self.complete("exact", "--radii", "na"), ["naccess"])
        self.assertEqual(self.complete("render", "--view", "-"), ["-x", "-y", "-z"])
        for text in self.complete("exact", "--radii", ""):
            self.run_ok("exact", "--sample", "bpti", "--radii", text, "--topology", "off")

    def test_a_value_behind_an_equals_sign(self):
        self.assertEqual(self.complete("mesh", "--mesher", "=", "e"), ["exact"])
        self.assertEqual(self.complete("mesh", "--mesher", "="), ["marching-cubes", "exact"])

    def test_lists(self):
        self.assertEqual(self.complete("study", "--field", "vdw,s"), ["vdw,soft"])
        self.assertEqual(self.complete("study", "--field", "so"), ["soft"])

    def test_numbers_have_nothing_to_offer(self):
        self.file("1.pdb", "")
        self.assertEqual(self.complete("mesh", "--spacing", ""), [])

    def test_files_and_folders(self):
        self.file("a.pdb", "")
        (self.folder / "atoms").mkdir()
        self.assertEqual(sorted(self.complete("report", "a")), ["a.pdb", "atoms"])
        self.assertEqual(sorted(self.complete("report", "--json", "a")), ["a.pdb", "atoms"])
        self.assertEqual(self.complete("study", "-o", "a"), ["a.pdb", "atoms"][1:])
        self.assertEqual(self.complete("exact", "--radii", "a"), ["alvarez", "a.pdb", "atoms"])


class Typed(ProgramTest):
    """Keys typed on a terminal; the shell prints the words that it would have started a program with."""

    def typed(self, shell, setup, keys):
        primary, secondary = os.openpty()
        environment = {"TERM": "vt100", "PATH": os.environ["PATH"], "HOME": str(self.folder), "PS1": "> ",
                       "LC_ALL": "C.UTF-8"}  # fmt: skip
        process = subprocess.Popen(shell, stdin=secondary, stdout=secondary, stderr=secondary,
                                   env=environment, cwd=self.folder, start_new_session=True)  # fmt: skip
        os.close(secondary)
        self.addCleanup(os.close, primary)
        self.addCleanup(process.wait)
        self.addCleanup(process.kill)
        self.shown = ""
        for line in (*setup, "vdwmesh() { printf 'G%s<%s>' OT \"$*\"; }", "printf 'READ%s' Y"):
            os.write(primary, line.encode() + b"\n")
        self.read_until(primary, r"READY")
        os.write(primary, f"{keys}\n".encode())
        return self.read_until(primary, r"GOT<(.*?)>")

    def read_until(self, terminal, pattern):
        end = time.monotonic() + 60
        while time.monotonic() < end:
            if select.select([terminal], [], [], 1)[0]:
                self.shown += os.read(terminal, 65536).decode(errors="replace")
            found = re.search(pattern, self.shown)
            if found:
                return found[found.lastindex or 0].split()
        self.fail(f"nothing like {pattern} in {self.shown!r}")

    def test_bash(self):
        words = self.typed(["bash", "--norc", "--noprofile", "-i"], [f"source '{MANUAL}/bash/vdwmesh'"],
                           "vdwmesh rep\t--sample ub\t--fi\tbl\t--mesher=ex\t")  # fmt: skip
        self.assertEqual(words, ["report", "--sample", "ubiquitin", "--field", "blinn", "--mesher=exact"])

    def test_zsh(self):
        zsh = need_package("zsh", program="zsh")
        for path in (MANUAL / "zsh").iterdir():
            checked = subprocess.run([zsh, "-n", path], capture_output=True, text=True)
            self.assertEqual((checked.returncode, checked.stderr), (0, ""))
        setup = [f"fpath=('{MANUAL}/zsh' $fpath)", "autoload -U compinit", "compinit -u -D"]
        words = self.typed([zsh, "-f", "-i"], setup, "vdwmesh rep\t--sample=ub\t --fi\tbl\t--wat\t")
        self.assertEqual(words, ["report", "--sample=ubiquitin", "--field", "blinn", "--waters"])


class Installed(ProgramTest):
    def test_where_man_and_the_shells_look(self):
        build = pathlib.Path(os.environ["VDWMESH_BUILD_DIR"])
        for component, program in (("program", "vdwmesh"), ("mpi", "vdwmesh-mpi")):
            if component == "mpi" and not has_ranks():
                continue
            prefix = self.folder / component
            subprocess.run(["cmake", "--install", build, "--component", component, "--prefix", prefix],
                           check=True, capture_output=True)  # fmt: skip
            self.assertTrue(os.access(prefix / "bin" / program, os.X_OK))
            for name in (f"man/man1/{program}.1", f"man/man1/{program}-mesh.1",
                         f"bash-completion/completions/{program}", f"zsh/site-functions/_{program}"):  # fmt: skip
                self.assertTrue((prefix / "share" / name).is_file(), name)
            pages = list((prefix / "share/man/man1").iterdir())
            self.assertEqual({path.name.startswith("vdwmesh-mpi") for path in pages}, {component == "mpi"})
