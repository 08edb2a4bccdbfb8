#pragma once

#include <algorithm>
#include <cstddef>
#include <cstdint>
#include <functional>
#include <span>
#include <utility>
#include <vector>

#include <tbb/blocked_range.h>
#include <tbb/parallel_for.h>
#include <tbb/parallel_reduce.h>
#include <Eigen/LU>

#include "base/indices.h"
#include "base/rows.h"
#include "cameras/camera_residuals.h"

namespace colmap_ext {

// The cameras' normal equations after the landmarks are eliminated: for each
// view a row of blocks, of the views from itself on that share a landmark with
// it.
struct ReducedSystem {
  Rows<uint32_t> columns;         // [views] views, ascending
  std::vector<ViewBlock> blocks;  // [columns.values]
  std::vector<ViewStep> slopes;   // [views]
};

// The landmarks of one kind, where they are, and the part of the normal
// equations that they are in. Each view's sums are those of one thread, in one
// order, so that they do not depend on the number of threads.
template <typename Residuals>
class Landmarks {
 public:
  static constexpr int kDim = Residuals::kDim;
  using Landmark = typename Residuals::Landmark;

  Landmarks(Residuals residuals, const CameraSteps& steps, size_t num_views)
      : residuals_(std::move(residuals)), at_(residuals_.Start()) {
    const size_t count = at_.size();
    views_ = MakeRows<uint32_t>(count, [&](size_t l,
                                           std::vector<uint32_t>* views) {
      std::vector<uint32_t> of_landmark;
      residuals_.ForEach(l, steps, at_[l], kAnyView, [&](const auto& residual) {
        Append(std::span(residual.views).first(residual.num_views),
               &of_landmark);
      });
      SortUnique(&of_landmark);
      Append(of_landmark, views);
    });
    landmarks_of_ = GroupInRows<uint32_t>(num_views, [&](const auto& add) {
      for (uint32_t l = 0; l < count; ++l) {
        for (const uint32_t view : views_[l]) {
          add(view, l);
        }
      }
    });
    by_views_.resize(views_.values.size());
    own_.resize(count);
    slopes_.resize(count);
    inverses_.resize(count);
    steps_.resize(count);
  }

  const std::vector<Landmark>& At() const { return at_; }

  // Appends the views that share a landmark with a view, from itself on.
  void AppendNeighbors(uint32_t view, std::vector<uint32_t>* neighbors) const {
    for (const uint32_t l : landmarks_of_[view]) {
      for (const uint32_t other : views_[l]) {
        if (other >= view) {
          neighbors->push_back(other);
        }
      }
    }
  }

  // Half of the robust sum of the squared residuals, with the priors.
  // \param moves  the landmarks by their last steps
  double Cost(const CameraSteps& steps, bool moves) const {
    return Sum([&](size_t l) {
      const Landmark at = moves ? at_[l] + steps_[l] : at_[l];
      const Prior<kDim> prior = residuals_.PriorOf(l);
      double cost =
          (at - prior.mean).squaredNorm() / (prior.sigma * prior.sigma);
      residuals_.ForEach(l, steps, at, kAnyView, [&](const auto& residual) {
        cost += RobustLoss(residual.value.squaredNorm());
      });
      return 0.5 * cost;
    });
  }

  void Linearize(const CameraSteps& steps) {
    tbb::parallel_for(size_t{0}, own_.size(), [&](size_t l) {
      const Prior<kDim> prior = residuals_.PriorOf(l);
      const double weight = 1 / (prior.sigma * prior.sigma);
      own_[l] = weight * Own::Identity();
      slopes_[l] = weight * (at_[l] - prior.mean);
      std::fill_n(by_views_.begin() + static_cast<ptrdiff_t>(views_.offsets[l]),
                  views_[l].size(), ByView::Zero());
      residuals_.ForEach(l, steps, at_[l], kAnyView, [&](const auto& residual) {
        const double robust = RobustWeight(residual.value.squaredNorm());
        const auto weighted = (robust * residual.by_landmark).eval();
        own_[l] += weighted.transpose() * residual.by_landmark;
        slopes_[l] += weighted.transpose() * residual.value;
        for (int k = 0; k < residual.num_views; ++k) {
          by_views_[PlaceOf(l, residual.views[k])] +=
              residual.by_views[k].transpose() * weighted;
        }
      });
    });
  }

