// A store in which calls of the library keep memory and results for later calls.
#pragma once

#include <memory>
#include <typeindex>
#include <typeinfo>
#include <unordered_map>

namespace vdwmesh {

// A caller that calls the library many times, for example for the frames of a trajectory, passes
// the same Workspace to every call. Search structures and arrays then stay in memory, and results
// for the same spheres are not computed again. Results are the same, bit for bit, with and without
// a workspace.
//
// A workspace serves one call at a time; calls that run at the same time need one each. It may be
// passed to different functions of the library in turn. Its device memory belongs to the CUDA
// device that was current when the workspace was first used; a thread that changes to another
// device needs another workspace.
class Workspace {
 public:
  Workspace() = default;
  Workspace(const Workspace&) = delete;
  Workspace& operator=(const Workspace&) = delete;

  // Frees all that is kept.
  void clear() { kept_.clear(); }

  // For the library: returns the one object of type T that this workspace keeps. The first call for
  // a type makes the object by T().
  template <class T>
  T& get() {
    std::shared_ptr<void>& kept = kept_[typeid(T)];
    if (!kept) kept = std::make_shared<T>();
    return *static_cast<T*>(kept.get());
  }

 private:
  std::unordered_map<std::type_index, std::shared_ptr<void>> kept_;
};

// The workspace that a call uses: the caller's, or its own, which ends with the call, if the caller
// passed none (null).
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
