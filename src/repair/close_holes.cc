#include "repair/borders.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <functional>
#include <limits>
#include <numbers>
#include <queue>
#include <tuple>
#include <utility>

#include <Eigen/Core>

#include "mesh/adjacency.h"
#include "mesh/normals.h"
#include "repair/fill_loops.h"
#include "spatial/self_intersections.h"

namespace colmap_ext {
namespace {

// In the order of their first half-edges.
std::vector<BorderLoop> FindLoops(const TriangleMesh& mesh) {
  const std::vector<uint32_t> partners = PairHalfEdges(mesh.facets);
  // [V] the border's half-edge that leaves a vertex; a manifold mesh has one.
  std::vector<uint32_t> leaving(mesh.vertices.size(), kNone);
  for (uint32_t half = 0; half < partners.size(); ++half) {
    if (partners[half] == kNone) {
      leaving[FromVertex(mesh.facets, half)] = half;
    }
  }
  std::vector<BorderLoop> loops;
  for (uint32_t half = 0; half < partners.size(); ++half) {
    BorderLoop loop;
    uint32_t vertex = FromVertex(mesh.facets, half);
    while (partners[half] == kNone && leaving[vertex] != kNone) {
      loop.push_back(vertex);
      vertex = ToVertex(mesh.facets, std::exchange(leaving[vertex], kNone));
    }
    if (!loop.empty()) {
      loops.push_back(std::move(loop));
    }
  }
  return loops;
}

// [V] By how much a border turns at each of its vertices, seen along the
// surface: pi less the angles of the facets there, radians.
std::vector<double> Turns(const TriangleMesh& mesh) {
  std::vector<double> turns(mesh.vertices.size(), std::numbers::pi);
  for (const Facet& facet : mesh.facets) {
    for (uint32_t k = 0; k < 3; ++k) {
      turns[facet[k]] -= AngleVector(mesh, facet, k).norm();
    }
  }
  return turns;
}

// Whether a loop is no wider than so many pixels. Its width is the longest
// chord if one vertex after the other is cut off, that with the shortest chord
// first, until three are left: about the width of a slit, and the diameter of a
// round hole.
// \param footprints [V] scene units a pixel
bool IsNarrow(const TriangleMesh& mesh, std::span<const float> footprints,
              double max_width, const BorderLoop& loop) {
  const auto size = static_cast<uint32_t>(loop.size());
  std::vector<uint32_t> before(size);
  std::vector<uint32_t> after(size);
  // Pixels, and what the chord cuts off, begins and ends at.
  using Chord = std::tuple<double, uint32_t, uint32_t, uint32_t>;
  std::priority_queue<Chord, std::vector<Chord>, std::greater<>> chords;
  const auto add = [&](uint32_t i) {
    const uint32_t a = loop[before[i]];
    const uint32_t b = loop[after[i]];
    chords.emplace((mesh.vertices[a] - mesh.vertices[b]).norm() * 2 /
                       (footprints[a] + footprints[b]),
                   i, before[i], after[i]);
  };
  for (uint32_t i = 0; i < size; ++i) {
    before[i] = (i + size - 1) % size;
    after[i] = (i + 1) % size;
    add(i);
  }
  for (uint32_t num_left = size; num_left > 3;) {
    const auto [length, i, a, b] = chords.top();
    chords.pop();
    if (before[i] != a || after[i] != b) {
      continue;  // It has been cut off, or a neighbor has.
    }
    if (length > max_width) {
      return false;
    }
    before[i] = kNone;
    after[a] = b;
    before[b] = a;
    add(a);
    add(b);
    --num_left;
  }
  return true;
}

// A mesh with fillings behind its own facets.
struct FilledMesh {
  TriangleMesh mesh;
  size_t num_facets = 0;         // of its own
  std::vector<uint32_t> owners;  // of the other facets: their filling
  size_t num_fillings = 0;

