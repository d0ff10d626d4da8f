// The GLSL shaders of a surface and their uniform variables.
//
// Reflection is computed by Blinn's model with one light source at infinity. The computation is in
// linear light: colours are decoded from sRGB before it and encoded after it. kCommon holds the
// model and goes into both shaders. For Gouraud shading the vertex shader evaluates the model, for
// shading per pixel the fragment shader; the macro GOURAUD selects one of them when the shaders are
// compiled. Both sides of a triangle are lit; for the back side the normal is reversed.
#include "render/opengl/surface_program.hpp"

#include <fmt/format.h>

#include <array>
#include <string>

#include "core/errors.hpp"

namespace vdwmesh {
namespace {

// The common part of both shaders: the reflection model in eye coordinates (origin at the eye, x
// right, y up, z toward the viewer). illuminate() returns two factors: of the surface's own colour,
// and of white for the highlight. The ambient factor is larger at points that face the viewer, so
// that shape stays visible at points that the light does not reach.
constexpr const char* kCommon = R"(#version 330 core
uniform vec3 light;          // unit, toward it
uniform vec4 material;       // ambient, diffuse, specular, shininess
uniform bool perspective;

vec3 toward_viewer(vec3 position) { return perspective ? normalize(-position) : vec3(0, 0, 1); }

// Share of the surface's own colour, and of white. Places that see less of the sky get less of all.
vec2 illuminate(vec3 normal, vec3 position, float sky) {
  vec3 viewer = toward_viewer(position);
  float ambient = material.x * (0.5 + 0.5 * max(dot(normal, viewer), 0.0));
  float diffuse = material.y * max(dot(normal, light), 0.0);
  float highlight = pow(max(dot(normal, normalize(light + viewer)), 0.0), material.w);
  return sky * vec2(ambient + diffuse, dot(normal, light) > 0.0 ? material.z * highlight : 0.0);
}

vec3 to_linear(vec3 c) {
  return mix(c / 12.92, pow((c + 0.055) / 1.055, vec3(2.4)), greaterThan(c, vec3(0.04045)));
}
vec3 to_srgb(vec3 c) {
  c = clamp(c, 0.0, 1.0);
  return mix(12.92 * c, 1.055 * pow(c, vec3(1.0 / 2.4)) - 0.055,
             greaterThan(c, vec3(0.0031308)));
}
)";

// The vertex shader. If GOURAUD is defined, it calls illuminate() for both sides of the surface,
// because only the fragment shader knows which side is seen. The result both_lights has the two
// factors of the front in xy and those of the back in zw.
constexpr const char* kVertex = R"(
layout(location = 0) in vec3 position;
layout(location = 1) in vec3 normal;
layout(location = 2) in vec4 color;
layout(location = 3) in float value;
uniform mat4 clip;
uniform mat3 axes;           // from the surface to eye coordinates
uniform vec3 eye;
out vec3 eye_position;
out vec3 eye_normal;
out vec3 own_color;
out float own_value;
out float own_sky;
#ifdef GOURAUD
out vec4 both_lights;
#endif

void main() {
  gl_Position = clip * vec4(position, 1);
  eye_position = axes * position - eye;
  eye_normal = axes * normal;
  own_color = to_linear(color.rgb);
  own_value = value;
  own_sky = color.a;
#ifdef GOURAUD
  vec3 n = normalize(eye_normal);
  both_lights = vec4(illuminate(n, eye_position, own_sky), illuminate(-n, eye_position, own_sky));
#endif
}
)";

// The fragment shader. The surface's own colour comes from the vertices or, if values are painted,
// from the palette: the value is interpolated first, and then looked up in the palette for each
// pixel. The values `bounds` are at the centres of the first and the last texel. NaN is shown grey.
constexpr const char* kFragment = R"(
in vec3 eye_position;
in vec3 eye_normal;
in vec3 own_color;
in float own_value;
in float own_sky;
#ifdef GOURAUD
in vec4 both_lights;
#endif
uniform int paint;           // 0: colour of the vertices, 1: their value, 2: the triangle's value
uniform vec2 bounds;         // of the values
uniform int first_triangle;
uniform sampler2D palette;
uniform samplerBuffer triangle_values;
#ifdef LAYERS
uniform sampler2D nearer;    // depths of the layer in front
uniform bool is_behind;      // whether there is one
#endif
out vec4 result;

const vec3 no_value = vec3(0.5);

vec3 color_of(float v) {
  if (isnan(v)) return to_linear(no_value);
  float t = clamp((v - bounds.x) / (bounds.y - bounds.x), 0.0, 1.0);
  float size = float(textureSize(palette, 0).x);
  return to_linear(texture(palette, vec2((t * (size - 1.0) + 0.5) / size, 0.5)).rgb);
}

