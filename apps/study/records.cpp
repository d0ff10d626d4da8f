#include "study/records.hpp"

#include <concepts>
#include <limits>
#include <type_traits>
#include <utility>

#include "options.hpp"
#include "parse.hpp"

namespace vdwmesh::apps {
namespace {

constexpr Choice<BinScale> kScales[] = {{"linear", BinScale::linear},
                                        {"logarithmic", BinScale::logarithmic}};

// Enumerations by the names of the command line.
std::string_view name(Mesher value) { return mesher_name(value); }
std::string_view name(FieldKind value) { return field_name(value); }
std::string_view name(Projection value) { return projection_name(value); }
std::string_view name(BinScale value) { return name_of(value, kScales); }
void from_name(std::string_view text, Mesher& value) { value = mesher_of_name(text); }
void from_name(std::string_view text, FieldKind& value) { value = field_of_name(text); }
void from_name(std::string_view text, Projection& value) { value = projection_of_name(text); }
void from_name(std::string_view text, BinScale& value) { value = choose("scale", text, kScales); }

// T or const T: describe() serves writing and reading.
template <class U, class T>
concept Of = std::same_as<std::remove_const_t<U>, T>;

template <class A, Of<Distribution> T>
void describe(A& a, T& d) {
  a("min", d.min), a("p01", d.p01), a("median", d.median);
  a("p99", d.p99), a("max", d.max), a("mean", d.mean);
}

template <class A, Of<DistanceStatistics> T>
void describe(A& a, T& d) {
  a("mean", d.mean), a("rms", d.rms), a("max", d.max);
  a("p50", d.p50), a("p95", d.p95), a("p99", d.p99);
  a("mean_error", d.mean_error), a("rms_error", d.rms_error), a("samples", d.samples);
}

template <class A, Of<MeshDistances> T>
void describe(A& a, T& d) {
  a("mesh_to_surface", d.mesh_to_surface), a("surface_to_mesh", d.surface_to_mesh);
  a("hausdorff_lower_bound", d.hausdorff_lower_bound), a("samples", d.samples), a("seed", d.seed);
}

template <class A, Of<Comparison> T>
void describe(A& a, T& c) {
  a("area_relative_error", c.area_relative_error);
  a("volume_relative_error", c.volume_relative_error);
  a("euler_characteristic_difference", c.euler_characteristic_difference);
  a("distances", c.distances);
}

template <class A, Of<MeshTopology> T>
void describe(A& a, T& t) {
  a("vertices", t.vertices), a("edges", t.edges), a("triangles", t.triangles);
  a("isolated_vertices", t.isolated_vertices), a("shells", t.shells);
  a("components", t.components), a("voids", t.voids), a("genus", t.genus);
  a("euler_characteristic", t.euler_characteristic);
  a("closed", t.closed), a("manifold", t.manifold), a("oriented", t.oriented);
}

template <class A, Of<MeshMeasures> T>
void describe(A& a, T& m) {
  a("area", m.area), a("volume", m.volume);
  a("outer_area", m.outer_area), a("void_area", m.void_area);
}

template <class A, Of<MeshQuality> T>
void describe(A& a, T& q) {
  a("min_angle_deg", q.min_angle_deg), a("aspect_ratio", q.aspect_ratio);
  a("edge_length", q.edge_length), a("degenerate_triangles", q.degenerate_triangles);
}

template <class A, Of<Histogram> T>
void describe(A& a, T& h) {
  a("scale", h.scale), a("lower", h.lower), a("upper", h.upper);
  a("below", h.below), a("above", h.above), a("counts", h.counts);
}

template <class A, Of<QualityHistograms> T>
void describe(A& a, T& h) {
  a("min_angle_deg", h.min_angle_deg), a("aspect_ratio", h.aspect_ratio);
  a("edge_length", h.edge_length);
}

template <class A, Of<StudySeconds> T>
void describe(A& a, T& s) {
  a("field", s.field), a("extract", s.extract), a("refine", s.refine), a("mesh", s.mesh);
  a("distances", s.distances);
}

template <class A, Of<StudyMemory> T>
void describe(A& a, T& m) {
  a("mesh", m.mesh), a("peak", m.peak);
}

template <class A, Of<StudyKey> T>
void describe(A& a, T& k) {
  a("mesher", k.mesher), a("field", k.field), a("project", k.projection);
  a("subdivide", k.subdivisions), a("backend", k.backend);
}

template <class A, Of<StudySetting> T>
void describe(A& a, T& s) {
  describe(a, s.key);
  a("resolution", s.resolution);
}

template <class A, Of<PowerLaw> T>
void describe(A& a, T& p) {
  a("order", p.order), a("scale", p.scale);
  a("rms_residual", p.rms_residual), a("points", p.points);
}

template <class A, Of<Extrapolation> T>
void describe(A& a, T& e) {
  a("limit", e.limit), a("order", e.order);
}

template <class A, Of<StudyOrders> T>
void describe(A& a, T& o) {
  a("area_error", o.area_error), a("volume_error", o.volume_error);
  a("mesh_to_surface_rms", o.mesh_to_surface_rms);
  a("surface_to_mesh_rms", o.surface_to_mesh_rms), a("hausdorff", o.hausdorff);
}

// Topology, measures and quality in one block, as in the report.
struct MeshBlock {
  MeshTopology& topology;
  MeshMeasures& measures;
  MeshQuality& quality;
  std::optional<std::uint64_t>& self_intersections;
};
template <class A, Of<MeshBlock> T>
void describe(A& a, T& m) {
  describe(a, m.topology), describe(a, m.measures), describe(a, m.quality);
  a("self_intersections", m.self_intersections);
}

template <class A>
void describe(A& a, StudyRun& run) {
  a("parameters", run.setting);
  MeshBlock mesh{run.topology, run.measures, run.quality, run.self_intersections};
  a("mesh", mesh);
  a("histograms", run.histograms), a("comparison", run.comparison);
  a("timing", run.seconds), a("memory", run.memory);
}

class Writer {
 public:
  template <class T>
  void operator()(const char* key, T& value) {
    out_[key] = convert(value);
  }
  Json take() && { return std::move(out_); }

