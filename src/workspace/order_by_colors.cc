#include "workspace/order_by_colors.h"

#include <algorithm>
#include <cmath>
#include <cstdlib>
#include <limits>
#include <map>

namespace colmap_ext {
namespace {

// The sample: .vis indices, and points of each. Choices; the figures below hold
// for them.
constexpr size_t kMaxIndices = 6;
constexpr size_t kMaxPointsPerIndex = 2000;

// Grey values of 255, at which an error is cut off: larger ones come from
// occlusions and highlights. A choice.
constexpr double kMaxError = 60;

// An order is better if the mean of the paired differences of the errors lies
// so many of its standard errors above zero, and is at least this share of the
// other order's error. Tuned on: toycars and bunny, whose wrong orders are
// worse by 60 and more standard errors and by a third of the error; and
// fountain, whose points have no colours and reach 7 and 0.4 %.
constexpr double kMinStandardErrors = 10;
constexpr double kMinErrorGain = 0.05;

// .vis indices for which the orders name different images.
std::vector<uint32_t> IndicesThatDiffer(
    const std::vector<VerifiedOrder>& orders) {
  const std::vector<size_t>& first = orders[0].order.images;
  size_t num_common = first.size();
  for (const VerifiedOrder& other : orders) {
    num_common = std::min(num_common, other.order.images.size());
  }
  std::vector<uint32_t> indices;
  for (uint32_t i = 0; i < num_common; ++i) {
    if (std::ranges::any_of(orders, [&](const VerifiedOrder& other) {
          return other.order.images[i] != first[i];
        })) {
      indices.push_back(i);
    }
  }
  return indices;
}

// At most so many of the values, spread evenly over all of them.
std::vector<uint32_t> SampleEvenly(const std::vector<uint32_t>& values,
                                   size_t count) {
  if (values.size() <= count) {
    return values;
  }
  std::vector<uint32_t> sample;
  for (size_t i = 0; i < count; ++i) {
    sample.push_back(values[i * values.size() / count]);
  }
  return sample;
}

// The points that list each of the .vis indices.
std::map<uint32_t, std::vector<uint32_t>> PointsOf(
    const std::vector<uint32_t>& indices, const Visibility& visibility) {
  std::map<uint32_t, std::vector<uint32_t>> points;
  for (const uint32_t index : indices) {
    points[index];
  }
  for (size_t i = 0; i < visibility.size(); ++i) {
    for (const uint32_t index : visibility[i]) {
      const auto it = points.find(index);
      if (it != points.end()) {
        it->second.push_back(static_cast<uint32_t>(i));
      }
    }
  }
  return points;
}

// Mean absolute difference of the channels; NaN for a point outside the image.
double ColorError(const PlyCloud& cloud, size_t point, const View& view,
                  const ColorImage& image) {
  const std::optional<Eigen::Vector2d> pixel =
      PixelInImage(view, cloud.positions[point].cast<double>());
  if (!pixel) {
    return std::numeric_limits<double>::quiet_NaN();
  }
  const Color& seen =
      image.At(static_cast<int>(pixel->y()), static_cast<int>(pixel->x()));
  double error = 0;
  for (int i = 0; i < 3; ++i) {
    error += std::abs(int{cloud.colors[point][i]} - int{seen[i]}) / 3.0;
  }
  return std::min(error, kMaxError);
}

bool IsClearlyBetter(const std::vector<double>& errors,
                     const std::vector<double>& other_errors) {
  double num = 0;
  double sum = 0;
  double sum_squared = 0;
  double sum_other_errors = 0;
  for (size_t i = 0; i < errors.size(); ++i) {
    const double gain = other_errors[i] - errors[i];
    if (std::isfinite(gain)) {
      num += 1;
      sum += gain;
      sum_squared += gain * gain;
      sum_other_errors += other_errors[i];
    }
  }
  const double mean = sum / num;
  const double variance = sum_squared / num - mean * mean;
  return num > 0 && sum > kMinErrorGain * sum_other_errors &&
         mean * std::sqrt(num) > kMinStandardErrors * std::sqrt(variance);
}

}  // namespace

std::optional<size_t> FindOrderByColors(
    const OrderQuestion& question, const std::vector<VerifiedOrder>& orders) {
  if (question.cloud.colors.empty()) {
    return std::nullopt;
  }
  std::vector<std::vector<double>> errors(orders.size());  // of equal lengths
  const std::vector<uint32_t> indices =
      SampleEvenly(IndicesThatDiffer(orders), kMaxIndices);
  for (const auto& [index, all_points] :
       PointsOf(indices, question.visibility)) {
    const std::vector<uint32_t> points =
        SampleEvenly(all_points, kMaxPointsPerIndex);
    for (size_t i = 0; i < orders.size(); ++i) {
      const View& view = question.views[orders[i].order.images[index]];
      const std::optional<ColorImage> image =
          question.decoder.read_color(question.images_path / view.name);
      if (!image || image->width != view.width ||
          image->height != view.height) {
        return std::nullopt;
      }
      for (const uint32_t point : points) {
        errors[i].push_back(ColorError(question.cloud, point, view, *image));
      }
    }
  }
  return FindBest(orders.size(), [&errors](size_t i, size_t j) {
    return IsClearlyBetter(errors[i], errors[j]);
  });
}

}  // namespace colmap_ext
