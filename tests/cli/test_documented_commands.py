"""Documents show commands that there are: verbs, options and names by the program's own help."""

import json
import os
import pathlib
import re
import shlex
import unittest

from documented import commands, pieces
from program import SOURCE_DIR, UNSEEN, run

DOCUMENTS = sorted({*SOURCE_DIR.glob("*.md"), *(SOURCE_DIR / "docs").glob("**/*.md"),
                    *(SOURCE_DIR / "bench").glob("*.md")})  # fmt: skip
RANKS_PAGE = pathlib.Path(os.environ["VDWMESH_MANUAL_DIR"]) / "man1" / "vdwmesh-mpi.1"
# Older names of values, which are read and not shown, by the names that are shown in their place.
NAMES = SOURCE_DIR / "src" / "request" / "names.hpp"
# The first word after the program's name that begins a sentence about it, not a command.
PROSE = {"--version", "--help", "VERB"}


def older_names(text):
    """The names of each table of names.hpp that are shown, and those that are read only."""
    found = {}
    for table in re.findall(r"= *names<\w+>\(\{(.*?)\}\);", re.sub(r"\s+", " ", text)):
        rows = re.findall(r'\{ ?"([\w-]+)", [\w:]+(, NameUse::accepted)?', table)
        found[frozenset(name for name, older in rows if not older)] = {name for name, older in rows if older}
    return found


OLDER_NAMES = older_names(NAMES.read_text())


class Helps:
    """What --help-all says of the verbs: options, each with the names that it takes, or None."""

    def __init__(self):
        self.texts = {}

    def text(self, program, verb):
        key = (program, verb)
        if key not in self.texts:
            self.texts[key] = help_of(program, verb)
        return self.texts[key]

    def options(self, program, verb):
        """Name -> the names of values, empty where any value will do; None for what is no verb."""
        text = self.text(program, verb)
        if text is None:
            return None
        options = dict.fromkeys({"--help", "--help-all", "-h", *UNSEEN}, set())
        for entry in re.findall(r"^  (-\S.*(?:\n {32}.*)*)", text, re.M):
            names = re.match(r"((?:-[\w-]+,? ?)+)", entry)[1].replace(",", "").split()
            plain = re.sub(r"\s+", " ", entry)
            values = re.search(r" NAME.*: ([\w-]+(?:(?:, | or )[\w-]+)+)(?: \[|$)", plain)
            shown = set(re.split(", | or ", values[1])) if values else set()
            options.update(dict.fromkeys(names, shown | OLDER_NAMES.get(frozenset(shown), set())))
        return options


def help_of(program, verb):
    """Of vdwmesh-mpi the man page has it, since that program needs mpirun; it is made from the same list."""
    if program == "vdwmesh":
        result = run(verb, "--help-all")
        return result.stdout if result.returncode == 0 else None
    page = RANKS_PAGE.with_name(f"vdwmesh-mpi-{verb}.1")
    if not page.exists():
        return None
    text = page.read_text().replace("\\-", "-")
    return "".join(f"  {term}\n" for term in re.findall(r"^\.TP\n\\fB(-.*)\\fR", text, re.M)).replace(
        "\\fR", "").replace("\\fB", "")  # fmt: skip


class Fault(Exception):
    pass


HELPS = Helps()


def check(program, words):
    verb = words[0]
    options = HELPS.options(program, verb)
    if options is None:
        raise Fault(f"{program} has no verb {verb}")
    for i, word in enumerate(words):
        name, equals, value = word.partition("=")
        if not re.match(r"--?[a-z]", name):
            continue
        if name not in options:
            raise Fault(f"{program} {verb} has no option {name}")
        if options[name] and not equals:
            value = words[i + 1] if i + 1 < len(words) else ""
        # Capitals stand for a value that the reader chooses.
        unknown = {v for v in value.split(",") if not v.isupper()} - options[name] if options[name] else set()
        if unknown:
            raise Fault(f"{program} {verb} {name}: there is no {' '.join(sorted(unknown))}")


