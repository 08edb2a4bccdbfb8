#include "colmap_ext/options/region_option.h"

#include "colmap_ext/errors.h"
#include "formats/read_region.h"
#include "scene/focus_region.h"

namespace colmap_ext {

void RegionOption::Finish() {
  if (text.empty()) {
    return;
  }
  is_auto = text == "auto";
  if (is_auto) {
    return;
  }
  region = ParseCorners(text);
  if (!region && !std::filesystem::exists(text)) {
    throw OptionError(
        "--region is auto, two opposite corners x0,y0,z0,x1,y1,z1 of a box, or "
        "a file, but not " +
        text);
  }
  if (!region) {
    region = ReadRegion(text);
  }
}

std::optional<Region> RegionOption::Resolve(
    const std::vector<View>& views,
    const std::vector<Eigen::Vector3f>& sparse_points) const {
  if (!is_auto) {
    return region;
  }
  std::optional<Region> found = FocusRegion(views, sparse_points);
  if (!found) {
    throw OptionError(
        "--region auto finds too few sparse points in the images; give a box");
  }
  return found;
}

std::filesystem::path RegionPath(const std::filesystem::path& mesh_path) {
  return std::filesystem::path(mesh_path).replace_extension(".region.txt");
}

void WriteFoundRegion(const RegionOption& option,
                      const std::optional<Region>& region,
                      const std::filesystem::path& mesh_path,
                      AtomicFiles* together) {
  if (option.is_auto && region) {
    WriteText(RegionPath(mesh_path), RegionText(*region), together);
  }
}

}  // namespace colmap_ext
