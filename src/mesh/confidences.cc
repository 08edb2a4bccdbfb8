#include "mesh/confidences.h"

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <limits>

#include <tbb/parallel_for.h>
#include <tbb/parallel_sort.h>
#include <Eigen/Core>
#include <Eigen/Geometry>

#include "mesh/adjacency.h"
#include "mesh/normals.h"

namespace colmap_ext {
namespace {

// The support of a facet's corners for each pixel that it covers where it is
// seen best, and the support itself. A facet without area is small, one without
// views has neither.
struct FacetDensity {
  double density = 0;
  double support = 0;

  // NOLINTNEXTLINE(modernize-use-nullptr)
  auto operator<=>(const FacetDensity&) const = default;
};

// The pixels that the facet covers in the view that has most of them; -1
// if none of the views has it before its camera.
double PixelArea(const TriangleMesh& mesh, const Facet& facet,
                 const Rows<uint32_t>& vertex_views,
                 const std::vector<View>& views) {
  // As PhotometricOptions::min_cosine: a facet that is seen edge-on by all
  // views is one that none of them sees.
  constexpr double kMinCosine = 0.1;
  const auto [a, b, c] = CornersOf<double>(mesh, facet);
  const Eigen::Vector3d center = (a + b + c) / 3;
  const Eigen::Vector3d area_normal = (b - a).cross(c - a) / 2;
  double largest = -1;
  for (const uint32_t vertex : facet) {
    for (const uint32_t index : vertex_views[vertex]) {
      const View& view = views[index];
      const double depth = view.CamFromWorld(center).z();
      if (depth > 0) {
        const Eigen::Vector3d ray = (center - view.Center()).normalized();
        const double seen_area = std::max(std::abs(area_normal.dot(ray)),
                                          kMinCosine * area_normal.norm());
        largest =
            std::max(largest, seen_area * view.fx * view.fy / (depth * depth));
      }
    }
  }
  return largest;
}

// The density where half of the support is denser; 0 without support.
double UsualDensity(std::vector<FacetDensity> densities) {
  tbb::parallel_sort(densities.begin(), densities.end());
  double total = 0;
  for (const FacetDensity& density : densities) {
    total += density.support;
  }
  double sum = 0;
  for (const FacetDensity& density : densities) {
    sum += density.support;
    if (2 * sum >= total) {
      return density.density;
    }
  }
  return 0;
}

}  // namespace

std::vector<float> FacetConfidences(const TriangleMesh& mesh,
                                    const std::vector<float>& support,
                                    const Rows<uint32_t>& vertex_views,
                                    const std::vector<View>& views) {
  // The usual density has the confidence 1 - exp(-3) = 0.95, a tenth of it has
  // 0.26. A choice.
  constexpr double kUsual = 3;
  std::vector<FacetDensity> densities(mesh.facets.size());
  tbb::parallel_for(size_t{0}, densities.size(), [&](size_t i) {
    const auto& [a, b, c] = mesh.facets[i];
    const double sum = double{support[a]} + support[b] + support[c];
    const double area = PixelArea(mesh, mesh.facets[i], vertex_views, views);
    if (sum > 0 && area >= 0) {
      densities[i] = {
          sum / std::max(area, std::numeric_limits<double>::epsilon()), sum};
    }
  });
  const double usual = UsualDensity(densities);
  std::vector<float> confidences(densities.size(), 0);
  tbb::parallel_for(size_t{0}, usual > 0 ? densities.size() : 0, [&](size_t i) {
    confidences[i] =
        static_cast<float>(-std::expm1(-kUsual * densities[i].density / usual));
  });
  return confidences;
}

std::vector<float> VertexConfidences(
    const TriangleMesh& mesh, const std::vector<float>& facet_confidences) {
  const Rows<uint32_t> corners = CornersByVertex(mesh.facets);
  std::vector<float> confidences(mesh.vertices.size(), 0);
  tbb::parallel_for(size_t{0}, corners.size(), [&](size_t vertex) {
    double sum = 0;
    double sum_of_angles = 0;
    for (const uint32_t corner : corners[vertex]) {
      const uint32_t facet = corner / 3;
      const double angle =
          AngleVector(mesh, mesh.facets[facet], corner % 3).norm();
      sum += angle * facet_confidences[facet];
      sum_of_angles += angle;
    }
    if (sum_of_angles > 0) {
      confidences[vertex] =
          static_cast<float>(std::min(sum / sum_of_angles, 1.0));
    }
  });
  return confidences;
}

std::vector<float> MeanOfCorners(const std::vector<Facet>& facets,
                                 const std::vector<float>& values) {
  std::vector<float> means;
  means.reserve(facets.size());
  for (const auto& [a, b, c] : facets) {
    means.push_back((values[a] + values[b] + values[c]) / 3);
  }
  return means;
}

}  // namespace colmap_ext
