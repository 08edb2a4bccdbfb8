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

bool IsSameMesh(const TriangleMesh& a, const TriangleMesh& b) {
  return a.vertices == b.vertices && a.facets == b.facets;
}

void Add(const FacetTerms& added, FacetTerms* terms) {
  terms->energy += added.energy;
  terms->weight += added.weight;
  terms->num_pixels += added.num_pixels;
  std::ranges::transform(terms->slopes, added.slopes, terms->slopes.begin(),
                         std::plus());
  std::ranges::transform(terms->curvatures, added.curvatures,
                         terms->curvatures.begin(), std::plus());
}

// \param phi  barycentric coordinates of the pixel on its facet.
void AddDerivatives(const std::array<float, 3>& phi, float slope,
                    float curvature, FacetTerms* sum) {
  for (int k = 0, m = 0; k < 3; ++k) {
    sum->slopes[k] += phi[k] * slope;
    for (int l = k; l < 3; ++l, ++m) {
      sum->curvatures[m] += phi[k] * phi[l] * curvature;
    }
  }
}

// Evaluates one direction of a pair at a time, i <- j. Holds scratch: each
// thread has its own.
class DirectionEvaluator {
 public:
  DirectionEvaluator(const PhotometricOptions& options, size_t num_facets)
      : options_(options), correlation_(options), places_(num_facets) {}

  // \param mesh  as it is at present.
  // \param facets  those that the pair refines, ascending.
  // \param tiles  of image i, see FindTiles().
  // \return [facets]
  std::vector<FacetTerms> Evaluate(const DrawnView& i, const DrawnView& j,
                                   const TriangleMesh& mesh,
                                   std::span<const uint32_t> facets,
                                   const std::vector<PixelRectangle>& tiles);

 private:
  void MarkCenters(const PixelRectangle& rectangle,
                   const FacetIdBuffer& drawn_i);
  void AddTile(std::vector<FacetTerms>* sums) const;

  PhotometricOptions options_;
  WindowCorrelation correlation_;
  CorrelationTile tile_;
  TileGeometry geometry_;
  FacetPlaces places_;  // of the pair's facets
};

// Those of the rectangle that show one of the pair's facets.
void DirectionEvaluator::MarkCenters(const PixelRectangle& rectangle,
                                     const FacetIdBuffer& drawn_i) {
  std::fill(tile_.is_center.begin(), tile_.is_center.end(), 0);
  for (int row = rectangle.first_row; row <= rectangle.last_row; ++row) {
    const uint32_t* shown = drawn_i.facets.data() + drawn_i.Index(row, 0);
    for (int col = rectangle.first_col; col <= rectangle.last_col; ++col) {
      tile_.is_center[tile_.Index(row - geometry_.first_row,
                                  col - geometry_.first_col)] =
          shown[col] != kNone && places_.Has(shown[col]);
    }
  }
}

// Adds a tile's sums to the pair's facets. Pixels of other facets are part of
// the windows, but get no derivative.
void DirectionEvaluator::AddTile(std::vector<FacetTerms>* sums) const {
  for (int row = 0; row < tile_.height; ++row) {
    for (int col = 0; col < tile_.width; ++col) {
      const size_t at = tile_.Index(row, col);
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
      AddDerivatives(geometry_.barycentric[at], tile_.derivatives[at] * motion,
                     tile_.curvatures[at] * motion * motion, &sum);
    }
  }
}

std::vector<FacetTerms> DirectionEvaluator::Evaluate(
    const DrawnView& i, const DrawnView& j, const TriangleMesh& mesh,
    std::span<const uint32_t> facets,
    const std::vector<PixelRectangle>& tiles) {
  places_.Set(facets);
  const PairWarp warp(i, j, mesh);
  constexpr int kMultiple = 8;  // see WindowRows
  const int radius = options_.window_radius;
  const float max_relative_depth = MaxRelativeDepth(options_, i.view);
  std::vector<FacetTerms> sums(facets.size());
  for (const PixelRectangle& rectangle : tiles) {
    const int width = rectangle.last_col - rectangle.first_col + 1 + 2 * radius;
    tile_.Resize((width + kMultiple - 1) / kMultiple * kMultiple,
                 rectangle.last_row - rectangle.first_row + 1 + 2 * radius);
    geometry_.first_row = rectangle.first_row - radius;
    geometry_.first_col = rectangle.first_col - radius;
    MarkCenters(rectangle, i.drawn);
    tile_.FindReached(radius);
    warp.Compute(&tile_, &geometry_);
    correlation_.Compute(max_relative_depth, &tile_);
    AddTile(&sums);
  }
  places_.Clear(facets);
  return sums;
}

// Calls use(i, compute(i)) for each i < size in ascending order, one at a time;
// compute() is called in parallel.
template <typename Compute, typename Use>
void ComputeInOrder(size_t size, const Compute& compute, const Use& use) {
  // Results a thread that wait for their turn. More would take memory, fewer
  // would let threads wait; the result is the same.
  constexpr size_t kMaxWaiting = 4;
  using Result = decltype(compute(size));
  size_t next = 0;
  tbb::parallel_pipeline(
      kMaxWaiting * tbb::this_task_arena::max_concurrency(),
      tbb::make_filter<void, size_t>(tbb::filter_mode::serial_in_order,
                                     [&](tbb::flow_control& control) {
                                       if (next == size) {
                                         control.stop();
                                       }
                                       return next++;
                                     }) &
          tbb::make_filter<size_t, std::pair<size_t, Result>>(
              tbb::filter_mode::parallel,
              [&](size_t i) { return std::pair(i, compute(i)); }) &
          tbb::make_filter<std::pair<size_t, Result>, void>(
              tbb::filter_mode::serial_in_order,
              [&](const std::pair<size_t, Result>& result) {
                use(result.first, result.second);
              }));
}

