# Writes OUTPUT, a C++ source with font_data(), from the bytes of FONT.
file(READ "${FONT}" bytes HEX)
string(REGEX REPLACE "([0-9a-f][0-9a-f])" "\\\\x\\1" bytes "${bytes}")
file(WRITE "${OUTPUT}" "#include <string_view>

namespace vdwmesh {
std::string_view font_data();
namespace {
constexpr char kFont[] = \"${bytes}\";
}  // namespace

std::string_view font_data() { return {kFont, sizeof kFont - 1}; }

}  // namespace vdwmesh
")
