#include "gl/program.h"

#include <algorithm>
#include <array>

#include "base/index_limit.h"
#include "gl/debug_output.h"
#include "gl/gl_error.h"
#include "gl/shader_sources.h"

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

Shader Compile(const std::string& name, const ShaderConstants& constants) {
  const std::string text = AddConstants(ShaderSource(name), constants);
  Shader shader(glCreateShader(ShaderType(name)));
  const char* data = text.data();
  const auto length = static_cast<GLint>(text.size());
  glShaderSource(shader.Get(), 1, &data, &length);
  glCompileShader(shader.Get());
  GLint status = GL_FALSE;
  glGetShaderiv(shader.Get(), GL_COMPILE_STATUS, &status);
  if (status != GL_TRUE) {
    GLint log_length = 0;
    glGetShaderiv(shader.Get(), GL_INFO_LOG_LENGTH, &log_length);
    std::string log(log_length, '\0');
    glGetShaderInfoLog(shader.Get(), log_length, &log_length, log.data());
    log.resize(log_length);
    throw GlError("The shader " + name + " does not compile:\n" + log);
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
  GLint status = GL_FALSE;
  glGetProgramiv(name_.Get(), GL_LINK_STATUS, &status);
  if (status != GL_TRUE) {
    GLint length = 0;
    glGetProgramiv(name_.Get(), GL_INFO_LOG_LENGTH, &length);
    std::string log(length, '\0');
    glGetProgramInfoLog(name_.Get(), length, &length, log.data());
    log.resize(length);
    throw GlError("The shaders " + title_ + " do not link:\n" + log);
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

void Program::Set(std::string_view uniform, int value) {
  glProgramUniform1i(name_.Get(), Location(uniform), value);
}

void Program::Set(std::string_view uniform, unsigned int value) {
  glProgramUniform1ui(name_.Get(), Location(uniform), value);
}

void Program::Set(std::string_view uniform, float value) {
  glProgramUniform1f(name_.Get(), Location(uniform), value);
}

void Program::Set(std::string_view uniform, double value) {
  glProgramUniform1d(name_.Get(), Location(uniform), value);
}

void Program::Set(std::string_view uniform, const Eigen::Vector2i& value) {
  glProgramUniform2iv(name_.Get(), Location(uniform), 1, value.data());
}

void Program::Set(std::string_view uniform, const Eigen::Vector2f& value) {
  glProgramUniform2fv(name_.Get(), Location(uniform), 1, value.data());
}

void Program::Set(std::string_view uniform, const Eigen::Vector3f& value) {
  glProgramUniform3fv(name_.Get(), Location(uniform), 1, value.data());
}

void Program::Set(std::string_view uniform, const Eigen::Matrix3f& value) {
  glProgramUniformMatrix3fv(name_.Get(), Location(uniform), 1, GL_FALSE,
                            value.data());
}

void Program::Set(std::string_view uniform, const Eigen::Vector2d& value) {
  glProgramUniform2dv(name_.Get(), Location(uniform), 1, value.data());
}

void Program::Set(std::string_view uniform, const Eigen::Vector3d& value) {
  glProgramUniform3dv(name_.Get(), Location(uniform), 1, value.data());
}

void Program::Set(std::string_view uniform, const Eigen::Matrix3d& value) {
  glProgramUniformMatrix3dv(name_.Get(), Location(uniform), 1, GL_FALSE,
                            value.data());
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
