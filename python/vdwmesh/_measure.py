"""Calls the exact measures of the C++ side, for one structure and for frames alike."""

from __future__ import annotations

from dataclasses import dataclass, replace
from typing import TYPE_CHECKING, Any, NamedTuple

from vdwmesh import _core
from vdwmesh._arrays import Brief, given_number, thread_count, view
from vdwmesh._cuda import CudaArray, CudaAtoms, CudaGradient, CudaInput, packed

if TYPE_CHECKING:
    from collections.abc import Sequence

    from vdwmesh._types import Floats, Ids, NDArray


@dataclass(frozen=True)
class Counts:
    """What of the topology of a union of closed balls is known without its tunnels and shells.

    Attributes
    ----------
    components : int
        Connected pieces of the union.
    euler_characteristic : int
        2 (components - tunnels + voids), of the boundary.
    hidden_atoms : int
        Atoms without exposed area.
    """

    components: int
    euler_characteristic: int
    hidden_atoms: int


@dataclass(frozen=True)
class Void:
    """A pocket without a way out: a bounded component of the complement of a union of balls.

    Attributes
    ----------
    area : float
        Of its whole boundary, with that of what lies in it, Å².
    volume : float
        Å³.
    center : tuple of float
        The point of the void at which the least power to an atom, squared distance less squared
        radius, is largest, Å: for one radius the centre of the largest ball that fits in.
    clearance : float
        From there to the nearest sphere, Å.
    lining : tuple of int
        Atoms with exposed area in the void, ascending.
    """

    area: float
    volume: float
    center: tuple[float, float, float]
    clearance: float
    lining: tuple[int, ...]


@dataclass(frozen=True, eq=False, repr=False)
class Topology(Brief):
    """Topology of a union of closed balls, exact for the coordinates given.

    Attributes
    ----------
    components, tunnels, voids : int
        Betti numbers of the union. Voids are the pockets without a way out.
    euler_characteristic : int
        2 (components - tunnels + voids), of the boundary.
    point_contacts : int
        Pairs of balls that touch in one exposed point.
    hidden_atoms : int
        Atoms without exposed area.
    shells : ndarray of float64, shape (S, 2)
        Area (Å²) and enclosed volume (Å³) of each connected piece of the boundary: outer surfaces,
        then voids, whose volume is negative.
    outer_area, void_area : float
        Å².
    void_volume : float
        Å³ enclosed by the voids.
    void_table : tuple of Void
        Each void, by falling volume.
    """

    components: int
    tunnels: int
    voids: int
    euler_characteristic: int
    point_contacts: int
    hidden_atoms: int
    shells: Floats
    outer_area: float
    void_area: float
    void_volume: float
    void_table: tuple[Void, ...]


@dataclass(frozen=True)
class Options:
    """Options of the measures, checked; those of a whole trajectory, whatever its parts."""

    probe: float
    topology: str  # "off", "counts" or "full"
    threads: int | None
    device: str
    atoms: Ids | None = None
    method: str = "auto"
    per_atom: bool = False
    groups: Ids | None = None
    group_count: int = 0
    unit: float = 1.0  # Å
    balls: int = 0  # in all frames

    @staticmethod
    def of(
        probe: Any, topology: Any, threads: Any, device: str, *, surface: str = "vdw", **others: Any
    ) -> Options:
        """From the arguments of the functions that users call."""
        named = {"topology": topology_name(topology), "method": others.pop("method", "auto")}
        checked = _core.settle_measures(surface=surface, probe=given_number("probe", probe), **named)
        return Options(threads=thread_count(threads), device=device, **checked, **others)


def topology_name(topology: Any) -> str:
    """The argument `topology`: a name, or a truth value for "full" and "off"."""
    return topology if isinstance(topology, str) else "full" if topology else "off"


def _void(lining: list[int], **others: Any) -> Void:
    return Void(lining=tuple(lining), **others)


@dataclass(frozen=True)
class InvalidFrame:
    """The first frame of a call that cannot be measured, from 0, and why."""

    frame: int
    atom: int | None
    reason: str


class Measured(NamedTuple):
    """What is known of frames: up to the first that cannot be measured."""

    frames: list[dict[str, Any]]
    groups: list[Floats]  # areas by group
    invalid: InvalidFrame | None
    cuda: CudaAtoms | None  # of all frames, (T, N), where they are on a device and wanted


def as_arrays(found: dict[str, Any]) -> dict[str, Any]:
    """Makes NumPy's arrays of what is known of the atoms."""
    for name in ("atom_area", "atom_volume"):
        if found[name] is not None:
            found[name] = view(found[name])
    return found


def measure(
    frames: NDArray[Any] | CudaInput, radii: NDArray[Any] | CudaInput, options: Options
) -> Measured:
    """The measures of each frame (T, N, 3)."""
    if isinstance(frames, CudaInput):
        return _measured(*_core.measure_on_device(frames.packed, packed(radii), **vars(options)))
    return _measured(*_core.measure(frames, radii, **vars(options)))


def measure_gradient_there(frames: CudaInput, radii: Any, weights: list[Any], options: Options) -> Measured:
    """The measures of each frame (T, N, 3) on a device, with the gradient in its ``cuda``."""
    given = [None if w is None else w.packed for w in weights]
    *found, slopes = _core.gradient_on_device(frames.packed, packed(radii), *given, **vars(options))
    measured = _measured(*found)
    for k, one in enumerate(measured.frames):
        *columns, kinks = slopes
        own = gradient_there([column.row(k) for column in columns], kinks[k])
        one["cuda"] = replace(one["cuda"], gradient=own)
    return measured


def gradient_there(columns: Sequence[Any], kinks: int) -> CudaGradient:
    """Columns of derivatives that the C++ side left on a device."""
    area_coords, area_radii, volume_coords, volume_radii = map(CudaArray, columns)
    return CudaGradient(area_coords, area_radii, volume_coords, volume_radii, kinks)


def atoms_there(areas: Any, volumes: Any, gradient: CudaGradient | None = None) -> CudaAtoms:
    """Columns of measures that the C++ side left on a device."""
    return CudaAtoms(CudaArray(areas), CudaArray(volumes), gradient)


def _measured(found: list[dict[str, Any]], groups: list[Any], invalid: Any, columns: Any = None) -> Measured:
    """What the C++ side found, with the classes that users see."""
    for k, one in enumerate(found):
        one["cuda"] = columns and atoms_there(*(column.row(k) for column in columns))
        as_arrays(one)
        if one["counts"] is not None:
            one["counts"] = Counts(**one["counts"])
        if one["topology"] is not None:
            shells = view(one["topology"].pop("shells"))
            voids = one["topology"].pop("void_table")
            table = tuple(_void(**v) for v in voids)
            one["topology"] = Topology(shells=shells, void_table=table, **one["topology"])
    return Measured(
        found,
        [view(sums) for sums in groups],
        None if invalid is None else InvalidFrame(*invalid),
        columns and atoms_there(*columns),
    )
