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

// Runs a compute shader of workgroups of `group_size` threads for `size`
// threads, at least; it sees what the ones before have written.
void Dispatch(const Program& program, size_t size, int group_size);
void Dispatch(const Program& program, const Eigen::Vector2i& size,
              const Eigen::Vector2i& group_size);
// As many workgroups as three numbers at the start of a buffer say.
void DispatchIndirect(const Program& program, const GlBuffer& num_groups);

}  // namespace colmap_ext
