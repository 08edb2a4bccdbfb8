#pragma once

#include <array>
#include <filesystem>
#include <string>
#include <vector>

#include "colmap_ext/refinement/run_identity.h"
#include "refine/facetwise_refinement.h"
#include "scene/view.h"

namespace colmap_ext {

// What is refined of a view: fx, fy, cx, cy, the rotation by rows, the
// translation.
using CameraNumbers = std::array<double, 16>;

// [views]
std::vector<CameraNumbers> CameraNumbersOf(const std::vector<View>& views);

// The views with these numbers.
// \pre as many of both
std::vector<View> WithCameraNumbers(std::vector<View> views,
                                    const std::vector<CameraNumbers>& numbers);

// What OUTPUT.ply.resume says of an interrupted refinement: what run it
// belongs to, the files that the last complete level left, and the report up to
// there.
struct ResumeRecord {
  RunIdentity identity;
  int level = 0;     // the last one that is complete; 1 or more
  std::string mesh;  // fingerprints
  std::string visibility;
  std::string origins;
  std::string fixed;                   // "none" where no vertex stays
  std::vector<CameraNumbers> cameras;  // [views]
  RefinementReport report;  // steps, labelings, and counts up to the level
};

// As JSON. Numbers are read back as they were, also those that are not finite.
std::string ResumeText(const ResumeRecord& record);

// \param path  for the messages.
// \throw FileError if the text is damaged, or of another version of the
//        program. Allocates no more than a small multiple of the text's size.
ResumeRecord ParseResumeText(const std::string& text,
                             const std::filesystem::path& path);

}  // namespace colmap_ext
