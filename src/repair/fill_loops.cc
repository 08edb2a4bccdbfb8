#include "repair/fill_loops.h"

#include <algorithm>
#include <exception>
#include <iterator>
#include <new>
#include <unordered_map>
#include <utility>

#include <CGAL/Exact_predicates_inexact_constructions_kernel.h>
#include <CGAL/Polygon_mesh_processing/triangulate_hole.h>
#include <CGAL/Surface_mesh.h>

#include "mesh/split_fans.h"

namespace colmap_ext {
namespace {

namespace pmp = CGAL::Polygon_mesh_processing;

using Kernel = CGAL::Exact_predicates_inexact_constructions_kernel;
using CgalMesh = CGAL::Surface_mesh<Kernel::Point_3>;

// The facets around a loop, as a mesh of their own.
struct Surroundings {
  TriangleMesh mesh;              // manifold
  std::vector<uint32_t> sources;  // [V] in the whole mesh
};

// Facets up to three edges away: two for the curvature at the loop, one more
// for that of these.
Surroundings FindSurroundings(const TriangleMesh& mesh,
                              const VertexRings& rings,
                              const BorderLoop& loop) {
  constexpr int kNumRings = 3;
  const MeshPart part =
      TakePart(mesh, rings.FacetsAt(rings.VerticesAround(loop, kNumRings - 1)));
  // Its outer border may touch itself, the loop does not.
  FanSplit split = SplitFans(part.mesh);
  Surroundings surroundings{std::move(split.mesh), {}};
  for (const auto& source : split.from.vertices) {
    surroundings.sources.push_back(part.vertices[source[0]]);
  }
  return surroundings;
}

CgalMesh ToCgal(const TriangleMesh& mesh) {
  CgalMesh cgal;
  for (const Eigen::Vector3f& p : mesh.vertices) {
    cgal.add_vertex({p.x(), p.y(), p.z()});
  }
  for (const auto& [a, b, c] : mesh.facets) {
    cgal.add_face(CgalMesh::Vertex_index(a), CgalMesh::Vertex_index(b),
                  CgalMesh::Vertex_index(c));
  }
  return cgal;
}

// \return the faces that fill the hole
std::vector<CgalMesh::Face_index> Fill(FillingKind kind,
                                       CgalMesh::Halfedge_index border,
                                       size_t loop_size, CgalMesh* mesh) {
  // Edges of a loop from which on facets are sought among those of the Delaunay
  // tetrahedra of its vertices only: all others take cubic time. A choice.
  constexpr size_t kMaxCubic = 300;
  const auto options =
      CGAL::parameters::do_not_use_cubic_algorithm(loop_size > kMaxCubic);
  std::vector<CgalMesh::Face_index> faces;
  std::vector<CgalMesh::Vertex_index> vertices;
  switch (kind) {
    case FillingKind::kFair:
      if (!std::get<0>(pmp::triangulate_refine_and_fair_hole(
              *mesh, border, std::back_inserter(faces),
              std::back_inserter(vertices), options))) {
        faces.clear();
      }
      break;
    case FillingKind::kRefined:
      pmp::triangulate_and_refine_hole(*mesh, border, std::back_inserter(faces),
                                       std::back_inserter(vertices), options);
      break;
    case FillingKind::kFlat:
      pmp::triangulate_hole(*mesh, border, std::back_inserter(faces), options);
      break;
  }
  std::sort(faces.begin(), faces.end());
  return faces;
}

// \param num_vertices  of the whole mesh
LoopFilling ToFilling(const CgalMesh& cgal,
                      const std::vector<CgalMesh::Face_index>& faces,
                      const Surroundings& surroundings, size_t num_vertices) {
  LoopFilling filling;
  std::unordered_map<uint32_t, uint32_t> new_vertices;
  for (const CgalMesh::Face_index face : faces) {
    Facet facet;
    size_t k = 0;
    for (const CgalMesh::Vertex_index vertex :
         cgal.vertices_around_face(cgal.halfedge(face))) {
      if (vertex.idx() < surroundings.sources.size()) {
        facet[k++] = surroundings.sources[vertex.idx()];
        continue;
      }
      const auto [found, is_new] = new_vertices.try_emplace(
          vertex.idx(),
          static_cast<uint32_t>(num_vertices + filling.vertices.size()));
      if (is_new) {
        const Kernel::Point_3& p = cgal.point(vertex);
        filling.vertices.push_back(
            Eigen::Vector3d(p.x(), p.y(), p.z()).cast<float>());
      }
      facet[k++] = found->second;
    }
    filling.facets.push_back(facet);
  }
  return filling;
}

}  // namespace

std::optional<LoopFilling> FillLoop(FillingKind kind, const TriangleMesh& mesh,
                                    const VertexRings& rings,
                                    const BorderLoop& loop) {
  const Surroundings surroundings = FindSurroundings(mesh, rings, loop);
  const auto find = [&](uint32_t vertex) {
    return CgalMesh::Vertex_index(
        static_cast<uint32_t>(std::ranges::find(surroundings.sources, vertex) -
                              surroundings.sources.begin()));
  };
  try {
    CgalMesh cgal = ToCgal(surroundings.mesh);
    const CgalMesh::Halfedge_index border =
        cgal.halfedge(find(loop[1]), find(loop[0]));
    if (!border.is_valid() || !cgal.is_border(border)) {
      return std::nullopt;
    }
    const std::vector<CgalMesh::Face_index> faces =
        Fill(kind, border, loop.size(), &cgal);
    LoopFilling filling =
        ToFilling(cgal, faces, surroundings, mesh.vertices.size());
    const bool is_finite = std::ranges::all_of(
        filling.vertices, [](const auto& p) { return p.allFinite(); });
    if (filling.facets.empty() || !is_finite) {
      return std::nullopt;
    }
    return filling;
  } catch (const std::bad_alloc&) {
    throw;
  } catch (const std::exception&) {  // CGAL's
    return std::nullopt;
  }
}

}  // namespace colmap_ext
