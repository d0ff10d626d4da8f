"""The exceptions of the package, one class for each cause.

Each message is one line: what is wrong, at which argument or place of a file, and what would work.
Every class is also the class of Python that callers know for such a cause.
"""

__all__ = ["BackendUnavailable", "CudaError", "Error", "FileFormatError", "InternalError",
           "InvalidInput", "LimitExceeded"]  # fmt: skip


class Error(Exception):
    """Base of all exceptions of the package."""


class InvalidInput(Error, ValueError):
    """An argument violates what the function asks for; the message names it."""


class FileFormatError(Error, OSError):
    """A file cannot be opened, read, understood or written."""


class BackendUnavailable(Error, RuntimeError):
    """The device asked for is not there, or this build has no code for it."""


class CudaError(Error, RuntimeError):
    """A CUDA call failed."""


class LimitExceeded(Error, MemoryError):
    """The call would need more memory, cells or vertices than there may be."""


class InternalError(Error, RuntimeError):
    """A check of the library failed that no input should be able to fail."""
