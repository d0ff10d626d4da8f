"""vdwmesh.openmm in OpenMM's package for Python: beside the program, as a Force among others, and what it refuses."""

import copy
import math
import re
import unittest

import numpy as np
import openmm
import openmm.app
import vdwmesh
from openmm import unit
from openmm_systems import alanine_dipeptide, ubiquitin
from program import SOURCE_DIR, ProgramTest
from vdwmesh.openmm import ExactAreaForce

RADII = {"H": 0.12, "C": 0.17, "N": 0.155, "O": 0.152, "S": 0.18}  # nm, Bondi
PROBE = 0.14  # nm
TENSION, PRESSURE = 25.0, 10.0  # kJ/mol/nm², kJ/mol/nm³: enough to be seen beside the other forces


def area_force(topology, tension=TENSION, pressure=PRESSURE):
    force = ExactAreaForce()
    for atom in topology.atoms():
        force.addParticle(RADII[atom.element.symbol], tension)
    force.setProbeRadius(PROBE)
    force.setPressure(pressure)
    return force


def in_context(system, positions, step=0.0005, threads="2"):
    integrator = openmm.VerletIntegrator(step)
    context = openmm.Context(system, integrator, openmm.Platform.getPlatformByName("CPU"), {"Threads": threads})
    context.setPositions(positions)
    return context, integrator


def energies(context, groups=-1):
    state = context.getState(getEnergy=True, groups=groups)
    found = state.getPotentialEnergy(), state.getPotentialEnergy() + state.getKineticEnergy()
    return [energy.value_in_unit(unit.kilojoule_per_mole) for energy in found]


def forces_of(context, groups):
    return context.getState(getForces=True, groups=groups).getForces(asNumpy=True)._value


class UbiquitinTest(ProgramTest):
    @classmethod
    def setUpClass(cls):
        modeller, cls.system = ubiquitin()
        cls.topology, cls.positions = modeller.topology, np.array(modeller.positions._value)
        cls.force = area_force(cls.topology)
        cls.force.setForceGroup(1)
        cls.system.addForce(cls.force)
        cls.context, _ = in_context(cls.system, cls.positions)

    def test_the_energy_is_that_of_the_program(self):
        radii = [RADII[atom.element.symbol] for atom in self.topology.atoms()]
        rows = (" ".join(map(repr, map(float, (*(10 * x), 10 * r)))) for x, r in zip(self.positions, radii))
        exact = self.report("exact", self.file("ubiquitin.xyzr", "\n".join(rows) + "\n"), "--probe", "1.4")["exact"]
        expected = TENSION * exact["area"] / 100 + PRESSURE * exact["volume"] / 1000
        self.assertGreater(len(radii), 1200)
        self.assert_close(energies(self.context, {1})[0], expected, 1e-12)

    def test_forces_are_differences_of_the_energy(self):
        step = 2e-6  # nm
        forces = forces_of(self.context, {1})
        self.assertAlmostEqual(np.abs(forces.sum(axis=0)).max(), 0, delta=1e-9)
        self.addCleanup(self.context.setPositions, self.positions)
        for atom in range(0, len(self.positions), 150):
            moved, values = self.positions.copy(), []
            for sign in (1, -1):
                moved[atom, atom % 3] = self.positions[atom, atom % 3] + sign * step
                self.context.setPositions(moved)
                values.append(energies(self.context, {1})[0])
            slope = (values[0] - values[1]) / (2 * step)
            self.assertAlmostEqual(forces[atom, atom % 3], -slope, delta=1e-4 * (1 + abs(slope)))

    def test_threads_change_nothing(self):
        alone, _ = in_context(self.system, self.positions, threads="1")
        np.testing.assert_array_equal(forces_of(alone, {1}), forces_of(self.context, {1}))
        self.assertEqual(energies(alone, {1})[0], energies(self.context, {1})[0])


class DipeptideTest(unittest.TestCase):
    def setUp(self):
        self.modeller, self.system = alanine_dipeptide()
        self.positions = self.modeller.positions

    def test_minimises(self):
        bare, _ = in_context(copy.deepcopy(self.system), self.positions)
        self.system.addForce(area_force(self.modeller.topology, tension=200))
        context, _ = in_context(self.system, self.positions)
        before = forces_of(context, -1)
        for one in (bare, context):
            openmm.LocalEnergyMinimizer.minimize(one, 0.01)
        self.assertLess(np.abs(forces_of(context, -1)).max(), 0.02 * np.abs(before).max())
        relaxed = bare.getState(getPositions=True).getPositions()
        lowest = energies(context)[0]
        context.setPositions(relaxed)
        self.assertLess(lowest, energies(context)[0] - 0.1)

    def test_runs_at_constant_energy(self):
        """Over 2 ps the total energy scatters by about 0.02 kJ/mol, with the force and without it. With forces a
        hundredth too large it scatters by 0.17."""
        self.system.addForce(area_force(self.modeller.topology, tension=1000, pressure=500))
        context, integrator = in_context(self.system, self.positions, step=0.00025)
        openmm.LocalEnergyMinimizer.minimize(context, 1)
        context.setVelocitiesToTemperature(300, 11)
        totals = []
        for _ in range(80):
            integrator.step(100)
            totals.append(energies(context)[1])
        self.assertLess(np.std(totals), 0.05)

    def test_survives_xml_within_its_system(self):
        force = area_force(self.modeller.topology)
        force.setParticleParameters(3, 1.5 * unit.angstrom, -2 * unit.kilocalorie_per_mole / unit.nanometer**2)
        self.system.addForce(force)
        read = openmm.XmlSerializer.deserialize(openmm.XmlSerializer.serialize(self.system))
        plain = read.getForce(read.getNumForces() - 1)
        self.assertTrue(ExactAreaForce.isinstance(plain))
        self.assertFalse(ExactAreaForce.isinstance(read.getForce(0)))
        again = ExactAreaForce.cast(plain)
        radius, tension = again.getParticleParameters(3)
        self.assertAlmostEqual(radius / unit.nanometer, 0.15, delta=1e-15)
        self.assertAlmostEqual(tension.value_in_unit(unit.kilojoule_per_mole / unit.nanometer**2), -8.368, delta=1e-12)
        self.assertEqual(again.getProbeRadius(), PROBE * unit.nanometer)
        self.assertEqual(
            *(energies(in_context(system, self.positions)[0], {0})[0] for system in (self.system, read))
        )


