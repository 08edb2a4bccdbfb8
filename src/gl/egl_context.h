#pragma once

#include <string>

namespace colmap_ext {

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
  EglContext(EglContext&& other) noexcept;
  EglContext& operator=(EglContext&& other) noexcept;

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

}  // namespace colmap_ext
