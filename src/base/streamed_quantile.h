#pragma once

#include <algorithm>
#include <bit>
#include <cstddef>
#include <cstdint>
#include <utility>
#include <vector>

namespace colmap_ext {

// Finds the lowest of many values up to which the weights sum up to a target,
// without holding them: they are given twice. The first time it adds up the
// weights of values whose first 16 bits agree, the second it keeps the values
// of the one group that it lies in.
class StreamedQuantile {
 public:
  // The first time.
  // \param value   not negative, nor NaN
  // \param weight  not negative
  void Count(double value, double weight) {
    weights_[GroupOf(value)] += weight;
    total_ += weight;
  }

  // The sum of all weights.
  double Total() const { return total_; }

  // To be called in between.
  void Seek(double target) {
    target_ = target;
    group_ = 0;
    while (group_ + 1 < weights_.size() && below_ + weights_[group_] < target) {
      below_ += weights_[group_++];
    }
  }

  // The second time.
  void Keep(double value, double weight) {
    if (GroupOf(value) == group_) {
      kept_.emplace_back(value, weight);
    }
  }

  // 0 where there are no values.
  double Find() {
    std::ranges::sort(kept_);
    double sum = below_;
    for (const auto& [value, weight] : kept_) {
      sum += weight;
      if (sum >= target_) {
        return value;
      }
    }
    return kept_.empty() ? 0 : kept_.back().first;
  }

 private:
  static size_t GroupOf(double value) {
    return std::bit_cast<uint64_t>(value) >> 48;
  }

  std::vector<double> weights_ = std::vector<double>(1 << 15, 0.0);
  double total_ = 0;
  double target_ = 0;
  double below_ = 0;
  size_t group_ = 0;
  std::vector<std::pair<double, double>> kept_;
};

}  // namespace colmap_ext