class PageTest(ProgramTest):
    def test_the_code_of_the_page_runs(self):
        """It ends with an energy that the force has part in."""
        page = (SOURCE_DIR / "docs" / "tasks" / "gradients.md").read_text()
        code = re.search(r"^## A force of OpenMM.*?```python\n(.*?)```", page, re.S | re.M)[1]
        self.assertIn('"protein.pdb"', code)
        modeller, _ = alanine_dipeptide()
        path = self.folder / "protein.pdb"
        with path.open("w") as file:
            openmm.app.PDBFile.writeFile(modeller.topology, modeller.positions, file)
        found = {"vdwmesh": vdwmesh}
        exec(compile(code.replace("protein.pdb", str(path)), "gradients.md", "exec"), found)
        context = found["simulation"].context
        energy = context.getState(getEnergy=True).getPotentialEnergy() / unit.kilojoule_per_mole
        found["force"].setProbeRadius(0)
        found["force"].updateParametersInContext(context)
        changed = context.getState(getEnergy=True).getPotentialEnergy() / unit.kilojoule_per_mole
        self.assertGreater(energy - changed, 1)  # the area with a probe is larger by more than 1 nm²


class OneBallTest(unittest.TestCase):
    def setUp(self):
        self.system, self.force = openmm.System(), ExactAreaForce()
        self.system.addParticle(1.0)
        self.force.addParticle(3.0 * unit.angstrom, 2.0)

    def context(self):
        return in_context(self.system, [openmm.Vec3(0, 0, 0)])[0]

    def test_parameters_change_in_a_context(self):
        self.system.addForce(self.force)
        context = self.context()
        self.assertAlmostEqual(energies(context)[0], 2 * 4 * math.pi * 0.09, places=13)
        self.force.setParticleParameters(0, 0.2, -1.0)
        self.force.setProbeRadius(1 * unit.angstrom)
        self.force.updateParametersInContext(context)
        self.assertAlmostEqual(energies(context)[0], -4 * math.pi * 0.09, places=13)

    def test_pressures_have_units(self):
        self.force.setPressure(1 * unit.bar)
        per_volume = unit.kilojoule_per_mole / unit.nanometer**3
        # 1 bar nm³ is 1e-22 J; Avogadro's number of them 60.2214 J.
        self.assertAlmostEqual(self.force.getPressure().value_in_unit(per_volume), 0.0602214, places=7)
        self.force.setPressure(1 * unit.kilocalorie_per_mole / unit.nanometer**3)
        self.assertAlmostEqual(self.force.getPressure().value_in_unit(per_volume), 4.184, places=12)
        with self.assertRaises(TypeError):
            self.force.setPressure(1 * unit.kelvin)

    def test_refusals(self):
        for change, says in (
            (lambda force: force.setParticleParameters(0, -1.0, 1.0), "particle 0 has the radius"),
            (lambda force: force.setParticleParameters(0, float("nan"), 1.0), "particle 0 has the radius"),
            (lambda force: force.setProbeRadius(-1), "the probe has the radius"),
            (lambda force: force.addParticle(0.1, 1), "has 2 particles, but the System has 1"),
        ):
            force = ExactAreaForce()
            force.addParticle(0.3, 2.0)
            change(force)
            self.system.addForce(force)
            with self.assertRaisesRegex(openmm.OpenMMException, rf"\AExactAreaForce: [^\n]*{says}[^\n]*\Z"):
                self.context()
            self.system.removeForce(0)
        with self.assertRaisesRegex(openmm.OpenMMException, "there is no particle 7"):
            self.force.getParticleParameters(7)

    def test_periodic_boxes(self):
        """Refused, or images are ignored: two balls that touch through the face of the box keep their areas."""
        others = openmm.NonbondedForce()
        others.setNonbondedMethod(openmm.NonbondedForce.CutoffPeriodic)
        for _ in range(2):
            others.addParticle(0, 0.1, 0)
        self.system.addParticle(1.0)
        self.force.addParticle(0.3, 2.0)
        self.system.addForce(others)
        self.system.addForce(self.force)
        self.assertFalse(self.force.usesPeriodicBoundaryConditions())
        with self.assertRaisesRegex(openmm.OpenMMException, "the System is periodic"):
            self.context()
        self.force.setPeriodicMethod(ExactAreaForce.IgnoreImages)
        context, _ = in_context(self.system, [openmm.Vec3(0, 0, 0), openmm.Vec3(1.9, 0, 0)])  # in a box of 2 nm
        self.assertAlmostEqual(energies(context)[0], 2 * 2 * 4 * math.pi * 0.09, places=12)


if __name__ == "__main__":
    unittest.main()
