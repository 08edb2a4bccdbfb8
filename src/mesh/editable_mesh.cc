#include "mesh/editable_mesh.h"

#include <algorithm>
#include <utility>

namespace colmap_ext {

EditableMesh::EditableMesh(TriangleMesh mesh, std::vector<uint32_t> partners)
    : mesh_(std::move(mesh)),
      partners_(std::move(partners)),
      outgoing_(mesh_.vertices.size(), kNone) {
  for (uint32_t half = 0; half < partners_.size(); ++half) {
    uint32_t& outgoing = outgoing_[From(half)];
    if (outgoing == kNone || partners_[half] == kNone) {
      outgoing = half;
    }
  }
}

int EditableMesh::Valence(uint32_t vertex) const {
  int valence = IsBorderVertex(vertex) ? 1 : 0;
  ForEachOutgoing(vertex, [&](uint32_t /*half*/) { ++valence; });
  return valence;
}

MeshPart EditableMesh::Compact() const {
  MeshPart part;
  part.mesh.vertices = mesh_.vertices;
  for (uint32_t facet = 0; facet < NumFacets(); ++facet) {
    if (!IsRemovedFacet(facet)) {
      part.facets.push_back(facet);
      part.mesh.facets.push_back(mesh_.facets[facet]);
    }
  }
  part.vertices = DropUnusedVertices(&part.mesh);
  return part;
}

void EditableMesh::Join(uint32_t half, uint32_t other) {
  if (half != kNone) {
    partners_[half] = other;
  }
  if (other != kNone) {
    partners_[other] = half;
  }
}

// Makes the half-edge, or at a border the one from which all others follow,
// that of the vertex that it comes from.
void EditableMesh::SetOutgoing(uint32_t half) {
  const uint32_t first = half;
  while (partners_[half] != kNone) {
    half = NextHalfEdge(partners_[half]);
    if (half == first) {
      break;
    }
  }
  outgoing_[From(half)] = half;
}

bool EditableMesh::AreNeighbors(uint32_t vertex, uint32_t other) const {
  bool is_neighbor = false;
  ForEachNeighbor(vertex,
                  [&](uint32_t neighbor) { is_neighbor |= neighbor == other; });
  return is_neighbor;
}

uint32_t EditableMesh::Split(uint32_t half) {
  const uint32_t partner = partners_[half];
  const uint32_t middle = static_cast<uint32_t>(NumVertices());
  const uint32_t to = To(half);
  mesh_.vertices.emplace_back((Position(From(half)) + Position(to)) / 2);

  // Cuts the facet of a half-edge. The part at `from` keeps the facet's index;
  // the part at `to` is new.
  const auto cut = [&](uint32_t cut_half, bool keeps_from) {
    const uint32_t next = NextHalfEdge(cut_half);
    const uint32_t previous = PreviousHalfEdge(cut_half);
    const uint32_t apex = To(next);
    const uint32_t added = static_cast<uint32_t>(partners_.size());
    partners_.resize(added + 3, kNone);
    // The half-edge that the part replaces, and the corner that it takes over.
    const uint32_t outer = keeps_from ? next : previous;
    const uint32_t moved = keeps_from ? next : cut_half;
    const uint32_t end =
        std::exchange(mesh_.facets[cut_half / 3][moved % 3], middle);
    mesh_.facets.push_back(keeps_from ? Facet{middle, end, apex}
                                      : Facet{end, middle, apex});
    Join(added + (keeps_from ? 1 : 2), partners_[outer]);
    Join(added + (keeps_from ? 2 : 1), outer);
    return added;
  };

  const uint32_t added = cut(half, true);  // from the new vertex to `to`
  outgoing_.push_back(added);
  uint32_t added_partner = kNone;
  if (partner != kNone) {
    added_partner = cut(partner, false);  // from `to` to the new vertex
  }
  Join(added, added_partner);
  Join(half, partner);
  SetOutgoing(added + 1);  // from `to`
  SetOutgoing(added + 2);  // from the apex
  if (added_partner != kNone) {
    SetOutgoing(added_partner + 2);  // from the partner's apex
  }
  return middle;
}

bool EditableMesh::CanCollapse(uint32_t half) const {
  const uint32_t from = From(half);
  const uint32_t to = To(half);
  const uint32_t partner = partners_[half];
  if (partner != kNone && IsBorderVertex(from) && IsBorderVertex(to)) {
    return false;
  }
  // No apex may lose its last facet, or be left with two.
  for (const uint32_t side : {half, partner}) {
    if (side != kNone) {
      const uint32_t apex = Apex(side);
      if (Valence(apex) <= (IsBorderVertex(apex) ? 2 : 3)) {
        return false;
      }
    }
  }
  int num_common = 0;
  ForEachNeighbor(from, [&](uint32_t neighbor) {
    num_common += AreNeighbors(to, neighbor) ? 1 : 0;
  });
  return num_common == (partner == kNone ? 1 : 2);
}

void EditableMesh::Collapse(uint32_t half) {
  const uint32_t from = From(half);
  const uint32_t to = To(half);
  const uint32_t partner = partners_[half];
  std::vector<uint32_t> moved;  // half-edges from `from`
  ForEachOutgoing(from, [&](uint32_t outgoing) { moved.push_back(outgoing); });
  for (const uint32_t outgoing : moved) {
    mesh_.facets[outgoing / 3][outgoing % 3] = to;
  }
  std::array<uint32_t, 4> rims;  // outside the removed facets
  rims.fill(kNone);
  int num_rims = 0;
  for (const uint32_t side : {half, partner}) {
    if (side != kNone) {
      const uint32_t a = partners_[NextHalfEdge(side)];
      const uint32_t b = partners_[PreviousHalfEdge(side)];
      mesh_.facets[side / 3] = {0, 0, 0};
      std::fill_n(partners_.begin() + side / 3 * 3, 3, kNone);
      Join(a, b);
      rims[num_rims++] = a;
      rims[num_rims++] = b;
    }
  }
  // The ends of the rims: `to` and the apices.
  for (const uint32_t rim : rims) {
    if (rim != kNone) {
      SetOutgoing(rim);
      SetOutgoing(NextHalfEdge(rim));
    }
  }
  outgoing_[from] = kNone;
}

bool EditableMesh::CanFlip(uint32_t half) const {
  const uint32_t partner = partners_[half];
  return partner != kNone && Apex(half) != Apex(partner) &&
         !AreNeighbors(Apex(half), Apex(partner));
}

void EditableMesh::Flip(uint32_t half) {
  const uint32_t partner = partners_[half];
  const uint32_t next = NextHalfEdge(half);
  const uint32_t partner_next = NextHalfEdge(partner);
  const uint32_t apex = Apex(half);
  const uint32_t partner_apex = Apex(partner);
  const uint32_t outer = partners_[next];
  const uint32_t partner_outer = partners_[partner_next];
  // Each facet passes the half-edge after the edge to the other one.
  mesh_.facets[next / 3][next % 3] = partner_apex;
  mesh_.facets[partner_next / 3][partner_next % 3] = apex;
  Join(half, partner_outer);
  Join(partner, outer);
  Join(next, partner_next);
  SetOutgoing(half);
  SetOutgoing(partner);
  SetOutgoing(PreviousHalfEdge(half));
  SetOutgoing(PreviousHalfEdge(partner));
}

}  // namespace colmap_ext
