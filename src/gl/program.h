#pragma once

#include <map>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

#include <Eigen/Core>

#include "gl/gl_objects.h"

namespace colmap_ext {

// The text of a file of shaders/, which is part of the program.
// \param name  of the file, without folders.
// \throw std::out_of_range if there is no such file.
std::string_view ShaderSource(std::string_view name);

struct DeleteProgram {
  void operator()(GLuint name) const { glDeleteProgram(name); }
};

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

  GlName<DeleteProgram> name_;
  std::string title_;  // for messages
  std::map<std::string, GLint, std::less<>> locations_;
};

// Runs a compute shader of workgroups of kGroupSize threads for `size` threads,
// at least; it sees what the ones before have written.
void Dispatch(const Program& program, size_t size);
// Runs as many workgroups as three numbers at the start of a buffer say.
void DispatchIndirect(const Program& program, const GlBuffer& num_groups);

}  // namespace colmap_ext
