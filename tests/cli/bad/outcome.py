"""Runs the program on a damaged file, with little room, and says what is wrong with what it did."""

import dataclasses
import json
import os
import pathlib
import re
import resource
import subprocess

import program
from .case import Expect

# Of CPU time, a hundred times what such a file needs.
SECONDS = 200 if program.SANITIZED else 20
MEMORY = 3 << 30  # bytes
ODD = "the file may have been cut off"


@dataclasses.dataclass(frozen=True)
class Outcome:
    code: int
    message: str  # all of standard error
    report: dict | None
    left_behind: list
    problems: list

    def described(self, path):
        """The message without the name of the file."""
        if self.report is not None:
            warnings = "; ".join(self.report["warnings"])
            return "read" + (f", with a warning: {warnings}" if warnings else "")
        return self.message.strip().removeprefix("vdwmesh: ").replace(str(path), "FILE")


def bound():
    resource.setrlimit(resource.RLIMIT_CPU, (SECONDS, SECONDS))
    if not program.SANITIZED:  # address space, of which the sanitizers reserve terabytes
        resource.setrlimit(resource.RLIMIT_AS, (MEMORY, MEMORY))
    resource.setrlimit(resource.RLIMIT_CORE, (0, 0))


def environment():
    options = [os.environ.get("ASAN_OPTIONS", ""), f"hard_rss_limit_mb={MEMORY >> 20}"]
    return {**os.environ, "ASAN_OPTIONS": ":".join(filter(None, options))}


def run_bounded(arguments, folder, path):
    """The report goes into a file, which must not be there after a failure."""
    report_path = folder / "report.json"
    command = [program.PROGRAM, *map(str, arguments), "--threads", "2", "--quiet", "--json",
               str(report_path)]
    before = set(folder.iterdir())
    try:
        result = subprocess.run(command, capture_output=True, timeout=10 * SECONDS, preexec_fn=bound,
                                env=environment())
    except subprocess.TimeoutExpired:
        return Outcome(-1, "", None, [], ["it hung"])
    message = result.stderr.decode(errors="replace")
    report = None
    if report_path.exists():
        report = program.parse_json(report_path.read_text())
        report_path.unlink()
    left = sorted(p.name for p in set(folder.iterdir()) - before)
    outcome = Outcome(result.returncode, message, report, left, [])
    outcome.problems.extend(problems_of(outcome, path))
    return outcome


def problems_of(outcome, path):
    """What no run may do, whatever the file."""
    found = [f"left {outcome.left_behind} behind"] if outcome.left_behind else []
    if outcome.code == program.DONE:
        if outcome.report is None:
            return [*found, "succeeded without a report"]
        return found + [e.message for e in program.schema_validator().iter_errors(outcome.report)]
    if outcome.code not in (program.BAD_INPUT, program.LIMIT_HIT):
        found.append(f"ended with {outcome.code}")
    if not re.fullmatch(r"vdwmesh: [^\n]+\n", outcome.message):
        found.append(f"said {outcome.message!r}, which is not one line")
    if not outcome.message.isascii() and not outcome.message.isprintable():
        printable = outcome.message.rstrip("\n")
        if not printable.isprintable():
            found.append("the message holds letters that cannot be printed")
    # A limit may be of the options as well.
    if outcome.code != program.LIMIT_HIT and pathlib.Path(path).name not in outcome.message:
        found.append("the message does not name the file")
    if "out of memory" in outcome.message or "internal error" in outcome.message:
        found.append("memory ran out, or the program broke")
    if outcome.report is not None:
        found.append("a report was left after a failure")
    return found


def judged(case, outcome, items, same):
    """Adds what is wrong for this very case. `items` and `same` are read off the report."""
    found = outcome.problems
    if found:
        return found
    done = outcome.code == program.DONE
    if case.expect is Expect.REFUSED and done:
        found.append("was not refused")
    if case.expect in (Expect.READ, Expect.SAME) and not done:
        found.append("was refused: " + outcome.message.strip())
    if not done:
        return found
    if case.items is not None and items != case.items:
        found.append(f"{items} were read of {case.items}")
    if case.expect is Expect.SAME and not same:
        found.append("it reads as something else than the sound file")
    if case.expect is Expect.DOUBTED and not any(ODD in w for w in outcome.report["warnings"]):
        found.append("nobody was told that the file may have been cut off")
    return found


def structure_items(report):
    """The atoms read, where the account of them is right; -1 where it is not."""
    account = report["input"]
    lost = account["atoms_read"] - account["atoms_used"] - sum(account["skipped"].values())
    return account["atoms_read"] if lost == 0 else -1
