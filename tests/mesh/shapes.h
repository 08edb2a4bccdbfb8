#pragma once

#include <cstdint>

#include "mesh/triangle_mesh.h"
#include "tests/mesh/known_meshes.h"

// Meshes with a shape, of irregular facets whose sides are a cell long or less.
namespace colmap_ext {

// A unit sphere around the origin with bumps of the given height.
TriangleMesh MakeBumpySphere(float cell_size, float height = 0.1f);

// What of it lies above z = -0.3: one border loop.
TriangleMesh MakeBumpyCap(float cell_size, float height = 0.1f);

// A torus around the z axis with radii of 0.7 and 0.3.
TriangleMesh MakeRoundTorus(float cell_size);

// A cube of sides of 2 around the origin.
TriangleMesh MakeFineCube(float cell_size);

// A square sheet of sides of 1 in the plane z = 0, its inner vertices moved
// within the plane by up to a third of their distance.
TriangleMesh MakeJitteredSquare(uint32_t num_quads, Random* random);

// A manifold mesh of any topology, with positions at random.
TriangleMesh MakeRandomManifold(Random* random);

// Returns the area of all facets.
double Area(const TriangleMesh& mesh);

}  // namespace colmap_ext
