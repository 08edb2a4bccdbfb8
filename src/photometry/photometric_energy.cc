#include "photometry/photometric_energy.h"

#include <algorithm>
#include <cassert>
#include <cmath>
#include <functional>
#include <optional>
#include <span>
#include <utility>

#include <tbb/enumerable_thread_specific.h>
#include <tbb/parallel_pipeline.h>
#include <tbb/task_arena.h>

#include "photometry/pair_warp.h"
#include "photometry/pair_work.h"
#include "photometry/window_correlation.h"

namespace colmap_ext {
namespace {

void Add(const FacetTerms& added, FacetTerms* terms) {
  terms->energy += added.energy;
  terms->weight += added.weight;
  terms->num_pixels += added.num_pixels;
  std::ranges::transform(terms->slopes, added.slopes, terms->slopes.begin(),
                         std::plus());
  std::ranges::transform(terms->curvatures, added.curvatures,
                         terms->curvatures.begin(), std::plus());
}

// Evaluates one direction of a pair at a time, i <- j. Holds scratch: each
// thread has its own.
class DirectionEvaluator {
 public:
  DirectionEvaluator(const PhotometricOptions& options, size_t num_facets)
      : options_(options), correlation_(options), places_(num_facets) {}

  // \param mesh  the present one
  // \param facets  those that the pair refines, ascending
  // \param tiles  of image i, see FindTiles()
  // \return [facets]
  std::vector<FacetTerms> Evaluate(const DrawnView& i, const DrawnView& j,
                                   const TriangleMesh& mesh,
                                   std::span<const uint32_t> facets,
                                   const std::vector<PixelBox>& tiles) {
    places_.Set(facets);
    const PairWarp warp(i, j, mesh);
    constexpr int kMultiple = 8;  // see WindowRows
    const int radius = options_.window_radius;
    const float max_relative_depth = MaxRelativeDepth(options_, i.view, radius);
    std::vector<FacetTerms> sums(facets.size());
    for (const PixelBox& tile : tiles) {
      const int width = tile.last_col - tile.first_col + 1 + 2 * radius;
      tile_.Resize((width + kMultiple - 1) / kMultiple * kMultiple,
                   tile.last_row - tile.first_row + 1 + 2 * radius);
      geometry_.first_row = tile.first_row - radius;
      geometry_.first_col = tile.first_col - radius;
      MarkCenters(tile, i.drawn);
      tile_.FindReached(radius);
      warp.Compute(&tile_, &geometry_);
      correlation_.Compute(max_relative_depth, &tile_);
      AddTile(&sums);
    }
    places_.Clear(facets);
    return sums;
  }

 private:
  // Marks the pixels of the rectangle that show one of the pair's facets.
  void MarkCenters(const PixelBox& rectangle, const FacetIdBuffer& drawn_i) {
    std::ranges::fill(tile_.is_center, 0);
    for (int row = rectangle.first_row; row <= rectangle.last_row; ++row) {
      for (int col = rectangle.first_col; col <= rectangle.last_col; ++col) {
        const uint32_t shown = drawn_i.facets[drawn_i.Index(row, col)];
        tile_.is_center[tile_.Index(row - geometry_.first_row,
                                    col - geometry_.first_col)] =
            shown != kNone && places_.Has(shown);
      }
    }
  }

  // Adds a tile's sums to the pair's facets. Pixels of other facets are part of
  // the windows, but get no derivative.
  void AddTile(std::vector<FacetTerms>* sums) const {
    for (size_t at = 0; at < geometry_.facets.size(); ++at) {
      const uint32_t facet = geometry_.facets[at];
      if (facet == kNone || !places_.Has(facet)) {
        continue;
      }
      FacetTerms& sum = (*sums)[places_[facet]];
      if (tile_.weights[at] > 0) {
        sum.energy += tile_.energies[at];
        sum.weight += tile_.weights[at];
        sum.num_pixels += 1;
      }
      const float motion = geometry_.motion[at];
      const float slope = tile_.derivatives[at] * motion;
      const float curvature = tile_.curvatures[at] * motion * motion;
      const std::array<float, 3>& phi = geometry_.barycentric[at];
      for (int k = 0, m = 0; k < 3; ++k) {
        sum.slopes[k] += phi[k] * slope;
        for (int l = k; l < 3; ++l, ++m) {
          sum.curvatures[m] += phi[k] * phi[l] * curvature;
        }
      }
    }
  }

  PhotometricOptions options_;
  WindowCorrelation correlation_;
  CorrelationTile tile_;
  TileGeometry geometry_;
  FacetPlaces places_;  // of the pair's facets
};

class CpuPhotometricEnergy : public PhotometricEnergy {
 public:
  CpuPhotometricEnergy(const PhotometricOptions& options,
                       std::shared_ptr<ImagePyramid> images, size_t max_memory)
      : options_(options),
        images_(std::move(images)),
        max_memory_(max_memory) {}

  void SetLevel(int level) override {
    images_->SetLevel(level);
    if (std::exchange(level_, level) != level) {
      Forget();
    }
  }

  void SetViews(std::vector<View> views) override {
    images_->SetViews(std::move(views));
    Forget();
  }

