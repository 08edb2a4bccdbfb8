#include "gl/gl_objects.h"

#include <algorithm>
#include <array>
#include <optional>

#include "base/indices.h"
#include "gl/egl_context.h"

namespace colmap_ext {
namespace {

using Shader = GlName<Delete<&glDeleteShader>>;

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

void GlBuffer::Resize(size_t num_bytes) {
  if (num_bytes != num_bytes_) {
    // Those of no bytes cannot be bound.
    glNamedBufferData(Name(), std::max<size_t>(num_bytes, 4), nullptr,
                      GL_DYNAMIC_COPY);
    ThrowOnGlError("A buffer");
    num_bytes_ = num_bytes;
  }
}

void GlBuffer::SetZero() const {
  glClearNamedBufferData(Name(), GL_R8UI, GL_RED_INTEGER, GL_UNSIGNED_BYTE,
                         nullptr);
}

void GlBuffer::Write(const void* data, size_t num_bytes) const {
  if (num_bytes > 0) {
    glNamedBufferSubData(Name(), 0, num_bytes, data);
  }
}

void GlBuffer::ReadBytes(void* data, size_t num_bytes) const {
  if (num_bytes > 0) {
    glMemoryBarrier(GL_BUFFER_UPDATE_BARRIER_BIT);
    glGetNamedBufferSubData(Name(), 0, num_bytes, data);
  }
}

void GlBuffer::BindToStorage(GLuint index) const {
  GLint64 max_bytes = 0;
  glGetInteger64v(GL_MAX_SHADER_STORAGE_BLOCK_SIZE, &max_bytes);
  if (num_bytes_ > static_cast<size_t>(max_bytes)) {
    throw GlError("The mesh is too large for this OpenGL: it takes " +
                  std::to_string(num_bytes_) + " bytes in one piece, of " +
                  std::to_string(max_bytes));
  }
  glBindBufferBase(GL_SHADER_STORAGE_BUFFER, index, Name());
}

void GlBuffer::BindToStorage(GLuint index, size_t first_byte,
                             size_t num_bytes) const {
  glBindBufferRange(GL_SHADER_STORAGE_BUFFER, index, Name(),
                    static_cast<GLintptr>(first_byte),
                    static_cast<GLsizeiptr>(num_bytes));
}

GlTexture::GlTexture(GLenum format, int width, int height)
    : format_(format), width_(width), height_(height) {
  GLint max_size = 0;
  glGetIntegerv(GL_MAX_TEXTURE_SIZE, &max_size);
  if (std::max(width, height) > max_size) {
    throw GlError("An image is too large for this OpenGL: " +
                  std::to_string(width) + " x " + std::to_string(height) +
                  " pixels, of " + std::to_string(max_size));
  }
  GLuint name = 0;
  glCreateTextures(GL_TEXTURE_2D, 1, &name);
  name_ = GlName<DeleteOne<&glDeleteTextures>>(name);
  glTextureStorage2D(name, 1, format, width, height);
  ThrowOnGlError("A texture");
  glTextureParameteri(name, GL_TEXTURE_MIN_FILTER, GL_NEAREST);
  glTextureParameteri(name, GL_TEXTURE_MAG_FILTER, GL_NEAREST);
}

void GlTexture::Write(GLenum format, GLenum type, const void* pixels) const {
  glPixelStorei(GL_UNPACK_ALIGNMENT, 1);
  glTextureSubImage2D(Name(), 0, 0, 0, width_, height_, format, type, pixels);
}

void GlTexture::ReadBytes(GLenum format, GLenum type, void* pixels,
                          size_t num_bytes) const {
  glMemoryBarrier(GL_TEXTURE_UPDATE_BARRIER_BIT);
  glPixelStorei(GL_PACK_ALIGNMENT, 1);
  glGetTextureImage(Name(), 0, format, type, static_cast<GLsizei>(num_bytes),
                    pixels);
}

void GlTexture::BindToSampler(GLuint index) const {
  glBindTextureUnit(index, Name());
}

void GlTexture::BindToImage(GLuint index, GLenum access) const {
  glBindImageTexture(index, Name(), 0, GL_FALSE, 0, access, format_);
}

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

void DispatchWithoutBarrier(const Program& program, size_t size) {
  // As many as OpenGL 4.5 is sure to have room for in the first dimension.
  constexpr GLuint kMaxGroups = 65535;
  const auto num_groups =
      static_cast<GLuint>((size + kGroupSize - 1) / kGroupSize);
  const GLuint columns = std::min(num_groups, kMaxGroups);
  program.Use();
  if (num_groups > 0) {
    glDispatchCompute(columns, (num_groups + columns - 1) / columns, 1);
  }
}

void Dispatch(const Program& program, size_t size) {
  DispatchWithoutBarrier(program, size);
  glMemoryBarrier(GL_ALL_BARRIER_BITS);
}

void DispatchIndirect(const Program& program, const GlBuffer& num_groups) {
  program.Use();
  glBindBuffer(GL_DISPATCH_INDIRECT_BUFFER, num_groups.Name());
  glDispatchComputeIndirect(0);
  glMemoryBarrier(GL_ALL_BARRIER_BITS);
}

}  // namespace colmap_ext
