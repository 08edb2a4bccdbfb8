#pragma once

#include <cstddef>
#include <cstdint>

namespace colmap_ext {

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
