#include "colmap_ext/options/scene_options.h"

#include "formats/read_numbers.h"

namespace colmap_ext {

void RegionOption::Finish() {
  is_auto = text == "auto";
  if (text.empty() || is_auto) {
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
  RefuseIf(
      !found,
      "--region auto finds too few sparse points in the images; give a box");
  return found;
}

std::filesystem::path RegionOption::FoundPath(
    std::filesystem::path mesh_path) const {
  return is_auto ? mesh_path.replace_extension(".region.txt") : "";
}

void RegionOption::WriteFound(const std::optional<Region>& found,
                              const std::filesystem::path& mesh_path,
                              AtomicFiles* together) const {
  if (is_auto && found) {
    WriteText(FoundPath(mesh_path), RegionText(*found), together);
  }
}

void SceneOptions::Finish() {
  region.Finish();
  if (!transform_path.empty()) {
    transform = ReadTransform(transform_path);
  }
}

void AddRegionOption(const std::string& effect, RegionOption* region,
                     const std::string& automatic, CommandOptions* options) {
  options->Add(
      "region", &region->text,
      effect +
          " this region: two opposite corners x0,y0,z0,x1,y1,z1 of a box, or a "
          "file, such as that of stereo_fusion --bbox_path (docs/tuning.md)" +
          automatic);
}

void AddMaskOption(std::string* mask_path, CommandOptions* options) {
  options->Add("mask_path", mask_path,
               "Folder of image masks, PNG: image.jpg.png for image.jpg. "
               "Pixels of value 0 are ignored");
}

void AddTransformOption(std::string* transform_path, CommandOptions* options) {
  options->Add("transform_path", transform_path,
               "Transform the written mesh by this file of model_aligner; its "
               "positions are double then");
}

void AddImageOrderOption(std::optional<ImageOrderKind>* order,
                         CommandOptions* options) {
  options->AddWord("image_order", order,
                   {{"auto", std::nullopt},
                    {"file", ImageOrderKind::kFile},
                    {"image_id", ImageOrderKind::kImageId},
                    {"frame", ImageOrderKind::kFrame},
                    {"frame_id", ImageOrderKind::kFrameId}},
                   "Order of the images by which .vis files number them. Set "
                   "it if the command asks for it");
}

void AddFusedPathOption(CommandOptions::Value path, CommandOptions* options) {
  options->Add(
      "fused_path", path,
      "Fused points, PLY, with their .vis. Default: WORKSPACE/fused.ply");
}

void AddSparsePathOption(CommandOptions::Value path, CommandOptions* options) {
  options->Add("sparse_path", path,
               "Sparse model with the cameras, or a folder that has one, such "
               "as WORKSPACE/sparse-refined. Default: WORKSPACE/sparse");
}

void AddGpuIndexOption(int* gpu_index, CommandOptions* options) {
  options->Add("gpu_index", gpu_index, kCountOrMinusOne,
               "Graphics card, by its index in EGL's device list; -1: the "
               "first suitable one");
}

}  // namespace colmap_ext
