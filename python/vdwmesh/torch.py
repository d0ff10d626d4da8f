"""Exact areas and volumes of atoms as functions of PyTorch, which this module imports."""

from __future__ import annotations

from importlib import import_module
from typing import Any

import numpy as np

from vdwmesh._batch import exact_many, pulled_back, set_offsets
from vdwmesh._derivatives import rates

torch: Any = import_module("torch")  # types are not checked, whether it is installed or not
once_differentiable = torch.autograd.function.once_differentiable

__all__ = ["areas", "measures", "volumes"]


def measures(
    coords: Any, radii: Any, *, probe: float = 0.0, threads: int | None = None, offsets: Any = None
) -> tuple[Any, Any]:
    """Exact area and volume of every atom, with exact derivatives by coordinates and radii.

    Tensors on a CUDA device are measured there, where their gradients are too. The backward pass
    measures again, with the incoming gradients as weights; forward mode (``torch.autograd.forward_ad``,
    ``torch.func.jvp``) does so along the tangents. There is no second derivative: it is infinite where
    two circles of a sphere touch.

    Parameters
    ----------
    coords : Tensor, shape (N, 3) or (T, N, 3)
        Centres, Å; of one set, of many (see `offsets`), or of the same atoms in T frames. Numbers of
        other types than float64 are converted, and gradients back.
    radii : Tensor, shape (N,)
        Å.
    probe : float
        Added to every radius, Å.
    threads : int, optional
        At most so many; all cores by default.
    offsets : sequence of int, shape (B + 1,), optional
        As of `exact_many`: where each of B sets begins, which do not see each other, and the end.

    Returns
    -------
    areas, volumes : Tensor of float64, shape (N,) or (T, N)
        Å², Å³, as of `exact`.

    Examples
    --------
    >>> import torch, vdwmesh.torch
    >>> coords = torch.tensor([[0.0, 0, 0], [1, 0, 0]], dtype=torch.float64, requires_grad=True)
    >>> vdwmesh.torch.areas(coords, torch.ones(2)).sum().backward()
    >>> round(float(coords.grad[1, 0]) / torch.pi, 9)  # the area is 2 pi (2 + d)
    2.0
    """
    given = offsets.tolist() if isinstance(offsets, torch.Tensor) else offsets
    starts = set_offsets(tuple(coords.shape), tuple(radii.shape), given)
    shape = coords.shape[:-1]
    sizes = radii.expand(shape).reshape(-1)
    areas, volumes = _Measures.apply(coords.reshape(-1, 3), sizes, starts, probe, threads)
    return areas.reshape(shape), volumes.reshape(shape)


def areas(coords: Any, radii: Any, **options: Any) -> Any:
    """The areas of `measures`, which has the same options."""
    return measures(coords, radii, **options)[0]


def volumes(coords: Any, radii: Any, **options: Any) -> Any:
    """The volumes of `measures`, which has the same options."""
    return measures(coords, radii, **options)[1]


def _array(tensor: Any) -> Any:
    return tensor.detach().to("cpu", torch.float64).numpy()


def _there(tensor: Any, device: Any) -> Any:
    return tensor.detach().to(device, torch.float64).contiguous()


def _tensor(array: Any, device: Any) -> Any:
    """A copy, to which autograd may write, of an array on the host or the device."""
    return torch.tensor(array, device=device) if device.type == "cpu" else torch.as_tensor(array, device=device).clone()


class _Measures(torch.autograd.Function):  # type: ignore[misc]
    @staticmethod
    def forward(
        ctx: Any, coords: Any, radii: Any, offsets: tuple[int, ...], probe: float, threads: int | None
    ) -> tuple[Any, Any]:
        ctx.save_for_backward(coords, radii)
        ctx.save_for_forward(coords, radii)
        ctx.offsets, ctx.options = offsets, {"probe": probe, "threads": threads}
        place = coords.device
        found: Any
        if coords.is_cuda:
            found = exact_many(_there(coords, place), _there(radii, place), offsets, **ctx.options).cuda
        else:
            found = exact_many(_array(coords), _array(radii), offsets, device="cpu", **ctx.options)
        return _tensor(found.atom_area, place), _tensor(found.atom_volume, place)

    @staticmethod
    @once_differentiable  # type: ignore[misc]
    def backward(ctx: Any, area_grads: Any, volume_grads: Any) -> tuple[Any, Any, None, None, None]:
        coords, radii = ctx.saved_tensors
        if coords.is_cuda:
            x, r, *weights = (_there(tensor, coords.device) for tensor in (coords, radii, area_grads, volume_grads))
            found = exact_many(x, r, ctx.offsets, gradient=True, weights=(weights[0], weights[1]), **ctx.options)
            g: Any = found.cuda and found.cuda.gradient
            columns = (g.area_coords, g.area_radii, g.volume_coords, g.volume_radii)
            by_a, by_ar, by_v, by_vr = (_tensor(column, coords.device) for column in columns)
            return (by_a + by_v).to(coords), (by_ar + by_vr).to(radii), None, None, None
        given = (_array(area_grads), _array(volume_grads))
        by_coords, by_radii = pulled_back(
            _array(coords), _array(radii), ctx.offsets, given, device="cpu", **ctx.options
        )
        return torch.tensor(by_coords).to(coords), torch.tensor(by_radii).to(radii), None, None, None

    @staticmethod
    def jvp(ctx: Any, move: Any, growth: Any, *_: Any) -> tuple[Any, Any]:
        coords, radii = ctx.saved_tensors
        arrays = [None if given is None else _array(given) for given in (coords, radii, move, growth)]
        columns = []
        for first, end in zip(ctx.offsets, ctx.offsets[1:]):
            places, sizes, moves, growths = (None if own is None else own[first:end] for own in arrays)
            columns.append(rates(places, sizes, move=moves, growth=growths, **ctx.options))
        areas, volumes = (np.concatenate(column) for column in zip(*columns))
        return torch.tensor(areas, device=coords.device), torch.tensor(volumes, device=coords.device)
