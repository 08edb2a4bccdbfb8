#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <span>
#include <vector>

#include <Eigen/Core>

#include "delaunay/tetrahedralization.h"
#include "scene/progress.h"

namespace colmap_ext {

// A Delaunay tetrahedralization while points are inserted. A point is a vertex
// once it is inserted. Cells are oriented as those of a Tetrahedralization, and
// infinite ones close the hull.
struct GrowingComplex {
  struct alignas(32) Cell {
    std::array<uint32_t, 4> vertices;  // index into points, or kInfiniteVertex
    // [i]: the mirror facet of the facet opposite to vertex i: the same facet
    // in the neighboring cell, as 4 * cell + facet.
    std::array<uint32_t, 4> mirror_facets;
  };

  std::vector<Eigen::Vector3f> points;  // [P], distinct
  std::vector<Cell> cells;              // [C], those not in use included
  std::vector<uint8_t> is_marked;       // [C], scratch of an insertion
  std::vector<uint32_t> vertex_cells;   // [P], a finite cell of each, or kNone
  std::vector<uint32_t> free_cells;     // not in use
};

// Appends cells that are not in use.
// \throw std::invalid_argument where there are too many cells for 32-bit arcs
void AddFreeCells(size_t num_cells, GrowingComplex* complex);

// Whether not all points lie in a plane.
// \pre they differ
bool SpansVolume(const std::vector<Eigen::Vector3f>& points);

// Makes a complex of the first points in their order that span a volume.
// \param order  indices of points
// \return the four points
// \throw std::invalid_argument where the points span no volume
std::array<uint32_t, 4> StartComplex(std::span<const uint32_t> order,
                                     GrowingComplex* complex);

// The corner of a cell that is the infinite vertex; 4 where none is.
uint32_t InfiniteCorner(const GrowingComplex::Cell& cell);

// The orientation of a cell with a point in the place of corner i.
// \pre the other corners are finite
int OrientationWith(const GrowingComplex& complex,
                    const GrowingComplex::Cell& cell, uint32_t i,
                    const Eigen::Vector3f& point);

// Whether a point conflicts with a cell: whether it lies in the circumsphere of
// a finite cell, or beyond the hull facet of an infinite one. Perturbed as
// IsInSphere().
// \pre the point is at none of the cell's vertices
bool IsInConflict(const GrowingComplex& complex, uint32_t cell,
                  const Eigen::Vector3f& point);

// The tetrahedralization of a complex, with other numbers for the vertices. It
// depends on the points and their numbers alone. The complex is empty
// afterwards.
// \param numbers [P] from 0 on, each once
Tetrahedralization TakeTetrahedra(const std::vector<uint32_t>& numbers,
                                  GrowingComplex* complex);

// Inserts points into a Delaunay tetrahedralization: the cells whose
// circumspheres contain the point are replaced by cells from the point to the
// facets of the cavity [Bowyer1981; Watson1981]. The result depends neither on
// the order of insertion nor on the inserter (IsInSphere).
//
// Several inserters work concurrently on disjoint ranges of vertices
// [Marot2019]. An inserter changes a cell only if it owns at least three of its
// vertices, and replaces or walks through a cell only if it owns all four. All
// inserters own the infinite vertex. No data race: of a cell, at most one
// inserter owns three vertices.
class PointInserter {
 public:
  // \param begin, end  the range of vertices that the inserter owns
  PointInserter(uint32_t begin, uint32_t end, GrowingComplex* complex)
      : begin_(begin), end_(end), complex_(complex) {}

  // Unused cells: those that the inserter may use, and those that it released.
  std::vector<uint32_t>& free_cells() { return free_cells_; }

  // A visibility walk to the cell that contains a point: one of them if it lies
  // on a facet, an infinite one if it lies beyond the hull.
  // \param hint  a finite cell, all of whose vertices the inserter owns
  // \return kNone if the walk meets a vertex that the inserter does not own
  uint32_t Locate(uint32_t point, uint32_t hint) const;

  // \param cell  contains the point
  // \return a new finite cell; kNone if the point is not inserted, because
  //         the inserter does not own the cells or too few are free
  uint32_t Insert(uint32_t point, uint32_t cell);

  bool IsOwn(uint32_t cell) const;

  // A finite cell all of whose vertices the inserter owns; kNone where none is
  // found.
  uint32_t FindOwnCell() const;

 private:
  bool FindCavity(uint32_t point, uint32_t cell);
  uint32_t FillCavity(uint32_t point);
  uint32_t AddCell(uint32_t point, uint32_t arc);
  void Connect(uint32_t cell, uint32_t arc);
  uint32_t TurnThroughCavity(uint32_t arc, uint32_t exit) const;

  uint32_t begin_;
  uint32_t end_;
  GrowingComplex* complex_;
  std::vector<uint32_t> free_cells_;
  std::vector<uint32_t> cavity_;     // cells in conflict, marked
  std::vector<uint32_t> boundary_;   // their arcs to cells that are not
  std::vector<uint32_t> new_cells_;  // [boundary]
};

inline constexpr char kTriangulatingStage[] = "Triangulating points";

// The points without repeats, in their order along the Morton curve. Of points
// at one position the first is kept.
// \param representatives [P] is set to the point that is kept at each point's
//        position
// \return indices of points
// \pre all positions are finite
// \throw std::invalid_argument if there are more than 32 bits can number.
std::vector<uint32_t> DistinctPoints(
    const std::vector<Eigen::Vector3f>& positions,
    std::vector<uint32_t>* representatives);

// A biased randomized insertion order [Amenta2003]: random rounds of doubling
// size, each in ascending order. Seeds are fixed.
// \param num_points  along the curve
// \return [num_points] indices of points
std::vector<uint32_t> InsertionOrder(size_t num_points);

// Inserts points into an empty complex, in parallel. The result does not depend
// on the number of threads.
// \param order  InsertionOrder()
// \throw std::invalid_argument where the points span no volume or are too many
//        for 32-bit cell indices
void InsertPoints(const std::vector<uint32_t>& order, const Progress& progress,
                  GrowingComplex* complex);

// Appends points to a complex and inserts them, one after the other: fast where
// neighbors in the list are neighbors in space.
// \pre the positions are new to the complex
// \throw std::invalid_argument as InsertPoints()
void InsertMorePoints(std::span<const Eigen::Vector3f> positions,
                      GrowingComplex* complex);

}  // namespace colmap_ext
