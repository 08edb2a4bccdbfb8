#include "photometry/cpu_photometric_energy.h"

#include <algorithm>
#include <list>
#include <mutex>
#include <utility>

#include <tbb/enumerable_thread_specific.h>
#include <tbb/parallel_for.h>
#include <tbb/parallel_pipeline.h>
#include <tbb/task_arena.h>

#include "photometry/pair_warp.h"
#include "photometry/pair_work.h"
#include "photometry/window_correlation.h"
#include "raster/facet_frames.h"
#include "raster/facet_id_buffer.h"

namespace colmap_ext {

namespace {

// The mesh drawn into the views, as many at a time as memory allows.
class DrawnFacets {
 public:
  DrawnFacets(std::shared_ptr<ImagePyramid> images, double min_cosine,
              size_t max_memory)
      : images_(std::move(images)),
        min_cosine_(min_cosine),
        max_memory_(max_memory) {}

  void Draw(const TriangleMesh& mesh) {
    mesh_ = mesh;
    entries_.clear();
    memory_ = 0;
    size_t memory = 0;
    size_t num_views = 0;
    for (; num_views < images_->Views().size(); ++num_views) {
      memory += Memory(images_->Views()[num_views]);
      if (memory > max_memory_) {
        break;
      }
    }
    tbb::parallel_for(size_t{0}, num_views, [&](size_t i) { Get(i); });
  }

  std::shared_ptr<const FacetIdBuffer> Get(size_t view) {
    {
      const std::scoped_lock lock(mutex_);
      const auto found =
          std::find_if(entries_.begin(), entries_.end(),
                       [&](const Entry& entry) { return entry.view == view; });
      if (found != entries_.end()) {
        entries_.splice(entries_.begin(), entries_, found);
        return found->drawn;
      }
    }
    const View& size = images_->Views()[view];
    auto drawn = std::make_shared<const FacetIdBuffer>(
        DrawFacets(size, mesh_, min_cosine_));
    const std::scoped_lock lock(mutex_);
    memory_ += Memory(size);
    while (!entries_.empty() && memory_ > max_memory_) {
      memory_ -= Memory(images_->Views()[entries_.back().view]);
      entries_.pop_back();
    }
    entries_.push_front({view, drawn});
    return drawn;
  }

 private:
  struct Entry {
    size_t view;
    std::shared_ptr<const FacetIdBuffer> drawn;
  };

  static size_t Memory(const View& view) {
    return static_cast<size_t>(view.width) * view.height *
           (sizeof(uint32_t) + sizeof(float));
  }

