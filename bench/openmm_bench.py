"""ExactAreaForce of OpenMM on ubiquitin with hydrogens (1,231 atoms, amber14, no cutoff, no constraints).

    PYTHONPATH=build/release/python:tests/python python3 bench/openmm_bench.py forces
    PYTHONPATH=build/release/python:tests/python python3 bench/openmm_bench.py speed [--threads N] [--seconds S]
    PYTHONPATH=build/release/python:tests/python python3 bench/openmm_bench.py energy [--picoseconds P] [--step FS]
        [--seed N] [--whole] [--energies FILE.csv]

`forces` compares forces with differences of the energy; `speed` times evaluations of forces and energy, in turn, beside the
generalised Born force of OpenMM and its ACE approximation of the area; `energy` runs at constant energy with the force
and without it, both from the same places and velocities at 300 K, and prints how the total energies drift. Charges there
have a cutoff of 1 nm, which takes a tenth of the time; --whole leaves them whole.
"""

import argparse
import copy
import os
import time

import numpy as np
import openmm
import vdwmesh
from openmm import unit
from openmm.app.internal.customgbforces import GBSAOBC2Force
from openmm_systems import ubiquitin
from vdwmesh.openmm import ExactAreaForce

PROBE = 0.14  # nm
TENSION = 2.25936  # kJ/mol/nm², what OpenMM's ACE uses by default
KT = 2.494339  # kJ/mol, at 300 K


def area_force(topology):
    force = ExactAreaForce()
    for radius in vdwmesh.radii_of([atom.element.symbol for atom in topology.atoms()]):
        force.addParticle(radius * unit.angstrom, TENSION)
    force.setProbeRadius(PROBE)
    return force


def charges(system):
    force = next(one for one in system.getForces() if isinstance(one, openmm.NonbondedForce))
    return [force.getParticleParameters(i)[0] for i in range(system.getNumParticles())]


def born_force(system, topology, tension):
    force = openmm.GBSAOBCForce()
    force.setSurfaceAreaEnergy(tension)
    for charge, parameters in zip(charges(system), GBSAOBC2Force.getStandardParameters(topology)):
        force.addParticle(charge, *parameters[:2])
    return force


def custom_born_force(system, topology):
    force = GBSAOBC2Force(SA="ACE")
    for charge, parameters in zip(charges(system), GBSAOBC2Force.getStandardParameters(topology)):
        force.addParticle([charge, *parameters[:2]])
    force.finalize()
    return force


def in_context(system, positions, threads, step=0.001):
    integrator = openmm.VerletIntegrator(step)
    context = openmm.Context(system, integrator, openmm.Platform.getPlatformByName("CPU"), {"Threads": str(threads)})
    context.setPositions(positions)
    return context, integrator


def total_energy(context):
    state = context.getState(getEnergy=True)
    return (state.getPotentialEnergy() + state.getKineticEnergy()).value_in_unit(unit.kilojoule_per_mole)


def compare_forces(system, topology, positions, threads):
    alone = openmm.System()
    for _ in range(system.getNumParticles()):
        alone.addParticle(1)
    alone.addForce(area_force(topology))
    context, _ = in_context(alone, positions, threads)
    places, step, worst = np.array(positions._value), 1e-6, 0.0
    forces = context.getState(getForces=True).getForces(asNumpy=True)._value
    for atom in range(0, len(places), 10):
        for axis in range(3):
            values = []
            for sign in (1, -1):
                moved = places.copy()
                moved[atom, axis] += sign * step
                context.setPositions(moved)
                values.append(context.getState(getEnergy=True).getPotentialEnergy()._value)
            worst = max(worst, abs(forces[atom, axis] + (values[0] - values[1]) / (2 * step)))
    print(f"forces: rms {np.sqrt((forces**2).mean()):.3f} kJ/mol/nm, largest difference from differences {worst:.1e}, "
          f"sum {np.abs(forces.sum(axis=0)).max():.1e}")  # fmt: skip


def compare_speed(system, topology, positions, threads, seconds):
    kinds = {
        "amber14 alone": [],
        "and ExactAreaForce": [area_force(topology)],
        "and GBSAOBCForce without ACE": [born_force(system, topology, 0)],
        "and GBSAOBCForce with ACE": [born_force(system, topology, TENSION)],
        "and CustomGBForce (OBC2) with ACE": [custom_born_force(system, topology)],
    }
    contexts, times = {}, {}
    for name, forces in kinds.items():
        more = copy.deepcopy(system)
        for force in forces:
            more.addForce(force)
        contexts[name], times[name] = in_context(more, positions, threads), []
        contexts[name][1].step(2)
    end = time.monotonic() + seconds
    while time.monotonic() < end:
        for name, (_, integrator) in contexts.items():
            begin = time.perf_counter()
            integrator.step(1)
            times[name].append(time.perf_counter() - begin)
    for name, all_times in times.items():
        print(f"{name:36} least {1e3 * min(all_times):8.2f} ms, median {1e3 * np.median(all_times):8.2f} ms a step, "
              f"{1 / min(all_times):6.1f} steps/s, {len(all_times)} steps")  # fmt: skip


