"""Meshes as objects of other packages, which are imported when they are asked for."""

from __future__ import annotations

from importlib import import_module
from typing import TYPE_CHECKING, Any

import numpy as np

if TYPE_CHECKING:
    from vdwmesh._mesh import Mesh


def to_trimesh(mesh: Mesh) -> Any:
    """Vertices are not merged (trimesh#222: process=False), so that they keep their order."""
    trimesh = import_module("trimesh")

    return trimesh.Trimesh(
        vertices=np.array(mesh.vertices),
        faces=mesh.faces.astype(np.int64),
        vertex_normals=None if mesh.normals is None else np.array(mesh.normals, np.float64),
        vertex_attributes=_given(atom=mesh.vertex_atoms),
        face_attributes=_given(atom=mesh.face_atoms),
        process=False,
    )


def to_pyvista(mesh: Mesh) -> Any:
    """PyVista's faces are one list: the number of corners of each, then the corners."""
    pyvista = import_module("pyvista")

    corners = np.full((len(mesh.faces), 4), 3, np.int64)
    corners[:, 1:] = mesh.faces
    surface = pyvista.PolyData(np.array(mesh.vertices), corners.ravel())
    if mesh.normals is not None:
        surface.point_data["Normals"] = np.array(mesh.normals)
    for name, array in _given(atom=mesh.vertex_atoms).items():
        surface.point_data[name] = array
    for name, array in _given(atom=mesh.face_atoms).items():
        surface.cell_data[name] = array
    return surface


def to_meshio(mesh: Mesh) -> Any:
    """Atoms are point data and cell data of the name "atom"."""
    meshio = import_module("meshio")

    points = {} if mesh.normals is None else {"normals": np.array(mesh.normals)}
    points.update(_given(atom=mesh.vertex_atoms))
    cells = {name: [array] for name, array in _given(atom=mesh.face_atoms).items()}
    return meshio.Mesh(
        np.array(mesh.vertices),
        [("triangle", mesh.faces.astype(np.int64))],
        point_data=points,
        cell_data=cells,
    )


def to_open3d(mesh: Mesh) -> Any:
    """Open3D has no place for atoms."""
    open3d = import_module("open3d")

    surface = open3d.geometry.TriangleMesh(
        open3d.utility.Vector3dVector(np.array(mesh.vertices)),
        open3d.utility.Vector3iVector(mesh.faces.astype(np.int32)),
    )
    if mesh.normals is not None:
        surface.vertex_normals = open3d.utility.Vector3dVector(np.array(mesh.normals, np.float64))
    return surface


def _given(**arrays: Any) -> dict[str, Any]:
    return {name: array.astype(np.int64) for name, array in arrays.items() if array is not None}
