#pragma once

#include <filesystem>
#include <optional>
#include <string>
#include <vector>

#include <Eigen/Core>

#include "formats/atomic_file.h"
#include "scene/region.h"
#include "scene/view.h"

namespace colmap_ext {

// What --region has: nothing, "auto", two corners "x0,y0,z0,x1,y1,z1", or a
// file that ReadRegion() reads.
struct RegionOption {
  std::string text;  // as it is typed

  // The same, read by Finish().
  bool is_auto = false;
  std::optional<Region> region;

  // \throw OptionError if it is none of these; FileError if the file is no
  //        region.
  void Finish();

  // The region: for "auto" the FocusRegion().
  // \pre finished
  // \throw OptionError if no region is found.
  std::optional<Region> Resolve(
      const std::vector<View>& views,
      const std::vector<Eigen::Vector3f>& sparse_points) const;
};

// Path of the file for a found region: "mesh.region.txt" for "mesh.ply".
std::filesystem::path RegionPath(const std::filesystem::path& mesh_path);

// Writes a region that was found automatically, if the option requests that,
// beside the mesh and together with it.
// \throw FileError if it can not be written.
void WriteFoundRegion(const RegionOption& option,
                      const std::optional<Region>& region,
                      const std::filesystem::path& mesh_path,
                      AtomicFiles* together);

}  // namespace colmap_ext