def with_cut_charges(system):
    for force in system.getForces():
        if isinstance(force, openmm.NonbondedForce):
            force.setNonbondedMethod(openmm.NonbondedForce.CutoffNonPeriodic)
            force.setUseSwitchingFunction(True)
            force.setSwitchingDistance(0.9)


def start_at(system, positions, threads, seed):
    """Minimised, then brought to 300 K by a thermostat over 5 ps, without the force."""
    integrator = openmm.LangevinMiddleIntegrator(300, 5, 0.001)
    integrator.setRandomNumberSeed(seed)
    options = {"Threads": str(threads), "DeterministicForces": "true"}
    context = openmm.Context(system, integrator, openmm.Platform.getPlatformByName("CPU"), options)
    context.setPositions(positions)
    openmm.LocalEnergyMinimizer.minimize(context, 10, 200)
    context.setVelocitiesToTemperature(300, seed)
    integrator.step(5000)
    return context.getState(getPositions=True, getVelocities=True)


def drift_of(energies, freedom):
    """The slope of a line through the energies (kJ/mol/ps), its error from the means of ten blocks, the scatter about it."""
    times = 0.1 * np.arange(1, len(energies) + 1)
    line = np.polyfit(times, energies, 1)
    rest = energies - np.polyval(line, times)
    blocks = np.array([block.mean() for block in np.array_split(rest, 10)])
    middles = np.array([block.mean() for block in np.array_split(times, 10)])
    error = np.sqrt((blocks**2).sum() / 8 / ((middles - middles.mean()) ** 2).sum())
    return line[0], error, rest.std(), 1000 * line[0] / freedom / KT


def compare_drift(system, topology, positions, asked):
    """Both runs in turn, 0.1 ps each, so that they see the same load; energies go to a file, if one is named."""
    if not asked.whole:
        with_cut_charges(system)
    start = start_at(system, positions, asked.threads, asked.seed)
    with_area = copy.deepcopy(system)
    with_area.addForce(area_force(topology))
    runs = {name: in_context(one, positions, asked.threads, asked.step / 1000)
            for name, one in (("without", system), ("with", with_area))}  # fmt: skip
    for context, _ in runs.values():
        context.setPositions(start.getPositions())
        context.setVelocities(start.getVelocities())
    rows, freedom = [], 3 * system.getNumParticles() - 3
    with open(asked.energies or os.devnull, "w", encoding="ascii") as file:
        print("ps," + ",".join(runs), file=file)
        for tenth in range(1, 10 * asked.picoseconds + 1):
            for _, integrator in runs.values():
                integrator.step(round(100 / asked.step))
            rows.append([total_energy(context) for context, _ in runs.values()])
            print(f"{tenth / 10}," + ",".join(f"{energy:.6f}" for energy in rows[-1]), file=file, flush=True)
    for name, energies in zip(runs, np.transpose(rows)):
        slope, error, scatter, per_freedom = drift_of(energies, freedom)
        print(f"seed {asked.seed}, {asked.picoseconds} ps, {name}: drift {slope:.4f} +- {error:.4f} kJ/mol/ps, {per_freedom:.5f} kT/ns "
              f"a degree of freedom, scatter about it {scatter:.3f} kJ/mol of {energies.mean():.1f}", flush=True)  # fmt: skip


def main():
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("what", choices=("forces", "speed", "energy"))
    parser.add_argument("--threads", type=int, default=1)
    parser.add_argument("--seconds", type=float, default=60)
    parser.add_argument("--picoseconds", type=int, default=100)
    parser.add_argument("--step", type=float, default=1.0, help="femtoseconds")
    parser.add_argument("--seed", type=int, default=1)
    parser.add_argument("--whole", action="store_true", help="charges of the run at constant energy have no cutoff")
    parser.add_argument("--energies", metavar="FILE.csv", help="write the total energies of both runs, every 0.1 ps")
    asked = parser.parse_args()
    modeller, system = ubiquitin()
    given = system, modeller.topology, modeller.positions, asked.threads
    if asked.what == "forces":
        compare_forces(*given)
    elif asked.what == "speed":
        compare_speed(*given, asked.seconds)
    else:
        compare_drift(system, modeller.topology, modeller.positions, asked)


if __name__ == "__main__":
    main()
