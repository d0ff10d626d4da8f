"""Exact area, volume and topology of unions of balls."""

from __future__ import annotations

from dataclasses import dataclass
from typing import TYPE_CHECKING, Any

import numpy as np

from vdwmesh import _core
from vdwmesh._arrays import chosen, number, thread_count, view
from vdwmesh._sources import Atoms, arrays_of
from vdwmesh.errors import InvalidInput

if TYPE_CHECKING:
    from vdwmesh._types import ArrayLike, Floats, Ids, NDArray


@dataclass(frozen=True)
class Topology:
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


@dataclass(frozen=True)
class ExactUnion:
    """Area and volume of a union of balls, from its geometry, without a mesh.

    Attributes
    ----------
    area, volume : float
        Å², Å³; of the atoms that were measured.
    atom_area, atom_volume : ndarray of float64, shape (N,)
        The exposed part of each sphere, Å², and the part of each ball that is nearer to it than to
        all others (by power), Å³. NaN for atoms that were not to be measured.
    topology : Topology or None
        None where it was not asked for.
    method : {"cgal", "arcs", "both"}
        What computed them.
    check_area, check_volume : float or None
        A second computation by other formulas, where the method has one.
    fallback_atoms : int
        Atoms of which the arcs failed a check, so that a triangulation measured them.
    """

    area: float
    volume: float
    atom_area: Floats
    atom_volume: Floats
    topology: Topology | None
    method: str
    check_area: float | None
    check_volume: float | None
    fallback_atoms: int


def exact(
    coords: Any,
    radii: ArrayLike | str | None = None,
    *,
    probe: float = 0.0,
    atoms: ArrayLike | None = None,
    topology: bool = False,
    method: str = "auto",
    threads: int | None = None,
    device: str = "auto",
) -> ExactUnion:
    """Exact area and volume of the union of the atoms' balls, and its topology.

    Parameters
    ----------
    coords : array_like, shape (N, 3), or a molecule
        Centres, Å; or a `Molecule`.
    radii : array_like, shape (N,), or the name of a set (as of `read`) or a path, optional
        Radii, Å. A molecule brings its own.
    probe : float
        Added to every radius, Å. With 1.4 the area is the solvent-accessible one.
    atoms : array_like, mask (N,) or indices, optional
        Only these are measured, while all others still bury them.
    topology : bool
        Whether components, tunnels and voids are computed too, which takes longer.
    method : {"auto", "cgal", "arcs", "both"}
        "cgal": regular triangulation and dual complex (Edelsbrunner 1995). "arcs": each sphere by
        the arcs on it, area and volume only. "both": the one checks the other. "auto": "cgal" for
        the topology, else "arcs".
    threads : int, optional
        At most so many; all cores by default.
    device : {"auto", "cpu", "cuda"}

    Returns
    -------
    ExactUnion

    Raises
    ------
    InvalidInput
        An argument is no such array, or has numbers that are not finite; the message names it.
    BackendUnavailable
        `device` is "cuda": exact measures of this package are made on the CPU.

    Examples
    --------
    Two unit balls whose centres are 1 Å apart:

    >>> import vdwmesh
    >>> union = vdwmesh.exact([[0, 0, 0], [1, 0, 0]], [1, 1])
    >>> round(union.area, 6), round(union.volume, 6)  # 6 pi, 9/4 pi
    (18.849556, 7.068583)
    """
    centers, sizes, _ = arrays_of(coords, radii)
    _core.require_cpu(device)
    found = _core.exact(
        centers,
        sizes,
        number("probe", probe),
        chosen("atoms", atoms, len(centers)),
        bool(topology),
        method,
        thread_count(threads),
    )
    found["atom_area"] = view(found["atom_area"])
    found["atom_volume"] = view(found["atom_volume"])
    if found["topology"] is not None:
        shells = view(found["topology"].pop("shells"))
        found["topology"] = Topology(shells=shells, **found["topology"])
    return ExactUnion(**found)


def sasa(
    coords: Any,
    radii: ArrayLike | str | None = None,
    *,
    probe: float = 1.4,
    mode: str = "total",
    groups: ArrayLike | None = None,
    atoms: ArrayLike | None = None,
    method: str = "auto",
    threads: int | None = None,
    device: str = "auto",
) -> Floats:
    """Exact solvent-accessible surface area, Å², of one structure or of frames.

    Parameters
    ----------
    coords : array_like, shape (N, 3) or (T, N, 3), or a molecule
        Centres, Å.
    radii, atoms, method, threads, device
        As for `exact`.
    probe : float
        Radius of the solvent, Å.
    mode : {"total", "atom", "residue"}
        One area for all atoms, for each atom, or for each residue.
    groups : array_like, shape (N,), optional
        Labels of the atoms: atoms of one label are a residue. A molecule brings its own. Areas are
        in the order in which the labels first appear.

    Returns
    -------
    ndarray of float64
        Of shape () for "total", (N,) for "atom", (G,) for "residue"; with T in front for frames.
        NaN for what was not measured.

    Examples
    --------
    >>> import numpy, vdwmesh
    >>> area = vdwmesh.sasa([[0, 0, 0]], [1.6], probe=1.4)
    >>> round(float(area) / numpy.pi, 9)  # 4 pi 3²
    36.0
    """
    centers, sizes, source = arrays_of(coords, radii, frames=True)
    _core.require_cpu(device)
    has_frames = centers.ndim == 3
    frames = centers if has_frames else centers[np.newaxis]
    labels, count = _groups(mode, groups, source, frames.shape[1])
    found = view(
        _core.sasa(
            frames,
            sizes,
            number("probe", probe),
            chosen("atoms", atoms, frames.shape[1]),
            labels,
            count,
            method,
            thread_count(threads),
        )
    )
    shaped: NDArray[Any] = found if mode == "total" else found.reshape(len(frames), count)
    return shaped if has_frames else shaped[0, ...]


def _groups(mode: str, groups: Any, source: Atoms, count: int) -> tuple[Ids | None, int]:
    """The number of the group of each atom, and how many there are; no groups are 0."""
    if mode != "residue" and groups is not None:
        raise InvalidInput('groups: are of mode="residue"')
    if mode == "total":
        return None, 0
    if mode == "atom":
        return np.arange(count, dtype=np.uint32), count
    if mode != "residue":
        raise InvalidInput(f"mode: {mode!r}; there are total, atom and residue")
    labels = source.residues if groups is None else np.asarray(groups).tolist()
    if labels is None:
        raise InvalidInput("groups: are needed, a label for each atom; coordinates alone have none")
    if len(labels) != count:
        raise InvalidInput(f"groups: has {len(labels)} labels for {count} atoms")
    numbers: dict[Any, int] = {}
    found = [numbers.setdefault(label, len(numbers)) for label in labels]
    return np.array(found, dtype=np.uint32), len(numbers)

