#pragma once

#include <stdexcept>

namespace colmap_ext {

// What OpenGL or a shader's compiler objects to.
class GlError : public std::runtime_error {
 public:
  using std::runtime_error::runtime_error;
};

// There is no OpenGL 4.5 here.
class NoGlError : public GlError {
 public:
  using GlError::GlError;
};

}  // namespace colmap_ext
