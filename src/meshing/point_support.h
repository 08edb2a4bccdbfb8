#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <vector>

namespace colmap_ext {

// The support of each vertex of a tetrahedralization, the summed weights of the
// points that it stands for: [num_vertices].
// \param point_vertices [P] the vertex of each point, < num_vertices
// \param point_weights [P] not negative
std::vector<float> SupportOfVertices(
    size_t num_vertices, const std::vector<uint32_t>& point_vertices,
    const std::vector<float>& point_weights);

// The same for the vertices of a surface: [V] the mean of two supports.
// \param sources [V] two vertices each, see Provenance; those from
//        supports.size() on have none
std::vector<float> SupportOfSurface(
    const std::vector<float>& supports,
    const std::vector<std::array<uint32_t, 2>>& sources);

}  // namespace colmap_ext
