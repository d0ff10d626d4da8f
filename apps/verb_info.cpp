#include <fmt/format.h>
#include <tbb/info.h>

#include <CLI/CLI.hpp>

#include "build_id.hpp"
#include "cuda/backend.hpp"
#include "json_writer.hpp"
#include "output.hpp"
#include "render/renderer.hpp"
#include "verbs.hpp"

namespace vdwmesh::apps {
namespace {

Json devices_json(const DeviceList& list) {
  Json devices = Json::array();
  for (const DeviceInfo& device : list.devices) {
    devices.push_back(
        {{"name", device.name}, {"driver", device.driver}, {"memory", device.memory}});
  }
  return devices;
}

// What draws pictures, or why nothing does.
struct PictureDevice {
  std::optional<std::string> name;
  std::string reason;
};

PictureDevice picture_device() {
  try {
    return {Renderer().device(), {}};
  } catch (const BackendUnavailable& error) {
    return {{}, error.what()};
  }
}

std::string info_json(const DeviceList& list, const PictureDevice& pictures) {
  return write_json(
      {{"schema", "vdwmesh-info/1"},
       {"version", kVersion},
       {"revision", kRevision},
       {"build", kBuild},
       {"threads", tbb::info::default_concurrency()},
       {"cuda", {{"devices", devices_json(list)}, {"reason", list.reason}}},
       {"pictures", {{"device", or_null(pictures.name)}, {"reason", pictures.reason}}}});
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

class InfoVerb : public Verb {
 public:
  std::string name() const override { return "info"; }
  std::string summary() const override { return "version, build, backends, devices"; }
  void add_options(CLI::App& app) override { output_.add_to(app, OutputFlags::PerAtom::none); }
  void run() const override {
    NamedFiles files;
    const OutputOptions output = output_.resolve(files);
    const DeviceList list = cuda_devices();
    const PictureDevice pictures = picture_device();
    if (output.json.empty()) return write_standard_output(info_text(list, pictures));
    write_output(output.json, info_json(list, pictures));
  }

 private:
  OutputFlags output_;
};

}  // namespace

std::unique_ptr<Verb> make_info_verb() { return std::make_unique<InfoVerb>(); }

}  // namespace vdwmesh::apps
