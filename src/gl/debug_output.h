#pragma once

namespace colmap_ext {

// Enables synchronous debug messages of the current OpenGL context.
// \pre it is a debug context
void EnableDebugOutput();

// Throws if OpenGL has reported an error since the last call: with its message
// if EnableDebugOutput() was called, else with the error's code.
// \param where  for the message
// \throw GlError
void ThrowOnGlError(const char* where);

}  // namespace colmap_ext
