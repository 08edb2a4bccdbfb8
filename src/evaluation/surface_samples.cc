#include "evaluation/mesh_evaluation.h"

#include <array>
#include <cmath>
#include <stdexcept>
#include <tuple>

#include <tbb/parallel_for.h>
#include <tbb/parallel_sort.h>
#include <Eigen/Geometry>

#include "scene/depth_maps.h"

namespace colmap_ext {
namespace {

bool IsDepth(float depth) { return std::isfinite(depth) && depth > 0; }

using Eigen::Vector3d;

using Corners = std::array<Vector3d, 3>;

// \param side  is set to the longest: it goes from that corner to the next.
double LongestSide(const Corners& triangle, int* side) {
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

// Approximate number of samples of a facet: its area over the squared spacing,
// but at least one per spacing along its longest side.
double EstimateCount(const Corners& triangle, double spacing) {
  int side = 0;
  const double area =
      (triangle[1] - triangle[0]).cross(triangle[2] - triangle[0]).norm() / 2;
  return area / (spacing * spacing) + LongestSide(triangle, &side) / spacing;
}

void SampleTriangle(const Corners& whole, double spacing,
                    std::vector<Corners>* stack,
                    std::vector<Eigen::Vector3f>* samples) {
  // A corner is at most two thirds of the longest side from the centroid.
  const double max_side = 1.5 * spacing;
  stack->assign(1, whole);
  while (!stack->empty()) {
    const Corners triangle = stack->back();
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

struct GridPoint {
  std::array<int32_t, 3> voxel;
  float offset_squared;  // from the voxel's center, in voxels
  Eigen::Vector3f point;
};

GridPoint Locate(const Eigen::Vector3f& point, double spacing) {
  constexpr double kMaxIndex = 2147483647;
  const Eigen::Array3d position = point.cast<double>().array() / spacing;
  const Eigen::Array3d voxel = position.floor();
  if (!(voxel.abs() < kMaxIndex).all()) {
    throw std::invalid_argument(
        "the spacing of the samples is too small for the extent of the scene");
  }
  return {{static_cast<int32_t>(voxel[0]), static_cast<int32_t>(voxel[1]),
           static_cast<int32_t>(voxel[2])},
          static_cast<float>((position - voxel - 0.5).matrix().squaredNorm()),
          point};
}

// A total order: points that compare equal are equal.
bool IsBefore(const GridPoint& a, const GridPoint& b) {
  const auto key = [](const GridPoint& p) {
    return std::tuple(p.voxel, p.offset_squared, p.point.x(), p.point.y(),
                      p.point.z());
  };
  return key(a) < key(b);
}

}  // namespace

DepthMap RenderDepths(const Bvh& surface, const View& view, int stride,
                      std::vector<int32_t>* facets) {
  DepthMap map = EmptyDepths(view.width, view.height, stride);
  if (facets != nullptr) {
    facets->assign(map.depths.size(), -1);
  }
  const Eigen::Vector3f eye = view.Center().cast<float>();
  tbb::parallel_for(0, (map.height + 1) / 2, [&](int row_pair) {
    for (int col = 0; col < map.width; col += 2) {
      const int row = 2 * row_pair;
      RayPacket rays;
      rays.origin = eye;
      for (int i = 0; i < 4; ++i) {
        rays.SetDirection(i, RayDirection(view, map.Pixel(col + i % 2) + 0.5,
                                          map.Pixel(row + i / 2) + 0.5));
      }
      const HitPacket hits = surface.Intersect(rays);
      for (int i = 0; i < 4; ++i) {
        if (hits.facet[i] >= 0 && row + i / 2 < map.height &&
            col + i % 2 < map.width) {
          const size_t index = map.Index(row + i / 2, col + i % 2);
          map.depths[index] = hits.distance[i];
          if (facets != nullptr) {
            (*facets)[index] = hits.facet[i];
          }
        }
      }
    }
  });
  return map;
}

double DepthErrors::Share(size_t threshold) const {
  return static_cast<double>(num_within[threshold]) /
         static_cast<double>(num_depths);
}

void AddDepthErrors(const DepthMap& truth, const DepthMap& mesh,
                    DepthErrors* errors) {
  errors->num_within.resize(errors->thresholds.size(), 0);
  for (size_t i = 0; i < truth.depths.size(); ++i) {
    if (!IsDepth(truth.depths[i])) {
      continue;
    }
    ++errors->num_depths;
    if (!IsDepth(mesh.depths[i])) {
      ++errors->num_missing;
      continue;
    }
    const double error = std::abs(double{mesh.depths[i]} - truth.depths[i]);
    for (size_t t = 0; t < errors->thresholds.size(); ++t) {
      errors->num_within[t] += error < errors->thresholds[t];
    }
  }
}

std::vector<Eigen::Vector3f> SampleSurface(const TriangleMesh& mesh,
                                           double spacing) {
  constexpr double kMaxSamples = 1e9;  // 12 GB
  double num_samples = 0;
  std::vector<Corners> triangles;
  triangles.reserve(mesh.facets.size());
  for (const Facet& facet : mesh.facets) {
    triangles.push_back(CornersOf<double>(mesh, facet));
    num_samples += EstimateCount(triangles.back(), spacing);
  }
  if (num_samples > kMaxSamples) {
    throw std::invalid_argument(
        "the spacing of the samples is too small for the size of the mesh");
  }
  std::vector<Eigen::Vector3f> samples;
  std::vector<Corners> stack;
  for (const Corners& triangle : triangles) {
    SampleTriangle(triangle, spacing, &stack, &samples);
  }
  return samples;
}

void DownsampleByVoxels(double spacing, std::vector<Eigen::Vector3f>* points) {
  std::vector<GridPoint> located;
  located.reserve(points->size());
  for (const Eigen::Vector3f& point : *points) {
    located.push_back(Locate(point, spacing));
  }
  tbb::parallel_sort(located.begin(), located.end(), IsBefore);
  points->clear();
  for (size_t i = 0; i < located.size(); ++i) {
    if (i == 0 || located[i].voxel != located[i - 1].voxel) {
      points->push_back(located[i].point);
    }
  }
}

}  // namespace colmap_ext
