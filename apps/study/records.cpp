// Writes records and reads them back. Reading goes by the description of what was written: every
// member must be there, and anything else makes the record none, so that a file cut off or of
// another version is made anew rather than trusted.
#include "study/records.hpp"

#include <concepts>
#include <limits>
#include <nlohmann/json.hpp>
#include <type_traits>

#include "build_id.hpp"
#include "core/errors.hpp"
#include "json_text.hpp"

namespace vdwmesh::apps {

using Json = nlohmann::ordered_json;

// A visitor that fills the members it is shown.
class JsonReader {
 public:
  explicit JsonReader(const Json& in) : in_(in) {}
  template <class T>
  void operator()(const char* key, T& value) {
    read(in_.at(key), value);
  }

 private:
  template <class T>
  static void read(const Json& json, T& value) {
    if constexpr (std::is_enum_v<T>) {
      value = value_named<T>("record", json.get_ref<const std::string&>());
    } else if constexpr (std::is_floating_point_v<T>) {
      value = json.is_null() ? std::numeric_limits<T>::quiet_NaN() : json.get<T>();
    } else if constexpr (std::is_class_v<T> && !std::constructible_from<Json, T>) {
      JsonReader inner(json);
      describe(inner, value);
    } else {
      value = json.get<T>();
    }
  }
  template <class T>
  static void read(const Json& json, std::optional<T>& value) {
    value.reset();
    if (!json.is_null()) read(json, value.emplace());
  }

  const Json& in_;
};

void describe(JsonText& a, const RunKey& key) {
  a("version", kVersion), a("revision", kRevision), a("build", kBuild);
  a("spheres", key.spheres);
  a("setting", key.setting);
  a("samples", key.samples), a("seed", key.seed);
  a("self_intersections", key.self_intersections);
  a("device", key.device), a("threads", key.threads);
}

std::string key_json(const RunKey& key) { return json_of(key); }

std::string record_json(const RunKey& key, const StudyRun& run) {
  JsonText json;
  json("key", key);
  json("run", run);
  return std::move(json).take();
}

std::optional<StudyRun> run_of_record(const std::string& record, const RunKey& key) {
  try {
    const Json kept = Json::parse(record);
    if (kept.at("key") != Json::parse(key_json(key))) return std::nullopt;
    StudyRun run;
    JsonReader reader(kept.at("run"));
    describe(reader, run);
    return run;
  } catch (const Json::exception&) {
    return std::nullopt;
  } catch (const InvalidInput&) {
    return std::nullopt;
  }
}

}  // namespace vdwmesh::apps