  void Add(const LoopFilling& filling, size_t num_old_vertices) {
    const auto shift =
        static_cast<uint32_t>(mesh.vertices.size() - num_old_vertices);
    for (Facet facet : filling.facets) {
      for (uint32_t& vertex : facet) {
        vertex += vertex >= num_old_vertices ? shift : 0;
      }
      mesh.facets.push_back(facet);
      owners.push_back(static_cast<uint32_t>(num_fillings));
    }
    Append(filling.vertices, &mesh.vertices);
    ++num_fillings;
  }

  // Marks the filling that a facet is of, if it is of one.
  void Mark(uint32_t facet, std::vector<uint8_t>* is_marked) const {
    if (facet >= num_facets) {
      (*is_marked)[owners[facet - num_facets]] = 1;
    }
  }
};

// [fillings] whether it shares an edge with too many facets, or has the three
// vertices of another facet.
std::vector<uint8_t> FindNonManifold(const FilledMesh& filled) {
  std::vector<uint8_t> is_found(filled.num_fillings, 0);
  std::vector<std::array<uint32_t, 3>> beside(filled.mesh.facets.size());
  ForEachEdge(filled.mesh.facets, [&](auto first, auto last) {
    if (last - first == 2) {
      const uint32_t a = first->second;
      const uint32_t b = (first + 1)->second;
      beside[a / 3][a % 3] = b / 3;
      beside[b / 3][b % 3] = a / 3;
    }
    for (auto half = first; last - first > 2 && half != last; ++half) {
      filled.Mark(half->second / 3, &is_found);
    }
  });
  for (auto facet = static_cast<uint32_t>(filled.num_facets);
       facet < beside.size(); ++facet) {
    if (beside[facet][0] == beside[facet][1] &&
        beside[facet][1] == beside[facet][2]) {
      filled.Mark(facet, &is_found);
    }
  }
  return is_found;
}

// [fillings] whether one of its facets intersects another.
std::vector<uint8_t> FindIntersecting(const FilledMesh& filled) {
  std::vector<uint8_t> is_found(filled.num_fillings, 0);
  for (const auto& [a, b] : FindSelfIntersections(filled.mesh)) {
    filled.Mark(a, &is_found);
    filled.Mark(b, &is_found);
  }
  return is_found;
}

// What one loop is filled with.
struct Patch {
  BorderLoop loop;
  LoopFilling filling;
};

// A mesh whose holes are closed, round by round.
class HoleCloser {
 public:
  // \param may_intersect  whether a loop is closed by facets that intersect
  //        others where there is no other way
  HoleCloser(bool may_intersect, Surface* surface)
      : may_intersect_(may_intersect),
        rings_(MakeVertexRings(surface->mesh)),
        surface_(*surface) {}

  HoleReport Close(std::vector<BorderLoop> loops) {
    const TriangleMesh mesh = surface_.mesh;
    report_.num_loops = loops.size();
    for (const FillingKind kind :
         {FillingKind::kFair, FillingKind::kRefined, FillingKind::kFlat}) {
      if (!loops.empty()) {
        loops = CloseBy(kind, mesh, std::move(loops));
      }
    }
    report_.num_vertices = surface_.mesh.vertices.size() - rings_.NumVertices();
    report_.num_facets = surface_.mesh.facets.size() - mesh.facets.size();
    return report_;
  }

 private:
  // \return the loops that are not closed
  std::vector<BorderLoop> CloseBy(FillingKind kind, const TriangleMesh& mesh,
                                  std::vector<BorderLoop> loops) {
    std::vector<BorderLoop> left;
    std::vector<Patch> patches;
    for (BorderLoop& loop : loops) {
      if (auto filling = FillLoop(kind, mesh, rings_, loop)) {
        patches.push_back({std::move(loop), std::move(*filling)});
      } else {
        left.push_back(std::move(loop));
      }
    }
    Remove(FindNonManifold(Fill(patches)), &patches, &left);
    const std::vector<uint8_t> is_intersecting =
        FindIntersecting(Fill(patches));
    if (kind == FillingKind::kFlat && may_intersect_) {
      report_.num_intersecting =
          static_cast<size_t>(std::ranges::count(is_intersecting, 1));
    } else {
      Remove(is_intersecting, &patches, &left);
    }
    for (const Patch& patch : patches) {
      InheritFrom(patch);
    }
    report_.num_closed += patches.size();
    surface_.mesh = Fill(patches).mesh;
    return left;
  }

