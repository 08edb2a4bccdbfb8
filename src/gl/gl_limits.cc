#include "gl/gl_limits.h"

#include <algorithm>
#include <array>

#include <epoxy/gl.h>

namespace colmap_ext {

namespace {

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

}  // namespace

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

}  // namespace colmap_ext
