#include "evaluation/observability.h"

namespace colmap_ext {

bool ObservabilityMask::Contains(const Eigen::Vector3f& point) const {
  const Eigen::Array3d voxel =
      ((point.cast<double>() - origin) / resolution).array().round();
  size_t index = 0;
  for (int i = 0; i < 3; ++i) {
    if (!(voxel[i] >= 0 && voxel[i] < static_cast<double>(size[i]))) {
      return false;
    }
    index = index * size[i] + static_cast<size_t>(voxel[i]);
  }
  return voxels[index] != 0;
}

namespace {

void DropOutside(const std::optional<Region>& region,
                 std::vector<Eigen::Vector3f>* samples) {
  if (region) {
    std::erase_if(*samples, [&](const Eigen::Vector3f& sample) {
      return !region->Contains(sample);
    });
  }
}

}  // namespace

void Observability::RestrictMesh(std::vector<Eigen::Vector3f>* samples) const {
  DropOutside(region, samples);
  if (mask) {
    std::erase_if(*samples, [this](const Eigen::Vector3f& sample) {
      return !mask->Contains(sample);
    });
  }
}

void Observability::RestrictTruth(std::vector<Eigen::Vector3f>* samples) const {
  DropOutside(region, samples);
  if (ground_plane) {
    std::erase_if(*samples, [this](const Eigen::Vector3f& sample) {
      return !(ground_plane->head<3>().dot(sample.cast<double>()) +
                   (*ground_plane)[3] >
               0);
    });
  }
}

void Observability::RestrictDepths(const View& view, DepthMap* depths) const {
  if (!region) {
    return;
  }
  const Eigen::Vector3d center = view.Center();
  for (int row = 0; row < depths->height; ++row) {
    for (int col = 0; col < depths->width; ++col) {
      float& depth = depths->depths[depths->Index(row, col)];
      const Eigen::Vector3f ray = RayDirection(view, depths->Pixel(col) + 0.5,
                                               depths->Pixel(row) + 0.5);
      if (!region->Contains(
              Eigen::Vector3d(center + depth * ray.cast<double>()))) {
        depth = 0;
      }
    }
  }
}

}  // namespace colmap_ext
