#pragma once

#include <cstddef>
#include <functional>
#include <memory>
#include <string>

#include "gl/egl_context.h"
#include "photometry/image_pyramid.h"
#include "photometry/photometric_energy.h"

namespace colmap_ext {

struct GlOptions {
  int gpu_index = -1;  // see EglContext
  // Bytes: on the host, of visibility buffers (MakeCpuPhotometricEnergy); on a
  // card that does not report its memory, of views. Two views always fit.
  size_t max_memory = SIZE_MAX;
  // Used at most, where the card has more.
  GlLimits limits = {};
  // About how large the mesh will get: facets, and labels' directions of each.
  size_t expected_facets = 0;
  size_t expected_directions = 0;
  // Called with one line for the user, as part of what is called: when such a
  // mesh may not fit on the card, and when the processor takes over. May be
  // empty.
  std::function<void(const std::string& warning)> warn = {};
};

// The energy by OpenGL. It may be used by any thread, one at a time. Results
// are the same from run to run on one graphics card. Where the card runs out of
// memory or fails, the processor takes over for good, and nothing is lost.
//
// \pre options in their ranges
// \throw NoGlError if there is no OpenGL 4.5; GlError if it fails at once.
std::unique_ptr<PhotometricEnergy> MakeGlPhotometricEnergy(
    const PhotometricOptions& options, std::shared_ptr<ImagePyramid> images,
    GlOptions gl);

}  // namespace colmap_ext