void main() {
#ifdef LAYERS
  if (is_behind && gl_FragCoord.z <= texelFetch(nearer, ivec2(gl_FragCoord.xy), 0).r) discard;
#endif
  vec3 color = own_color;
  if (paint == 1) color = color_of(own_value);
  if (paint == 2) color = color_of(texelFetch(triangle_values, first_triangle + gl_PrimitiveID).r);
#ifdef GOURAUD
  vec2 shares = gl_FrontFacing ? both_lights.xy : both_lights.zw;
#else
  vec3 n = normalize(eye_normal);
  vec2 shares = illuminate(gl_FrontFacing ? n : -n, eye_position, own_sky);
#endif
  result = vec4(to_srgb(shares.x * color + shares.y), 1);
}
)";

// Returns the first line of a shader's or a program's log; `get` is the OpenGL function that reads
// the log.
std::string log_of(GLuint name, decltype(glGetShaderInfoLog) get) {
  char text[512] = "";
  get(name, sizeof text, nullptr, text);
  const std::string log = text;
  return log.substr(0, log.find('\n'));
}

// A compiled shader, deleted with the object.
class Shader {
 public:
  Shader(GLenum kind, const std::string& defines, const char* body) : name_(glCreateShader(kind)) {
    const char* parts[] = {kCommon, defines.c_str(), body};
    glShaderSource(name_, 3, parts, nullptr);
    glCompileShader(name_);
    GLint compiled = 0;
    glGetShaderiv(name_, GL_COMPILE_STATUS, &compiled);
    if (compiled) return;
    const std::string log = log_of(name_, glGetShaderInfoLog);
    glDeleteShader(name_);
    throw Error(fmt::format("a shader was not compiled: {}", log));
  }
  ~Shader() { glDeleteShader(name_); }
  Shader(const Shader&) = delete;
  Shader& operator=(const Shader&) = delete;
  GLuint name() const { return name_; }

 private:
  GLuint name_;
};

std::array<GLfloat, 16> to_floats(const std::array<double, 16>& m) {
  std::array<GLfloat, 16> result{};
  for (std::size_t i = 0; i < m.size(); ++i) result[i] = static_cast<GLfloat>(m[i]);
  return result;
}

// The value of the uniform variable `paint`; the fragment shader lists its meanings.
int paint_number(PaintKind paint) {
  return paint == PaintKind::vertex_color ? 0 : paint == PaintKind::vertex_value ? 1 : 2;
}

}  // namespace

SurfaceProgram::SurfaceProgram(const RenderOptions& options) {
  std::string defines = options.shading == Shading::gouraud ? "#define GOURAUD\n" : "";
  if (options.opacity < 1) defines += "#define LAYERS\n";
  const Shader vertex(GL_VERTEX_SHADER, defines, kVertex);
  const Shader fragment(GL_FRAGMENT_SHADER, defines, kFragment);
  name_ = glCreateProgram();
  glAttachShader(name_, vertex.name());
  glAttachShader(name_, fragment.name());
  glLinkProgram(name_);
  GLint linked = 0;
  glGetProgramiv(name_, GL_LINK_STATUS, &linked);
  if (linked) return;
  const std::string log = log_of(name_, glGetProgramInfoLog);
  glDeleteProgram(name_);
  throw Error(fmt::format("the shaders were not linked: {}", log));
}

SurfaceProgram::~SurfaceProgram() { glDeleteProgram(name_); }

GLint SurfaceProgram::place(const char* uniform) const {
  return glGetUniformLocation(name_, uniform);
}

void SurfaceProgram::use(const Camera& camera, const RenderOptions& options, PaintKind paint,
                         const ColorScale* scale) const {
  glUseProgram(name_);
  glUniformMatrix4fv(place("clip"), 1, GL_FALSE, to_floats(clip_matrix(camera)).data());
  const Axes& a = camera.axes;
  // The axes are the rows of the matrix, so OpenGL has to transpose it (GL_TRUE).
  const double rows[] = {a[0].x, a[0].y, a[0].z, a[1].x, a[1].y, a[1].z, a[2].x, a[2].y, a[2].z};
  std::array<GLfloat, 9> axes{};
  for (std::size_t i = 0; i < axes.size(); ++i) axes[i] = static_cast<GLfloat>(rows[i]);
  glUniformMatrix3fv(place("axes"), 1, GL_TRUE, axes.data());
  const Vec3f eye = cast<float>(camera.eye);
  glUniform3f(place("eye"), eye.x, eye.y, eye.z);
  const Vec3f light = (1 / norm(options.light)) * options.light;
  glUniform3f(place("light"), light.x, light.y, light.z);
  const Material& m = options.material;
  glUniform4f(place("material"), m.ambient, m.diffuse, m.specular, m.shininess);
  glUniform1i(place("perspective"), camera.projection == CameraProjection::perspective);
  glUniform1i(place("paint"), paint_number(paint));
  if (scale) {
    glUniform2f(place("bounds"), static_cast<float>(scale->lower),
                static_cast<float>(scale->upper));
  }
  glUniform1i(place("palette"), 0);
  glUniform1i(place("triangle_values"), 1);
  glUniform1i(place("nearer"), 2);
}

void SurfaceProgram::set_layer(int layer) const { glUniform1i(place("is_behind"), layer > 0); }

void SurfaceProgram::set_first_triangle(std::uint64_t triangle) const {
  glUniform1i(place("first_triangle"), static_cast<GLint>(triangle));
}

}  // namespace vdwmesh
