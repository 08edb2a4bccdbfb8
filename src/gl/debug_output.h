#pragma once

namespace colmap_ext {

// Lets OpenGL say what is wrong, in words, at once. Of the current context.
// \pre it is a debug context
void EnableDebugOutput();

// Throws if OpenGL has found something wrong since the last call: what it said,
// where EnableDebugOutput() was called, else the error's code.
// \param where  for the message
// \throw GlError
void ThrowOnGlError(const char* where);

}  // namespace colmap_ext
