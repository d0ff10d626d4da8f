"""The exceptions of the package, one class for each cause.

Each message is one line: what is wrong, at which argument or place of a file, and what would work.
Every class is also the class of Python that callers know for such a cause.
"""

import re

__all__ = ["BackendUnavailable", "CudaError", "Error", "FileFormatError", "FileMissing",
           "InternalError", "InvalidInput", "LimitExceeded"]  # fmt: skip


class Error(Exception):
    """Base of all exceptions of the package."""


class InvalidInput(Error, ValueError):
    """An argument violates what the function asks for; the message names it."""


class FileFormatError(Error, OSError):
    """A file cannot be opened, read, understood or written."""


class FileMissing(FileFormatError, FileNotFoundError):
    """A file that was named is not there."""


class BackendUnavailable(Error, RuntimeError):
    """The device asked for is not there, or this build has no code for it."""


class CudaError(Error, RuntimeError):
    """A CUDA call failed."""


class LimitExceeded(Error, MemoryError):
    """The call would need more memory, cells or vertices than there may be."""


class InternalError(Error, RuntimeError):
    """A check of the library failed that no input should be able to fail."""


_SWITCHES = {"--waters": "waters=True", "--no-hydrogens": "hydrogens=False", "--no-hetatm": "hetatm=False"}
_OPTION = re.compile(
    r"(?<![\w./-])--(?:waters|no-hydrogens|no-hetatm|"
    r"(format|model|assembly|radii|select|altloc|units|probe|spacing|edge-length|threads|device)"
    r"(?:[ =]('[^']*'|[A-Z]+\b|\d[\d.]*\b|(?:pdb|mmcif|bcif|pqr|xyzr|gro|mol2|sdf|xyz)\b"
    r"|(?:bondi|alvarez|protor|naccess|oons)\b(?:,[^\s;]+)?|(?:first|highest|nm|pm)\b))?)(?![\w-])"
)


def in_terms_of_python(message: str) -> str:
    """A message of the library, which names options of the program, with arguments of Python."""
    return _OPTION.sub(_argument, message)


def _argument(option: re.Match[str]) -> str:
    name, value = option[1], option[2]
    if name is None:
        return _SWITCHES[option[0]]
    name = name.replace("-", "_")
    if value is None:
        return str(name)
    stands_for_itself = value.startswith("'") or value[0].isdigit() or (value.isupper() and len(value) > 1)
    return f"{name}={value}" if stands_for_itself else f"{name}={value!r}"
