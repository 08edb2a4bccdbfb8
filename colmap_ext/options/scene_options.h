#pragma once

#include <optional>
#include <string>

#include <Eigen/Core>

#include "colmap_ext/options/command_options.h"
#include "colmap_ext/options/region_option.h"

namespace colmap_ext {

// What of a scene a mesh is made of, and where it is put.
struct SceneOptions {
  std::string mask_path;       // a folder; empty: no masks
  std::string transform_path;  // of the mesh that is written; empty: none
  std::optional<Eigen::Matrix4d> transform;  // the same, read by Finish()
  RegionOption region;                       // nothing of the mesh is outside

  // \throw OptionError, FileError as RegionOption::Finish(); FileError if the
  //        transform can not be read.
  void Finish();
};

// Adds them to those of a command.
// \param what  the region says: "What is meshed".
// \param scene  has to outlive the manager's parsing.
void AddSceneOptions(CommandOptions* manager, const std::string& what,
                     SceneOptions* scene);

}  // namespace colmap_ext
