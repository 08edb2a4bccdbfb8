#pragma once

#include <cstddef>
#include <cstdint>
#include <functional>
#include <vector>

#include "delaunay/tetrahedralization.h"
#include "mesh/triangle_mesh.h"
#include "optim/min_cut.h"

namespace colmap_ext {

enum class FixingRule {
  // The paper's three passes: relabel, split, relabel. Of the components of one
  // label around a vertex the one with the most cells keeps its label.
  kPaper,
  // Passes until nothing changes. At each vertex the flip is made that leaves
  // the fewest components around all vertices that it touches, and of these the
  // one with the least energy (BestFlip), but none that does not reduce their
  // number.
  kEnergy,
};

struct FixingReport {
  size_t num_singular_raw = 0;     // vertices, of the cut, before any fixing
  size_t num_singular_fixed = 0;   // vertices, left for the fan split
  size_t num_relabeled_cells = 0;  // a cell counts each time
  size_t num_split_cells = 0;      // each into four at its centroid
  // How often the surroundings of a vertex were examined: once each at first,
  // then again those of the vertices of cells that were relabelled.
  size_t num_examined_vertices = 0;
};

// A partially loaded tetrahedralization, and which of its singular vertices to
// fix.
struct PartialComplex {
  // Singular vertices to be fixed, ascending; then those that are left.
  std::vector<uint32_t> singular;
  // Whether a vertex that is not one of these is known to be regular.
  std::function<bool(uint32_t vertex)> is_examined;
  // Called with singular vertices before their surroundings change. Must append
  // all cells that are not loaded yet at these vertices and at the vertices of
  // their cells.
  std::function<void(const std::vector<uint32_t>& vertices)> complete;
  // Called before a cell is split, at the next vertex.
  std::function<void(uint32_t cell)> split;
};

// Preemptive fixing of singular vertices [Romanoni2020, section IV]: changes
// the labels of cells around them, and splits cells, so that the surface needs
// fewer copies of vertices to become manifold. All vertices are examined once;
// after that the time is proportional to the number of singular ones.
//
// \param tetrahedra no longer Delaunay where cells are split (SplitCell)
// \param graph      the cut's: node i is cell i
// \param is_free    [C] labels of the cells, 1: free space, 0: matter
// \param partial    nullptr: all cells are loaded
FixingReport FixSingularVertices(FixingRule rule,
                                 Tetrahedralization* tetrahedra,
                                 FlowCapacities* graph,
                                 std::vector<uint8_t>* is_free,
                                 PartialComplex* partial = nullptr);

// What one of the four parts of a split cell has of its capacities.
// \param part  the one that has the centroid in place of this corner
NodeCapacities PartOf(const NodeCapacities& cell, int part);

// Whether a cell can be split: it is finite, and its centroid, rounded to
// floats, lies within it, so that its parts are positively oriented.
bool CanSplit(const Tetrahedralization& tetrahedra, uint32_t cell);

// Splits a cell into four at its centroid. The cell keeps its index as
// the first of them; the other three are appended to the cells, and the
// centroid to the points. All four have the cell's label. They share out its
// terminal capacities; their outer facets keep its arcs, the arcs between them
// have no capacity: the cut's value stays.
//
// \param tetrahedra is no longer Delaunay afterwards
// \param graph      of the cells: node i is cell i; or nullptr
// \param is_free    [C] labels of the cells, 1: free space, 0: matter
// \pre CanSplit()
void SplitCell(uint32_t cell, Tetrahedralization* tetrahedra,
               FlowCapacities* graph, std::vector<uint8_t>* is_free);

// The facets between matter and free space, vertices still those of the
// tetrahedralization.
struct ExtractedSurface {
  TriangleMesh mesh;  // all of the tetrahedralization's points, used or not
  // [3 F] the half-edge with which each forms one surface: of the two facets
  // that the matter between them connects around the edge. kNone at a
  // border, where the surface continues to the vertex at infinity.
  std::vector<uint32_t> partners;
};

// Facets are in the order of the cells in matter. Their normals (right-handed)
// point into free space. Facets at infinity are left out.
// \param is_free [C] labels of the cells, 1: free space, 0: matter
ExtractedSurface ExtractSurface(const Tetrahedralization& tetrahedra,
                                const std::vector<uint8_t>& is_free);

}  // namespace colmap_ext