  std::shared_ptr<const VisibilityBuffers> Visibility(
      const TriangleMesh& mesh) override {
    if (!buffers_ || buffers_->Mesh().vertices != mesh.vertices ||
        buffers_->Mesh().facets != mesh.facets) {
      Forget();  // Before others take memory.
      buffers_ = std::make_shared<const VisibilityBuffers>(
          mesh, images_->Views(), options_.min_cosine,
          max_memory_ - std::min(max_memory_, images_->BorrowedMemory()),
          [images = images_](size_t view) { return images->Mask(view); });
    }
    return buffers_;
  }

  void Render(const TriangleMesh& mesh) override {
    Visibility(mesh)->DrawAhead();
  }

  PhotometricTerms Evaluate(const TriangleMesh& mesh,
                            const FacetLabels& labels) override;

  std::string Description() const override {
    const int num_threads = tbb::this_task_arena::max_concurrency();
    return "CPU, " + std::to_string(num_threads) +
           (num_threads == 1 ? " thread" : " threads");
  }

 private:
  // The facets and pixels that a labelling of the drawn mesh compares.
  struct Work {
    std::vector<ViewPair> pairs;
    Rows<uint32_t> facets;  // see GroupByDirection()
    std::vector<TiledDirection> directions;
  };

  void Forget() {
    work_.reset();
    buffers_.reset();
  }

  // Evaluations between two calls of Render() mostly have the same labels.
  const Work& WorkFor(const FacetLabels& labels) {
    if (!work_ || work_->pairs != labels.pairs ||
        !AreGroupsOf(labels, work_->facets)) {
      work_.reset();  // before others take memory
      work_ = Work{labels.pairs, GroupByDirection(labels),
                   FindDirections(*buffers_, labels)};
    }
    return *work_;
  }

  std::vector<FacetTerms> EvaluateDirection(
      const TriangleMesh& mesh, const Work& work,
      const TiledDirection& direction, DirectionEvaluator* evaluator) const {
    const auto& [index, i, j, tiles] = direction;
    const auto image_i = images_->Image(i);
    const auto image_j = images_->Image(j);
    const auto drawn_i = buffers_->Get(i);
    const auto drawn_j = buffers_->Get(j);
    const std::vector<View>& views = images_->Views();
    return evaluator->Evaluate({views[i], *image_i, *drawn_i, buffers_->Mesh()},
                               {views[j], *image_j, *drawn_j, buffers_->Mesh()},
                               mesh, work.facets[index], tiles);
  }

  PhotometricOptions options_;
  std::shared_ptr<ImagePyramid> images_;
  size_t max_memory_;
  int level_ = 0;
  std::shared_ptr<const VisibilityBuffers>
      buffers_;               // nothing: of another level
  std::optional<Work> work_;  // of buffers_
};

// Directions are evaluated in parallel and added in their order.
PhotometricTerms CpuPhotometricEnergy::Evaluate(const TriangleMesh& mesh,
                                                const FacetLabels& labels) {
  assert(buffers_ && buffers_->Mesh().facets.size() == mesh.facets.size());
  // Results per thread that wait for their turn: more take memory, with fewer
  // threads wait. The sums are the same.
  constexpr size_t kMaxWaiting = 4;
  const Work& work = WorkFor(labels);
  tbb::enumerable_thread_specific<DirectionEvaluator> evaluators(
      [&] { return DirectionEvaluator(options_, mesh.facets.size()); });
  PhotometricTerms terms{0, std::vector<FacetTerms>(mesh.facets.size())};
  using Result = std::pair<size_t, std::vector<FacetTerms>>;
  size_t next = 0;
  const auto take = tbb::make_filter<void, size_t>(
      tbb::filter_mode::serial_in_order, [&](tbb::flow_control& control) {
        if (next == work.directions.size()) {
          control.stop();
        }
        return next++;
      });
  const auto evaluate = tbb::make_filter<size_t, Result>(
      tbb::filter_mode::parallel, [&](size_t i) {
        return Result(i, EvaluateDirection(mesh, work, work.directions[i],
                                           &evaluators.local()));
      });
  const auto add = tbb::make_filter<Result, void>(
      tbb::filter_mode::serial_in_order, [&](const Result& result) {
        const auto& [i, sums] = result;
        const auto facets = work.facets[work.directions[i].direction];
        for (size_t k = 0; k < facets.size(); ++k) {
          Add(sums[k], &terms.facets[facets[k]]);
        }
      });
  tbb::parallel_pipeline(kMaxWaiting * tbb::this_task_arena::max_concurrency(),
                         take & evaluate & add);
  for (const FacetTerms& facet : terms.facets) {
    terms.energy += facet.energy;
  }
  return terms;
}

}  // namespace

double MeanZncc(double energy, double weight,
                const PhotometricOptions& options) {
  const double saturation = 1 + options.residual_floor;
  return weight > 0 ? -saturation * std::expm1(energy / weight / saturation)
                    : 0;
}

std::unique_ptr<PhotometricEnergy> MakeCpuPhotometricEnergy(
    const PhotometricOptions& options, std::shared_ptr<ImagePyramid> images,
    size_t max_memory) {
  return std::make_unique<CpuPhotometricEnergy>(options, std::move(images),
                                                max_memory);
}

}  // namespace colmap_ext
