# Writes OUTPUT, a C++ source with sample_text(), from the PDB files listed as name=path in SAMPLES.
set(arrays "")
set(choices "")
foreach(sample IN LISTS SAMPLES)
  string(REPLACE "=" ";" pair "${sample}")
  list(GET pair 0 name)
  list(GET pair 1 path)
  file(READ "${path}" bytes HEX)
  string(REGEX REPLACE "([0-9a-f][0-9a-f])" "0x\\1," bytes "${bytes}")
  string(APPEND arrays "constexpr char k_${name}[] = {${bytes}};\n")
  string(APPEND choices "  if (name == \"${name}\") return {k_${name}, sizeof k_${name}};\n")
endforeach()
file(WRITE "${OUTPUT}" "#include \"structure/samples.hpp\"

namespace vdwmesh {
namespace {
${arrays}}  // namespace

std::string_view sample_text(std::string_view name) {
${choices}  return {};
}

}  // namespace vdwmesh
")
