#include "tiles/ray_mask.h"

#include <algorithm>
#include <atomic>
#include <cmath>

#include "scene/region.h"
#include "spatial/facet_tree.h"

namespace colmap_ext {
namespace {

// Voxels are marked as if they were larger by this share, so that rounding on
// the way of a ray leaves out none that counts.
constexpr double kSlack = 1e-3;

// Of a voxel, in a grid of kSide voxels an axis.
template <int kSide>
size_t IndexIn(int x, int y, int z) {
  return (static_cast<size_t>(x) * kSide + static_cast<size_t>(y)) * kSide +
         static_cast<size_t>(z);
}

size_t SumIndex(int x, int y, int z) {
  return IndexIn<RayMask::kSize + 1>(x, y, z);
}

int ClampToVoxel(double at, int size = RayMask::kSize) {
  return static_cast<int>(std::clamp(std::floor(at), 0.0, size - 1.0));
}

}  // namespace

RayMask::RayMask(const Eigen::AlignedBox3d& bounds)
    : origin_(bounds.min()), is_marked_(size_t{kSize} * kSize * kSize, 0) {
  const double largest = std::max(bounds.sizes().maxCoeff(), 1e-30);
  for (int i = 0; i < 3; ++i) {
    voxels_per_unit_[i] = kSize / std::max(bounds.sizes()[i], 1e-6 * largest);
  }
}

std::vector<RayMask::Plane> RayMask::PlanesAround(
    std::span<const Eigen::Vector3d> corners) {
  std::vector<Plane> planes;
  const auto add = [&](const Eigen::Vector3d& normal) {
    // A normal that is hardly one tells nothing.
    if (normal.norm() > 1e-9) {
      double offset = -INFINITY;
      for (const Eigen::Vector3d& corner : corners) {
        offset = std::max(offset, normal.dot(corner));
      }
      planes.push_back({normal, offset});
    }
  };
  for (size_t i = 0; i + 2 < corners.size(); ++i) {
    for (size_t j = i + 1; j + 1 < corners.size(); ++j) {
      for (size_t k = j + 1; k < corners.size(); ++k) {
        const Eigen::Vector3d normal =
            (corners[j] - corners[i]).cross(corners[k] - corners[i]);
        add(normal);
        add(-normal);
      }
    }
  }
  return planes;
}

void RayMask::Mark(std::span<const Eigen::Vector3d> corners) {
  std::vector<Eigen::Vector3d> places;
  Eigen::AlignedBox3d box;
  for (const Eigen::Vector3d& corner : corners) {
    places.push_back(ToVoxels(corner));
    box.extend(places.back());
  }
  box = GrowBox(box, kSlack);
  Voxel first;
  int extent = 0;
  for (int i = 0; i < 3; ++i) {
    first[i] = ClampToVoxel(box.min()[i]);
    extent = std::max(extent, ClampToVoxel(box.max()[i]) - first[i] + 1);
  }
  if (extent <= 2) {
    MarkWithin({}, box, first, 2);
  } else {
    MarkWithin(PlanesAround(places), box, {0, 0, 0}, kSize);
  }
}

// Marks the voxels of a cube that are not beyond a plane nor out of the box.
void RayMask::MarkWithin(const std::vector<Plane>& planes,
                         const Eigen::AlignedBox3d& box, const Voxel& first,
                         int size) {
  const Eigen::Vector3d center(first[0] + 0.5 * size, first[1] + 0.5 * size,
                               first[2] + 0.5 * size);
  const double half = 0.5 * size + kSlack;
  const Eigen::Vector3d halves = Eigen::Vector3d::Constant(half);
  if (!box.intersects(Eigen::AlignedBox3d(center - halves, center + halves))) {
    return;
  }
  for (const Plane& plane : planes) {
    if (plane.normal.dot(center) - half * plane.normal.lpNorm<1>() >
        plane.offset) {
      return;
    }
  }
  if (size == 1) {
    if (std::ranges::max(first) < kSize) {
      const size_t index = IndexIn<kSize>(first[0], first[1], first[2]);
      std::atomic_ref<uint8_t>(is_marked_[index])
          .store(1, std::memory_order_relaxed);
    }
    return;
  }
  const int child = size / 2;
  for (int i = 0; i < 8; ++i) {
    MarkWithin(planes, box,
               {first[0] + child * (i & 1), first[1] + child * (i >> 1 & 1),
                first[2] + child * (i >> 2)},
               child);
  }
}

void RayMask::Finish() {
  is_coarse_marked_.assign(size_t{kCoarseSize} * kCoarseSize * kCoarseSize, 0);
  for (int x = 0; x < kSize; ++x) {
    for (int y = 0; y < kSize; ++y) {
      for (int z = 0; z < kSize; ++z) {
        is_coarse_marked_[IndexIn<kCoarseSize>(x / kRatio, y / kRatio,
                                               z / kRatio)] |=
            is_marked_[IndexIn<kSize>(x, y, z)];
      }
    }
  }
  constexpr size_t kStride = kSize + 1;
  sums_.assign(kStride * kStride * kStride, 0);
  for (int x = 0; x < kSize; ++x) {
    for (int y = 0; y < kSize; ++y) {
      uint32_t row = 0;
      for (int z = 0; z < kSize; ++z) {
        row += is_marked_[IndexIn<kSize>(x, y, z)];
        sums_[SumIndex(x + 1, y + 1, z + 1)] =
            row + sums_[SumIndex(x, y + 1, z + 1)] +
            sums_[SumIndex(x + 1, y, z + 1)] - sums_[SumIndex(x, y, z + 1)];
      }
    }
  }
}

bool RayMask::MayTouch(const Eigen::AlignedBox3d& box) const {
  const Eigen::Vector3d lower = ToVoxels(box.min());
  const Eigen::Vector3d upper = ToVoxels(box.max());
  if ((upper.array() < -kSlack).any() ||
      (lower.array() > kSize + kSlack).any()) {
    return false;
  }
  const int x0 = ClampToVoxel(lower.x());
  const int y0 = ClampToVoxel(lower.y());
  const int z0 = ClampToVoxel(lower.z());
  const int x1 = ClampToVoxel(upper.x()) + 1;
  const int y1 = ClampToVoxel(upper.y()) + 1;
  const int z1 = ClampToVoxel(upper.z()) + 1;
  const auto sum = [&](int x, int y, int z) {
    return sums_[SumIndex(x, y, z)];
  };
  return sum(x1, y1, z1) - sum(x0, y1, z1) - sum(x1, y0, z1) - sum(x1, y1, z0) +
             sum(x0, y0, z1) + sum(x0, y1, z0) + sum(x1, y0, z0) -
             sum(x0, y0, z0) !=
         0;
}

bool RayMask::MayPass(const Eigen::Vector3d& from,
                      const Eigen::Vector3d& direction, double length) const {
  if (direction.isZero(0)) {
    return true;
  }
  const Eigen::Vector3d start = ToVoxels(from);
  const Eigen::Vector3d way = direction.cwiseProduct(voxels_per_unit_);
  const SegmentPart part =
      ClipToBox(start, way, Eigen::Vector3d::Constant(-kSlack),
                Eigen::Vector3d::Constant(kSize + kSlack), {0, length});
  if (part.IsEmpty()) {
    return false;
  }
  const double begin = FirstMark<kCoarseSize>(
      is_coarse_marked_, start / kRatio, way / kRatio, part.first, part.second);
  return begin <= part.second && FirstMark<kSize>(is_marked_, start, way, begin,
                                                  part.second) <= part.second;
}

// Goes from voxel to voxel [Amanatides1987].
// \param way  voxels
// \param begin, end  multiples of the way
// \return where the first marked voxel begins, or infinity
template <int kGridSize>
double RayMask::FirstMark(const std::vector<uint8_t>& is_marked,
                          const Eigen::Vector3d& from,
                          const Eigen::Vector3d& way, double begin,
                          double end) {
  constexpr std::array<int, 3> kStrides = {kGridSize * kGridSize, kGridSize, 1};
  Voxel left;  // how many voxels there are to go
  Voxel step;
  std::array<double, 3> next;  // multiple of the way to the next voxel
  std::array<double, 3> width;
  int index = 0;
  for (int i = 0; i < 3; ++i) {
    const int voxel = ClampToVoxel(from[i] + begin * way[i], kGridSize);
    index += kStrides[i] * voxel;
    left[i] = way[i] > 0 ? kGridSize - 1 - voxel : voxel;
    step[i] = way[i] > 0 ? kStrides[i] : -kStrides[i];
    width[i] = way[i] != 0 ? std::abs(1 / way[i]) : INFINITY;
    next[i] =
        way[i] != 0 ? (voxel + (way[i] > 0) - from[i]) / way[i] : INFINITY;
  }
  while (is_marked[static_cast<size_t>(index)] == 0) {
    const int axis = next[0] < next[1] ? (next[0] < next[2] ? 0 : 2)
                                       : (next[1] < next[2] ? 1 : 2);
    begin = next[axis];
    if (!(begin <= end) || left[axis] == 0) {
      return INFINITY;
    }
    --left[axis];
    index += step[axis];
    next[axis] += width[axis];
  }
  return begin;
}

}  // namespace colmap_ext
