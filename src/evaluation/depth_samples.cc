#include "evaluation/depth_samples.h"

#include <cmath>

#include <tbb/parallel_for.h>

namespace colmap_ext {

namespace {

DepthMap EmptyMap(int width, int height, int stride) {
  DepthMap map;
  map.stride = stride;
  map.width = (width - stride / 2 + stride - 1) / stride;
  map.height = (height - stride / 2 + stride - 1) / stride;
  map.depths.resize(static_cast<size_t>(map.width) * map.height, 0);
  return map;
}

bool IsDepth(float depth) { return std::isfinite(depth) && depth > 0; }

}  // namespace

DepthMap RenderDepths(const Bvh& surface, const View& view, int stride,
                      std::vector<int32_t>* facets) {
  DepthMap map = EmptyMap(view.width, view.height, stride);
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

DepthMap Subsample(const DepthMap& map, int stride) {
  DepthMap samples = EmptyMap(map.width, map.height, stride);
  for (int row = 0; row < samples.height; ++row) {
    for (int col = 0; col < samples.width; ++col) {
      samples.depths[samples.Index(row, col)] =
          map.depths[map.Index(samples.Pixel(row), samples.Pixel(col))];
    }
  }
  return samples;
}

std::vector<Eigen::Vector3f> PointsWhere(const DepthMap& depths,
                                         const DepthMap& mask,
                                         const View& view) {
  const Eigen::Vector3f eye = view.Center().cast<float>();
  std::vector<Eigen::Vector3f> points;
  for (int row = 0; row < depths.height; ++row) {
    for (int col = 0; col < depths.width; ++col) {
      const size_t index = depths.Index(row, col);
      if (depths.depths[index] > 0 && mask.depths[index] > 0) {
        points.emplace_back(eye + depths.depths[index] *
                                      RayDirection(view,
                                                   depths.Pixel(col) + 0.5,
                                                   depths.Pixel(row) + 0.5));
      }
    }
  }
  return points;
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

}  // namespace colmap_ext
