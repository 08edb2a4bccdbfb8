#include "evaluation/surface_samples.h"

#include <array>
#include <stdexcept>

#include <Eigen/Geometry>

namespace colmap_ext {
namespace {

using Eigen::Vector3d;

using Triangle = std::array<Vector3d, 3>;

// \param side  is set to the longest: it goes from that corner to the next.
double LongestSide(const Triangle& triangle, int* side) {
  double longest = -1;
  for (int i = 0; i < 3; ++i) {
    const double length = (triangle[(i + 1) % 3] - triangle[i]).norm();
    if (length > longest) {
      longest = length;
      *side = i;
    }
  }
  return longest;
}

// About how many samples a facet takes: as many as squares of the spacing fit
// into it, but one for each spacing along a narrow one.
double EstimateCount(const Triangle& triangle, double spacing) {
  int side = 0;
  const double area =
      (triangle[1] - triangle[0]).cross(triangle[2] - triangle[0]).norm() / 2;
  return area / (spacing * spacing) + LongestSide(triangle, &side) / spacing;
}

void SampleTriangle(const Triangle& whole, double spacing,
                    std::vector<Triangle>* stack,
                    std::vector<Eigen::Vector3f>* samples) {
  // A corner is at most two thirds of the longest side from the centroid.
  const double max_side = 1.5 * spacing;
  stack->assign(1, whole);
  while (!stack->empty()) {
    const Triangle triangle = stack->back();
    stack->pop_back();
    int side = 0;
    if (LongestSide(triangle, &side) <= max_side) {
      samples->push_back(
          ((triangle[0] + triangle[1] + triangle[2]) / 3).cast<float>());
      continue;
    }
    const Vector3d& a = triangle[side];
    const Vector3d& b = triangle[(side + 1) % 3];
    const Vector3d& c = triangle[(side + 2) % 3];
    const Vector3d middle = (a + b) / 2;
    stack->push_back({a, middle, c});
    stack->push_back({middle, b, c});
  }
}

}  // namespace

std::vector<Eigen::Vector3f> SampleSurface(const TriangleMesh& mesh,
                                           double spacing) {
  constexpr double kMaxSamples = 1e9;  // 12 GB
  double num_samples = 0;
  std::vector<Triangle> triangles;
  triangles.reserve(mesh.facets.size());
  for (const Facet& facet : mesh.facets) {
    triangles.push_back({mesh.vertices[facet[0]].cast<double>(),
                         mesh.vertices[facet[1]].cast<double>(),
                         mesh.vertices[facet[2]].cast<double>()});
    num_samples += EstimateCount(triangles.back(), spacing);
  }
  if (num_samples > kMaxSamples) {
    throw std::invalid_argument(
        "the spacing of the samples is too small for the size of the mesh");
  }
  std::vector<Eigen::Vector3f> samples;
  std::vector<Triangle> stack;
  for (const Triangle& triangle : triangles) {
    SampleTriangle(triangle, spacing, &stack, &samples);
  }
  return samples;
}

}  // namespace colmap_ext
