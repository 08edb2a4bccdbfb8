#include "colmap_ext/jobs/resumable_refinement.h"

#include <algorithm>
#include <optional>
#include <utility>

#include "colmap_ext/errors.h"
#include "gl/egl_context.h"
#include "gl/gl_error.h"
#include "gl/gl_photometric_energy.h"

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

std::unique_ptr<PhotometricEnergy> MakeGl(const RefinerOptions& options,
                                          std::shared_ptr<ImagePyramid> images,
                                          size_t expected_facets, Warn warn) {
  // Both directions of the first labels, one of the final ones.
  const FacetLabelingOptions& labeling = options.refinement.labeling;
  const int num_directions =
      std::max(2 * labeling.pairs_per_facet, labeling.final_pairs_per_facet);
  return MakeGlPhotometricEnergy(options.refinement.photometric,
                                 std::move(images),
                                 {options.gpu_index,
                                  options.MaxDrawingMemory(),
                                  {},
                                  expected_facets,
                                  static_cast<size_t>(num_directions),
                                  std::move(warn)});
}

RefinementBackend Describe(std::unique_ptr<PhotometricEnergy> energy,
                           const std::string& reason = "") {
  const std::string description = energy->Description() + reason;
  return {std::move(energy), description};
}

}  // namespace

RefinementBackend MakeBackend(const RefinerOptions& options,
                              std::shared_ptr<ImagePyramid> images,
                              size_t expected_facets, const Warn& warn) {
  const auto make_cpu = [&] {
    return MakeCpuPhotometricEnergy(options.refinement.photometric, images,
                                    options.MaxDrawingMemory());
  };
  if (options.backend == Backend::kCpu) {
    return Describe(make_cpu());
  }
  const std::optional<bool> is_software = IsGlSoftware(options.gpu_index);
  if (options.backend == Backend::kGl) {
    if (is_software.value_or(false)) {
      warn(
          "OpenGL is drawn by software here, which is slower than "
          "--FacetwiseRefinement.backend cpu");
    }
    try {
      return Describe(MakeGl(options, images, expected_facets, warn));
    } catch (const NoGlError& error) {
      throw OptionError(std::string(error.what()) +
                        "; --FacetwiseRefinement.backend cpu needs none");
    }
  }
  if (is_software.has_value() && !*is_software) {
    try {
      return Describe(MakeGl(options, images, expected_facets, warn));
    } catch (const GlError& error) {
      warn(std::string("the graphics card can not be used (") + error.what() +
           "); the processor computes all");
    }
  }
  return Describe(make_cpu(), !is_software   ? "; there is no OpenGL here"
                              : *is_software ? "; OpenGL would be software here"
                                             : "");
}

}  // namespace colmap_ext