  // Of the linearization, eliminated with damped own parts.
  void AddTo(const CameraSteps& steps, double damping, ReducedSystem* system) {
    tbb::parallel_for(size_t{0}, own_.size(), [&](size_t l) {
      Own damped = own_[l];
      damped.diagonal() *= 1 + damping;
      inverses_[l] = damped.inverse();
    });
    tbb::parallel_for(size_t{0}, landmarks_of_.size(), [&](size_t view) {
      const auto columns = system->columns[view];
      std::vector<uint32_t> places(landmarks_of_.size(), kNone);
      for (size_t k = 0; k < columns.size(); ++k) {
        places[columns[k]] =
            static_cast<uint32_t>(system->columns.offsets[view] + k);
      }
      for (const uint32_t l : landmarks_of_[view]) {
        AddResiduals(static_cast<uint32_t>(view), l, steps, places, system);
        Eliminate(static_cast<uint32_t>(view), l, places, system);
      }
    });
  }

  // The landmarks' steps that follow from the cameras'.
  void FindSteps(const CameraSteps& change) {
    tbb::parallel_for(size_t{0}, own_.size(), [&](size_t l) {
      Landmark slope = slopes_[l];
      for (uint64_t k = views_.offsets[l]; k < views_.offsets[l + 1]; ++k) {
        slope += by_views_[k].transpose() * change[views_.values[k]];
      }
      steps_[l] = -(inverses_[l] * slope);
    });
  }

  void Move() {
    for (size_t l = 0; l < at_.size(); ++l) {
      at_[l] += steps_[l];
    }
  }

 private:
  using ByView = Eigen::Matrix<double, kViewDim, kDim>;
  using Own = Eigen::Matrix<double, kDim, kDim>;

  template <typename Value>
  double Sum(const Value& value) const {
    return tbb::parallel_deterministic_reduce(
        tbb::blocked_range<size_t>(0, at_.size(), 256), 0.0,
        [&](const tbb::blocked_range<size_t>& range, double sum) {
          for (size_t l = range.begin(); l < range.end(); ++l) {
            sum += value(l);
          }
          return sum;
        },
        std::plus<double>());
  }

  uint64_t PlaceOf(size_t l, uint32_t view) const {
    return views_.offsets[l] + IndexOf(views_[l], view);
  }

  // The derivatives of a landmark's residuals by the view and by others.
  void AddResiduals(uint32_t view, uint32_t l, const CameraSteps& steps,
                    const std::vector<uint32_t>& places,
                    ReducedSystem* system) const {
    residuals_.ForEach(l, steps, at_[l], view, [&](const auto& residual) {
      const double robust = RobustWeight(residual.value.squaredNorm());
      for (int k = 0; k < residual.num_views; ++k) {
        if (residual.views[k] != view) {
          continue;
        }
        const auto weighted =
            (robust * residual.by_views[k].transpose()).eval();
        system->slopes[view] += weighted * residual.value;
        for (int other = 0; other < residual.num_views; ++other) {
          if (residual.views[other] >= view) {
            system->blocks[places[residual.views[other]]] +=
                weighted * residual.by_views[other];
          }
        }
      }
    });
  }

  void Eliminate(uint32_t view, uint32_t l, const std::vector<uint32_t>& places,
                 ReducedSystem* system) const {
    const ByView gain = by_views_[PlaceOf(l, view)] * inverses_[l];
    system->slopes[view] -= gain * slopes_[l];
    for (uint64_t k = views_.offsets[l]; k < views_.offsets[l + 1]; ++k) {
      if (views_.values[k] >= view) {
        system->blocks[places[views_.values[k]]] -=
            gain * by_views_[k].transpose();
      }
    }
  }

  Residuals residuals_;
  std::vector<Landmark> at_;
  Rows<uint32_t> views_;         // [landmarks] that see each, ascending
  Rows<uint32_t> landmarks_of_;  // [views]
  // The linearization, and the steps.
  std::vector<ByView> by_views_;  // [views_.values]
  std::vector<Own> own_;          // [landmarks]
  std::vector<Landmark> slopes_;  // [landmarks]
  std::vector<Own> inverses_;     // [landmarks] of the damped own parts
  std::vector<Landmark> steps_;   // [landmarks]
};

}  // namespace colmap_ext
