#include "colmap_ext/jobs/refinement_backend.h"

#include <algorithm>
#include <optional>
#include <utility>

#include "colmap_ext/errors.h"
#include "gl/egl_context.h"
#include "gl/gl_error.h"
#include "gl/gl_photometric_energy.h"
#include "photometry/photometric_energy.h"

namespace colmap_ext {

namespace {

// Whether OpenGL would be software; nothing if there is none.
std::optional<bool> IsGlSoftware(int gpu_index) {
  try {
    return EglContext(gpu_index).IsSoftware();
  } catch (const NoGlError&) {
    return std::nullopt;
  }
}

RefinementBackend MakeGl(const RefinerOptions& options,
                         std::shared_ptr<ImagePyramid> images,
                         size_t expected_facets, Warn warn) {
  // Both directions of the first labels, one of the final ones.
  const FacetLabelingOptions& labeling = options.refinement.labeling;
  const int num_directions =
      std::max(2 * labeling.pairs_per_facet, labeling.final_pairs_per_facet);
  RefinementBackend backend;
  backend.energy =
      MakeGlPhotometricEnergy(options.refinement.photometric, std::move(images),
                              {options.gpu_index,
                               options.MaxDrawingMemory(),
                               {},
                               expected_facets,
                               static_cast<size_t>(num_directions),
                               std::move(warn)});
  backend.description = backend.energy->Description();
  return backend;
}

RefinementBackend MakeCpu(const RefinerOptions& options,
                          std::shared_ptr<ImagePyramid> images) {
  RefinementBackend backend;
  backend.energy =
      MakeCpuPhotometricEnergy(options.refinement.photometric,
                               std::move(images), options.MaxDrawingMemory());
  backend.description = backend.energy->Description();
  return backend;
}

}  // namespace

RefinementBackend MakeBackend(const RefinerOptions& options,
                              std::shared_ptr<ImagePyramid> images,
                              size_t expected_facets, Warn warn) {
  if (options.backend == Backend::kCpu) {
    return MakeCpu(options, std::move(images));
  }
  const std::optional<bool> is_software = IsGlSoftware(options.gpu_index);
  if (options.backend == Backend::kGl) {
    if (is_software.value_or(false)) {
      warn(
          "OpenGL is drawn by software here, which is slower than "
          "--FacetwiseRefinement.backend cpu");
    }
    try {
      return MakeGl(options, std::move(images), expected_facets,
                    std::move(warn));
    } catch (const NoGlError& error) {
      throw OptionError(std::string(error.what()) +
                        "; --FacetwiseRefinement.backend cpu needs none");
    }
  }
  if (is_software.has_value() && !*is_software) {
    try {
      return MakeGl(options, images, expected_facets, warn);
    } catch (const GlError& error) {
      warn(std::string("the graphics card can not be used (") + error.what() +
           "); the processor computes all");
    }
  }
  RefinementBackend backend = MakeCpu(options, std::move(images));
  if (is_software.value_or(true)) {
    backend.description += is_software ? "; OpenGL would be software here"
                                       : "; there is no OpenGL here";
  }
  return backend;
}

}  // namespace colmap_ext
