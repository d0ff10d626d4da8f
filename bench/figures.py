"""Figures of a benchmark beside what is wanted of them, printed as they come and once more at the end."""

import dataclasses
import resource
import time


@dataclasses.dataclass
class Figure:
    name: str
    value: float
    unit: str
    wanted: float | None = None  # nothing: only told
    at_most: bool = False  # or at least
    note: str = ""

    @property
    def is_met(self):
        return self.wanted is None or (self.value <= self.wanted if self.at_most else self.value >= self.wanted)

    def line(self):
        goal = "" if self.wanted is None else f"{'≤' if self.at_most else '≥'} {self.wanted:g}"
        verdict = "" if self.wanted is None else "met" if self.is_met else "MISSED"
        return f"{self.name:58} {self.value:10.4g} {self.unit:9} {goal:>9}  {verdict:6} {self.note}"


class Figures:
    def __init__(self, title):
        self.all = []
        print(title, flush=True)

    def add(self, name, value, unit, at_least=None, at_most=None, note=""):
        wanted = at_least if at_least is not None else at_most
        self.all.append(Figure(name, value, unit, wanted, at_most is not None, note))
        print(self.all[-1].line(), flush=True)
        return value

    def left_out(self, name, why):
        print(f"{name:58} left out: {why}", flush=True)

    def summary(self):
        judged = [f for f in self.all if f.wanted is not None]
        missed = [f for f in judged if not f.is_met]
        print(f"\n{len(judged) - len(missed)} of {len(judged)} figures are met")
        for figure in missed:
            print(figure.line())


def cpu_seconds(who=resource.RUSAGE_SELF):
    used = resource.getrusage(who)
    return used.ru_utime + used.ru_stime


def measured(work):
    """Wall time and CPU time of a call, seconds."""
    began, used = time.perf_counter(), cpu_seconds()
    work()
    return time.perf_counter() - began, cpu_seconds() - used


def best(work, runs=5):
    """The least wall time and the least CPU time of several calls, seconds."""
    times = [measured(work) for _ in range(runs)]
    return min(wall for wall, _ in times), min(cpu for _, cpu in times)
