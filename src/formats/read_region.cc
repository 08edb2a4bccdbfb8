#include "formats/read_region.h"

#include <cstddef>
#include <span>
#include <vector>

#include <fmt/format.h>
#include <Eigen/SVD>

#include "formats/errors.h"
#include "formats/read_numbers.h"

namespace colmap_ext {

namespace {

constexpr size_t kNumCorners = 6;
constexpr size_t kNumOriented = 15;

Eigen::Vector3d VectorAt(std::span<const double> numbers, size_t first) {
  return {numbers[first], numbers[first + 1], numbers[first + 2]};
}

std::optional<Region> BetweenCorners(const Eigen::Vector3d& a,
                                     const Eigen::Vector3d& b) {
  if (!((a - b).cwiseAbs().minCoeff() > 0)) {
    return std::nullopt;
  }
  return RegionBetween(a.cwiseMin(b), a.cwiseMax(b));
}

// \pre 15 numbers
std::optional<Region> Oriented(std::span<const double> numbers) {
  constexpr double kTolerance = 1e-3;  // of a rotation's entries; a choice
  Eigen::Matrix3d rotation;
  rotation << VectorAt(numbers, 0).transpose(),
      VectorAt(numbers, 3).transpose(), VectorAt(numbers, 6).transpose();
  const Eigen::Matrix3d difference =
      rotation * rotation.transpose() - Eigen::Matrix3d::Identity();
  const Eigen::Vector3d half_sizes = VectorAt(numbers, 12);
  if (!(difference.cwiseAbs().maxCoeff() < kTolerance) ||
      !(half_sizes.minCoeff() > 0)) {
    return std::nullopt;
  }
  // The nearest rotation.
  const Eigen::JacobiSVD<Eigen::Matrix3d> svd(
      rotation, Eigen::ComputeFullU | Eigen::ComputeFullV);
  return Region{svd.matrixU() * svd.matrixV().transpose(), VectorAt(numbers, 9),
                half_sizes};
}

}  // namespace

Region ReadRegion(const std::filesystem::path& path) {
  const std::vector<double> numbers = ReadNumbers(path);
  std::optional<Region> region;
  if (numbers.size() == kNumCorners) {
    region = BetweenCorners(VectorAt(numbers, 0), VectorAt(numbers, 3));
  } else if (numbers.size() == kNumOriented) {
    region = Oriented(numbers);
  }
  if (!region) {
    throw FileError(
        path,
        fmt::format("not a region: {} numbers; 6 are expected, two opposite "
                    "corners of a box, or 15, the rows of its rotation, its "
                    "centre, and half its sizes",
                    numbers.size()));
  }
  return *region;
}

std::string RegionText(const Region& region) {
  std::string text =
      "# A region: the rows of its rotation, its centre, half its sizes.\n";
  const auto add = [&text](const Eigen::Vector3d& row) {
    text += fmt::format("{} {} {}\n", row.x(), row.y(), row.z());
  };
  for (int row = 0; row < 3; ++row) {
    add(region.region_from_world.row(row));
  }
  add(region.center);
  add(region.half_sizes);
  return text;
}

std::optional<Region> ParseCorners(std::string_view text) {
  const std::optional<std::vector<double>> numbers = ParseNumbers(text);
  if (!numbers || numbers->size() != kNumCorners) {
    return std::nullopt;
  }
  return BetweenCorners(VectorAt(*numbers, 0), VectorAt(*numbers, 3));
}

}  // namespace colmap_ext
