"""ExactAreaForce of OpenMM on ubiquitin with hydrogens (1,231 atoms, amber14, no cutoff, no constraints).

    PYTHONPATH=build/release/python:tests/python python3 bench/openmm_bench.py forces
    PYTHONPATH=build/release/python:tests/python python3 bench/openmm_bench.py speed [--threads N] [--seconds S]
    PYTHONPATH=build/release/python:tests/python python3 bench/openmm_bench.py energy [--picoseconds P] [--step FS]

`forces` compares forces with differences of the energy; `speed` times evaluations of forces and energy, in turn, beside the
generalised Born force of OpenMM and its ACE approximation of the area; `energy` runs at constant energy with the force
and without it, both from 300 K, and prints how the total energies drift. Charges there have a cutoff of 1 nm, which takes
a tenth of the time.
"""

import argparse
import copy
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


def compare_drift(system, topology, positions, threads, picoseconds, step):
    """Both runs in turn, a picosecond each, so that they see the same load; a line after every fifth one."""
    for force in system.getForces():
        if isinstance(force, openmm.NonbondedForce):
            force.setNonbondedMethod(openmm.NonbondedForce.CutoffNonPeriodic)
            force.setUseSwitchingFunction(True)
            force.setSwitchingDistance(0.9)
    with_area = copy.deepcopy(system)
    with_area.addForce(area_force(topology))
    runs = {"without": in_context(system, positions, threads, step / 1000),
            "with": in_context(with_area, positions, threads, step / 1000)}  # fmt: skip
    for context, integrator in runs.values():
        openmm.LocalEnergyMinimizer.minimize(context, 10, 200)
        context.setVelocitiesToTemperature(300, 5)
        integrator.step(round(1000 / step))  # until kinetic and potential energy have mixed
    energies = {name: [] for name in runs}
    freedom, chunk = 3 * system.getNumParticles() - 3, round(100 / step)
    for picosecond in range(1, picoseconds + 1):
        for name, (context, integrator) in runs.items():
            for _ in range(10):
                integrator.step(chunk)
                energies[name].append(total_energy(context))
        if picosecond % 5 and picosecond != picoseconds:
            continue
        for name, found in energies.items():
            times = 0.1 * np.arange(1, len(found) + 1)
            slope, _ = np.polyfit(times, found, 1)
            rest = np.std(found - np.polyval(np.polyfit(times, found, 1), times))
            print(f"{picosecond} ps, {name}: drift {slope:.4f} kJ/mol/ps, {1000 * slope / freedom / KT:.5f} kT/ns a degree of "
                  f"freedom, scatter about it {rest:.3f} kJ/mol of {np.mean(found):.1f}", flush=True)  # fmt: skip


def main():
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("what", choices=("forces", "speed", "energy"))
    parser.add_argument("--threads", type=int, default=1)
    parser.add_argument("--seconds", type=float, default=60)
    parser.add_argument("--picoseconds", type=int, default=100)
    parser.add_argument("--step", type=float, default=1.0, help="femtoseconds")
    asked = parser.parse_args()
    modeller, system = ubiquitin()
    given = system, modeller.topology, modeller.positions, asked.threads
    if asked.what == "forces":
        compare_forces(*given)
    elif asked.what == "speed":
        compare_speed(*given, asked.seconds)
    else:
        compare_drift(*given, asked.picoseconds, asked.step)


if __name__ == "__main__":
    main()
