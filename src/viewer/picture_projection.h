#pragma once

#include "gl/program.h"
#include "scene/view.h"

namespace colmap_ext {

// The camera of a picture, and what its depths need.
struct PictureProjection {
  View view;
  double near = 1e-3;  // nothing nearer is drawn, scene units
};

// Sets what viewer_projection.glsl needs.
void SetProjection(const PictureProjection& projection, Program* program);
// The part of it that viewer_mesh.frag needs, too.
void SetEye(const PictureProjection& projection, Program* program);

}  // namespace colmap_ext
