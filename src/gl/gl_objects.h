#pragma once

#include <cstddef>
#include <map>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

#include <epoxy/gl.h>
#include <Eigen/Core>

namespace colmap_ext {

// The name of an OpenGL object, which is deleted with it; 0: none. The context
// that it was made in has to be current whenever it is used.
template <typename Deleter>
class GlName {
 public:
  GlName() = default;
  explicit GlName(GLuint name) : name_(name) {}
  ~GlName() {
    if (name_ != 0) {
      Deleter()(name_);
    }
  }
  GlName(GlName&& other) noexcept : name_(std::exchange(other.name_, 0)) {}
  GlName& operator=(GlName&& other) noexcept {
    std::swap(name_, other.name_);
    return *this;
  }

  GLuint Get() const { return name_; }

 private:
  GLuint name_ = 0;
};

// \tparam kDelete  a variable of epoxy's: glDeleteShader or glDeleteProgram.
template <auto* kDelete>
struct Delete {
  void operator()(GLuint name) const { (*kDelete)(name); }
};

// \tparam kDelete  a variable of epoxy's: glDeleteBuffers and its like.
template <auto* kDelete>
struct DeleteOne {
  void operator()(GLuint name) const { (*kDelete)(1, &name); }
};

// An object that glCreate...() makes and glDelete...() deletes.
template <auto* kCreate, auto* kDelete>
class GlObject {
 public:
  GlObject()
      : name_([] {
          GLuint name = 0;
          (*kCreate)(1, &name);
          return name;
        }()) {}

  GLuint Name() const { return name_.Get(); }

 private:
  GlName<DeleteOne<kDelete>> name_;
};

using GlVertexArray = GlObject<&glCreateVertexArrays, &glDeleteVertexArrays>;

// A run of bytes on the graphics card. Like a pointer's, its constness is not
// that of the bytes.
class GlBuffer : public GlObject<&glCreateBuffers, &glDeleteBuffers> {
 public:
  // What was in it is lost; of another size it is made anew.
  // \throw GlError if there is no memory for it.
  void Resize(size_t num_bytes);
  // All bytes.
  void SetZero() const;

  template <typename T>
  void Assign(const std::vector<T>& values) {
    Resize(values.size() * sizeof(T));
    Write(values.data(), values.size() * sizeof(T));
  }

  // The first bytes.
  // \pre the buffer is as large as that, at least
  void Write(const void* data, size_t num_bytes) const;

  // \pre the buffer is as large as that, at least
  template <typename T>
  std::vector<T> Read(size_t count) const {
    std::vector<T> values(count);
    ReadBytes(values.data(), count * sizeof(T));
    return values;
  }

  size_t NumBytes() const { return num_bytes_; }

  // For `layout(std430, binding = index) buffer`.
  // \throw GlError if it is larger than shaders can use.
  void BindToStorage(GLuint index) const;
  // A part of it, that begins at a multiple of 256 bytes.
  void BindToStorage(GLuint index, size_t first_byte, size_t num_bytes) const;

 private:
  void ReadBytes(void* data, size_t num_bytes) const;

  size_t num_bytes_ = 0;
};

// A two-dimensional texture of a single level, read pixel by pixel.
class GlTexture {
 public:
  // \param format  how it is kept, e.g. GL_R32F
  // \throw GlError if it is too large, or there is no memory for it.
  GlTexture(GLenum format, int width, int height);

  // All pixels, rows from the first.
  // \param format, type  of `pixels`, e.g. GL_RED, GL_FLOAT
  void Write(GLenum format, GLenum type, const void* pixels) const;
  template <typename T>
  std::vector<T> Read(GLenum format, GLenum type) const {
    std::vector<T> pixels(static_cast<size_t>(width_) * height_);
    ReadBytes(format, type, pixels.data(), pixels.size() * sizeof(T));
    return pixels;
  }

  int Width() const { return width_; }
  int Height() const { return height_; }
  GLuint Name() const { return name_.Get(); }

  // For `layout(binding = index) uniform sampler2D`.
  void BindToSampler(GLuint index) const;
  // For `layout(binding = index, ...) uniform image2D`.
  void BindToImage(GLuint index, GLenum access) const;

