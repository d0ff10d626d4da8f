// `vdwmesh info`: which program this is, and what it can compute and draw on here. That something
// is missing is part of the answer, with the reason, and no error: this is the verb that one asks
// when something does not work.
#include <fmt/format.h>
#include <tbb/info.h>

#include <optional>
#include <string>
#include <utility>

#include "build_id.hpp"
#include "command_line/command_line.hpp"
#include "core/errors.hpp"
#include "cuda/backend.hpp"
#include "render/renderer.hpp"
#include "report/json_text.hpp"
#include "report/output.hpp"
#include "verbs/verbs.hpp"

namespace vdwmesh::apps {
namespace {

// What draws pictures, or why nothing does.
struct PictureDevice {
  std::optional<std::string> name;
  std::string reason;
};

// Whether pictures can be drawn is known only by trying.
PictureDevice picture_device() {
  try {
    return {Renderer().device(), {}};
  } catch (const BackendUnavailable& error) {
    return {{}, error.what()};
  }
}

std::string info_json(const DeviceList& list, const PictureDevice& pictures) {
  JsonText json;
  json("schema", "vdwmesh-info/1");
  json("version", kVersion), json("revision", kRevision), json("build", kBuild);
  json("threads", tbb::info::default_concurrency());
  json.object("cuda", [&] {
    json.list("devices", list.devices, [&](const DeviceInfo& device) {
      json("name", device.name), json("driver", device.driver), json("memory", device.memory);
    });
    json("reason", list.reason);
  });
  json.object("pictures", [&] {
    json("device", pictures.name);
    json("reason", pictures.reason);
  });
  return std::move(json).take();
}

std::string cuda_text(const DeviceList& list) {
  if (list.devices.empty()) return fmt::format("cuda      none: {}\n", list.reason);
  constexpr double kGibibyte = 1024.0 * 1024 * 1024;
  std::string text;
  for (const DeviceInfo& device : list.devices) {
    text += fmt::format("cuda      {}, driver {}, {:.1f} GiB\n", device.name, device.driver,
                        static_cast<double>(device.memory) / kGibibyte);
  }
  return text;
}

std::string info_text(const DeviceList& list, const PictureDevice& pictures) {
  return fmt::format("vdwmesh {} ({})\nbuild     {}\ncpu       {} threads\n{}pictures  {}\n",
                     kVersion, kRevision, kBuild, tbb::info::default_concurrency(), cuda_text(list),
                     pictures.name.value_or(pictures.reason));
}

}  // namespace

void run_info(const Options& options) {
  const DeviceList list = cuda_devices();
  const PictureDevice pictures = picture_device();
  if (options.output.json.empty()) return write_standard_output(info_text(list, pictures));
  write_output(options.output.json, info_json(list, pictures));
}

}  // namespace vdwmesh::apps
