"""The commands of the pages in docs/tasks and of docs/start.md are run as they stand, and print what the pages say.

A block marked `sh` is run in a folder that looks like a clone, by bash, with the program and the package for
Python on their paths; the blocks of one page follow each other in one folder. A block marked `text` behind it
is compared with what it printed: each of its lines has to be there, in this order; a line `…` stands for any
lines, `…` at the end of a line for the rest of the line, and blanks may differ in number. Blocks marked
`shell` take long, or change the machine: LONG names each with what runs it instead.

Pictures that a page shows are those that its commands draw.
"""

import functools
import os
import re
import subprocess
import sys
import unittest

from documented import CODE, FENCE
from program import (PROGRAM, SOURCE_DIR, ProgramTest, is_required, need_package, need_shared, parse_json,
                     ranks_environment)  # fmt: skip

IMAGES = SOURCE_DIR / "docs" / "images"
PAGES = [SOURCE_DIR / "docs" / "start.md", *sorted((SOURCE_DIR / "docs" / "tasks").glob("*.md"))]

# Files that are no part of a clone: the word in a command, and the file that stands in.
FILES = {
    "1F2N.pdb": "molecules/special/1F2N.pdb",
    "1L2Y.pdb": "molecules/special/1L2Y.pdb",
    "1L2Y.xtc": "molecules/special/1L2Y.xtc",
    "thesis": "molecules/thesis",
}
MODULES = {"MDAnalysis": "python3-mdanalysis", "numpy": "python3-numpy"}

# The blocks that this test does not run, by their first words, and what runs them. With VDWMESH_LONG_DOCUMENTS=1,
# as scripts/run-documents.sh sets it, it runs those that name the script.
LONG = {
    "scripts/demo.sh": "a person, from a fresh clone",
    "mpirun -n 2 vdwmesh-mpi mesh": "scripts/run-documents.sh; tests/cli/test_ranks.py with smaller files",
    "vdwmesh-bench thesis": "scripts/run-documents.sh; tests/cli/test_bench.py with one entry",
}
# Pictures that no command draws.
DRAWN_ELSEWHERE = {"study.png": "a person, by a browser, of the page that the command in its text writes"}
IMAGE = re.compile(r"!\[[^]]*\]\([./\w]*images/(\w+\.png)\)")
BLOCK = re.compile(r"^```(sh|text|shell)\n(.*?)^```$", re.MULTILINE | re.DOTALL)


def blocks(page):
    return [(found[1], found[2]) for found in BLOCK.finditer(page.read_text())]


def what_is_missing(printed, promised):
    """The first line of the page that was not printed behind the lines before it; None if there is none."""
    lines = iter(" ".join(line.split()) for line in printed.splitlines())
    for line in promised.splitlines():
        line = " ".join(line.split())
        if line in ("", "…"):
            continue
        begins = line.removesuffix("…")
        if not any(one == line or (begins != line and one.startswith(begins)) for one in lines):
            return line
    return None


class PictureTest(ProgramTest):
    # Mesa draws the same on every machine but for rounding; another driver places the edges otherwise.
    STEPS = 8  # of 255
    SHARE = 1e-4  # of the pixels may differ by more

    def device(self):
        """What draws; where nothing does, VDWMESH_REQUIRE_EGL=1 makes commands fail, and otherwise the test skips."""
        pictures = parse_json(self.run_ok("info", "--json", "-").stdout)["pictures"]
        if pictures["device"] is None and not is_required("VDWMESH_REQUIRE_EGL"):
            self.skipTest(f"no pictures: {pictures['reason']}")
        return pictures["device"] or ""

    def assert_is_shown(self, name):
        """The picture that was drawn is the one in docs/images."""
        self.assertTrue((self.folder / name).is_file(), f"{name} is shown, and no command draws it")
        if "llvmpipe" not in self.device():
            return
        need_package("python3-pil", module="PIL.Image")
        from PIL import Image, ImageChops

        drawn, shown = (Image.open(path).convert("RGB") for path in (self.folder / name, IMAGES / name))
        self.assertEqual(drawn.size, shown.size, name)
        most = functools.reduce(ImageChops.lighter, ImageChops.difference(drawn, shown).split())
        share = sum(most.histogram()[self.STEPS + 1 :]) / (drawn.width * drawn.height)
        self.assertLessEqual(share, self.SHARE, f"docs/images/{name} is not what its command draws now")


