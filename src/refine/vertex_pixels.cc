#include "refine/vertex_pixels.h"

#include <algorithm>
#include <cstddef>
#include <span>

#include <Eigen/Geometry>

#include "base/percentile.h"
#include "mesh/normals.h"

namespace colmap_ext {

namespace {

// Over the views of the best pairs around a vertex that it lies before; 0 if
// there are none.
float MeanFootprint(const Eigen::Vector3d& point,
                    std::span<const uint32_t> corners,
                    const FacetLabels& labels, const std::vector<View>& views) {
  double sum = 0;
  int count = 0;
  for (const uint32_t corner : corners) {
    const auto row = labels.labels[corner / 3];
    if (row.empty()) {
      continue;
    }
    const ViewPair& pair = labels.pairs[row.front()];
    for (const uint32_t view : {pair.first, pair.second}) {
      const double depth = views[view].CamFromWorld(point).z();
      if (depth > 0) {
        sum += depth / views[view].fx;
        ++count;
      }
    }
  }
  return count > 0 ? static_cast<float>(sum / count) : 0;
}

}  // namespace

std::vector<float> VertexFootprints(const TriangleMesh& mesh,
                                    const VertexRings& rings,
                                    const FacetLabels& labels,
                                    const std::vector<View>& views) {
  std::vector<float> footprints(mesh.vertices.size());
  std::vector<float> known;
  for (size_t i = 0; i < footprints.size(); ++i) {
    footprints[i] = MeanFootprint(mesh.vertices[i].cast<double>(),
                                  rings.corners[i], labels, views);
    if (footprints[i] > 0) {
      known.push_back(footprints[i]);
    }
  }
  if (known.empty()) {
    return footprints;
  }
  std::replace_if(
      footprints.begin(), footprints.end(),
      [](float footprint) { return !(footprint > 0); }, Percentile(50, &known));
  return footprints;
}

std::vector<uint8_t> SeenVertices(const TriangleMesh& mesh,
                                  const PhotometricTerms& terms) {
  std::vector<uint8_t> is_seen(mesh.vertices.size(), 0);
  for (size_t i = 0; i < mesh.facets.size(); ++i) {
    if (terms.facets[i].num_pixels > 0) {
      for (const uint32_t vertex : mesh.facets[i]) {
        is_seen[vertex] = 1;
      }
    }
  }
  return is_seen;
}

std::vector<float> PixelsOfVertices(const TriangleMesh& mesh,
                                    const PhotometricTerms& terms,
                                    const std::vector<float>& footprints) {
  std::vector<float> num_pixels(mesh.vertices.size(), 0);
  std::vector<float> areas(mesh.vertices.size(), 0);
  for (size_t i = 0; i < mesh.facets.size(); ++i) {
    const float area = AreaVector(mesh, mesh.facets[i]).norm() / 2;
    for (const uint32_t vertex : mesh.facets[i]) {
      num_pixels[vertex] += terms.facets[i].num_pixels / 3;
      areas[vertex] += area / 3;
    }
  }
  for (size_t i = 0; i < num_pixels.size(); ++i) {
    if (footprints[i] > 0) {
      num_pixels[i] =
          std::max(num_pixels[i], areas[i] / (footprints[i] * footprints[i]));
    }
  }
  return num_pixels;
}

}  // namespace colmap_ext
