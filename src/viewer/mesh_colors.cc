#include "viewer/mesh_colors.h"

#include "pictures/error_colors.h"
#include "pictures/mesh_renderer.h"

namespace colmap_ext {

namespace {

uint32_t Pack(const Color& color) {
  return color[0] | color[1] << 8 | color[2] << 16 | 0xFF000000U;
}

template <typename Value, typename Function>
std::vector<uint32_t> PackAll(const std::vector<Value>& values,
                              const Function& color_of) {
  std::vector<uint32_t> packed;
  packed.reserve(values.size());
  for (const Value& value : values) {
    packed.push_back(Pack(color_of(value)));
  }
  return packed;
}

const Color& Itself(const Color& color) { return color; }

}  // namespace

const char* NameOf(MeshMode mode) {
  constexpr const char* kNames[] = {"shaded", "color", "normals",
                                    "labels", "error", "confidence"};
  return kNames[static_cast<int>(mode)];
}

MeshColors ColorsByMode(const ShownMesh& mesh, MeshMode mode) {
  // Of colours that are read off a scale, as the surface has to be seen, too. A
  // choice.
  constexpr float kHalf = 0.5F;
  if (!MissingData(mesh, mode).empty()) {
    return {};
  }
  switch (mode) {
    case MeshMode::kShaded:
      return {};
    case MeshMode::kColor:
      return {ColorsOf::kVertices, PackAll(mesh.colors, Itself), 0};
    case MeshMode::kNormals:
      return {ColorsOf::kNormals, {}, 0};
    case MeshMode::kLabels:
      return {ColorsOf::kFacets, PackAll(mesh.labels, LabelColor), 1};
    case MeshMode::kErrors:
      return {ColorsOf::kVertices, PackAll(mesh.error_colors, Itself), kHalf};
    case MeshMode::kConfidence:
      return {
          ColorsOf::kVertices,
          PackAll(mesh.confidences,
                  [](float confidence) { return ErrorColor(confidence, 1); }),
          kHalf};
  }
  return {};
}

std::string MissingData(const ShownMesh& mesh, MeshMode mode) {
  if (mode == MeshMode::kColor && mesh.colors.empty()) {
    return mesh.name + " has no vertex colours";
  }
  if (mode == MeshMode::kLabels && mesh.labels.empty()) {
    return mesh.name +
           " has no labels; facetwise_refiner --labels_path writes them";
  }
  if (mode == MeshMode::kErrors && mesh.error_colors.empty()) {
    return mesh.name +
           " has no errors; mesh_evaluator --error_mesh_path writes them";
  }
  if (mode == MeshMode::kConfidence && mesh.confidences.empty()) {
    return mesh.name + " has no confidences";
  }
  return "";
}

}  // namespace colmap_ext
