"""The picture of docs/tasks/gradients.md, from the energies that `openmm_bench.py energy --energies` writes.

    PYTHONPATH=build/release/python python3 bench/gradients_figure.py ENERGIES.csv docs/images/gradients.svg

Needs python3-matplotlib and python3-torch. The same energies give the same bytes.
"""

import sys

import matplotlib
import numpy as np
import torch
import vdwmesh.torch

matplotlib.use("svg")
from matplotlib import pyplot

STEPS = 300
BLUE, ORANGE = "#1f5fa8", "#d9730d"
STYLE = {"svg.fonttype": "none", "svg.hashsalt": "vdwmesh", "font.size": 9, "axes.spines.top": False,
         "axes.spines.right": False, "axes.titlesize": 10, "legend.frameon": False, "lines.linewidth": 1.5}  # fmt: skip


def start():
    return np.random.default_rng(1).normal(size=(30, 3)), np.ones(30)


def relaxed():
    """Volume and loss of the page's packing before each of its steps, and behind the last."""
    (x, radii), volumes, losses = start(), [], []
    for _ in range(STEPS + 1):
        union = vdwmesh.exact(x, radii, gradient=True)
        volumes.append(union.volume)
        losses.append((x**2).sum() / 2 - union.volume)
        x -= 0.1 * (x - union.gradient.volume_coords)
    return volumes, losses


def optimised():
    """The same loss, minimised by PyTorch."""
    places, radii = (torch.tensor(array) for array in start())
    places.requires_grad_()
    optimiser, losses = torch.optim.Adam([places], lr=0.1), []
    for _ in range(STEPS + 1):
        optimiser.zero_grad()
        loss = (places**2).sum() / 2 - vdwmesh.torch.volumes(places, radii).sum()
        loss.backward()
        losses.append(float(loss))
        optimiser.step()
    return losses


def draw_packing(axes):
    volumes, losses = relaxed()
    axes[0].plot(volumes, color=BLUE)
    axes[0].set(title="A packing spreads", xlabel="step", ylabel="volume, Å³")
    axes[1].plot(losses, color=BLUE, label="this page's loop")
    axes[1].plot(optimised(), color=ORANGE, linestyle="--", label="torch.optim.Adam")
    axes[1].set(title="The same loss in PyTorch", xlabel="step", ylabel="Σ|x|²/2 − V")
    axes[1].legend()


def draw_energies(axes, path):
    """A band that holds all energies of a picosecond, and a line through their means."""
    table = np.genfromtxt(path, delimiter=",", names=True)
    for name, color, label in (("without", ORANGE, "without"), ("with", BLUE, "with the force")):
        energies = (table[name] - table[name].mean()).reshape(-1, 10)
        middles = table["ps"].reshape(-1, 10).mean(axis=1)
        axes.fill_between(middles, energies.min(axis=1), energies.max(axis=1), color=color, alpha=0.2, linewidth=0)
        axes.plot(middles, energies.mean(axis=1), color=color, linewidth=1, label=label)
    axes.set(title="OpenMM at constant energy", xlabel="ps", ylabel="energy − its mean, kJ/mol")
    axes.set_ylim(top=1.4 * axes.get_ylim()[1])
    axes.legend(ncols=2, loc="upper right", columnspacing=1)


def main():
    energies, picture = sys.argv[1:]
    with pyplot.rc_context(STYLE):
        figure, axes = pyplot.subplots(1, 3, figsize=(8, 2.7), layout="constrained", width_ratios=(3, 3, 4))
        draw_packing(axes)
        draw_energies(axes[2], energies)
        figure.savefig(picture, metadata={"Date": None})


if __name__ == "__main__":
    main()
