// vdwmesh.openmm: ExactAreaForce for OpenMM's package for Python, beside which SWIG puts it. Numbers
// with units are converted; plain ones are in nm, kJ/mol/nm² and kJ/mol/nm³.
%module(package="vdwmesh") openmm

%{
#include <OpenMM.h>

#include "exact_area_force.hpp"
%}

%include "typemaps.i"
%import(module="openmm.openmm") "openmm_base.i"

%pythoncode %{
import openmm.unit as _unit

__all__ = ["ExactAreaForce"]

_TENSION = _unit.kilojoule_per_mole / _unit.nanometer**2
_PRESSURE = _unit.kilojoule_per_mole / _unit.nanometer**3


def _in_unit(value, unit):
    """The number; of a pressure also in bar and its like."""
    if not _unit.is_quantity(value):
        return value
    if unit is _PRESSURE and value.unit.is_compatible(_unit.bar):
        return (value * _unit.AVOGADRO_CONSTANT_NA).value_in_unit(unit)
    return value.value_in_unit(unit)
%}

// As OpenMM's own functions.
%exception {
  try {
    $action
  } catch (const std::exception& error) {
    PyObject* package = PyImport_ImportModule("openmm");
    PyObject* type = package ? PyObject_GetAttrString(package, "OpenMMException") : nullptr;
    if (type) PyErr_SetString(type, error.what());
    Py_XDECREF(type);
    Py_XDECREF(package);
    SWIG_fail;
  }
}

%feature("docstring") vdwmesh::ExactAreaForce
"The exact surface area and volume of a union of balls: E = sum of gamma_i A_i + P V.

Forces are exact derivatives, without a cutoff. Add it to a System as any Force of OpenMM, with a
call of addParticle(radius, surfaceTension) or addParticleWithoutBall() for each particle. Plain
numbers are in nm, kJ/mol/nm² and kJ/mol/nm³; quantities with units are converted."

%feature("autodoc", "1");
%apply double& OUTPUT { double& radius, double& surfaceTension };

%pythonprepend vdwmesh::ExactAreaForce::addParticle %{
        radius, surfaceTension = _in_unit(radius, _unit.nanometer), _in_unit(surfaceTension, _TENSION)
%}
%pythonprepend vdwmesh::ExactAreaForce::setParticleParameters %{
        radius, surfaceTension = _in_unit(radius, _unit.nanometer), _in_unit(surfaceTension, _TENSION)
%}
%pythonappend vdwmesh::ExactAreaForce::getParticleParameters %{
        val = [val[0] * _unit.nanometer, val[1] * _TENSION]
%}
%pythonprepend vdwmesh::ExactAreaForce::setProbeRadius %{
        radius = _in_unit(radius, _unit.nanometer)
%}
%pythonappend vdwmesh::ExactAreaForce::getProbeRadius %{
        val = val * _unit.nanometer
%}
%pythonprepend vdwmesh::ExactAreaForce::setPressure %{
        pressure = _in_unit(pressure, _PRESSURE)
%}
%pythonappend vdwmesh::ExactAreaForce::getPressure %{
        val = val * _PRESSURE
%}

namespace vdwmesh {

class ExactAreaForce : public OpenMM::Force {
 public:
  enum PeriodicMethod { RefusePeriodic = 0, IgnoreImages = 1 };
  ExactAreaForce();
  int addParticle(double radius, double surfaceTension);
  int addParticleWithoutBall();
  int getNumParticles() const;
  bool hasBall(int index) const;
  void getParticleParameters(int index, double& radius, double& surfaceTension) const;
%clear double& radius, double& surfaceTension;
  void setParticleParameters(int index, double radius, double surfaceTension);
  double getProbeRadius() const;
  void setProbeRadius(double radius);
  double getPressure() const;
  void setPressure(double pressure);
  PeriodicMethod getPeriodicMethod() const;
  void setPeriodicMethod(PeriodicMethod method);
  bool usesPeriodicBoundaryConditions() const;
  void updateParametersInContext(OpenMM::Context& context);
  %extend {
    // System.getForce() and XmlSerializer give a plain Force.
    static bool isinstance(OpenMM::Force& force) {
      return dynamic_cast<vdwmesh::ExactAreaForce*>(&force) != nullptr;
    }
    static vdwmesh::ExactAreaForce& cast(OpenMM::Force& force) {
      return dynamic_cast<vdwmesh::ExactAreaForce&>(force);
    }
  }
};

}  // namespace vdwmesh
