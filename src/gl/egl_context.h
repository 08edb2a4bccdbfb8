#pragma once

#include <cstddef>
#include <stdexcept>
#include <string>

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

// Throws if OpenGL has reported an error since the last call. With MESA_DEBUG=1
// in the environment Mesa prints which function failed.
// \param where  for the message
// \throw GlError
void ThrowOnGlError(const char* where);

// An OpenGL 4.5 core context without a window or a display: on a graphics
// card's own EGL device where there is one, else by Mesa in software.
class EglContext {
 public:
  // While it exists, the context is current in the calling thread; then the
  // previous one is restored. The context must outlive the scope.
  class [[nodiscard]] Scope {
   public:
    ~Scope();
    Scope(const Scope&) = delete;
    Scope& operator=(const Scope&) = delete;

   private:
    friend class EglContext;
    Scope(void* display, void* context);

    void* display_;
    void* previous_display_;
    void* previous_context_;
  };

  // \param gpu_index  of the graphics cards, as EGL lists them; -1: the first
  //        that has what is needed, or software.
  // \throw NoGlError if there is none; says what was tried.
  explicit EglContext(int gpu_index = -1);
  ~EglContext();
  EglContext(const EglContext&) = delete;
  EglContext& operator=(const EglContext&) = delete;

  // To be used by one thread at a time.
  // \throw GlError if it is another thread's current one.
  Scope MakeCurrent() const;

  // As OpenGL names it, "llvmpipe (LLVM 15.0.6, 256 bits)".
  const std::string& RendererName() const { return renderer_name_; }

  // The processor draws, not a graphics card.
  bool IsSoftware() const { return is_software_; }

 private:
  std::string TryPlatform(unsigned int platform, void* native);

  void* display_ = nullptr;  // EGLDisplay
  void* context_ = nullptr;  // EGLContext
  std::string renderer_name_;
  bool is_software_ = false;
};

// Whether there is a graphics card with OpenGL. Where neither EGL nor the
// system lists one, Mesa's drivers are not loaded, which take 60 MB.
bool HasGraphicsCard(int gpu_index);

// Limits of a graphics card.
struct GlLimits {
  size_t max_block = SIZE_MAX;   // of a buffer that a shader reaches at a time,
                                 // bytes
  size_t max_memory = SIZE_MAX;  // of all buffers and textures together, as far
                                 // as they are free, bytes; SIZE_MAX: not known
  size_t max_loops = SIZE_MAX;   // of all loops of a shader together: runs
};

// Of the card of the current context, or `at_most` where that is less.
// \param is_software  the processor draws: there is no memory but the host's,
//        and loops end early.
GlLimits FindGlLimits(const GlLimits& at_most, bool is_software);

}  // namespace colmap_ext
