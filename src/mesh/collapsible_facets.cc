#include "mesh/collapsible_facets.h"

#include <utility>

#include "mesh/singular_vertices.h"

namespace colmap_ext {

static_assert(CollapsibleFacets::kNone == kNoPartner);

CollapsibleFacets::CollapsibleFacets(std::vector<Facet> facets,
                                     size_t num_vertices)
    : facets_(std::move(facets)),
      partners_(PairHalfEdges(facets_)),
      outgoing_(num_vertices, kNone),
      marks_(num_vertices, 0) {
  for (uint32_t half = 0; half < partners_.size(); ++half) {
    uint32_t& outgoing = outgoing_[From(half)];
    if (outgoing == kNone || partners_[half] == kNone) {
      outgoing = half;
    }
  }
}

void CollapsibleFacets::GetStar(uint32_t vertex, Star* star) const {
  star->halves.clear();
  star->neighbors.clear();
  const uint32_t first = outgoing_[vertex];
  uint32_t half = first;
  do {
    star->halves.push_back(half);
    star->neighbors.push_back(To(half));
    half = partners_[Previous(half)];
  } while (half != kNone && half != first);
  star->is_border = half == kNone;
  if (star->is_border) {
    star->neighbors.push_back(Apex(star->halves.back()));
  }
}

bool CollapsibleFacets::IsCollapsible(uint32_t half, const Star& from,
                                      const Star& to) {
  const bool is_border_edge = partners_[half] == kNone;
  if (from.is_border && to.is_border && !is_border_edge) {
    return false;
  }
  // A facet alone, or a tetrahedron.
  const size_t num_neighbors = from.neighbors.size() + to.neighbors.size();
  if ((is_border_edge && num_neighbors == 4) ||
      (!from.is_border && !to.is_border && num_neighbors == 6)) {
    return false;
  }
  // The ends have no other neighbours in common than the edge's facets have.
  ++num_tests_;
  for (const uint32_t neighbor : from.neighbors) {
    marks_[neighbor] = num_tests_;
  }
  int num_common = 0;
  for (const uint32_t neighbor : to.neighbors) {
    num_common += marks_[neighbor] == num_tests_;
  }
  return num_common == (is_border_edge ? 1 : 2);
}

void CollapsibleFacets::Collapse(uint32_t half, const Star& to) {
  const uint32_t kept = From(half);
  const uint32_t removed = To(half);
  const uint32_t partner = partners_[half];
  for (const uint32_t other : to.halves) {
    facets_[other / 3][other % 3] = kept;
  }
  outgoing_[removed] = kNone;
  const uint32_t outgoing = CloseFacet(half);
  if (partner != kNone) {
    CloseFacet(partner);
  }
  outgoing_[kept] = First(outgoing);
}

uint32_t CollapsibleFacets::CloseFacet(uint32_t half) {
  const uint32_t apex = Apex(half);
  const uint32_t to_apex = partners_[Previous(half)];
  const uint32_t from_apex = partners_[Next(half)];
  if (to_apex != kNone) {
    partners_[to_apex] = from_apex;
  }
  if (from_apex != kNone) {
    partners_[from_apex] = to_apex;
  }
  if (outgoing_[apex] == Previous(half)) {
    outgoing_[apex] = from_apex;
  }
  facets_[half / 3] = {kNone, kNone, kNone};
  return to_apex != kNone ? to_apex : Next(from_apex);
}

uint32_t CollapsibleFacets::First(uint32_t half) const {
  uint32_t first = half;
  while (partners_[first] != kNone) {
    first = Next(partners_[first]);
    if (first == half) {
      break;
    }
  }
  return first;
}

}  // namespace colmap_ext
