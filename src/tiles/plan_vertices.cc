#include "tiles/plan_vertices.h"

#include <algorithm>
#include <span>
#include <utility>

#include "base/indices.h"
#include "base/percentile.h"
#include "delaunay/growing_complex.h"
#include "meshing/finish_surface.h"
#include "meshing/noise_smoothing.h"

namespace colmap_ext {
namespace {

// The range of a sorted list of begins that a value lies in.
uint32_t RangeOf(const std::vector<uint32_t>& begins, uint32_t value) {
  return static_cast<uint32_t>(std::ranges::upper_bound(begins, value) -
                               begins.begin() - 1);
}

// Edge lengths that are kept of a tile. Any percentile of many tiles is known
// to 1 / 4096 of their edges then.
constexpr size_t kMaxLengths = 4096;

// \param is_end [V] edges of these do not count; empty: all do
EdgeSample SampleEdges(const Tetrahedralization& tetrahedra,
                       const std::vector<uint8_t>& is_end) {
  std::vector<float> all = EdgeLengths(tetrahedra, is_end);
  EdgeSample sample;
  sample.num_edges = all.size();
  if (all.empty()) {
    return sample;
  }
  std::ranges::sort(all);
  const size_t count = std::min(kMaxLengths, all.size());
  for (size_t i = 0; i < count; ++i) {
    sample.lengths.push_back(all[(2 * i + 1) * all.size() / (2 * count)]);
  }
  sample.percentile = Percentile(kSigmaPercentile, &all);
  return sample;
}

}  // namespace

uint32_t PlanBlocks::BlockOf(uint32_t vertex) const {
  return RangeOf(begins, vertex);
}

uint32_t PlanBlocks::TileOf(uint32_t vertex) const {
  return RangeOf(tile_begins, BlockOf(vertex));
}

uint32_t PlanBlocks::OwnerOf(const std::array<uint32_t, 4>& corners) const {
  std::array<uint32_t, 4> tiles;
  std::ranges::transform(corners, tiles.begin(), [this](uint32_t vertex) {
    return vertex == kInfiniteVertex ? vertex : TileOf(vertex);
  });
  uint32_t owner = kInfiniteVertex;
  int64_t most = 0;
  for (const uint32_t tile : tiles) {
    const int64_t count = std::ranges::count(tiles, tile);
    if (tile != kInfiniteVertex &&
        (count > most || (count == most && tile < owner))) {
      owner = tile;
      most = count;
    }
  }
  return owner;
}

void AddTile(const std::vector<Eigen::Vector3f>& positions,
             const Observations& observations, PlanBlocks* blocks) {
  const uint32_t first = blocks->NumVertices();
  const uint32_t num_vertices =
      ExpectIndexable(first + positions.size(), "vertices") - first;
  for (uint32_t begin = 0; begin < num_vertices; begin += kBlockVertices) {
    const uint32_t end = std::min(begin + kBlockVertices, num_vertices);
    Eigen::AlignedBox3f box;
    std::vector<uint32_t> views;
    bool has_ends = false;
    for (uint32_t i = begin; i < end; ++i) {
      box.extend(positions[i]);
      blocks->sum += positions[i].cast<double>();
      for (const Observation& observation : observations[i]) {
        views.push_back(observation.view);
      }
      has_ends = has_ends || observations.IsEnd(i);
    }
    SortUnique(&views);
    blocks->begins.push_back(first + end);
    blocks->boxes.push_back(box);
    blocks->views.AddRow(views);
    blocks->have_ends.push_back(has_ends);
  }
  blocks->tile_begins.push_back(static_cast<uint32_t>(blocks->NumBlocks()));
}

std::vector<Eigen::Vector3f> PositionsOf(const PlanVertices& plan,
                                         const std::vector<uint32_t>& ids) {
  const PlanBlocks& blocks = plan.Blocks();
  std::vector<Eigen::Vector3f> positions;
  std::vector<Eigen::Vector3f> of_block;
  uint32_t end = 0;
  uint32_t begin = 0;
  for (const uint32_t id : ids) {
    if (id >= end) {
      const uint32_t block = blocks.BlockOf(id);
      begin = blocks.begins[block];
      end = blocks.begins[block + 1];
      of_block = plan.ReadPositions(begin, end);
    }
    positions.push_back(of_block[id - begin]);
  }
  return positions;
}

TileVertices ThinTile(WeightedCloud weighted, const std::vector<View>& views,
                      const ThinningOptions& options) {
  const PointCloud& cloud = weighted.cloud;
  ThinnedPoints thinned = ThinPoints(cloud, views, options);
  TileVertices vertices;
  const std::vector<uint8_t> is_end = MarkEnds(thinned, &weighted);
  vertices.noises = LocalNoise(
      std::span(cloud.positions).first(weighted.num_points), thinned.positions);
  if (SpansVolume(thinned.positions)) {
    vertices.edges = SampleEdges(Tetrahedralize(thinned.positions), is_end);
  }
  const size_t num_vertices = thinned.vertex_points.size();
  vertices.positions = std::move(thinned.positions);
  vertices.observations = ObserveVertices(
      cloud, num_vertices, thinned.point_vertices, weighted.weights);
  vertices.observations.is_end = is_end;
  vertices.supports =
      SupportOfVertices(num_vertices, thinned.point_vertices, weighted.weights);
  vertices.attributes = AttributesOfPoints(cloud, thinned.vertex_points);
  return vertices;
}

float MergedPercentile(const std::vector<EdgeSample>& samples) {
  if (samples.size() == 1) {
    return samples[0].percentile;
  }
  std::vector<std::pair<float, double>> lengths;  // with how many each is for
  double total = 0;
  for (const EdgeSample& sample : samples) {
    for (const float length : sample.lengths) {
      lengths.emplace_back(length,
                           static_cast<double>(sample.num_edges) /
                               static_cast<double>(sample.lengths.size()));
    }
    total += static_cast<double>(sample.num_edges);
  }
  std::ranges::sort(lengths);
  double sum = 0;
  for (const auto& [length, count] : lengths) {
    sum += count;
    if (sum >= kSigmaPercentile / 100 * total) {
      return length;
    }
  }
  return 0;
}

}  // namespace colmap_ext