  std::shared_ptr<ImagePyramid> images_;
  double min_cosine_;
  size_t max_memory_;
  TriangleMesh mesh_;
  std::mutex mutex_;
  std::list<Entry> entries_;  // the last used first
  size_t memory_ = 0;         // bytes
};

// What one direction of a pair adds to a facet.
struct FacetSums {
  float energy = 0;
  float weight = 0;
  float num_pixels = 0;
  std::array<float, 3> slopes{};
  std::array<float, 6> curvatures{};
};

// A direction of a pair, i <- j, and what comes of it.
struct Direction {
  uint32_t pair = 0;
  uint32_t i = 0;
  uint32_t j = 0;
  std::vector<PixelRectangle> tiles;
  std::vector<FacetSums> sums;  // of the pair's facets
};

void AddDirection(const Rows<uint32_t>& pair_facets, const Direction& direction,
                  PhotometricTerms* terms) {
  const uint32_t* facets =
      pair_facets.values.data() + pair_facets.offsets[direction.pair];
  for (size_t i = 0; i < direction.sums.size(); ++i) {
    const uint32_t facet = facets[i];
    const FacetSums& sums = direction.sums[i];
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
}

// Of one thread.
struct Scratch {
  Scratch(const PhotometricOptions& options, size_t num_facets)
      : correlation(options), places(num_facets, UINT32_MAX) {}

  WindowCorrelation correlation;
  CorrelationTile tile;
  TileGeometry geometry;
  std::vector<uint32_t> places;  // [F] of the pair's facets in its sums
};

class CpuPhotometricEnergy : public PhotometricEnergy {
 public:
  CpuPhotometricEnergy(const PhotometricOptions& options,
                       std::shared_ptr<ImagePyramid> images, size_t max_memory)
      : options_(options),
        images_(std::move(images)),
        drawn_facets_(images_, options.min_cosine, max_memory) {}

  void SetLevel(int level) override { images_->SetLevel(level); }

  void Render(const TriangleMesh& mesh) override { drawn_facets_.Draw(mesh); }

  PhotometricTerms Evaluate(const TriangleMesh& mesh,
                            const FacetLabels& labels) override;

  std::string Description() const override {
    const int num_threads = tbb::this_task_arena::max_concurrency();
    return "CPU, " + std::to_string(num_threads) +
           (num_threads == 1 ? " thread" : " threads");
  }

 private:
  std::vector<Direction> FindDirections(const FacetLabels& labels);
  void EvaluateDirection(const std::vector<FacetFrame>& frames,
                         const Rows<uint32_t>& pair_facets,
                         Direction* direction, Scratch* scratch);
  void AddTile(const std::vector<FacetFrame>& frames, const PairWarp& warp,
               const Scratch& scratch, std::vector<FacetSums>* sums) const;

  PhotometricOptions options_;
  std::shared_ptr<ImagePyramid> images_;
  DrawnFacets drawn_facets_;
};

// By their view i, so that few views are in use at a time.
std::vector<Direction> CpuPhotometricEnergy::FindDirections(
    const FacetLabels& labels) {
  std::vector<std::vector<Direction>> by_view(images_->Views().size());
  tbb::parallel_for(size_t{0}, by_view.size(), [&](size_t view) {
    const bool is_used = std::any_of(
        labels.pairs.begin(), labels.pairs.end(), [&](const ViewPair& pair) {
          return pair.first == view || pair.second == view;
        });
    if (!is_used) {
      return;
    }
    const auto i = static_cast<uint32_t>(view);
    std::vector<std::vector<PixelRectangle>> tiles =
        FindTiles(*drawn_facets_.Get(view), i, labels);
    for (uint32_t pair = 0; pair < tiles.size(); ++pair) {
      if (!tiles[pair].empty()) {
        const auto [first, second] = labels.pairs[pair];
        by_view[view].push_back(
            {pair, i, first == i ? second : first, std::move(tiles[pair]), {}});
      }
    }
  });
  std::vector<Direction> directions;
  for (std::vector<Direction>& row : by_view) {
    std::move(row.begin(), row.end(), std::back_inserter(directions));
  }
  return directions;
}

// What the correlation of a tile says about the pair's facets on it. Pixels of
// other facets take part in the windows, but nothing is known of them here.
void CpuPhotometricEnergy::AddTile(const std::vector<FacetFrame>& frames,
                                   const PairWarp& warp, const Scratch& scratch,
                                   std::vector<FacetSums>* sums) const {
  const CorrelationTile& tile = scratch.tile;
  const TileGeometry& geometry = scratch.geometry;
  for (int row = 0; row < tile.height; ++row) {
    for (int col = 0; col < tile.width; ++col) {
      const size_t at = tile.Index(row, col);
      const uint32_t facet = geometry.facets[at];
      if (facet == kNoFacet || scratch.places[facet] == UINT32_MAX) {
        continue;
      }
      FacetSums& sum = (*sums)[scratch.places[facet]];
      if (tile.weights[at] > 0) {
        sum.energy += tile.energies[at];
        sum.weight += tile.weights[at];
        sum.num_pixels += 1;
      }
      const float slope = tile.derivatives[at] * geometry.motion[at];
      const float curvature =
          tile.curvatures[at] * geometry.motion[at] * geometry.motion[at];
      const Eigen::Vector3f phi =
          frames[facet]
              .Barycentric(warp.Point(frames[facet], geometry.first_row + row,
                                      geometry.first_col + col))
              .cast<float>();
      for (int k = 0, m = 0; k < 3; ++k) {
        sum.slopes[k] += phi[k] * slope;
        for (int l = k; l < 3; ++l, ++m) {
          sum.curvatures[m] += phi[k] * phi[l] * curvature;
        }
      }
    }
  }
}

void CpuPhotometricEnergy::EvaluateDirection(
    const std::vector<FacetFrame>& frames, const Rows<uint32_t>& pair_facets,
    Direction* direction, Scratch* scratch) {
  const std::shared_ptr<const GrayImage> image_i = images_->Image(direction->i);
  const std::shared_ptr<const GrayImage> image_j = images_->Image(direction->j);
  const std::shared_ptr<const FacetIdBuffer> drawn_i =
      drawn_facets_.Get(direction->i);
  const std::shared_ptr<const FacetIdBuffer> drawn_j =
      drawn_facets_.Get(direction->j);
  const View& view_i = images_->Views()[direction->i];
  const View& view_j = images_->Views()[direction->j];
  const PairWarp warp({view_i, *image_i, *drawn_i},
                      {view_j, *image_j, *drawn_j}, frames);
  const uint32_t* first =
      pair_facets.values.data() + pair_facets.offsets[direction->pair];
  const uint32_t* last =
      pair_facets.values.data() + pair_facets.offsets[direction->pair + 1];
  for (const uint32_t* facet = first; facet != last; ++facet) {
    scratch->places[*facet] = static_cast<uint32_t>(facet - first);
  }
  direction->sums.resize(last - first);
  const int radius = options_.window_radius;
  const float max_relative_depth = MaxRelativeDepth(options_, view_i);
  CorrelationTile& tile = scratch->tile;
  TileGeometry& geometry = scratch->geometry;
  for (const PixelRectangle& rectangle : direction->tiles) {
    tile.Resize(rectangle.last_col - rectangle.first_col + 1 + 2 * radius,
                rectangle.last_row - rectangle.first_row + 1 + 2 * radius);
    geometry.first_row = rectangle.first_row - radius;
    geometry.first_col = rectangle.first_col - radius;
    std::fill(tile.is_center.begin(), tile.is_center.end(), 0);
    for (int row = radius; row < tile.height - radius; ++row) {
      for (int col = radius; col < tile.width - radius; ++col) {
        const uint32_t facet = drawn_i->facets[drawn_i->Index(
            geometry.first_row + row, geometry.first_col + col)];
        tile.is_center[tile.Index(row, col)] =
            facet != kNoFacet && scratch->places[facet] != UINT32_MAX;
      }
    }
    tile.FindReached(radius);
    warp.Compute(&tile, &geometry);
    scratch->correlation.Compute(max_relative_depth, &tile);
    AddTile(frames, warp, *scratch, &direction->sums);
  }
  for (const uint32_t* facet = first; facet != last; ++facet) {
    scratch->places[*facet] = UINT32_MAX;
  }
}

PhotometricTerms CpuPhotometricEnergy::Evaluate(const TriangleMesh& mesh,
                                                const FacetLabels& labels) {
  const std::vector<FacetFrame> frames = ComputeFacetFrames(mesh);
  const Rows<uint32_t> pair_facets = GroupByPair(labels);
  std::vector<Direction> directions = FindDirections(labels);
  tbb::enumerable_thread_specific<Scratch> scratches(
      [&] { return Scratch(options_, mesh.facets.size()); });
  const size_t num_facets = mesh.facets.size();
  PhotometricTerms terms;
  terms.energies.assign(num_facets, 0);
  terms.weights.assign(num_facets, 0);
  terms.num_pixels.assign(num_facets, 0);
  terms.slopes.assign(num_facets, {});
  terms.curvatures.assign(num_facets, {});
  // Added in the directions' order, whoever computed them; no more of them than
  // a few a thread wait for that.
  constexpr size_t kMaxWaiting = 4;
  size_t next = 0;
  tbb::parallel_pipeline(
      kMaxWaiting * tbb::this_task_arena::max_concurrency(),
      tbb::make_filter<void, Direction*>(
          tbb::filter_mode::serial_in_order,
          [&](tbb::flow_control& control) -> Direction* {
            if (next == directions.size()) {
              control.stop();
              return nullptr;
            }
            return &directions[next++];
          }) &
          tbb::make_filter<Direction*, Direction*>(
              tbb::filter_mode::parallel,
              [&](Direction* direction) {
                EvaluateDirection(frames, pair_facets, direction,
                                  &scratches.local());
                return direction;
              }) &
          tbb::make_filter<Direction*, void>(
              tbb::filter_mode::serial_in_order, [&](Direction* direction) {
                AddDirection(pair_facets, *direction, &terms);
                *direction = {};
              }));
  for (const float energy : terms.energies) {
    terms.energy += energy;
  }
  return terms;
}

}  // namespace

std::unique_ptr<PhotometricEnergy> MakeCpuPhotometricEnergy(
    const PhotometricOptions& options, std::shared_ptr<ImagePyramid> images,
    size_t max_memory) {
  return std::make_unique<CpuPhotometricEnergy>(options, std::move(images),
                                                max_memory);
}

}  // namespace colmap_ext
