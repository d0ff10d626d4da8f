"""What the Python layer knows of the C++ side."""

from typing import Any

version: str

class Array:
    """Exports its memory by the buffer protocol, read-only."""

class RadiusTable:
    def __init__(self, name: str) -> None: ...
    def find(self, residue: str, atom: str, element: str) -> float | None: ...

def read_file(path: str, **options: Any) -> dict[str, Any]: ...
def read_bytes(name: str, data: bytes, **options: Any) -> dict[str, Any]: ...
def read_sample(name: str, **options: Any) -> dict[str, Any]: ...
def require_cpu(device: str) -> None: ...
def exact(
    coords: Any, radii: Any, probe: float, atoms: Any, topology: bool, method: str, threads: int | None
) -> dict[str, Any]: ...
def sasa(
    coords: Any,
    radii: Any,
    probe: float,
    atoms: Any,
    groups: Any,
    group_count: int,
    method: str,
    threads: int | None,
) -> Array: ...