  FilledMesh Fill(const std::vector<Patch>& patches) const {
    FilledMesh filled{surface_.mesh, surface_.mesh.facets.size(), {}, 0};
    for (const Patch& patch : patches) {
      // The fillings' indices are based on the old vertices.
      filled.Add(patch.filling, rings_.NumVertices());
    }
    return filled;
  }

  static void Remove(const std::vector<uint8_t>& is_removed,
                     std::vector<Patch>* patches,
                     std::vector<BorderLoop>* left) {
    std::vector<Patch> kept;
    for (size_t i = 0; i < patches->size(); ++i) {
      if (is_removed[i] != 0) {
        left->push_back(std::move((*patches)[i].loop));
      } else {
        kept.push_back(std::move((*patches)[i]));
      }
    }
    patches->swap(kept);
  }

  void InheritFrom(const Patch& patch) {
    VertexAttributes& attributes = surface_.attributes;
    for (const Eigen::Vector3f& vertex : patch.filling.vertices) {
      if (!surface_.origins.empty()) {
        surface_.origins.push_back(vertex);
      }
      if (!surface_.fixed_sources.empty()) {
        surface_.fixed_sources.push_back(kNone);
      }
      if (!attributes.colors.empty()) {
        attributes.colors.push_back(ColorAt(vertex, patch.loop));
      }
      if (!attributes.confidences.empty()) {
        attributes.confidences.push_back(0);
      }
      attributes.views.EndRow();
    }
  }

  // By the inverse squared distances from the vertices of the loop.
  Color ColorAt(const Eigen::Vector3f& point, const BorderLoop& loop) const {
    // Squared scene units; below it a vertex of the loop is met.
    constexpr double kTiny = std::numeric_limits<float>::min();
    Eigen::Vector3d sum = Eigen::Vector3d::Zero();
    double sum_of_weights = 0;
    for (const uint32_t vertex : loop) {
      const double distance_squared =
          (surface_.mesh.vertices[vertex] - point).cast<double>().squaredNorm();
      const double weight = 1 / std::max(distance_squared, kTiny);
      const Color& color = surface_.attributes.colors[vertex];
      sum += weight * Eigen::Vector3d(color[0], color[1], color[2]);
      sum_of_weights += weight;
    }
    const Eigen::Vector3d mean = sum / sum_of_weights;
    Color color;
    for (int k = 0; k < 3; ++k) {
      color[k] = static_cast<uint8_t>(std::lround(mean[k]));
    }
    return color;
  }

  bool may_intersect_;
  VertexRings rings_;  // of the old mesh
  Surface& surface_;
  HoleReport report_;
};

}  // namespace

HoleReport CloseHoles(double max_width, std::span<const float> footprints,
                      Surface* surface) {
  if (max_width == 0) {
    return {};
  }
  std::vector<BorderLoop> loops = FindLoops(surface->mesh);
  if (max_width != kAllLoops) {
    const std::vector<double> turns = Turns(surface->mesh);
    std::erase_if(loops, [&](const BorderLoop& loop) {
      double turn = 0;  // -2 pi around a hole in a plane, 2 pi around a disk
      for (const uint32_t vertex : loop) {
        turn += turns[vertex];
      }
      return turn >= 0 || !IsNarrow(surface->mesh, footprints, max_width, loop);
    });
  }
  return loops.empty() ? HoleReport()
                       : HoleCloser(/*may_intersect=*/true, surface)
                             .Close(std::move(loops));
}

HoleReport CloseNewHoles(const std::vector<uint8_t>& is_new, Surface* surface) {
  std::vector<BorderLoop> loops = FindLoops(surface->mesh);
  std::erase_if(loops, [&](const BorderLoop& loop) {
    return !std::ranges::all_of(
        loop, [&](uint32_t vertex) { return is_new[vertex] != 0; });
  });
  return HoleCloser(/*may_intersect=*/false, surface).Close(std::move(loops));
}

}  // namespace colmap_ext