class Documents(PictureTest):
    def run_page(self, page):
        printed = None
        long = os.environ.get("VDWMESH_LONG_DOCUMENTS") == "1"
        for kind, text in blocks(page):
            if kind == "text":
                self.assertIsNotNone(printed, f"{page.name}: output without a command")
                line = what_is_missing(printed, text)
                self.assertIsNone(line, f"{page.name} promises this line:\n{line}\nand printed was:\n{printed}")
            elif kind == "sh" or (long and "run-documents.sh" in self.reason(text)):
                printed = self.run_block(page, text)
        for name in IMAGE.findall(page.read_text()):
            self.assert_is_shown(name)

    def run_block(self, page, text):
        self.prepare(text)
        environment = dict(ranks_environment(), PATH=f"{self.folder / 'bin'}:{os.path.dirname(PROGRAM)}:{os.environ['VDWMESH_BUILD_DIR']}/bench:{os.environ['PATH']}")
        environment["PYTHONWARNINGS"] = "ignore"
        result = subprocess.run(
            ["bash", "-euo", "pipefail", "-c", text], cwd=self.folder, env=environment, timeout=3000,
            capture_output=True, text=True)  # fmt: skip
        self.assertEqual(result.returncode, 0, f"{page.name}:\n{text}\n{result.stderr}")
        return result.stdout

    def prepare(self, text):
        """A folder like that of a clone, with the files that the page says are needed."""
        (self.folder / "bin").mkdir(exist_ok=True)
        needed = {"data": SOURCE_DIR / "data", "bin/python3": sys.executable}
        words = set(re.findall(r"[\w.]+", text))
        needed.update((name, need_shared(path)) for name, path in FILES.items() if name in words)
        for name, path in needed.items():
            if not (self.folder / name).exists():
                (self.folder / name).symlink_to(path)
        for module, package in MODULES.items():
            if f"import {module}" in text:
                need_package(package, module=module)
        if "import vdwmesh" in text or ", vdwmesh" in text:
            if "PYTHONPATH" not in os.environ:
                self.skipTest("this build has no Python package")
        if " render " in text or "--picture" in text:
            self.device()

    @staticmethod
    def reason(text):
        """What runs a block that takes long."""
        found = [reason for words, reason in LONG.items() if text.startswith(words)]
        return found[0] if found else ""

    def test_long_blocks_are_listed(self):
        long = [text for page in PAGES for kind, text in blocks(page) if kind == "shell"]
        self.assertEqual([text for text in long if not self.reason(text)], [])
        unused = [words for words in LONG if not any(text.startswith(words) for text in long)]
        self.assertEqual(unused, [])

    def test_every_page_has_a_command_and_its_output(self):
        self.assertGreater(len(PAGES), 9)
        for page in PAGES:
            kinds = [kind for kind, _ in blocks(page)]
            self.assertIn("sh", kinds, page.name)
            self.assertIn("text", kinds, page.name)

    def test_a_line_that_is_not_printed_is_found(self):
        self.assertIsNone(what_is_missing("a  1\nb 2\nc 3.14\n", "a 1\n…\nc 3.1…\n"))
        self.assertEqual(what_is_missing("a 1\nb 2\n", "b 2\na 1\n"), "a 1")
        self.assertEqual(what_is_missing("a 12\n", "a 1\n"), "a 1")


class Quoted(ProgramTest):
    """Other pages quote what a command prints: blocks that begin with `$ vdwmesh`, on built-in structures."""

    def test_quoted_output(self):
        quoted = re.compile(r"^```\n\$ vdwmesh ([^\n]*--sample [^\n]*)\n(.*?)^```$", re.MULTILINE | re.DOTALL)
        seen = 0
        for page in [SOURCE_DIR / "README.md", *sorted((SOURCE_DIR / "docs").glob("*.md"))]:
            for arguments, text in quoted.findall(page.read_text()):
                printed = self.run_ok(*arguments.split()).stdout
                line = what_is_missing(printed, text.replace("\n...\n", "\n…\n"))
                self.assertIsNone(line, f"{page.name}: vdwmesh {arguments} does not print this line")
                seen += 1
        self.assertGreater(seen, 1)


class Pictures(PictureTest):
    """Pictures of commands within lines of other pages, such as `vdwmesh render --sample … -o NAME.png`."""

    @staticmethod
    def commands():
        """Commands by the pictures that they draw."""
        pages = [SOURCE_DIR / "README.md", *sorted((SOURCE_DIR / "docs").glob("*.md"))]
        texts = [re.sub(r"\s+", " ", FENCE.sub("", page.read_text())) for page in pages]
        shown = {name for page in pages for name in IMAGE.findall(page.read_text())}
        found = [code for text in texts for code in CODE.findall(text) if code.startswith("vdwmesh ") and "--sample" in code]
        return {word: code for code in found for word in code.split() if word in shown}

    def test_every_picture_is_drawn_by_a_command(self):
        pages = {name for page in PAGES for name in IMAGE.findall(page.read_text())}
        self.assertEqual({path.name for path in IMAGES.glob("*.png")}, {*pages, *self.commands(), *DRAWN_ELSEWHERE})

    def test_pictures_are_those_of_their_commands(self):
        if "llvmpipe" not in self.device():
            self.skipTest("pictures are compared on llvmpipe alone")
        for name, command in self.commands().items():
            self.run_ok(*command.split()[1:], cwd=self.folder)
            self.assert_is_shown(name)


class RadiusSets(ProgramTest):
    """The table of docs/concepts.md, whose command stands below it with SET in place of a name."""

    def test_area_and_volume_by_set(self):
        text = (SOURCE_DIR / "docs" / "concepts.md").read_text()
        rows = re.findall(r"^\| `(\w+)`[^|]*\|[^|]*\| ([\d.]+) \| ([\d.]+) \|$", text, re.MULTILINE)
        self.assertGreater(len(rows), 2)
        for name, area, volume in rows:
            report = self.run_ok("exact", "--sample", "ubiquitin", "--radii", name, "--json", "-").stdout
            exact = parse_json(report)["exact"]
            self.assertEqual((f"{exact['area']:.3f}", f"{exact['volume']:.3f}"), (area, volume), name)


def add_test_of(page):
    def test(self):
        self.run_page(page)

    setattr(Documents, f"test_commands_of_{page.stem}", test)


for one in PAGES:
    add_test_of(one)

if __name__ == "__main__":
    unittest.main()
