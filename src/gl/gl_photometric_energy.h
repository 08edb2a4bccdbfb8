#pragma once

#include <cstddef>
#include <memory>

#include "photometry/image_pyramid.h"
#include "photometry/photometric_energy.h"

namespace colmap_ext {

// The energy by OpenGL. It may be used by any thread, one at a time. Results
// are the same from run to run on one graphics card.
//
// \param gpu_index  see EglContext.
// \param max_memory  of the views that are kept on the graphics card, bytes;
//        the two of a pair whatever they take.
// \pre options in their ranges
// \throw NoGlError if there is no OpenGL 4.5; GlError if it fails, here and
//        later.
std::unique_ptr<PhotometricEnergy> MakeGlPhotometricEnergy(
    const PhotometricOptions& options, std::shared_ptr<ImagePyramid> images,
    int gpu_index, size_t max_memory);

}  // namespace colmap_ext
