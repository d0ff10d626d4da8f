// Memory and results that calls keep for the calls after them.
#pragma once

#include <memory>
#include <typeindex>
#include <typeinfo>
#include <unordered_map>

namespace vdwmesh {

// Whoever calls the library many times, as for the frames of a trajectory, hands the same Workspace
// to every call: search structures and arrays then stay in memory, and what was computed for the
// same spheres is not computed again. Results are the same, bit for bit, with and without one.
//
// A workspace serves one call at a time; calls that run at once need one each. It may be handed to
// different functions of the library in turn. Device memory in it belongs to the device on which it
// was used first: a thread that changes devices takes another workspace.
class Workspace {
 public:
  Workspace() = default;
  Workspace(const Workspace&) = delete;
  Workspace& operator=(const Workspace&) = delete;

  // Frees all that is kept.
  void clear() { kept_.clear(); }

  // For the library: the one T that this workspace keeps, made by T() when it is first asked for.
  template <class T>
  T& get() {
    std::shared_ptr<void>& kept = kept_[typeid(T)];
    if (!kept) kept = std::make_shared<T>();
    return *static_cast<T*>(kept.get());
  }

 private:
  std::unordered_map<std::type_index, std::shared_ptr<void>> kept_;
};

// The workspace that options name, or one for this call alone.
class WorkspaceOfCall {
 public:
  explicit WorkspaceOfCall(Workspace* given) : used_(given != nullptr ? given : &own_) {}
  operator Workspace&() { return *used_; }
  template <class T>
  T& get() {
    return used_->get<T>();
  }

 private:
  Workspace own_;
  Workspace* used_;
};

}  // namespace vdwmesh
