#include "formats/read_transform.h"

#include <cmath>
#include <optional>
#include <vector>

#include <fmt/format.h>
#include <Eigen/Geometry>

#include "formats/errors.h"
#include "formats/read_numbers.h"

namespace colmap_ext {

namespace {

constexpr size_t kNumMatrix = 16;
constexpr size_t kNumSimilarity = 8;

Eigen::Matrix4d FromSimilarity(const std::vector<double>& numbers) {
  const Eigen::Quaterniond rotation(numbers[1], numbers[2], numbers[3],
                                    numbers[4]);
  Eigen::Matrix4d transform = Eigen::Matrix4d::Identity();
  transform.topLeftCorner<3, 3>() =
      numbers[0] * rotation.normalized().toRotationMatrix();
  transform.topRightCorner<3, 1>() << numbers[5], numbers[6], numbers[7];
  return transform;
}

bool IsSimilarity(const Eigen::Matrix4d& transform) {
  constexpr double kTolerance = 1e-3;  // of the squared scale; a choice
  const Eigen::Matrix3d linear = transform.topLeftCorner<3, 3>();
  const double scale_squared = linear.squaredNorm() / 3;
  const Eigen::Matrix3d difference =
      linear * linear.transpose() - scale_squared * Eigen::Matrix3d::Identity();
  return transform.row(3) == Eigen::RowVector4d(0, 0, 0, 1) &&
         linear.determinant() > 0 &&
         difference.cwiseAbs().maxCoeff() < kTolerance * scale_squared;
}

}  // namespace

Eigen::Matrix4d ReadTransform(const std::filesystem::path& path) {
  const std::vector<double> numbers = ReadNumbers(path);
  Eigen::Matrix4d transform = Eigen::Matrix4d::Zero();
  if (numbers.size() == kNumMatrix) {
    transform = Eigen::Map<const Eigen::Matrix<double, 4, 4, Eigen::RowMajor>>(
        numbers.data());
  } else if (numbers.size() == kNumSimilarity) {
    transform = FromSimilarity(numbers);
  }
  if (!IsSimilarity(transform)) {
    throw FileError(
        path, fmt::format("no similarity transform: {} numbers; 16 are "
                          "expected, a 4 x 4 matrix, or 8, scale, quaternion "
                          "and translation, as model_aligner writes them",
                          numbers.size()));
  }
  return transform;
}

}  // namespace colmap_ext
