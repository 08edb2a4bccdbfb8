#pragma once

#include <stdexcept>

namespace colmap_ext {

// An error of OpenGL or of a shader's compiler.
class GlError : public std::runtime_error {
 public:
  using std::runtime_error::runtime_error;
};

// OpenGL 4.5 is not available.
class NoGlError : public GlError {
 public:
  using GlError::GlError;
};

// Enables synchronous debug messages of the current OpenGL context.
// \pre it is a debug context
void EnableDebugOutput();

// Throws if OpenGL has reported an error since the last call: with its message
// if EnableDebugOutput() was called, else with the error's code.
// \param where  for the message
// \throw GlError
void ThrowOnGlError(const char* where);

}  // namespace colmap_ext
