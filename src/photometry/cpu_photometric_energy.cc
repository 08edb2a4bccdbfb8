#include "photometry/cpu_photometric_energy.h"

#include <algorithm>
#include <cassert>
#include <optional>
#include <utility>

#include <tbb/enumerable_thread_specific.h>
#include <tbb/parallel_pipeline.h>
#include <tbb/task_arena.h>

#include "photometry/direction_sums.h"
#include "photometry/pair_work.h"
#include "raster/visibility_buffers.h"

namespace colmap_ext {

namespace {

bool IsSameMesh(const TriangleMesh& a, const TriangleMesh& b) {
  return a.vertices == b.vertices && a.facets == b.facets;
}

PhotometricTerms EmptyTerms(size_t num_facets) {
  PhotometricTerms terms;
  terms.energies.assign(num_facets, 0);
  terms.weights.assign(num_facets, 0);
  terms.num_pixels.assign(num_facets, 0);
  terms.slopes.assign(num_facets, {});
  terms.curvatures.assign(num_facets, {});
  return terms;
}

void AddFacet(const FacetSums& sums, uint32_t facet, PhotometricTerms* terms) {
  terms->energies[facet] += sums.energy;
  terms->weights[facet] += sums.weight;
  terms->num_pixels[facet] += sums.num_pixels;
  for (int k = 0; k < 3; ++k) {
    terms->slopes[facet][k] += sums.slopes[k];
  }
  for (int k = 0; k < 6; ++k) {
    terms->curvatures[facet][k] += sums.curvatures[k];
  }
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
  std::vector<FacetSums> EvaluateDirection(const TriangleMesh& mesh,
                                           const Work& work,
                                           const TiledDirection& direction,
                                           DirectionEvaluator* evaluator) const;

  PhotometricOptions options_;
  std::shared_ptr<ImagePyramid> images_;
  size_t max_memory_;
  int level_ = 0;
  std::shared_ptr<const VisibilityBuffers>
      drawings_;              // nothing: of another level
  std::optional<Work> work_;  // of drawings_
};

void CpuPhotometricEnergy::SetLevel(int level) {
  images_->SetLevel(level);
  if (level != level_) {
    level_ = level;
    work_.reset();
    drawings_.reset();
  }
}

void CpuPhotometricEnergy::SetViews(std::vector<View> views) {
  images_->SetViews(std::move(views));
  work_.reset();
  drawings_.reset();
}

std::shared_ptr<const VisibilityBuffers> CpuPhotometricEnergy::Visibility(
    const TriangleMesh& mesh) {
  if (!drawings_ || !IsSameMesh(drawings_->Mesh(), mesh)) {
    work_.reset();
    drawings_.reset();  // Before there are others: they take memory.
    drawings_ = std::make_shared<const VisibilityBuffers>(
        mesh, images_->Views(), options_.min_cosine,
        max_memory_ - std::min(max_memory_, images_->BorrowedMemory()),
        [images = images_](size_t view) { return images->Mask(view); });
  }
  return drawings_;
}

// Evaluations between two calls of Render() have the same labels, as a rule.
const CpuPhotometricEnergy::Work& CpuPhotometricEnergy::WorkFor(
    const FacetLabels& labels) {
  if (!work_ || work_->pairs != labels.pairs ||
      !IsGroupedByDirection(labels, work_->facets)) {
    work_.reset();
    work_ = Work{labels.pairs, GroupByDirection(labels),
                 FindDirections(*drawings_, labels)};
  }
  return *work_;
}

std::vector<FacetSums> CpuPhotometricEnergy::EvaluateDirection(
    const TriangleMesh& mesh, const Work& work, const TiledDirection& direction,
    DirectionEvaluator* evaluator) const {
  const std::shared_ptr<const GrayImage> image_i = images_->Image(direction.i);
  const std::shared_ptr<const GrayImage> image_j = images_->Image(direction.j);
  const std::shared_ptr<const FacetIdBuffer> drawn_i =
      drawings_->Get(direction.i);
  const std::shared_ptr<const FacetIdBuffer> drawn_j =
      drawings_->Get(direction.j);
  const std::vector<View>& views = images_->Views();
  return evaluator->Evaluate({views[direction.i], *image_i, *drawn_i},
                             {views[direction.j], *image_j, *drawn_j}, mesh,
                             work.facets[direction.direction], direction.tiles);
}

PhotometricTerms CpuPhotometricEnergy::Evaluate(const TriangleMesh& mesh,
                                                const FacetLabels& labels) {
  assert(drawings_ && drawings_->Mesh().facets.size() == mesh.facets.size());
  const Work& work = WorkFor(labels);
  tbb::enumerable_thread_specific<DirectionEvaluator> evaluators(
      [&] { return DirectionEvaluator(options_, mesh.facets.size()); });
  PhotometricTerms terms = EmptyTerms(mesh.facets.size());
  ComputeInOrder(
      work.directions.size(),
      [&](size_t i) {
        return EvaluateDirection(mesh, work, work.directions[i],
                                 &evaluators.local());
      },
      [&](size_t i, const std::vector<FacetSums>& sums) {
        const auto facets = work.facets[work.directions[i].direction];
        for (size_t k = 0; k < facets.size(); ++k) {
          AddFacet(sums[k], facets[k], &terms);
        }
      });
  for (const float energy : terms.energies) {
    terms.energy += energy;
  }
  return terms;
}

std::string CpuPhotometricEnergy::Description() const {
  const int num_threads = tbb::this_task_arena::max_concurrency();
  return "CPU, " + std::to_string(num_threads) +
         (num_threads == 1 ? " thread" : " threads");
}

}  // namespace

std::unique_ptr<PhotometricEnergy> MakeCpuPhotometricEnergy(
    const PhotometricOptions& options, std::shared_ptr<ImagePyramid> images,
    size_t max_memory) {
  return std::make_unique<CpuPhotometricEnergy>(options, std::move(images),
                                                max_memory);
}

}  // namespace colmap_ext