class DocumentedCommands(unittest.TestCase):
    def test_verbs_options_and_names(self):
        count = 0
        for path in DOCUMENTS:
            for program, words in commands(path.read_text()):
                if words[0] in PROSE or (program == "vdwmesh-mpi" and not RANKS_PAGE.exists()):
                    continue
                count += 1
                with self.subTest(document=path.name, command=" ".join((program, *words))):
                    check(program, words)
        self.assertGreater(count, 60)

    def test_scripts_presets_and_targets(self):
        """What stands beside the program in documents: files of the project, presets, targets."""
        presets = json.loads((SOURCE_DIR / "CMakePresets.json").read_text())
        names = {preset["name"] for preset in presets["configurePresets"]}
        count = 0
        for path in DOCUMENTS:
            text = path.read_text()
            for name in re.findall(r"\b(?:scripts|tests|bench|data)/[\w/.-]+\.(?:sh|py|csv|cpp|cu|hpp|json)\b", text):
                count += 1
                self.assertTrue((SOURCE_DIR / name).exists(), f"{path.name}: {name}")
            for piece in pieces(text):
                for preset in re.findall(r"\bcmake (?:--build )?--preset[ =](\w+)", piece):
                    count += 1
                    self.assertIn(preset, names, path.name)
        self.assertGreater(count, 40)


class TheCheckItself(unittest.TestCase):
    def faults(self, text):
        found = []
        for program, words in commands(text):
            try:
                check(program, words)
            except Fault as fault:
                found.append(str(fault))
        return found

    def test_what_is_right(self):
        text = ("```\n$ vdwmesh report a.pdb --json r.json    a report, --with words\n"
                "vdwmesh mesh a.pdb --field=blinn \\\n    -o a.ply   # --no comment\n```\n"
                "`vdwmesh study a.pdb -o DIR --field vdw,soft` and `vdwmesh exact A [--probe 1.4]`\n")  # fmt: skip
        self.assertEqual(len(list(commands(text))), 4)
        self.assertEqual(self.faults(text), [])

    def test_names_that_are_read_and_not_shown(self):
        self.assertEqual(older_names('x = names<A>({{"a", A::a},\n {"b", A::b}, {"old",\n A::b, NameUse::accepted}});'),
                         {frozenset("ab"): {"old"}})  # fmt: skip
        self.assertEqual(self.faults("`vdwmesh exact a.pdb --surface excluded` `vdwmesh exact a.pdb --surface ses`"), [])
        self.assertEqual(self.faults("`vdwmesh exact a.pdb --surface conolly`"),
                         ["vdwmesh exact --surface: there is no conolly"])  # fmt: skip

    def test_what_is_stale(self):
        self.assertEqual(self.faults("`vdwmesh draw a.pdb`"), ["vdwmesh has no verb draw"])
        self.assertEqual(self.faults("```\nmpirun -n 2 vdwmesh-mpi render a.pdb\n```"),
                         ["vdwmesh-mpi has no verb render"])  # fmt: skip
        self.assertEqual(self.faults("```\nx\nvdwmesh exact a.pdb \\\n  --spacing 1\n```"),
                         ["vdwmesh exact has no option --spacing"])  # fmt: skip
        self.assertEqual(self.faults("`vdwmesh mesh a.pdb --field gauss`"),
                         ["vdwmesh mesh --field: there is no gauss"])  # fmt: skip
        self.assertEqual(self.faults("`vdwmesh study a.pdb --field=vdw,gauss`"),
                         ["vdwmesh study --field: there is no gauss"])  # fmt: skip

    def test_what_is_no_command(self):
        for text in ("`vdwmesh::mesh`", "`vdwmesh.read(x)`", "vdwmesh draws", "`make vdwmesh`", "`vdwmesh`"):
            self.assertEqual(list(commands(text)), [], text)