 private:
  template <class T>
  static Json convert(T& value) {
    using U = std::remove_const_t<T>;
    if constexpr (std::is_enum_v<U>) {
      return name(value);
    } else if constexpr (std::is_class_v<U> && !std::constructible_from<Json, U>) {
      Writer inner;
      describe(inner, value);
      return std::move(inner).take();
    } else {
      return value;
    }
  }
  template <class T>
  static Json convert(const std::optional<T>& value) {
    return value ? convert(*value) : Json(nullptr);
  }
  template <class T>
  static Json convert(std::optional<T>& value) {
    return convert(std::as_const(value));
  }

  Json out_ = Json::object();
};

class Reader {
 public:
  explicit Reader(const Json& in) : in_(in) {}
  template <class T>
  void operator()(const char* key, T& value) {
    read(in_.at(key), value);
  }

 private:
  template <class T>
  static void read(const Json& json, T& value) {
    if constexpr (std::is_enum_v<T>) {
      from_name(json.get_ref<const std::string&>(), value);
    } else if constexpr (std::is_floating_point_v<T>) {
      value = json.is_null() ? std::numeric_limits<T>::quiet_NaN() : json.get<T>();
    } else if constexpr (std::is_class_v<T> && !std::constructible_from<Json, T>) {
      Reader inner(json);
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

template <class T>
Json written(T& value) {
  Writer writer;
  describe(writer, value);
  return std::move(writer).take();
}

}  // namespace

Json setting_json(const StudySetting& setting) { return written(setting); }

Json run_json(const StudyRun& run) {
  StudyRun copy = run;
  return written(copy);
}

Json series_json(const StudySeries& series) {
  Json json = written(series.key);
  json["runs"] = series.runs;
  json["by_resolution"] = written(series.by_resolution);
  json["by_triangles"] = written(series.by_triangles);
  json["area_extrapolated"] = series.area ? written(*series.area) : Json(nullptr);
  json["volume_extrapolated"] = series.volume ? written(*series.volume) : Json(nullptr);
  return json;
}

StudyRun run_from_json(const Json& json) {
  StudyRun run;
  Reader reader(json);
  describe(reader, run);
  return run;
}

}  // namespace vdwmesh::apps
