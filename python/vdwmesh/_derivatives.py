"""Exact derivatives of the areas and volumes of atoms: along a motion, and all of them as a sparse matrix."""

from __future__ import annotations

from dataclasses import dataclass
from typing import TYPE_CHECKING, Any, NamedTuple

import numpy as np

from vdwmesh import _core
from vdwmesh._arrays import Brief, floats, number, thread_count, view
from vdwmesh._sources import arrays_of
from vdwmesh.errors import InvalidInput

if TYPE_CHECKING:
    from vdwmesh._types import ArrayLike, Floats, NDArray


class Rates(NamedTuple):
    """By how much the exact measures of each atom change, to first order.

    Attributes
    ----------
    atom_area, atom_volume : ndarray of float64, shape (N,)
        Å², Å³.
    """

    atom_area: Floats
    atom_volume: Floats


@dataclass(frozen=True, eq=False, repr=False)
class Jacobian(Brief):
    """Derivatives of the area and the volume of each atom by the centre and the radius of each, in compressed rows (CSR).

    Row i, of the measures of atom i, has the entries ``indptr[i]`` to ``indptr[i + 1] - 1``, by ascending
    columns: atom i itself, and those that bound its part of the union.

    Attributes
    ----------
    indptr : ndarray of int64, shape (N + 1,)
        Where rows begin.
    indices : ndarray of int32, shape (M,)
        Columns: the atom by whose centre and radius an entry is.
    area_coords : ndarray of float64, shape (M, 3)
        Of the area by the centre, Å.
    area_radii : ndarray of float64, shape (M,)
        Of the area by the radius, Å.
    volume_coords, volume_radii : ndarray of float64, shapes (M, 3) and (M,)
        Of the volume, Å².
    """

    indptr: NDArray[np.int64]
    indices: NDArray[np.int32]
    area_coords: Floats
    area_radii: Floats
    volume_coords: Floats
    volume_radii: Floats


def rates(
    coords: Any,
    radii: ArrayLike | str | None = None,
    *,
    move: ArrayLike | None = None,
    growth: ArrayLike | None = None,
    probe: float = 0.0,
    threads: int | None = None,
) -> Rates:
    """By how much the exact area and volume of each atom change when atoms move and grow.

    This is the product of the derivatives with a motion (forward mode); ``exact(gradient=True,
    weights=...)`` is that with weights (reverse mode). It computes on the CPU.

    Parameters
    ----------
    coords, radii, threads
        As for `exact`.
    move : array_like, shape (N, 3), optional
        By how much centres move, Å.
    growth : array_like, shape (N,), optional
        By how much radii grow, Å.
    probe : float
        Added to every radius, Å.

    Returns
    -------
    Rates

    Raises
    ------
    InvalidInput
        An argument is no such array, has numbers that are not finite or not one for each atom; or there
        is neither `move` nor `growth`.

    Examples
    --------
    Two unit balls that part, at 1 Å:

    >>> import numpy, vdwmesh
    >>> found = vdwmesh.rates([[0, 0, 0], [1, 0, 0]], [1, 1], move=[[0, 0, 0], [1, 0, 0]])
    >>> numpy.round(found.atom_area / numpy.pi, 9)  # the area of each is pi (2 + d)
    array([1., 1.])
    """
    if move is None and growth is None:
        raise InvalidInput("rates: give move or growth, or both")
    centers, sizes = arrays_of(coords, radii)[:2]
    moves = None if move is None else floats("move", move, "(N, 3)")
    growths = None if growth is None else floats("growth", growth, "(N,)")
    for name, given in (("move", moves), ("growth", growths)):
        if given is not None and len(given) != len(centers):
            raise InvalidInput(f"{name}: has {len(given)} rows for {len(centers)} atoms of coords")
    rows = view(_core.union_rates(centers, sizes, moves, growths, number("probe", probe), thread_count(threads)))
    return Rates(rows[:, 0], rows[:, 1])


def jacobian(
    coords: Any,
    radii: ArrayLike | str | None = None,
    *,
    probe: float = 0.0,
    threads: int | None = None,
) -> Jacobian:
    """All derivatives of the exact area and volume of each atom, as a sparse matrix. It computes on the CPU.

    Parameters
    ----------
    coords, radii, threads
        As for `exact`.
    probe : float
        Added to every radius, Å.

    Returns
    -------
    Jacobian

    Examples
    --------
    Two balls that bound each other. ``scipy.sparse.bsr_matrix((j.area_coords[:, None], j.indices,
    j.indptr))`` makes a matrix with three columns for each centre.

    >>> import vdwmesh
    >>> j = vdwmesh.jacobian([[0, 0, 0], [1, 0, 0]], [1, 1])
    >>> j.indptr.tolist(), j.indices.tolist(), j.area_coords.shape
    ([0, 2, 4], [0, 1, 0, 1], (4, 3))
    """
    centers, sizes = arrays_of(coords, radii)[:2]
    first, columns, entries = _core.union_jacobian(centers, sizes, number("probe", probe), thread_count(threads))
    table = view(entries)
    return Jacobian(
        view(first).view(np.int64),
        view(columns).view(np.int32),
        table[:, :3],
        table[:, 3],
        table[:, 4:7],
        table[:, 7],
    )
