#!/usr/bin/env python3
"""Times a loss of all areas and volumes and its backward pass by vdwmesh.torch, on the CPU and on the CUDA device.

    bench/torch_bench.py SPHERES.xyzr [COPIES]

Copies stand side by side, 100 Å apart; the probe has 1.4 Å. Medians of wall times in ms. Beside them `vdwmesh.exact()` with
gradients of arrays that lie on the device.
"""

import statistics
import sys
import time

import numpy as np
import torch
import vdwmesh
import vdwmesh.torch

RUNS = 15


def median_ms(work):
    times = []
    for _ in range(RUNS):
        torch.cuda.synchronize()
        begin = time.perf_counter()
        work()
        torch.cuda.synchronize()
        times.append(1e3 * (time.perf_counter() - begin))
    return statistics.median(times)


def main():
    balls = np.loadtxt(sys.argv[1])
    copies = int(sys.argv[2]) if len(sys.argv) > 2 else 1
    coords, radii = np.tile(balls[:, :3], (copies, 1)), np.tile(balls[:, 3], copies)
    coords[:, 0] += 100.0 * np.repeat(np.arange(copies), len(balls))
    for place in ("cpu", "cuda"):
        x, r = torch.tensor(coords, device=place, requires_grad=True), torch.tensor(radii, device=place)

        def loss(x=x, r=r):
            areas, volumes = vdwmesh.torch.measures(x, r, probe=1.4)
            (areas.sum() + volumes.sum()).backward()
            x.grad = None

        print(f"{len(radii)} atoms, {place}: loss and backward pass {median_ms(loss):.2f} ms")
    x, r = x.detach(), r.detach()
    exact = median_ms(lambda: vdwmesh.exact(x, r, probe=1.4, gradient=True))
    print(f"{len(radii)} atoms, cuda: exact(gradient=True) {exact:.2f} ms")


if __name__ == "__main__":
    main()
