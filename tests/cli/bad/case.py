"""What a damaged file is, and what may be made of it."""

import dataclasses
import enum
import random


class Expect(enum.Enum):
    REFUSED = "refused"  # one line, non-zero
    READ = "read"  # everything in it
    SAME = "same"  # read, and it means the same as the sound file
    DOUBTED = "doubted"  # refused, or read with a warning that it may have been cut off
    EITHER = "either"  # refused, or read in whole: the file does not tell what was meant


@dataclasses.dataclass(frozen=True)
class Case:
    damage: str
    name: str  # of the file; the format is its extension
    data: bytes
    expect: Expect
    items: int | None = None  # atoms or triangles that the file holds, where that is known

    @property
    def format(self):
        return "".join("." + part for part in self.name.split(".")[1:])


class Maker:
    """Collects the cases of one format."""

    def __init__(self, extension):
        self.extension = extension
        self.cases = []

    def add(self, damage, data, expect, items=None):
        data = data.encode() if isinstance(data, str) else data
        name = f"{self.extension}{len(self.cases):03}.{self.extension}"
        self.cases.append(Case(damage, name, data, expect, items))

    def dice(self, damage):
        return random.Random(f"{self.extension} {damage}")
