#include "gl/gl_error.h"

#include <string>
#include <utility>

#include <epoxy/gl.h>

namespace colmap_ext {

namespace {

// The first message since the last ThrowOnGlError(). Debug output is
// synchronous: what the thread's own calls lead to.
thread_local std::string pending_message;

// Exceptions must not cross the driver, so that messages wait for
// ThrowOnGlError().
void KeepErrors(GLenum source, GLenum type, GLuint /*id*/, GLenum /*severity*/,
                GLsizei length, const GLchar* text,
                const void* /*user*/) noexcept {
  const bool is_error =
      type == GL_DEBUG_TYPE_ERROR || type == GL_DEBUG_TYPE_UNDEFINED_BEHAVIOR;
  // Compiler messages are read from the info logs of the shaders.
  const bool is_compiler = source == GL_DEBUG_SOURCE_SHADER_COMPILER;
  if (is_error && !is_compiler && pending_message.empty()) {
    pending_message.assign(text, length);
  }
}

const char* ErrorName(GLenum error) {
  switch (error) {
    case GL_INVALID_ENUM:
      return "invalid enumerant";
    case GL_INVALID_VALUE:
      return "invalid value";
    case GL_INVALID_OPERATION:
      return "invalid operation";
    case GL_INVALID_FRAMEBUFFER_OPERATION:
      return "invalid framebuffer operation";
    case GL_OUT_OF_MEMORY:
      return "out of memory";
    default:
      return "unknown error";
  }
}

}  // namespace

void EnableDebugOutput() {
  glEnable(GL_DEBUG_OUTPUT);
  glEnable(GL_DEBUG_OUTPUT_SYNCHRONOUS);
  glDebugMessageCallback(KeepErrors, nullptr);
  pending_message.clear();
}

void ThrowOnGlError(const char* where) {
  GLenum first = GL_NO_ERROR;
  for (GLenum error = glGetError(); error != GL_NO_ERROR;
       error = glGetError()) {
    first = first == GL_NO_ERROR ? error : first;
    if (error == GL_CONTEXT_LOST) {  // It would be said for ever.
      throw GlError(std::string(where) + ": the graphics card was reset");
    }
  }
  const std::string message = std::exchange(pending_message, {});
  if (!message.empty()) {
    throw GlError(std::string(where) + ": OpenGL: " + message);
  }
  if (first != GL_NO_ERROR) {
    throw GlError(std::string(where) + ": OpenGL: " + ErrorName(first));
  }
}

}  // namespace colmap_ext
