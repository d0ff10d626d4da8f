# Writes OUTPUT, a C++ source with sample_text(), from DATA_DIR/<name>.pdb of each of NAMES.
set(arrays "")
set(choices "")
foreach(name IN LISTS NAMES)
  file(READ "${DATA_DIR}/${name}.pdb" bytes HEX)
  string(REGEX REPLACE "([0-9a-f][0-9a-f])" "0x\\1," bytes "${bytes}")
  string(APPEND arrays "constexpr char k_${name}[] = {${bytes}};\n")
  string(APPEND choices "  if (name == \"${name}\") return {k_${name}, sizeof k_${name}};\n")
endforeach()
file(WRITE "${OUTPUT}" "#include \"structure/molecule/samples.hpp\"

namespace vdwmesh {
namespace {
${arrays}}  // namespace

std::string_view sample_text(std::string_view name) {
${choices}  return {};
}

}  // namespace vdwmesh
")
