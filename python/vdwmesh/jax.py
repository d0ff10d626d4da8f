"""Exact areas and volumes of atoms as functions of JAX, which this module imports."""

from __future__ import annotations

from functools import partial
from importlib import import_module
from typing import Any

import numpy as np

from vdwmesh._batch import exact_many, pulled_back, set_offsets

jax: Any = import_module("jax")  # types are not checked, whether it is installed or not

__all__ = ["areas", "measures", "volumes"]


def measures(
    coords: Any, radii: Any, *, probe: float = 0.0, threads: int | None = None, offsets: Any = None
) -> tuple[Any, Any]:
    """Exact area and volume of every atom, with exact derivatives by coordinates and radii.

    The host computes them in double precision, also within `jax.jit` and one after another within
    `jax.vmap`. The backward pass measures again, with the cotangents as weights. There is neither
    forward mode nor a second derivative, which is infinite where two circles of a sphere touch.
    Needs JAX 0.4.34 or newer.

    Parameters
    ----------
    coords : Array, shape (N, 3) or (T, N, 3)
        Centres, Å; of one set, of many (see `offsets`), or of the same atoms in T frames.
    radii : Array, shape (N,)
        Å.
    probe : float
        Added to every radius, Å.
    threads : int, optional
        At most so many; all cores by default.
    offsets : sequence of int, shape (B + 1,), optional
        As of `exact_many`: where each of B sets begins, which do not see each other, and the end. Not
        traced.

    Returns
    -------
    areas, volumes : Array, shape (N,) or (T, N)
        Å², Å³, as of `exact`, of the type to which JAX promotes those of coordinates and radii:
        float64 needs ``jax.config.update("jax_enable_x64", True)``.

    Examples
    --------
    >>> import jax, vdwmesh.jax
    >>> coords = jax.numpy.array([[0.0, 0, 0], [1, 0, 0]])
    >>> slope = jax.grad(lambda x: vdwmesh.jax.areas(x, jax.numpy.ones(2)).sum())(coords)
    >>> round(float(slope[1, 0]) / jax.numpy.pi, 5)  # the area is 2 pi (2 + d)
    2.0
    """
    coords, radii = jax.numpy.asarray(coords), jax.numpy.asarray(radii)
    starts = set_offsets(coords.shape, radii.shape, offsets)
    shape = coords.shape[:-1]
    sizes = jax.numpy.broadcast_to(radii, shape).reshape(-1)
    kind = jax.numpy.result_type(coords, radii, jax.numpy.float32)
    places = coords.reshape(-1, 3).astype(kind)
    areas, volumes = _measures(places, sizes.astype(kind), starts, float(probe), threads)
    return areas.reshape(shape), volumes.reshape(shape)


def areas(coords: Any, radii: Any, **options: Any) -> Any:
    """The areas of `measures`, which has the same options."""
    return measures(coords, radii, **options)[0]


def volumes(coords: Any, radii: Any, **options: Any) -> Any:
    """The volumes of `measures`, which has the same options."""
    return measures(coords, radii, **options)[1]


def _double(*arrays: Any) -> list[Any]:
    return [np.asarray(array, dtype=np.float64) for array in arrays]


def _measured(offsets: Any, probe: float, threads: int | None, coords: Any, radii: Any) -> tuple[Any, Any]:
    places, sizes = _double(coords, radii)
    found = exact_many(places, sizes, offsets, probe=probe, threads=threads, device="cpu")
    return found.atom_area.astype(radii.dtype), found.atom_volume.astype(radii.dtype)


def _pulled_back(
    offsets: Any, probe: float, threads: int | None, coords: Any, radii: Any, area_grads: Any, volume_grads: Any
) -> tuple[Any, Any]:
    places, sizes, *weights = _double(coords, radii, area_grads, volume_grads)
    by_coords, by_radii = pulled_back(
        places, sizes, offsets, (weights[0], weights[1]), probe=probe, threads=threads, device="cpu"
    )
    return by_coords.astype(radii.dtype), by_radii.astype(radii.dtype)


def _on_host(function: Any, like: Any, *arrays: Any) -> Any:
    """Calls the function with arrays of NumPy; results are of the shapes and types of those in `like`."""
    shapes = tuple(jax.ShapeDtypeStruct(array.shape, array.dtype) for array in like)
    return jax.pure_callback(function, shapes, *arrays, vmap_method="sequential")


def _value(coords: Any, radii: Any, *call: Any) -> Any:
    return _on_host(partial(_measured, *call), (radii, radii), coords, radii)


def _forward(coords: Any, radii: Any, *call: Any) -> Any:
    return _value(coords, radii, *call), (coords, radii)


def _backward(offsets: Any, probe: float, threads: int | None, saved: Any, cotangents: Any) -> Any:
    return _on_host(partial(_pulled_back, offsets, probe, threads), saved, *saved, *cotangents)


_measures: Any = jax.custom_vjp(_value, nondiff_argnums=(2, 3, 4))
_measures.defvjp(_forward, _backward)
