#include "gl/program.h"

#include <algorithm>
#include <array>
#include <optional>

#include "base/index_limit.h"
#include "gl/gl_error.h"

namespace colmap_ext {

namespace {

struct DeleteShader {
  void operator()(GLuint name) const { glDeleteShader(name); }
};
using Shader = GlName<DeleteShader>;

GLenum ShaderType(std::string_view name) {
  if (name.ends_with(".vert")) {
    return GL_VERTEX_SHADER;
  }
  if (name.ends_with(".frag")) {
    return GL_FRAGMENT_SHADER;
  }
  return GL_COMPUTE_SHADER;
}

// The constants follow the line of the version, which has to be the first.
std::string AddConstants(std::string_view source,
                         const ShaderConstants& constants) {
  const size_t second_line = source.find('\n') + 1;
  std::string text(source.substr(0, second_line));
  text += "const int kGroupSize = " + std::to_string(kGroupSize) + ";\n";
  text += "const uint kNone = " + std::to_string(kNone) + "u;\n";
  for (const auto& [name, value] : constants) {
    text += "const int " + name + " = " + std::to_string(value) + ";\n";
  }
  text += "#line 2\n";
  text += source.substr(second_line);
  return text;
}

// The log of a shader or program, unless its compiler or linker succeeded.
template <typename GetNumber, typename GetLog>
std::optional<std::string> FindErrors(GLuint name, GLenum status,
                                      const GetNumber& get_number,
                                      const GetLog& get_log) {
  GLint has_succeeded = GL_FALSE;
  get_number(name, status, &has_succeeded);
  if (has_succeeded == GL_TRUE) {
    return std::nullopt;
  }
  GLint length = 0;
  get_number(name, GL_INFO_LOG_LENGTH, &length);
  std::string log(length, '\0');
  get_log(name, length, &length, log.data());
  log.resize(length);
  return log;
}

Shader Compile(const std::string& name, const ShaderConstants& constants) {
  const std::string text = AddConstants(ShaderSource(name), constants);
  Shader shader(glCreateShader(ShaderType(name)));
  const char* data = text.data();
  const auto length = static_cast<GLint>(text.size());
  glShaderSource(shader.Get(), 1, &data, &length);
  glCompileShader(shader.Get());
  if (const auto log = FindErrors(shader.Get(), GL_COMPILE_STATUS,
                                  glGetShaderiv, glGetShaderInfoLog)) {
    throw GlError("The shader " + name + " does not compile:\n" + *log);
  }
  return shader;
}

}  // namespace

Program::Program(const std::vector<std::string>& shaders,
                 const ShaderConstants& constants)
    : name_(glCreateProgram()) {
  std::vector<Shader> compiled;
  for (const std::string& shader : shaders) {
    title_ += (title_.empty() ? "" : " + ") + shader;
    compiled.push_back(Compile(shader, constants));
    glAttachShader(name_.Get(), compiled.back().Get());
  }
  glLinkProgram(name_.Get());
  if (const auto log = FindErrors(name_.Get(), GL_LINK_STATUS, glGetProgramiv,
                                  glGetProgramInfoLog)) {
    throw GlError("The shaders " + title_ + " do not link:\n" + *log);
  }
  FindUniforms();
  ThrowOnGlError(title_.c_str());
}

void Program::FindUniforms() {
  GLint count = 0;
  glGetProgramiv(name_.Get(), GL_ACTIVE_UNIFORMS, &count);
  for (GLint i = 0; i < count; ++i) {
    std::array<char, 256> name{};
    GLint size = 0;
    GLenum type = GL_NONE;
    glGetActiveUniform(name_.Get(), i, name.size(), nullptr, &size, &type,
                       name.data());
    locations_[name.data()] = glGetUniformLocation(name_.Get(), name.data());
  }
}

GLint Program::Location(std::string_view uniform) const {
  const auto found = locations_.find(uniform);
  if (found == locations_.end()) {
    throw GlError("The shader " + title_ + " has no uniform " +
                  std::string(uniform));
  }
  return found->second;
}

void Dispatch(const Program& program, size_t size) {
  // As many as OpenGL 4.5 is sure to have room for in the first dimension.
  constexpr GLuint kMaxGroups = 65535;
  const auto num_groups =
      static_cast<GLuint>((size + kGroupSize - 1) / kGroupSize);
  const GLuint columns = std::min(num_groups, kMaxGroups);
  program.Use();
  if (num_groups > 0) {
    glDispatchCompute(columns, (num_groups + columns - 1) / columns, 1);
    glMemoryBarrier(GL_ALL_BARRIER_BITS);
  }
}

void DispatchIndirect(const Program& program, const GlBuffer& num_groups) {
  program.Use();
  glBindBuffer(GL_DISPATCH_INDIRECT_BUFFER, num_groups.Name());
  glDispatchComputeIndirect(0);
  glMemoryBarrier(GL_ALL_BARRIER_BITS);
}

}  // namespace colmap_ext
