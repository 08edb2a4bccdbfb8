#pragma once

#include <cstdint>
#include <vector>

#include "cameras/refine_cameras.h"
#include "tests/refine/refinement_scene.h"

namespace colmap_ext {

// A statue rendered by known cameras, and its features, as a refinement of
// cameras takes them.
struct CameraScene {
  RefinementScene scene;
  CameraSet truth;
  SparseTracks tracks;  // observed by the true cameras
  std::vector<ViewPair> pairs;

  // Refines cameras at level 0 on the true surface.
  RefinedCameras Refine(const CameraRefinementOptions& options,
                        const CameraSet& start, const SparseTracks& used) const;
};

// \param with_own_cameras  each view has a camera of its own.
// \param width  of the images, px.
CameraScene MakeCameraScene(bool with_own_cameras = false, int width = 160);

// The cameras turned and moved at random, so that what they see moves by about
// so many px, RMS.
CameraSet Disturb(const CameraScene& scene, const CameraSet& cameras,
                  double pixels, uint64_t seed);

// How far the tracks' true points move in the views that see them, from one set
// of cameras to another: RMS, px.
// \param view  of this alone; -1 of all.
double Distance(const CameraScene& scene, const CameraSet& a,
                const CameraSet& b, int view = -1);

}  // namespace colmap_ext