class CpuPhotometricEnergy : public PhotometricEnergy {
 public:
  CpuPhotometricEnergy(const PhotometricOptions& options,
                       std::shared_ptr<ImagePyramid> images, size_t max_memory)
      : options_(options),
        images_(std::move(images)),
        max_memory_(max_memory) {}

  void SetLevel(int level) override;
  void SetViews(std::vector<View> views) override;
  std::shared_ptr<const VisibilityBuffers> Visibility(
      const TriangleMesh& mesh) override;
  void Render(const TriangleMesh& mesh) override {
    Visibility(mesh)->DrawAhead();
  }
  PhotometricTerms Evaluate(const TriangleMesh& mesh,
                            const FacetLabels& labels) override;
  std::string Description() const override;

 private:
  // What a labelling of the drawn mesh says about where to compare.
  struct Work {
    std::vector<ViewPair> pairs;
    Rows<uint32_t> facets;  // see GroupByDirection()
    std::vector<TiledDirection> directions;
  };

  const Work& WorkFor(const FacetLabels& labels);
  std::vector<FacetTerms> EvaluateDirection(
      const TriangleMesh& mesh, const Work& work,
      const TiledDirection& direction, DirectionEvaluator* evaluator) const;

  PhotometricOptions options_;
  std::shared_ptr<ImagePyramid> images_;
  size_t max_memory_;
  int level_ = 0;
  std::shared_ptr<const VisibilityBuffers>
      buffers_;               // nothing: of another level
  std::optional<Work> work_;  // of buffers_
};

void CpuPhotometricEnergy::SetLevel(int level) {
  images_->SetLevel(level);
  if (level != level_) {
    level_ = level;
    work_.reset();
    buffers_.reset();
  }
}

void CpuPhotometricEnergy::SetViews(std::vector<View> views) {
  images_->SetViews(std::move(views));
  work_.reset();
  buffers_.reset();
}

std::shared_ptr<const VisibilityBuffers> CpuPhotometricEnergy::Visibility(
    const TriangleMesh& mesh) {
  if (!buffers_ || !IsSameMesh(buffers_->Mesh(), mesh)) {
    work_.reset();
    buffers_.reset();  // Before there are others: they take memory.
    buffers_ = std::make_shared<const VisibilityBuffers>(
        mesh, images_->Views(), options_.min_cosine,
        max_memory_ - std::min(max_memory_, images_->BorrowedMemory()),
        [images = images_](size_t view) { return images->Mask(view); });
  }
  return buffers_;
}

// Evaluations between two calls of Render() have the same labels, as a rule.
const CpuPhotometricEnergy::Work& CpuPhotometricEnergy::WorkFor(
    const FacetLabels& labels) {
  Rows<uint32_t> facets = GroupByDirection(labels);
  if (!work_ || work_->pairs != labels.pairs || work_->facets != facets) {
    work_.reset();
    work_ = Work{labels.pairs, std::move(facets),
                 FindDirections(*buffers_, labels)};
  }
  return *work_;
}

std::vector<FacetTerms> CpuPhotometricEnergy::EvaluateDirection(
    const TriangleMesh& mesh, const Work& work, const TiledDirection& direction,
    DirectionEvaluator* evaluator) const {
  const std::shared_ptr<const GrayImage> image_i = images_->Image(direction.i);
  const std::shared_ptr<const GrayImage> image_j = images_->Image(direction.j);
  const std::shared_ptr<const FacetIdBuffer> drawn_i =
      buffers_->Get(direction.i);
  const std::shared_ptr<const FacetIdBuffer> drawn_j =
      buffers_->Get(direction.j);
  const std::vector<View>& views = images_->Views();
  return evaluator->Evaluate({views[direction.i], *image_i, *drawn_i},
                             {views[direction.j], *image_j, *drawn_j}, mesh,
                             work.facets[direction.direction], direction.tiles);
}

PhotometricTerms CpuPhotometricEnergy::Evaluate(const TriangleMesh& mesh,
                                                const FacetLabels& labels) {
  assert(buffers_ && buffers_->Mesh().facets.size() == mesh.facets.size());
  const Work& work = WorkFor(labels);
  tbb::enumerable_thread_specific<DirectionEvaluator> evaluators(
      [&] { return DirectionEvaluator(options_, mesh.facets.size()); });
  PhotometricTerms terms{0, std::vector<FacetTerms>(mesh.facets.size())};
  ComputeInOrder(
      work.directions.size(),
      [&](size_t i) {
        return EvaluateDirection(mesh, work, work.directions[i],
                                 &evaluators.local());
      },
      [&](size_t i, const std::vector<FacetTerms>& sums) {
        const auto facets = work.facets[work.directions[i].direction];
        for (size_t k = 0; k < facets.size(); ++k) {
          Add(sums[k], &terms.facets[facets[k]]);
        }
      });
  for (const FacetTerms& facet : terms.facets) {
    terms.energy += facet.energy;
  }
  return terms;
}

std::string CpuPhotometricEnergy::Description() const {
  const int num_threads = tbb::this_task_arena::max_concurrency();
  return "CPU, " + std::to_string(num_threads) +
         (num_threads == 1 ? " thread" : " threads");
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
