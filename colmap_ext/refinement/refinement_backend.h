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
  std::string description;  // and why it was taken, for "auto"
  std::string warning;      // empty: none
};

// By the option `backend`: "gl" is OpenGL, "cpu" the processor, and "auto"
// OpenGL where a graphics card has it, for the processor is faster without
// OpenGL in software.
//
// \throw OptionError if OpenGL is asked for, and is not to be had.
RefinementBackend MakeBackend(const RefinerOptions& options,
                              std::shared_ptr<ImagePyramid> images);

}  // namespace colmap_ext
