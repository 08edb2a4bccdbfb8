#include "workspace/image_order.h"

#include <algorithm>
#include <cmath>
#include <cstdlib>
#include <limits>
#include <map>
#include <numeric>
#include <set>
#include <string>
#include <utility>

#include <fmt/format.h>

namespace colmap_ext {
namespace {

// \param is_better  takes two indices.
// \return the index that is better than all others; nothing if there is none.
template <typename IsBetter>
std::optional<size_t> FindBest(size_t count, const IsBetter& is_better) {
  for (size_t i = 0; i < count; ++i) {
    size_t j = 0;
    while (j < count && (i == j || is_better(i, j))) {
      ++j;
    }
    if (j == count) {
      return i;
    }
  }
  return std::nullopt;
}

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

// Finds the order in which a .vis counts the images by the colours of the
// points: a point's colour is nearest to the pixels that it projects to in the
// right images. Reads a handful of the images in which the orders differ, and
// compares some points of each.
//
// \return the index of the order that is clearly better than every other;
//         nothing if there is none, or no colours or pictures to compare.
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

// Points that are projected. A choice.
constexpr size_t kMaxSamplePoints = 20000;

// The share of the observations that project inside their image, enlarged by a
// margin (share of its size). Tuned on: toycars, bunny and fountain, by: 100.00
// % for the right order, 82 - 97 % for random ones. Some wrong orders
// reach 99.8 %, so that passing does not suffice.
constexpr double kMinInside = 0.98;
constexpr double kImageMargin = 0.01;

// An order is better than another if that many times fewer observations speak
// against it (ratio), beyond so many (count). Choices.
constexpr double kClearRatio = 5;
constexpr double kClearCount = 20;

std::vector<size_t> FrameOrder(const std::vector<SparseFrame>& frames,
                               const std::map<uint32_t, size_t>& index_of_id) {
  std::vector<size_t> images;
  for (const SparseFrame& frame : frames) {
    for (const uint32_t image_id : frame.image_ids) {
      if (const auto it = index_of_id.find(image_id); it != index_of_id.end()) {
        images.push_back(it->second);
      }
    }
  }
  return images;
}

bool IsInside(const View& view, const Eigen::Vector3d& point) {
  const Eigen::Vector3d in_camera = view.CamFromWorld(point);
  if (!(in_camera.z() > 0)) {
    return false;
  }
  const Eigen::Vector2d pixel = view.ImageFromCam(in_camera);
  const double margin_x = kImageMargin * view.width + 1;
  const double margin_y = kImageMargin * view.height + 1;
  return pixel.x() >= -margin_x && pixel.x() <= view.width + margin_x &&
         pixel.y() >= -margin_y && pixel.y() <= view.height + margin_y;
}

OrderEvidence Examine(const OrderQuestion& question, const ImageOrder& order) {
  OrderEvidence evidence;
  size_t num_inside = 0;
  size_t num_facing = 0;
  const PlyCloud& cloud = question.cloud;
  const Visibility& visibility = question.visibility;
  const size_t num_points = cloud.positions.size();
  const size_t stride = num_points / kMaxSamplePoints + 1;
  for (size_t i = 0; i < num_points; i += stride) {
    const Eigen::Vector3d point = cloud.positions[i].cast<double>();
    if (!point.allFinite()) {
      continue;
    }
    for (const uint32_t index : visibility[i]) {
      ++evidence.num_observations;
      if (index >= order.images.size()) {
        continue;
      }
      const View& view = question.views[order.images[index]];
      const bool is_inside = IsInside(view, point);
      num_inside += is_inside;
      num_facing +=
          is_inside &&
          (cloud.normals.empty() ||
           cloud.normals[i].cast<double>().dot(view.Center() - point) >= 0);
    }
  }
  if (evidence.num_observations > 0) {
    evidence.inside = 1.0 * num_inside / evidence.num_observations;
    evidence.facing = 1.0 * num_facing / evidence.num_observations;
  }
  return evidence;
}

std::string Percent(double share) {
  return fmt::format("{:.1f} %", 100 * share);
}

std::string Describe(const std::vector<VerifiedOrder>& orders) {
  std::string text;
  for (const VerifiedOrder& verified : orders) {
    text += fmt::format("{}{}: {}", text.empty() ? "" : ", ",
                        NameOf(verified.order.kind),
                        Percent(verified.evidence.inside));
  }
  return text;
}

std::optional<size_t> FindOrderByPositions(
    const std::vector<VerifiedOrder>& orders) {
  const auto num_against = [&orders](size_t i) {
    const OrderEvidence& evidence = orders[i].evidence;
    return (1 - evidence.facing) *
           static_cast<double>(evidence.num_observations);
  };
  return FindBest(orders.size(), [&](size_t i, size_t j) {
    return num_against(j) >= kClearRatio * num_against(i) + kClearCount;
  });
}

// Orders that differ only in images which see no point are the same to us.
void KeepOnePerUse(const Visibility& visibility,
                   std::vector<ImageOrder>* orders) {
  std::vector<bool> is_used;
  for (const ImageOrder& order : *orders) {
    is_used.resize(std::max(is_used.size(), order.images.size()), false);
  }
  for (const uint32_t index : visibility.values) {
    if (index < is_used.size()) {
      is_used[index] = true;
    }
  }
  std::set<std::vector<size_t>> uses;
  std::erase_if(*orders, [&](const ImageOrder& order) {
    std::vector<size_t> use(order.images.size(), SIZE_MAX);
    for (size_t index = 0; index < use.size(); ++index) {
      if (is_used[index]) {
        use[index] = order.images[index];
      }
    }
    return !uses.insert(std::move(use)).second;
  });
}

// The orders that are to be tried.
std::vector<ImageOrder> OrdersToTry(const OrderQuestion& question,
                                    std::optional<ImageOrderKind> wanted) {
  std::vector<ImageOrder> orders = CandidateImageOrders(question.model);
  if (!wanted) {
    KeepOnePerUse(question.visibility, &orders);
    return orders;
  }
  std::erase_if(orders, [&wanted](const ImageOrder& order) {
    return order.kind != *wanted;
  });
  if (orders.empty()) {
    throw FileError(question.visibility_path,
                    fmt::format("cannot count the images by {}: the model in "
                                "sparse/ has no frames",
                                NameOf(*wanted)),
                    Alternative::kOtherImageOrder);
  }
  return orders;
}

VerifiedOrder TakeBest(const OrderQuestion& question,
                       std::vector<VerifiedOrder> passing) {
  std::optional<size_t> best = FindOrderByPositions(passing);
  const OrderReason reason =
      best ? OrderReason::kPositions : OrderReason::kColors;
  if (!best) {
    best = FindOrderByColors(question, passing);
  }
  if (!best) {
    throw FileError(question.visibility_path,
                    fmt::format("the order in which it numbers the images is "
                                "ambiguous ({} of the points lie inside their "
                                "images)",
                                Describe(passing)),
                    Alternative::kSayImageOrder);
  }
  passing[*best].reason = reason;
  return std::move(passing[*best]);
}

}  // namespace

const char* NameOf(ImageOrderKind kind) {
  constexpr const char* kNames[] = {"file", "image_id", "frame", "frame_id"};
  return kNames[static_cast<int>(kind)];
}

std::vector<ImageOrder> CandidateImageOrders(const SparseModel& model) {
  std::vector<size_t> in_file(model.images.size());
  std::iota(in_file.begin(), in_file.end(), size_t{0});
  const std::map<uint32_t, size_t> index_of_id = ImageIndices(model);
  std::vector<size_t> by_id;
  for (const auto& [image_id, index] : index_of_id) {
    by_id.push_back(index);
  }
  std::vector<SparseFrame> sorted_frames = model.frames;
  std::ranges::stable_sort(sorted_frames, {}, &SparseFrame::frame_id);
  std::vector<ImageOrder> orders = {{ImageOrderKind::kFile, in_file},
                                    {ImageOrderKind::kImageId, by_id}};
  if (!model.frames.empty()) {
    orders.push_back(
        {ImageOrderKind::kFrame, FrameOrder(model.frames, index_of_id)});
    orders.push_back(
        {ImageOrderKind::kFrameId, FrameOrder(sorted_frames, index_of_id)});
  }
  return orders;
}

VerifiedOrder FindImageOrder(const OrderQuestion& question,
                             std::optional<ImageOrderKind> wanted) {
  std::vector<VerifiedOrder> all;
  for (ImageOrder& order : OrdersToTry(question, wanted)) {
    const OrderEvidence evidence = Examine(question, order);
    all.push_back({std::move(order), evidence,
                   wanted ? OrderReason::kWanted : OrderReason::kOnlyOne});
  }
  std::vector<VerifiedOrder> passing = all;
  std::erase_if(passing, [](const VerifiedOrder& verified) {
    return verified.evidence.inside < kMinInside;
  });
  if (passing.empty()) {
    throw FileError(
        question.visibility_path,
        "the points do not lie inside the images that should see them, in "
        "whatever order the images are counted (" +
            Describe(all) + "; at least " + Percent(kMinInside) +
            " expected), so that it belongs to another model than sparse/; run "
            "`colmap stereo_fusion` again");
  }
  if (passing.size() > 1) {
    return TakeBest(question, std::move(passing));
  }
  if (all.size() > 1) {
    passing[0].reason = OrderReason::kOnlyFit;
  }
  return passing[0];
}

}  // namespace colmap_ext
