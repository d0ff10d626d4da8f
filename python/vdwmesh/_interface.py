"""Interfaces between chains or other groups of atoms: buried areas and contacts."""

from __future__ import annotations

from dataclasses import dataclass
from typing import TYPE_CHECKING, Any

import numpy as np

from vdwmesh import _core
from vdwmesh._arrays import number, refuse_masked, thread_count, view
from vdwmesh._molecule import Molecule
from vdwmesh._sources import arrays_of
from vdwmesh.errors import InvalidInput

if TYPE_CHECKING:
    from vdwmesh._types import ArrayLike, Floats, Ids


@dataclass(frozen=True)
class Complementarity:
    """How well the solvent-excluded surfaces of two sides fit (Lawrence and Colman 1993).

    Attributes
    ----------
    sc : float
        1 for surfaces that are each other's image; NaN where no part of a side is farther than 1.5 Å
        from what is not buried.
    error : float
        Estimate of the error of `sc`; samples are doubled until it is below 0.002. NaN where `sc` is.
    median_a, median_b : float
        Of both sides; `sc` is their mean.
    fitted_a, fitted_b : float
        Å² that the medians are over.
    buried_a, buried_b : float
        Å² of the excluded surfaces that the other side buries.
    contact_a, contact_b : float
        Contact molecular surface, Å²: the integral of exp(-d²/2) over the buried parts, with d (Å) the
        distance to the other side's.
    """

    sc: float
    error: float
    median_a: float
    median_b: float
    fitted_a: float
    fitted_b: float
    buried_a: float
    buried_b: float
    contact_a: float
    contact_b: float


@dataclass(frozen=True, eq=False)
class Interface:
    """What two sides bury of each other's surface, without all others.

    Attributes
    ----------
    a, b : str or int
        The sides.
    buried_area, buried_a, buried_b : float
        Å² that both lose to each other, and each of them.
    area_a, area_b : float
        Of each side alone, Å².
    contact_area : float
        Of all contacts, Å².
    atoms : ndarray of uint32, shape (K,)
        Atoms of both sides whose balls overlap one of the other side.
    atom_area, atom_area_in_pair : ndarray of float64, shape (K,)
        Their areas with their own side alone and with both, Å².
    contacts : ndarray of uint32, shape (C, 2)
        Pairs of atoms, of `a` and of `b`, that share a face of the power diagram.
    contact_areas : ndarray of float64, shape (C,)
        The part of the face inside both balls, Å².
    complementarity : Complementarity or None
        None where it was not asked for.
    """

    a: Any
    b: Any
    buried_area: float
    buried_a: float
    buried_b: float
    area_a: float
    area_b: float
    contact_area: float
    atoms: Ids
    atom_area: Floats
    atom_area_in_pair: Floats
    contacts: Ids
    contact_areas: Floats
    complementarity: Complementarity | None


@dataclass(frozen=True, eq=False)
class Interfaces:
    """All pairs of sides that touch.

    Attributes
    ----------
    pairs : tuple of Interface
        By the order in which the sides first come among the atoms.
    atom_area, atom_area_in_whole : ndarray of float64, shape (N,)
        With the atom's own side alone and among all atoms, Å²; NaN for atoms on no side.
    """

    pairs: tuple[Interface, ...]
    atom_area: Floats
    atom_area_in_whole: Floats


def interface(
    coords: Any,
    radii: ArrayLike | str | None = None,
    *,
    sides: ArrayLike | None = None,
    probe: float = 1.4,
    complementarity: bool = False,
    threads: int | None = None,
) -> Interfaces:
    """Exact buried areas and contacts of all pairs of sides that touch, in one call.

    Parameters
    ----------
    coords, radii
        As for `exact`.
    sides : array_like of str or int, shape (N,), optional
        The side of each atom; "" and numbers below 0 are on no side, and cover others in the whole
        alone. By default the chains of a `Molecule`.
    probe : float
        Added to every radius, Å.
    complementarity : bool
        Whether the fit of each pair's excluded surfaces is measured too, which takes longer.
    threads : int, optional
        At most so many; all cores by default.

    Returns
    -------
    Interfaces

    Raises
    ------
    InvalidInput
        There are fewer than two sides, or an argument is no such array.

    Examples
    --------
    Two unit balls at a distance of 1 bury caps of height 1/2; their contact is a disk.

    >>> import vdwmesh
    >>> found = vdwmesh.interface([[0, 0, 0], [1, 0, 0]], [1.0, 1.0], sides=["A", "B"], probe=0)
    >>> pair = found.pairs[0]
    >>> round(pair.buried_area, 6), round(pair.contact_area, 6)  # 2 pi, 3/4 pi
    (6.283185, 2.356194)
    """
    centers, sizes, _ = arrays_of(coords, radii)
    names, numbers = _numbered(sides, coords, len(centers))
    alone, whole, pairs = _core.interfaces(
        centers, sizes, number("probe", probe), numbers, complementarity, thread_count(threads)
    )
    return Interfaces(tuple(_pair(names, pair) for pair in pairs), view(alone), view(whole))


def _pair(names: list[Any], pair: dict[str, Any]) -> Interface:
    values = {k: v if isinstance(v, (int, float)) else view(v) for k, v in pair.items() if k != "complementarity"}
    fit = pair["complementarity"] and Complementarity(**pair["complementarity"])
    return Interface(**{**values, "a": names[pair["a"]], "b": names[pair["b"]], "complementarity": fit})


def _numbered(sides: Any, coords: Any, count: int) -> tuple[list[Any], Ids]:
    """The sides in the order of their first atoms, and the number of each atom's side."""
    if sides is None:
        if not isinstance(coords, Molecule):
            raise InvalidInput("sides: say which atoms are on which side; a Molecule has its chains")
        sides = coords.chains
    refuse_masked("sides", sides)
    labels = np.asarray(sides)
    if labels.shape != (count,) or labels.dtype.kind not in "USiu":
        raise InvalidInput(
            f"sides: has shape {labels.shape} of {labels.dtype}; {count} strings or whole numbers are needed"
        )
    known: dict[Any, int] = {}
    numbers = np.full(count, -1, np.int32)
    values: Any = labels.tolist()  # str, bytes or int
    for i, label in enumerate(values):
        if label not in ("", b"") and (isinstance(label, (str, bytes)) or label >= 0):
            numbers[i] = known.setdefault(label, len(known))
    if len(known) < 2:
        raise InvalidInput(f"sides: an interface has two sides, but there is {len(known)}")
    return list(known), numbers.view(np.uint32)
