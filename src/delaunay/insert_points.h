#pragma once

#include <cstddef>
#include <cstdint>
#include <span>
#include <vector>

#include <Eigen/Core>

#include "delaunay/growing_complex.h"
#include "delaunay/point_inserter.h"
#include "scene/progress.h"

namespace colmap_ext {

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

// Inserts a point; adds free cells where there are too few.
// \param inserter  of all vertices
// \param cell      that holds the point
// \return a finite cell at the point
uint32_t InsertPoint(uint32_t point, uint32_t cell, PointInserter* inserter,
                     GrowingComplex* complex);

// Inserts all points into an empty complex, in parallel. The result does not
// depend on the number of threads.
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
