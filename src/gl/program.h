#pragma once

#include <map>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

#include <Eigen/Core>

#include "gl/gl_objects.h"

namespace colmap_ext {

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
  void Set(std::string_view uniform, int value);
  void Set(std::string_view uniform, unsigned int value);
  void Set(std::string_view uniform, float value);
  void Set(std::string_view uniform, double value);
  void Set(std::string_view uniform, const Eigen::Vector2i& value);
  void Set(std::string_view uniform, const Eigen::Vector2f& value);
  void Set(std::string_view uniform, const Eigen::Vector3f& value);
  void Set(std::string_view uniform, const Eigen::Matrix3f& value);
  void Set(std::string_view uniform, const Eigen::Vector2d& value);
  void Set(std::string_view uniform, const Eigen::Vector3d& value);
  void Set(std::string_view uniform, const Eigen::Matrix3d& value);

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
