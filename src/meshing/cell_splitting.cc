#include "meshing/cell_splitting.h"

#include <array>

namespace colmap_ext {

void SplitCell(uint32_t cell, Tetrahedralization* tetrahedra,
               FlowCapacities* graph, std::vector<uint8_t>* is_free) {
  const Tetrahedralization::Cell parent = tetrahedra->cells[cell];
  const auto first_new = static_cast<uint32_t>(tetrahedra->cells.size());
  const std::array<uint32_t, 4> children = {cell, first_new, first_new + 1,
                                            first_new + 2};
  const auto centroid = static_cast<uint32_t>(tetrahedra->points.size());
  Eigen::Vector3d position = Eigen::Vector3d::Zero();
  for (const uint32_t vertex : parent.vertices) {
    position += 0.25 * tetrahedra->points[vertex].cast<double>();
  }
  tetrahedra->points.push_back(position.cast<float>());
  tetrahedra->vertex_cells.push_back(cell);
  tetrahedra->cells.resize(first_new + 3);
  graph->capacities.resize(first_new + 3);
  graph->source.resize(first_new + 3, graph->source[cell] / 4);
  graph->sink.resize(first_new + 3, graph->sink[cell] / 4);
  graph->source[cell] -= 3 * (graph->source[cell] / 4);
  graph->sink[cell] -= 3 * (graph->sink[cell] / 4);
  is_free->resize(first_new + 3, (*is_free)[cell]);
  const std::array<uint32_t, 4> capacities = graph->capacities[cell];
  for (int i = 0; i < 4; ++i) {
    // The child that has the centroid in place of the parent's vertex i.
    Tetrahedralization::Cell child{parent.vertices, children};
    child.vertices[i] = centroid;
    child.neighbors[i] = parent.neighbors[i];
    tetrahedra->cells[children[i]] = child;
    graph->capacities[children[i]] = {0, 0, 0, 0};
    graph->capacities[children[i]][i] = capacities[i];
    const uint32_t outer = parent.neighbors[i];
    const int back = tetrahedra->FacetTo(outer, cell);
    tetrahedra->cells[outer].neighbors[back] = children[i];
    tetrahedra->vertex_cells[parent.vertices[i]] = children[(i + 1) % 4];
  }
}

}  // namespace colmap_ext
