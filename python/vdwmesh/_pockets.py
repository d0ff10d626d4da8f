"""Pockets, channels and voids of molecules."""

from __future__ import annotations

import warnings
from dataclasses import dataclass
from typing import TYPE_CHECKING, Any

from vdwmesh import _core
from vdwmesh._arrays import Brief, thread_count
from vdwmesh._sources import arrays_of
from vdwmesh.errors import InvalidInput

if TYPE_CHECKING:
    from vdwmesh._types import ArrayLike


@dataclass(frozen=True)
class Mouth:
    """An opening of a pocket.

    Attributes
    ----------
    area, rim : float or None
        Å², Å: the opening less all balls, and the length of balls' arcs in it; None of sums.
    area_sum, rim_sum : float
        The same by CASTp's sums.
    center : tuple of float
        Å.
    faces : int
        Triangles of the triangulation.
    """

    area: float | None
    rim: float | None
    area_sum: float
    rim_sum: float
    center: tuple[float, float, float]
    faces: int


@dataclass(frozen=True, repr=False)
class Pocket(Brief):
    """A pocket for the centre of the probe.

    Attributes
    ----------
    kind : {"void", "pocket", "channel"}
        No mouth, one, or more.
    volume, area : float or None
        Å³, Å²: exact; None of sums.
    volume_sum, area_sum : float
        CASTp's sums, which are not volume and area of pockets with mouths.
    mouths : tuple of Mouth
        By falling area.
    lining, lining_areas : tuple
        Indices of atoms with area in the pocket, and the areas, Å².
    atoms, tetrahedra, sinks : int
        Of the triangulation.
    depth_alpha, bottleneck_alpha : float
        Å²: sizes of orthogonal spheres, at the deepest sink and at the narrowest place of the way out.
    center : tuple of float
        Å: where the largest probe fits.
    depth_probe, bottleneck_radius : float or None
        Å: the radius of that probe, and of the largest that can leave; None if an atom would vanish.
    margin : float or None
        Å: the least change of the probe that opens a void, closes a way out, or loses the place.
    """

    kind: str
    volume: float | None
    area: float | None
    volume_sum: float
    area_sum: float
    mouths: tuple[Mouth, ...]
    lining: tuple[int, ...]
    lining_areas: tuple[float, ...]
    atoms: int
    tetrahedra: int
    sinks: int
    depth_alpha: float
    bottleneck_alpha: float
    center: tuple[float, float, float]
    depth_probe: float | None
    bottleneck_radius: float | None
    margin: float | None


def pockets(
    coords: Any,
    radii: ArrayLike | str | None = None,
    *,
    probe: float | None = None,
    measures: str = "exact",
    threads: int | None = None,
) -> tuple[Pocket, ...]:
    """Pockets, channels and voids by the discrete flow (Edelsbrunner, Facello and Liang 1998), exactly.

    Parameters
    ----------
    coords : array_like, shape (N, 3), or a molecule
        Centres, Å; or whatever `exact` takes.
    radii : array_like, shape (N,), or the name of a set or a path, optional
        Radii, Å. A molecule brings its own.
    probe : float, optional
        Å, 1.4 by default: added to every radius; its centre is in the pockets.
    measures : {"exact", "sums"}
        "sums" gives CASTp's sums alone, several times as fast: no exact figures, no lining.
    threads : int, optional
        At most so many; all cores by default.

    Returns
    -------
    tuple of Pocket
        By falling volume. A `RuntimeWarning` says if it depends on ties.

    Examples
    --------
    The corners of a cube, with a mouth in each face:

    >>> import itertools, vdwmesh
    >>> (pocket,) = vdwmesh.pockets(list(itertools.product((0, 4.6), repeat=3)), [1.5] * 8)
    >>> pocket.kind, len(pocket.mouths), round(pocket.volume, 6)
    ('channel', 6, 13.497364)
    """
    centers, sizes, _ = arrays_of(coords, radii)
    checked = _core.probe_of("sas", None if probe is None else float(probe))
    found, ties = _core.pockets(centers, sizes, checked, is_exact(measures), thread_count(threads))
    if ties > 0:
        warnings.warn(f"{ties} ties: the pockets depend on how they are broken", RuntimeWarning, stacklevel=2)
    return tuple(map(pocket_of, found))


def is_exact(measures: Any) -> bool:
    """The argument `measures`, checked."""
    if measures not in ("exact", "sums"):
        raise InvalidInput(f"measures: {measures!r} is neither exact nor sums")
    return bool(measures == "exact")


def pocket_of(found: dict[str, Any]) -> Pocket:
    """A pocket of the C++ side as users see it."""
    return Pocket(mouths=tuple(Mouth(**m) for m in found.pop("mouths")), **found)
