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

void Observability::RestrictMesh(std::vector<Eigen::Vector3f>* samples) const {
  if (mask) {
    std::erase_if(*samples, [this](const Eigen::Vector3f& sample) {
      return !mask->Contains(sample);
    });
  }
}

void Observability::RestrictTruth(std::vector<Eigen::Vector3f>* samples) const {
  if (ground_plane) {
    std::erase_if(*samples, [this](const Eigen::Vector3f& sample) {
      return !(ground_plane->head<3>().dot(sample.cast<double>()) +
                   (*ground_plane)[3] >
               0);
    });
  }
}

}  // namespace colmap_ext
