#include "meshing/singular_vertices.h"

#include <atomic>
#include <iterator>
#include <memory>
#include <numeric>
#include <utility>

#include <tbb/parallel_for.h>

#include "base/indices.h"

namespace colmap_ext {
namespace {

// Calls visit(places) with the places in graph.cells of each component.
// \param seed_at  [S] -> all places: in this order components are found
template <typename SeedAt, typename Visit>
void ForEachComponent(const StarGraph& graph, const CellLabels& labels,
                      const SeedAt& seed_at, const Visit& visit) {
  thread_local std::vector<uint8_t> is_visited;
  thread_local std::vector<uint32_t> places;
  is_visited.assign(graph.cells.size(), 0);
  for (uint32_t k = 0; k < graph.cells.size(); ++k) {
    const uint32_t seed = seed_at(k);
    if (is_visited[seed]) {
      continue;
    }
    const uint8_t label = labels[graph.cells[seed]];
    is_visited[seed] = 1;
    places.assign(1, seed);
    for (size_t i = 0; i < places.size(); ++i) {
      for (const uint32_t neighbor : graph.neighbors[places[i]]) {
        if (!is_visited[neighbor] && labels[graph.cells[neighbor]] == label) {
          is_visited[neighbor] = 1;
          places.push_back(neighbor);
        }
      }
    }
    visit(places);
  }
}

using BoundaryFacet = std::array<uint32_t, 3>;

// An edge of a vertex's link, the sphere of the facets opposite to it in its
// cells, where free space and matter meet. All edges run with matter on the
// same side.
using LinkEdge = std::pair<uint32_t, uint32_t>;

// The edges between free space and matter in the link of each vertex.
struct BoundaryLinks {
  std::vector<uint64_t> offsets;      // [V + 1], into edges
  std::unique_ptr<LinkEdge[]> edges;  // in no particular order in each row

