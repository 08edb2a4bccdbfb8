#pragma once

#include <cstddef>
#include <functional>
#include <memory>
#include <string>

#include "colmap_ext/options/refinement_options.h"
#include "photometry/image_pyramid.h"
#include "photometry/photometric_energy.h"

namespace colmap_ext {

using Warn = std::function<void(const std::string& warning)>;

// What computes the energy, and what to tell of it.
struct RefinementBackend {
  std::unique_ptr<PhotometricEnergy> energy;
  std::string description;  // and why it was taken, for Backend::kAuto
};

// By options.backend. Where the choice is free, OpenGL in software is not
// taken: the processor is faster without it. Where the graphics card fails
// later, the processor takes over.
//
// \param expected_facets  of the mesh, at the finest level.
// \param warn  called with lines for the user, now and as long as the energy
//        lives.
// \throw OptionError if OpenGL is asked for, and is not to be had.
RefinementBackend MakeBackend(const RefinerOptions& options,
                              std::shared_ptr<ImagePyramid> images,
                              size_t expected_facets, Warn warn);

}  // namespace colmap_ext
