#pragma once

#include <memory>
#include <string>

#include "colmap_ext/options/refinement_options.h"
#include "photometry/image_pyramid.h"
#include "photometry/photometric_energy.h"

namespace colmap_ext {

// What computes the energy, and what to tell of it.
struct RefinementBackend {
  std::unique_ptr<PhotometricEnergy> energy;
  std::string description;  // and why it was taken, for Backend::kAuto
  std::string warning;      // empty: none
};

// By options.backend. Where the choice is free, OpenGL in software is not
// taken: the processor is faster without it.
//
// \throw OptionError if OpenGL is asked for, and is not to be had.
RefinementBackend MakeBackend(const RefinerOptions& options,
                              std::shared_ptr<ImagePyramid> images);

}  // namespace colmap_ext