  std::span<LinkEdge> Edges(size_t vertex) const {
    return {edges.get() + offsets[vertex], edges.get() + offsets[vertex + 1]};
  }
};

// Appends the facets between matter and free space of a range of cells, those
// at infinity, too, and counts them at each of their vertices.
void CollectBoundary(const Tetrahedralization& tetrahedra,
                     const std::vector<uint8_t>& is_free, size_t begin,
                     size_t end, std::vector<BoundaryFacet>* facets,
                     std::vector<uint64_t>* counts) {
  for (size_t index = begin; index < end; ++index) {
    const Tetrahedralization::Cell& cell = tetrahedra.cells[index];
    for (int i = 0; i < 4 && !is_free[index]; ++i) {
      if (!is_free[cell.neighbors[i]]) {
        continue;
      }
      BoundaryFacet& facet = facets->emplace_back();
      for (int k = 0; k < 3; ++k) {
        facet[k] = cell.vertices[kFacetCorners[i][k]];
        if (facet[k] != kInfiniteVertex) {
          std::atomic_ref<uint64_t>((*counts)[facet[k]])
              .fetch_add(1, std::memory_order_relaxed);
        }
      }
    }
  }
}

// Puts the edge of each facet that is opposite to a vertex into the vertex's
// row, from the row's end to its beginning.
void AddLinkEdges(const std::vector<BoundaryFacet>& facets,
                  std::vector<uint64_t>* ends, LinkEdge* edges) {
  for (const BoundaryFacet& facet : facets) {
    for (int k = 0; k < 3; ++k) {
      if (facet[k] != kInfiniteVertex) {
        const uint64_t end = std::atomic_ref<uint64_t>((*ends)[facet[k]])
                                 .fetch_sub(1, std::memory_order_relaxed);
        edges[end - 1] = {facet[(k + 1) % 3], facet[(k + 2) % 3]};
      }
    }
  }
}

BoundaryLinks CollectBoundaryLinks(const Tetrahedralization& tetrahedra,
                                   const std::vector<uint8_t>& is_free) {
  constexpr size_t kBlock = 1 << 14;  // cells: 512 kB, fits a core's cache
  const size_t num_cells = tetrahedra.cells.size();
  std::vector<std::vector<BoundaryFacet>> blocks((num_cells + kBlock - 1) /
                                                 kBlock);
  BoundaryLinks links;
  links.offsets.assign(tetrahedra.points.size() + 1, 0);
  tbb::parallel_for(size_t{0}, blocks.size(), [&](size_t block) {
    CollectBoundary(tetrahedra, is_free, block * kBlock,
                    std::min(num_cells, (block + 1) * kBlock), &blocks[block],
                    &links.offsets);
  });
  std::partial_sum(links.offsets.begin(), links.offsets.end(),
                   links.offsets.begin());
  links.edges =
      std::make_unique_for_overwrite<LinkEdge[]>(links.offsets.back());
  tbb::parallel_for(size_t{0}, blocks.size(), [&](size_t block) {
    AddLinkEdges(blocks[block], &links.offsets, links.edges.get());
  });
  return links;
}

// Whether the edges form one simple cycle, or are none at all. A planar graph
// whose vertices all have as many edges in as out divides the sphere into two
// regions just then: into the two components of a vertex that is not singular.
// \pre as many edges lead to each vertex as from it
// \param edges are sorted where they are many
bool IsAtMostOneCycle(std::span<LinkEdge> edges) {
  constexpr size_t kMaxLinearSearch = 32;  // edges: 256 bytes
  if (edges.empty()) {
    return true;
  }
  const bool is_sorted = edges.size() > kMaxLinearSearch;
  if (is_sorted) {
    std::ranges::sort(edges);
  }
  // Always on by the first edge from a vertex: a walk that returns after as
  // many steps as there are edges has passed as many vertices.
  const uint32_t start = edges.front().first;
  uint32_t at = start;
  size_t length = 0;
  do {
    const auto edge = is_sorted
                          ? std::ranges::lower_bound(edges, LinkEdge{at, 0})
                          : std::ranges::find(edges, at, &LinkEdge::first);
    at = edge->second;
    ++length;
  } while (at != start && length < edges.size());
  return at == start && length == edges.size();
}

// Those vertices that are singular, in their order.
std::vector<uint32_t> SingularAmong(const Tetrahedralization& tetrahedra,
                                    const std::vector<uint8_t>& is_free,
                                    const std::vector<uint32_t>& vertices) {
  std::vector<uint8_t> is_singular(vertices.size());
  tbb::parallel_for(size_t{0}, vertices.size(), [&](size_t i) {
    thread_local StarGraph star;
    MakeStarGraph(tetrahedra, vertices[i], &star);
    is_singular[i] = CountComponents(star, CellLabels(is_free)) > 2;
  });
  std::vector<uint32_t> singular = Marked(is_singular);
  for (uint32_t& i : singular) {
    i = vertices[i];
  }
  return singular;
}

}  // namespace

CellLabels::CellLabels(const std::vector<uint8_t>& is_free,
                       std::span<const uint32_t> flipped)
    : is_free_(is_free), flipped_(flipped) {
  for (const uint32_t cell : flipped) {
    residues_ |= uint64_t{1} << (cell % 64);
  }
}

bool CellLabels::IsFlipped(uint32_t cell) const {
  return std::ranges::binary_search(flipped_, cell);
}

void MakeStarGraph(const Tetrahedralization& tetrahedra, uint32_t vertex,
                   StarGraph* graph) {
  thread_local CellPlaces places;
  places.Clear();
  graph->cells.clear();
  graph->neighbors.clear();
  places.PlaceIn(tetrahedra.vertex_cells[vertex], &graph->cells);
  for (size_t i = 0; i < graph->cells.size(); ++i) {
    const Tetrahedralization::Cell& cell = tetrahedra.cells[graph->cells[i]];
    std::array<uint32_t, 3>& neighbors = graph->neighbors.emplace_back();
    int num_neighbors = 0;
    for (int k = 0; k < 4; ++k) {
      if (cell.vertices[k] != vertex) {
        neighbors[num_neighbors++] =
            places.PlaceIn(cell.neighbors[k], &graph->cells);
      }
    }
  }
}

void MakeVertexStar(const StarGraph& graph, const CellLabels& labels,
                    VertexStar* star) {
  std::vector<uint32_t> seeds = Iota(graph.cells.size());
  std::ranges::sort(seeds, {}, [&](uint32_t i) { return graph.cells[i]; });
  star->cells.clear();
  star->offsets.assign(1, 0);
  star->is_free.clear();
  ForEachComponent(
      graph, labels, [&](uint32_t k) { return seeds[k]; },
      [&](const std::vector<uint32_t>& places) {
        for (const uint32_t place : places) {
          star->cells.push_back(graph.cells[place]);
        }
        star->offsets.push_back(star->cells.size());
        star->is_free.push_back(labels[star->cells.back()]);
      });
}

void MakeVertexStar(const Tetrahedralization& tetrahedra,
                    const std::vector<uint8_t>& is_free, uint32_t vertex,
                    VertexStar* star) {
  thread_local StarGraph graph;
  MakeStarGraph(tetrahedra, vertex, &graph);
  MakeVertexStar(graph, CellLabels(is_free), star);
}

size_t CountComponents(const StarGraph& graph, const CellLabels& labels) {
  size_t count = 0;
  ForEachComponent(
      graph, labels, [](uint32_t k) { return k; },
      [&](const std::vector<uint32_t>&) { ++count; });
  return count;
}

std::vector<uint32_t> SingularVertices(const Tetrahedralization& tetrahedra,
                                       const std::vector<uint8_t>& is_free) {
  const BoundaryLinks links = CollectBoundaryLinks(tetrahedra, is_free);
  std::vector<uint8_t> is_singular(tetrahedra.points.size(), 0);
  tbb::parallel_for(size_t{0}, is_singular.size(), [&](size_t vertex) {
    is_singular[vertex] = !IsAtMostOneCycle(links.Edges(vertex));
  });
  return Marked(is_singular);
}

SingularVertexTracker::SingularVertexTracker(
    const Tetrahedralization& tetrahedra, std::vector<uint8_t>* is_free,
    const std::vector<uint32_t>* singular)
    : tetrahedra_(tetrahedra),
      is_free_(is_free),
      singular_(singular != nullptr ? *singular
                                    : SingularVertices(tetrahedra, *is_free)),
      num_examined_vertices_(singular != nullptr ? 0
                                                 : tetrahedra.points.size()) {}

const std::vector<uint32_t>& SingularVertexTracker::Singular() {
  std::vector<uint32_t> touched(is_touched_.begin(), is_touched_.end());
  std::ranges::sort(touched);
  num_examined_vertices_ += touched.size();
  const std::vector<uint32_t> found =
      SingularAmong(tetrahedra_, *is_free_, touched);
  std::vector<uint32_t> untouched;
  std::set_difference(singular_.begin(), singular_.end(), touched.begin(),
                      touched.end(), std::back_inserter(untouched));
  singular_.clear();
  std::merge(untouched.begin(), untouched.end(), found.begin(), found.end(),
             std::back_inserter(singular_));
  is_touched_.clear();
  return singular_;
}

void SingularVertexTracker::Flip(std::span<const uint32_t> cells) {
  for (const uint32_t cell : cells) {
    FlipCell(cell);
    flips_.push_back(cell);
  }
}

void SingularVertexTracker::UndoFlips(size_t num_flips) {
  for (; flips_.size() > num_flips; flips_.pop_back()) {
    FlipCell(flips_.back());
  }
}

void SingularVertexTracker::FlipCell(uint32_t cell) {
  (*is_free_)[cell] = !(*is_free_)[cell];
  for (const uint32_t vertex : tetrahedra_.cells[cell].vertices) {
    if (vertex != kInfiniteVertex) {
      is_touched_.insert(vertex);
    }
  }
}

}  // namespace colmap_ext
