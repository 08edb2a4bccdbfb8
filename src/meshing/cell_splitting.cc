#include "meshing/cell_splitting.h"

#include <algorithm>
#include <array>

#include "spatial/predicates.h"

namespace colmap_ext {
namespace {

// Gives the parts of a cell what they have of its capacities.
void SplitCapacities(const std::array<uint32_t, 4>& parts,
                     FlowCapacities* graph) {
  const NodeCapacities whole = (*graph)[parts[0]];
  graph->resize(graph->size() + 3);
  for (int i = 0; i < 4; ++i) {
    (*graph)[parts[i]] = PartOf(whole, i);
  }
}

Eigen::Vector3f Centroid(const Tetrahedralization& tetrahedra, uint32_t cell) {
  Eigen::Vector3d sum = Eigen::Vector3d::Zero();
  for (const uint32_t vertex : tetrahedra.cells[cell].vertices) {
    sum += 0.25 * tetrahedra.points[vertex].cast<double>();
  }
  return sum.cast<float>();
}

}  // namespace

NodeCapacities PartOf(const NodeCapacities& cell, int part) {
  NodeCapacities share{{}, cell.source / 4, cell.sink / 4};
  share.arcs[part] = cell.arcs[part];
  if (part == 0) {
    share.source = cell.source - 3 * share.source;
    share.sink = cell.sink - 3 * share.sink;
  }
  return share;
}

bool CanSplit(const Tetrahedralization& tetrahedra, uint32_t cell) {
  if (tetrahedra.IsInfinite(cell)) {
    return false;
  }
  const Eigen::Vector3f centroid = Centroid(tetrahedra, cell);
  return std::ranges::all_of(kFacetCorners, [&](const auto& corners) {
    const auto at = [&](int k) -> const Eigen::Vector3f& {
      return tetrahedra.points[tetrahedra.cells[cell].vertices[corners[k]]];
    };
    return Orientation(at(0), at(1), at(2), centroid) > 0;
  });
}

void SplitCell(uint32_t cell, Tetrahedralization* tetrahedra,
               FlowCapacities* graph, std::vector<uint8_t>* is_free) {
  const Tetrahedralization::Cell parent = tetrahedra->cells[cell];
  const auto first_new = static_cast<uint32_t>(tetrahedra->cells.size());
  const std::array<uint32_t, 4> children = {cell, first_new, first_new + 1,
                                            first_new + 2};
  const auto centroid = static_cast<uint32_t>(tetrahedra->points.size());
  tetrahedra->points.push_back(Centroid(*tetrahedra, cell));
  tetrahedra->vertex_cells.push_back(cell);
  tetrahedra->cells.resize(first_new + 3);
  if (graph != nullptr) {
    SplitCapacities(children, graph);
  }
  is_free->resize(first_new + 3, (*is_free)[cell]);
  for (int i = 0; i < 4; ++i) {
    // The child that has the centroid in place of the parent's vertex i.
    Tetrahedralization::Cell child{parent.vertices, children};
    child.vertices[i] = centroid;
    child.neighbors[i] = parent.neighbors[i];
    tetrahedra->cells[children[i]] = child;
    const uint32_t outer = parent.neighbors[i];
    const int back = tetrahedra->FacetTo(outer, cell);
    tetrahedra->cells[outer].neighbors[back] = children[i];
    tetrahedra->vertex_cells[parent.vertices[i]] = children[(i + 1) % 4];
  }
}

}  // namespace colmap_ext
