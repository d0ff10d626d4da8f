#include <fmt/format.h>
#include <tbb/info.h>

#include "cuda/backend.hpp"
#include "json_writer.hpp"
#include "output.hpp"
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

std::string info_json(const DeviceList& list) {
  return write_json({{"schema", "vdwmesh-info/1"},
                     {"version", VDWMESH_VERSION},
                     {"build", VDWMESH_BUILD},
                     {"threads", tbb::info::default_concurrency()},
                     {"cuda", {{"devices", devices_json(list)}, {"reason", list.reason}}}});
}

std::string info_text(const DeviceList& list) {
  std::string text = fmt::format("vdwmesh {}\nbuild     {}\ncpu       {} threads\n",
                                 VDWMESH_VERSION, VDWMESH_BUILD, tbb::info::default_concurrency());
  if (list.devices.empty()) return text + fmt::format("cuda      none: {}\n", list.reason);
  constexpr double kGibibyte = 1024.0 * 1024 * 1024;
  for (const DeviceInfo& device : list.devices) {
    text += fmt::format("cuda      {}, driver {}, {:.1f} GiB\n", device.name, device.driver,
                        static_cast<double>(device.memory) / kGibibyte);
  }
  return text;
}

class InfoVerb : public Verb {
 public:
  std::string name() const override { return "info"; }
  std::string summary() const override { return "version, build, backends, devices"; }
  void add_options(CLI::App& app) override { output_.add_to(app, OutputFlags::PerAtom::none); }
  void run() const override {
    const OutputOptions output = output_.resolve();
    const DeviceList list = cuda_devices();
    if (output.json.empty()) return write_standard_output(info_text(list));
    if (output.json == "-") return write_standard_output(info_json(list));
    write_file(output.json, info_json(list));
  }

 private:
  OutputFlags output_;
};

}  // namespace

std::unique_ptr<Verb> make_info_verb() { return std::make_unique<InfoVerb>(); }

}  // namespace vdwmesh::apps