 private:
  void ReadBytes(GLenum format, GLenum type, void* pixels,
                 size_t num_bytes) const;

  GlName<DeleteOne<&glDeleteTextures>> name_;
  GLenum format_ = 0;
  int width_ = 0;
  int height_ = 0;
};

class GlFramebuffer
    : public GlObject<&glCreateFramebuffers, &glDeleteFramebuffers> {
 public:
  // \param attachment  e.g. GL_COLOR_ATTACHMENT0
  void Attach(GLenum attachment, const GlTexture& texture) const {
    glNamedFramebufferTexture(Name(), attachment, texture.Name(), 0);
  }
};

// The text of a file of shaders/, which is part of the program.
// \param name  of the file, without folders.
// \throw std::out_of_range if there is no such file.
std::string_view ShaderSource(std::string_view name);

// Threads of a workgroup of the compute shaders that have one thread a facet,
// or a word of facets; all shaders are compiled with it. A choice: a multiple
// of the 32 or 64 threads that cards run at a time.
inline constexpr int kGroupSize = 64;

// Integers that a shader is compiled with, `const int <name> = <value>;`.
using ShaderConstants = std::vector<std::pair<std::string, int>>;

// A linked program of shaders, and its uniforms.
class Program {
 public:
  // \param shaders  names of files of shaders/; .vert, .frag, .comp say what
  //        they are.
  // \throw GlError with the compiler's words.
  explicit Program(const std::vector<std::string>& shaders,
                   const ShaderConstants& constants = {});

  // Sets a uniform.
  // \throw GlError if the program has none of that name.
  void Set(std::string_view name, int value) {
    glProgramUniform1i(name_.Get(), Location(name), value);
  }
  void Set(std::string_view name, unsigned int value) {
    glProgramUniform1ui(name_.Get(), Location(name), value);
  }
  void Set(std::string_view name, float value) {
    glProgramUniform1f(name_.Get(), Location(name), value);
  }
  void Set(std::string_view name, double value) {
    glProgramUniform1d(name_.Get(), Location(name), value);
  }
  void Set(std::string_view name, const Eigen::Vector2i& value) {
    glProgramUniform2iv(name_.Get(), Location(name), 1, value.data());
  }
  void Set(std::string_view name, const Eigen::Vector2f& value) {
    glProgramUniform2fv(name_.Get(), Location(name), 1, value.data());
  }
  void Set(std::string_view name, const Eigen::Vector3f& value) {
    glProgramUniform3fv(name_.Get(), Location(name), 1, value.data());
  }
  void Set(std::string_view name, const Eigen::Matrix3f& value) {
    glProgramUniformMatrix3fv(name_.Get(), Location(name), 1, GL_FALSE,
                              value.data());
  }
  void Set(std::string_view name, const Eigen::Vector2d& value) {
    glProgramUniform2dv(name_.Get(), Location(name), 1, value.data());
  }
  void Set(std::string_view name, const Eigen::Vector3d& value) {
    glProgramUniform3dv(name_.Get(), Location(name), 1, value.data());
  }
  void Set(std::string_view name, const Eigen::Matrix3d& value) {
    glProgramUniformMatrix3dv(name_.Get(), Location(name), 1, GL_FALSE,
                              value.data());
  }

  void Use() const { glUseProgram(name_.Get()); }

 private:
  void FindUniforms();
  GLint Location(std::string_view uniform) const;

  GlName<Delete<&glDeleteProgram>> name_;
  std::string title_;  // for messages
  std::map<std::string, GLint, std::less<>> locations_;
};

// Runs a compute shader of workgroups of kGroupSize threads for `size` threads,
// at least; it sees what the ones before have written.
void Dispatch(const Program& program, size_t size);

// The same, for several runs that do not read what the others write: what does
// has to come after a glMemoryBarrier().
void DispatchWithoutBarrier(const Program& program, size_t size);

// Runs as many workgroups as three numbers at the start of a buffer say.
void DispatchIndirect(const Program& program, const GlBuffer& num_groups);

}  // namespace colmap_ext
