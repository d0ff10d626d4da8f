"""Exact measures of the solvent-excluded surface."""

from __future__ import annotations

from dataclasses import dataclass
from typing import TYPE_CHECKING, Any

from vdwmesh import _core
from vdwmesh._arrays import Brief, given_number, thread_count, view
from vdwmesh._measure import topology_name

if TYPE_CHECKING:
    from vdwmesh._types import Floats


@dataclass(frozen=True)
class ExcludedShell:
    """A connected piece of the surface; its volume is negative for the wall of a cavity. Å², Å³."""

    area: float
    volume: float
    euler_characteristic: int
    genus: int


@dataclass(frozen=True)
class AccessibleComponent:
    """A connected piece of the accessible surface, and the area of what is over it. Å², Å³."""

    accessible_area: float
    accessible_volume: float
    is_cavity: bool
    excluded_area: float


@dataclass(frozen=True)
class ExcludedTopology:
    """Shells of a solvent-excluded surface: outer ones, then walls of cavities, by volume."""

    euler_characteristic: int
    cavities: int
    shells: tuple[ExcludedShell, ...]
    components: tuple[AccessibleComponent, ...]


@dataclass(frozen=True)
class ExcludedSurface:
    """Area and volume of a solvent-excluded surface, from its geometry, without a mesh.

    Attributes
    ----------
    area, volume : float
        Å², and Å³ of the solid that no probe reaches.
    contact_area, saddle_area, concave_area : float
        Parts of the area, Å².
    accessible_area, accessible_volume : float
        Of the balls grown by the probe, Å², Å³.
    topology : ExcludedTopology or None
        None where it was not asked for.
    euler_characteristic : int or None
        That of the topology; a device knows it without the shells.
    probes, low_probes, crowded_probes : int
        Probes that touch three or more atoms; those nearer than their radius to the plane of three;
        those that touch more than three.
    closure, check_volume : float
        \\|∫ n dA\\| / area; a second volume by other formulas, Å³.
    extended_decisions, ties, uncertified_patches : int
        Concave patches that needed more than double, those of them with a tie, and those whose
        boundary did not close: 0 if the result is certified.
    """

    area: float
    volume: float
    contact_area: float
    saddle_area: float
    concave_area: float
    accessible_area: float
    accessible_volume: float
    topology: ExcludedTopology | None
    euler_characteristic: int | None
    probes: int
    low_probes: int
    crowded_probes: int
    closure: float
    check_volume: float
    extended_decisions: int
    ties: int
    uncertified_patches: int


@dataclass(frozen=True, eq=False, repr=False)
class ExcludedGradient(Brief):
    """Exact derivatives of area and volume of the complete surface.

    Attributes
    ----------
    area_coords : ndarray of float64, shape (N, 3)
        Of the area by each centre, Å.
    area_radii : ndarray of float64, shape (N,)
        By each radius, Å, while the probe keeps its own.
    volume_coords, volume_radii : ndarray of float64, shapes (N, 3) and (N,)
        Of the volume, Å².
    area_probe, volume_probe : float
        By the radius of the probe, Å and Å².
    kink_probes, kink_atoms : int
        Probes that touch more than three atoms or lie in their plane, and atoms equal to others: they
        may have no derivative, and get a finite one.
    """

    area_coords: Floats
    area_radii: Floats
    volume_coords: Floats
    volume_radii: Floats
    area_probe: float
    volume_probe: float
    kink_probes: int
    kink_atoms: int

    @classmethod
    def _of(cls, rows: Any, *others: Any) -> ExcludedGradient:
        table = view(rows)
        return cls(table[:, :3], table[:, 3], table[:, 4:7], table[:, 7], *others)


@dataclass(frozen=True, eq=False, repr=False)
class ExcludedMeasures(Brief, ExcludedSurface):
    """The complete surface with its cavities, the shares of atoms in it, and the exterior surface.

    Attributes
    ----------
    probe : float
        Å.
    exterior : ExcludedSurface or None
        The surface of the solid with its cavities filled up; None from a device.
    atom_area, atom_volume : ndarray of float64, shape (N,)
        Å², Å³; they sum to area and volume.
    atom_contact_area, atom_saddle_area, atom_concave_area : ndarray of float64, shape (N,)
        Å².
    gradient : ExcludedGradient or None
        None where it was not asked for.
    """

    probe: float
    exterior: ExcludedSurface | None
    atom_area: Floats
    atom_contact_area: Floats
    atom_saddle_area: Floats
    atom_concave_area: Floats
    atom_volume: Floats
    gradient: ExcludedGradient | None


def measure_excluded(
    centers: Any,
    sizes: Any,
    probe: Any,
    topology: Any,
    threads: Any,
    device: str,
    gradient: bool = False,
    **others: Any,
) -> ExcludedMeasures:
    """The excluded surface of atoms that have been brought into form."""
    options = {"probe": given_number("probe", probe), "topology": topology_name(topology), **others}
    complete, exterior, rows, slopes = _core.excluded(
        centers, sizes, thread_count(threads), device, gradient, surface="ses", **options
    )
    shares = view(rows)
    area = shares[:, :3].sum(axis=1)
    area.flags.writeable = False
    return ExcludedMeasures(
        **_surface(complete),
        probe=_core.probe_of("ses", options["probe"]),
        exterior=None if exterior is None else ExcludedSurface(**_surface(exterior)),
        atom_area=area,
        atom_contact_area=shares[:, 0],
        atom_saddle_area=shares[:, 1],
        atom_concave_area=shares[:, 2],
        atom_volume=shares[:, 3],
        gradient=None if slopes is None else ExcludedGradient._of(*slopes),
    )


def _surface(found: dict[str, Any]) -> dict[str, Any]:
    """The members of a surface, its topology as the class of its own."""
    given = found["topology"]
    topology = None
    if given is not None:
        topology = ExcludedTopology(
            given["euler_characteristic"],
            given["cavities"],
            tuple(ExcludedShell(*row) for row in given["shells"]),
            tuple(AccessibleComponent(*row) for row in given["components"]),
        )
    return {**found, "topology": topology}
