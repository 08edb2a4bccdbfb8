#pragma once

#include <cstdint>
#include <vector>

#include <Eigen/Geometry>

#include "mesh/triangle_mesh.h"

namespace colmap_ext {

// [tiles] boxes that share out all space, infinite outwards; a lower side
// belongs to the box, an upper one to the next. See SplitTree::Cells().
using TileCells = std::vector<Eigen::AlignedBox3f>;

// The tile in whose cell a point lies.
uint32_t CellOf(const TileCells& cells, const Eigen::Vector3f& point);

Eigen::AlignedBox3f GrowBox(const Eigen::AlignedBox3f& box, float margin);

// The box of a facet's corners.
Eigen::AlignedBox3f BoxOf(const TriangleMesh& mesh, const Facet& facet);

// Gives tiles colours such that no facet's box comes near the cells of two
// tiles of one colour: tiles of one colour can be worked on at once. Greedy, in
// the tiles' order. \param reaches [tiles] what counts as near a cell, scene
// units \return [tiles] from 0 on
std::vector<uint32_t> ColorTiles(const TileCells& cells,
                                 const std::vector<float>& reaches,
                                 const TriangleMesh& mesh);

// Whether something within a box may lie between a camera and what another box
// encloses, or within that: whether the box meets the hull of the camera's
// centre and the other one.
// \pre neither box is empty
bool MayHide(const Eigen::AlignedBox3f& box, const Eigen::Vector3f& center,
             const Eigen::AlignedBox3f& seen);

}  // namespace colmap_ext
