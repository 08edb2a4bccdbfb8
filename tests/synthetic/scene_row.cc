#include "tests/synthetic/scene_row.h"

#include <cstdint>
#include <string>
#include <vector>

namespace colmap_ext::synthetic {
namespace {

std::vector<View> Moved(std::vector<View> views, const std::string& prefix,
                        const Eigen::Vector3d& offset) {
  for (View& view : views) {
    view.name = prefix + view.name;
    view.cam_from_world_translation -= view.cam_from_world_rotation * offset;
  }
  return views;
}

template <typename T>
void Append(const std::vector<T>& from, std::vector<T>* to) {
  to->insert(to->end(), from.begin(), from.end());
}

void AddMesh(const TriangleMesh& mesh, const Eigen::Vector3f& offset,
             TriangleMesh* row) {
  const auto first = static_cast<uint32_t>(row->vertices.size());
  for (const Eigen::Vector3f& vertex : mesh.vertices) {
    row->vertices.push_back(vertex + offset);
  }
  for (const auto& [a, b, c] : mesh.facets) {
    row->facets.push_back({a + first, b + first, c + first});
  }
}

void AddPoints(const FusedPoints& points, const Eigen::Vector3f& offset,
               uint32_t first_view, FusedPoints* row) {
  for (size_t i = 0; i < points.cloud.size(); ++i) {
    row->cloud.positions.push_back(points.cloud.positions[i] + offset);
    for (const uint32_t view : points.cloud.views[i]) {
      row->cloud.views.values.push_back(view + first_view);
    }
    row->cloud.views.EndRow();
  }
  Append(points.cloud.colors, &row->cloud.colors);
  Append(points.normals, &row->normals);
  Append(points.is_outlier, &row->is_outlier);
}

void AddSparse(const std::vector<SparsePoint>& points,
               const Eigen::Vector3d& offset, uint32_t first_view,
               std::vector<SparsePoint>* row) {
  for (SparsePoint point : points) {
    point.position += offset;
    for (Feature& feature : point.track) {
      feature.view += first_view;
    }
    row->push_back(point);
  }
}

}  // namespace

DenseScene MakeSceneRow(const DenseScene& scene, int num_copies,
                        const Eigen::Vector3d& offset) {
  DenseScene row;
  for (int copy = 0; copy < num_copies; ++copy) {
    const Eigen::Vector3d shift = copy * offset;
    const std::string prefix = std::to_string(copy) + "_";
    const auto first_view = static_cast<uint32_t>(row.model_views.size());
    AddMesh(scene.scene.surface, shift.cast<float>(), &row.scene.surface);
    Append(Moved(scene.scene.views, prefix, shift), &row.scene.views);
    Append(Moved(scene.model_views, prefix, shift), &row.model_views);
    Append(scene.images, &row.images);
    AddPoints(scene.fused, shift.cast<float>(), first_view, &row.fused);
    AddSparse(scene.sparse_points, shift, first_view, &row.sparse_points);
  }
  return row;
}

}  // namespace colmap_ext::synthetic
