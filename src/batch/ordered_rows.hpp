// One row for each structure of a source, made side by side and given out in order.
#pragma once

#include <tbb/parallel_pipeline.h>
#include <tbb/task_arena.h>

#include <cstddef>
#include <cstdint>
#include <exception>
#include <optional>
#include <utility>

#include "batch/structure_source.hpp"
#include "core/monitor.hpp"

namespace vdwmesh {

// Makes the rows of the next structures, up to `most`, with so many workers, and returns their
// number. make(structure) is called by any thread, for several structures at the same time;
// take(row) gets the rows in the order of the source, one at a time. Throws what make() and take()
// throw, and what the source throws once all rows before it are taken.
template <class Row, class Make, class Take>
std::uint64_t make_rows(StructureSource& source, std::uint64_t most, std::size_t workers,
                        Monitor* monitor, const Make& make, const Take& take) {
  // Rows under way for each worker, which bound the memory. One slow structure holds up the others
  // only when as many as this were made beside it.
  constexpr std::size_t kWindow = 16;
  using tbb::filter_mode;
  std::uint64_t read = 0, taken = 0;
  std::exception_ptr source_failure;
  const auto next = [&](tbb::flow_control& control) {
    try {
      std::optional<NamedStructure> found;
      if (read < most) found = source.next(StructureSource::Content::read);
      if (found) {
        ++read;
        return std::move(*found);
      }
    } catch (...) {
      source_failure = std::current_exception();
    }
    control.stop();
    return NamedStructure{};
  };
  // A thread that waits inside of one structure must not begin another one there: both would use
  // the memory of that thread.
  const auto make_one = [&](const NamedStructure& structure) {
    return tbb::this_task_arena::isolate([&] { return make(structure); });
  };
  const auto take_one = [&](const Row& row) {
    take(row);
    ++taken;
    advance(monitor, 1);
  };
  tbb::task_arena(static_cast<int>(workers)).execute([&] {
    tbb::parallel_pipeline(
        workers * kWindow,
        tbb::make_filter<void, NamedStructure>(filter_mode::serial_in_order, next) &
            tbb::make_filter<NamedStructure, Row>(filter_mode::parallel, make_one) &
            tbb::make_filter<Row, void>(filter_mode::serial_in_order, take_one));
  });
  if (source_failure) std::rethrow_exception(source_failure);
  return taken;
}

}  // namespace vdwmesh
