#pragma once

#include <memory>

#include "photometry/image_pyramid.h"
#include "photometry/photometric_energy.h"

namespace colmap_ext {

// The energy by the processor alone, in parallel over the pairs' directions.
// Results do not depend on the number of threads.
//
// \param max_memory  of the views' drawn facets that are kept, bytes; more are
//        drawn again when they are needed.
// \pre options in their ranges
std::unique_ptr<PhotometricEnergy> MakeCpuPhotometricEnergy(
    const PhotometricOptions& options, std::shared_ptr<ImagePyramid> images,
    size_t max_memory);

}  // namespace colmap_ext
