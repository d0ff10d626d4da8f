# vdwmesh_embed_assets(<target> <function> <name>=<file>...): the files' bytes in the program, as
# <function>(name) of the namespace vdwmesh::apps.
function(vdwmesh_embed_assets target function)
  set(source "${CMAKE_CURRENT_BINARY_DIR}/${target}_assets.cpp")
  set(bytes "")
  set(choices "")
  set(files "")
  set(number 0)
  foreach(pair IN LISTS ARGN)
    string(REGEX MATCH "^([^=]+)=(.+)$" matched "${pair}")
    set(name "${CMAKE_MATCH_1}")
    set(file "${CMAKE_MATCH_2}")
    set(symbol "vdwmesh_${function}_${number}")
    math(EXPR number "${number} + 1")
    list(APPEND files "${file}")
    string(APPEND bytes "asm(\".section .rodata\\n\"
    \".hidden ${symbol}_begin\\n.global ${symbol}_begin\\n${symbol}_begin:\\n\"
    \".incbin \\\"${file}\\\"\\n\"
    \".hidden ${symbol}_end\\n.global ${symbol}_end\\n${symbol}_end:\\n\"
    \".byte 0\\n.previous\\n\");
extern \"C\" const char ${symbol}_begin[];
extern \"C\" const char ${symbol}_end[];
")
    string(APPEND choices
           "  if (name == \"${name}\") return between(${symbol}_begin, ${symbol}_end);\n")
  endforeach()
  file(CONFIGURE OUTPUT "${source}" CONTENT "#include <cstddef>
#include <stdexcept>
#include <string>
#include <string_view>

@bytes@
namespace vdwmesh::apps {
namespace {

std::string_view between(const char* begin, const char* end) {
  return {begin, static_cast<std::size_t>(end - begin)};
}

}  // namespace

std::string_view @function@(std::string_view name);
std::string_view @function@(std::string_view name) {
@choices@  throw std::logic_error(\"no asset \" + std::string(name));
}

}  // namespace vdwmesh::apps
" @ONLY)
  set_source_files_properties("${source}" PROPERTIES OBJECT_DEPENDS "${files}")
  target_sources(${target} PRIVATE "${source}")
endfunction()
