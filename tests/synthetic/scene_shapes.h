#pragma once

#include <string>
#include <vector>

#include <Eigen/Core>

#include "scene/view.h"
#include "tests/synthetic/isosurface.h"
#include "tests/synthetic/scene.h"

namespace colmap_ext::synthetic {

// The properties of a kind of scene.
struct SceneShape {
  std::string name;
  Solid (*make_solid)(const SceneOptions& options);
  std::vector<View> (*make_views)(const SceneOptions& options);
  Eigen::Vector3f to_sun;  // any length
  Patch blank;             // of SceneOptions::untextured
  Patch shiny;             // of SceneOptions::gloss
};

// Returns nullptr for an unknown name.
const SceneShape* FindSceneShape(const std::string& name);

}  // namespace colmap_ext::synthetic
