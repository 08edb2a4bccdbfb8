#include "gl/egl_context.h"

#include <algorithm>
#include <array>
#include <cctype>
#include <filesystem>
#include <map>
#include <vector>

#define EGL_NO_X11
#define MESA_EGL_NO_X11_HEADERS

#include <dlfcn.h>
#include <epoxy/egl.h>
#include <epoxy/gl.h>

namespace colmap_ext {
namespace {

bool IsInstalled(const char* library) {
  return dlopen(library, RTLD_LAZY | RTLD_LOCAL) != nullptr;  // Kept open.
}

// The loader of OpenGL's functions ends the program where these are missing.
void CheckLibraries() {
  if (!IsInstalled("libEGL.so.1")) {
    throw NoGlError("No OpenGL: libEGL.so.1 is not installed");
  }
  if (!IsInstalled("libOpenGL.so.0") && !IsInstalled("libGL.so.1")) {
    throw NoGlError("No OpenGL: libOpenGL.so.0 is not installed");
  }
}

bool HasExtension(const char* extensions, const char* name) {
  return extensions != nullptr && epoxy_extension_in_string(extensions, name);
}

// The devices that are graphics cards.
std::vector<EGLDeviceEXT> GraphicsCards() {
  const char* extensions = eglQueryString(EGL_NO_DISPLAY, EGL_EXTENSIONS);
  if (!HasExtension(extensions, "EGL_EXT_platform_device") ||
      !(HasExtension(extensions, "EGL_EXT_device_base") ||
        HasExtension(extensions, "EGL_EXT_device_enumeration"))) {
    return {};
  }
  EGLint count = 0;
  if (!eglQueryDevicesEXT(0, nullptr, &count) || count == 0) {
    return {};
  }
  std::vector<EGLDeviceEXT> devices(count);
  eglQueryDevicesEXT(count, devices.data(), &count);
  devices.resize(count);
  std::erase_if(devices, [](EGLDeviceEXT device) {
    return HasExtension(eglQueryDeviceStringEXT(device, EGL_EXTENSIONS),
                        "EGL_MESA_device_software");
  });
  return devices;
}

// A context that reports resets of the graphics card, if supported: otherwise
// drivers may end the program.
EGLContext CreateContext(EGLDisplay display) {
  std::array<EGLint, 9> attributes = {
      EGL_CONTEXT_MAJOR_VERSION,
      4,
      EGL_CONTEXT_MINOR_VERSION,
      5,
      EGL_CONTEXT_OPENGL_PROFILE_MASK,
      EGL_CONTEXT_OPENGL_CORE_PROFILE_BIT,
      EGL_CONTEXT_OPENGL_RESET_NOTIFICATION_STRATEGY,
      EGL_LOSE_CONTEXT_ON_RESET,
      EGL_NONE};
  eglBindAPI(EGL_OPENGL_API);
  EGLContext context = eglCreateContext(display, EGL_NO_CONFIG_KHR,
                                        EGL_NO_CONTEXT, attributes.data());
  if (context != EGL_NO_CONTEXT) {
    return context;
  }
  attributes[6] = EGL_NONE;
  return eglCreateContext(display, EGL_NO_CONFIG_KHR, EGL_NO_CONTEXT,
                          attributes.data());
}

bool IsSoftwareRenderer(std::string name) {
  std::ranges::transform(name, name.begin(),
                         [](unsigned char c) { return std::tolower(c); });
  return std::ranges::any_of(
      std::array{"llvmpipe", "softpipe", "swrast", "software"},
      [&](const char* part) { return name.find(part) != std::string::npos; });
}

// Not used by anybody, bytes; SIZE_MAX if the driver does not tell.
size_t FreeMemory() {
  std::array<GLint, 4> kilobytes{};
  if (epoxy_has_gl_extension("GL_NVX_gpu_memory_info")) {
    glGetIntegerv(GL_GPU_MEMORY_INFO_CURRENT_AVAILABLE_VIDMEM_NVX,
                  kilobytes.data());
  } else if (epoxy_has_gl_extension("GL_ATI_meminfo")) {
    glGetIntegerv(GL_TEXTURE_FREE_MEMORY_ATI, kilobytes.data());
  }
  return kilobytes[0] > 0 ? size_t{1024} * kilobytes[0] : SIZE_MAX;
}

std::string ErrorName(GLenum error) {
  static const std::map<GLenum, const char*> names = {
      {GL_INVALID_ENUM, "invalid enumerant"},
      {GL_INVALID_VALUE, "invalid value"},
      {GL_INVALID_OPERATION, "invalid operation"},
      {GL_INVALID_FRAMEBUFFER_OPERATION, "invalid framebuffer operation"},
      {GL_OUT_OF_MEMORY, "out of memory"}};
  const auto found = names.find(error);
  return found != names.end() ? found->second : "unknown error";
}

}  // namespace

// \return what is missing; empty if the context has been made.
std::string EglContext::TryPlatform(unsigned int platform, void* native) {
  // EGL has one display for a platform and device. It is never terminated: that
  // would be for all who use it, and drivers leak when they are unloaded.
  display_ = eglGetPlatformDisplayEXT(platform, native, nullptr);
  if (display_ == EGL_NO_DISPLAY ||
      !eglInitialize(display_, nullptr, nullptr)) {
    return "its EGL display cannot be opened";
  }
  const char* extensions = eglQueryString(display_, EGL_EXTENSIONS);
  if (!HasExtension(extensions, "EGL_KHR_surfaceless_context") ||
      !(HasExtension(extensions, "EGL_KHR_no_config_context") ||
        HasExtension(extensions, "EGL_MESA_configless_context"))) {
    return "it cannot do without a window";
  }
  context_ = CreateContext(display_);
  if (context_ == EGL_NO_CONTEXT) {
    return "it has no OpenGL 4.5";
  }
  try {
    const Scope scope = MakeCurrent();
    renderer_name_ = reinterpret_cast<const char*>(glGetString(GL_RENDERER));
    is_software_ = IsSoftwareRenderer(renderer_name_);
  } catch (const GlError& error) {
    eglDestroyContext(display_, context_);
    return error.what();
  }
  return "";
}

EglContext::EglContext(int gpu_index) {
  CheckLibraries();
  const std::vector<EGLDeviceEXT> cards = GraphicsCards();
  const int num_cards = static_cast<int>(cards.size());
  if (gpu_index >= num_cards) {
    throw NoGlError("No graphics card " + std::to_string(gpu_index) +
                    ": EGL lists " + std::to_string(num_cards));
  }
  std::string tried;
  for (int i = std::max(gpu_index, 0); i < num_cards; ++i) {
    const std::string missing = TryPlatform(EGL_PLATFORM_DEVICE_EXT, cards[i]);
    if (missing.empty()) {
      return;
    }
    tried += "; graphics card " + std::to_string(i) + ": " + missing;
    if (gpu_index >= 0) {
      throw NoGlError("No OpenGL 4.5" + tried);
    }
  }
  if (!HasExtension(eglQueryString(EGL_NO_DISPLAY, EGL_EXTENSIONS),
                    "EGL_MESA_platform_surfaceless")) {
    throw NoGlError("No OpenGL 4.5" + tried +
                    "; no other graphics card's driver, and no Mesa");
  }
  const std::string missing =
      TryPlatform(EGL_PLATFORM_SURFACELESS_MESA, EGL_DEFAULT_DISPLAY);
  if (!missing.empty()) {
    throw NoGlError("No OpenGL 4.5" + tried + "; Mesa's software: " + missing);
  }
}

EglContext::~EglContext() { eglDestroyContext(display_, context_); }

EglContext::Scope EglContext::MakeCurrent() const {
  return Scope(display_, context_);
}

EglContext::Scope::Scope(void* display, void* context)
    : display_(display),
      previous_display_(eglGetCurrentDisplay()),
      previous_context_(eglGetCurrentContext()) {
  eglBindAPI(EGL_OPENGL_API);
  if (!eglMakeCurrent(display, EGL_NO_SURFACE, EGL_NO_SURFACE, context)) {
    throw GlError(
        "OpenGL cannot be used by this thread: the context is "
        "current in another one");
  }
}

EglContext::Scope::~Scope() {
  const bool had_context = previous_context_ != EGL_NO_CONTEXT;
  eglMakeCurrent(had_context ? previous_display_ : display_, EGL_NO_SURFACE,
                 EGL_NO_SURFACE, previous_context_);
}

bool HasGraphicsCard(int gpu_index) {
  try {
    CheckLibraries();
    return (!GraphicsCards().empty() || std::filesystem::exists("/dev/dri") ||
            std::filesystem::exists("/dev/dxg")) &&  // of WSL
           !EglContext(gpu_index).IsSoftware();
  } catch (const NoGlError&) {
    return false;
  }
}

GlLimits FindGlLimits(const GlLimits& at_most, bool is_software) {
  // The rest is left to the driver and to other programs: a choice.
  constexpr size_t kUsedTenths = 9;
  // Mesa's software ends a shader's loops, without a word, after 65535 runs in
  // all of them together. Some are left to the loops over a facet's corners.
  constexpr size_t kSoftwareLoops = 65'000;
  GLint64 max_block = 0;
  glGetInteger64v(GL_MAX_SHADER_STORAGE_BLOCK_SIZE, &max_block);
  const size_t memory = is_software ? SIZE_MAX : FreeMemory();
  return {std::min(at_most.max_block, static_cast<size_t>(max_block)),
          std::min(at_most.max_memory,
                   memory == SIZE_MAX ? memory : memory / 10 * kUsedTenths),
          std::min(at_most.max_loops, is_software ? kSoftwareLoops : SIZE_MAX)};
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
  if (first != GL_NO_ERROR) {
    throw GlError(std::string(where) + ": OpenGL: " + ErrorName(first));
  }
}

}  // namespace colmap_ext
