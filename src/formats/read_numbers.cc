#include "formats/read_numbers.h"

#include <algorithm>
#include <charconv>
#include <cmath>
#include <span>

#include <fmt/format.h>
#include <Eigen/Geometry>
#include <Eigen/SVD>

#include "formats/byte_reader.h"

namespace colmap_ext {
namespace {

Eigen::Vector3d VectorAt(std::span<const double> numbers, size_t first) {
  return {numbers[first], numbers[first + 1], numbers[first + 2]};
}

// Nothing unless there are six numbers.
std::optional<Region> BetweenCorners(std::span<const double> numbers) {
  if (numbers.size() != 6) {
    return std::nullopt;
  }
  const Eigen::Vector3d a = VectorAt(numbers, 0);
  const Eigen::Vector3d b = VectorAt(numbers, 3);
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

std::optional<std::vector<double>> ParseNumbers(std::string_view text) {
  constexpr std::string_view kSeparators = " \t\r\n,";
  std::vector<double> numbers;
  for (;;) {
    text.remove_prefix(
        std::min(text.find_first_not_of(kSeparators), text.size()));
    if (text.empty()) {
      return numbers;
    }
    if (text.front() == '#') {
      text.remove_prefix(std::min(text.find('\n'), text.size()));
      continue;
    }
    if (text.front() == '+') {  // which from_chars does not take
      text.remove_prefix(1);
    }
    double number = 0;
    const auto [rest, error] =
        std::from_chars(text.data(), text.data() + text.size(), number);
    text.remove_prefix(static_cast<size_t>(rest - text.data()));
    const bool is_whole =
        text.empty() || text.front() == '#' ||
        kSeparators.find(text.front()) != std::string_view::npos;
    if (error != std::errc() || !is_whole || !std::isfinite(number)) {
      return std::nullopt;
    }
    numbers.push_back(number);
  }
}

std::vector<double> ReadNumbers(const std::filesystem::path& path) {
  constexpr uint64_t kMaxSize = 1 << 16;  // bytes
  ByteReader reader(path);
  if (reader.Remaining() > kMaxSize) {
    reader.Throw("too long for a text of a few numbers");
  }
  std::string text(reader.Remaining(), ' ');
  reader.Read(text.data(), text.size(), "the text");
  std::optional<std::vector<double>> numbers = ParseNumbers(text);
  if (!numbers) {
    reader.Throw("not a text of numbers");
  }
  return *std::move(numbers);
}

Region ReadRegion(const std::filesystem::path& path) {
  const std::vector<double> numbers = ReadNumbers(path);
  const std::optional<Region> region =
      numbers.size() == 15 ? Oriented(numbers) : BetweenCorners(numbers);
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
  return numbers ? BetweenCorners(*numbers) : std::nullopt;
}

Eigen::Matrix4d ReadTransform(const std::filesystem::path& path) {
  const std::vector<double> numbers = ReadNumbers(path);
  Eigen::Matrix4d transform = Eigen::Matrix4d::Zero();
  if (numbers.size() == 16) {
    transform = Eigen::Map<const Eigen::Matrix<double, 4, 4, Eigen::RowMajor>>(
        numbers.data());
  } else if (numbers.size() == 8) {
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
