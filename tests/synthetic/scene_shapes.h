#pragma once

#include <string>
#include <vector>

#include <Eigen/Core>

#include "scene/view.h"
#include "tests/synthetic/isosurface.h"
#include "tests/synthetic/scene.h"

namespace colmap_ext::synthetic {

// What makes one scene differ from another.
struct SceneShape {
  std::string name;
  Solid (*make_solid)(const SceneOptions& options);
  std::vector<View> (*make_views)(const SceneOptions& options);
  Eigen::Vector3f to_sun;  // any length
  Patch blank;             // where SceneOptions::untextured takes effect
  Patch shiny;             // where SceneOptions::gloss does
};

// nullptr where there is none of the name.
const SceneShape* FindSceneShape(const std::string& name);

Solid MakeStatue(const SceneOptions& options);
Solid MakeWall(const SceneOptions& options);
Solid MakeGrid(const SceneOptions& options);

// Cameras all around the origin, in two rows.
std::vector<View> MakeViewsAround(const SceneOptions& options);

// Cameras on an arc before the plane y = 0.
std::vector<View> MakeViewsBefore(const SceneOptions& options);

}  // namespace colmap_ext::synthetic
