#include "viewer/shown_mesh.h"

#include <cmath>
#include <unordered_map>

#include <Eigen/Geometry>

#include "base/index_limit.h"
#include "base/mix_bits.h"
#include "mesh/normals.h"
#include "pictures/drawings.h"
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

double AreaOf(const TriangleMesh& mesh) {
  double area = 0;
  for (const Facet& facet : mesh.facets) {
    area += 0.5 * AreaVector(mesh, facet).norm();
  }
  return area;
}

// [V] the first vertex in the same cube of a grid.
std::vector<uint32_t> FirstInCube(const TriangleMesh& mesh, double side) {
  std::vector<uint32_t> firsts;
  firsts.reserve(mesh.vertices.size());
  std::unordered_map<uint64_t, uint32_t> first_of_cube;
  for (uint32_t i = 0; i < mesh.vertices.size(); ++i) {
    uint64_t key = 0;
    for (int axis = 0; axis < 3; ++axis) {
      const auto place =
          static_cast<int64_t>(std::floor(mesh.vertices[i][axis] / side));
      key = MixBits(key ^ static_cast<uint64_t>(place));
    }
    firsts.push_back(first_of_cube.try_emplace(key, i).first->second);
  }
  return firsts;
}

template <typename T>
void Keep(const std::vector<T>& values, uint32_t index, std::vector<T>* kept) {
  if (!values.empty()) {
    kept->push_back(values[index]);
  }
}

}  // namespace

const char* NameOf(MeshMode mode) {
  constexpr const char* kNames[] = {"shaded", "color", "normals",
                                    "labels", "error", "confidence"};
  return kNames[static_cast<int>(mode)];
}

MeshColors ColorsByMode(const ShownMesh& mesh, MeshMode mode) {
  // Shading of colors of a scale, so that the shape stays visible. Chosen by
  // hand.
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
    return mesh.name + " has no vertex colors";
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

ShownMesh CoarseMesh(const ShownMesh& mesh, size_t max_facets) {
  // Two facets for a square of a cube's side.
  const double side =
      std::sqrt(2 * AreaOf(mesh.mesh) / static_cast<double>(max_facets));
  const std::vector<uint32_t> firsts =
      FirstInCube(mesh.mesh, side > 0 ? side : 1);
  ShownMesh coarse;
  coarse.name = mesh.name;
  std::vector<uint32_t> new_index(firsts.size(), kNone);
  for (uint32_t i = 0; i < mesh.mesh.facets.size(); ++i) {
    Facet facet;
    for (int k = 0; k < 3; ++k) {
      facet[k] = firsts[mesh.mesh.facets[i][k]];
    }
    if (facet[0] == facet[1] || facet[1] == facet[2] || facet[2] == facet[0]) {
      continue;
    }
    for (uint32_t& vertex : facet) {
      if (new_index[vertex] == kNone) {
        new_index[vertex] = static_cast<uint32_t>(coarse.mesh.vertices.size());
        coarse.mesh.vertices.push_back(mesh.mesh.vertices[vertex]);
        Keep(mesh.colors, vertex, &coarse.colors);
        Keep(mesh.error_colors, vertex, &coarse.error_colors);
        Keep(mesh.confidences, vertex, &coarse.confidences);
      }
      vertex = new_index[vertex];
    }
    coarse.mesh.facets.push_back(facet);
    Keep(mesh.labels, i, &coarse.labels);
  }
  return coarse;
}

}  // namespace colmap_ext
