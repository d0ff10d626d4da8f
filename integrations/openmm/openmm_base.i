// What the wrapper needs to know of OpenMM, whose own module has these classes.
namespace OpenMM {
class Context;
class System;
class Force {
 public:
  virtual ~Force();
};
}  // namespace OpenMM
