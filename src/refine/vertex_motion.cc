#include "refine/vertex_motion.h"

#include <algorithm>
#include <cmath>
#include <utility>

#include <tbb/blocked_range.h>
#include <tbb/parallel_for.h>

#include "base/indices.h"
#include "base/mix_bits.h"
#include "mesh/normals.h"
#include "spatial/self_intersections.h"

namespace colmap_ext {
namespace {

// Where corners k <= l of a facet stand in its curvatures.
int CurvatureIndex(int k, int l) {
  constexpr int kIndex[3][3] = {{0, 1, 2}, {1, 3, 4}, {2, 4, 5}};
  return kIndex[k][l];
}

// 1 or -1.
double RandomSign(uint64_t index) {
  return (MixBits(index + kSplitMixStep) >> 63) != 0 ? 1 : -1;
}

}  // namespace

NormalEquations::NormalEquations(const EvaluatedSurface& surface,
                                 const SmoothnessDomain& domain,
                                 const ThinPlate& plate)
    : surface_(surface),
      domain_(domain),
      plate_(plate),
      weighted_changes_(surface.mesh.vertices.size()) {
  AddPhotometric();
  FindSmoothnessChanges();
  AddSmoothness();
  ClearFixed(&gradient_);
}

void NormalEquations::ClearFixed(std::vector<double>* values) const {
  for (uint32_t i = 0; i < domain_.fixed.size(); ++i) {
    if (IsFixed(domain_.fixed, i)) {
      (*values)[i] = 0;
    }
  }
}

void NormalEquations::AddPhotometric() {
  const TriangleMesh& mesh = surface_.mesh;
  const std::vector<Eigen::Vector3f>& normals = surface_.normals;
  const VertexRings& rings = domain_.rings;
  const size_t size = mesh.vertices.size();
  gradient_.assign(size, 0);
  photometric_diagonal_.assign(size, 0);
  photometric_.assign(rings.neighbors.values.size(), 0);
  tbb::parallel_for(size_t{0}, size, [&](size_t vertex) {
    const auto ring = rings.neighbors[vertex];
    const size_t row = rings.neighbors.offsets[vertex];
    const Eigen::Vector3d normal = normals[vertex].cast<double>();
    for (const uint32_t corner : rings.corners[vertex]) {
      const uint32_t facet = corner / 3;
      const int k = static_cast<int>(corner % 3);
      // How far the facet moves along its normal as its corners do.
      const Eigen::Vector3d facet_normal =
          ComputeFacetFrame(mesh, mesh.facets[facet]).normal;
      const FacetTerms& terms = surface_.terms.facets[facet];
      const double along = facet_normal.dot(normal);
      gradient_[vertex] += terms.slopes[k] * along;
      photometric_diagonal_[vertex] +=
          terms.curvatures[CurvatureIndex(k, k)] * along * along;
      for (int l = 0; l < 3; ++l) {
        const uint32_t other = mesh.facets[facet][l];
        if (l == k) {
          continue;
        }
        const size_t place =
            row + (std::ranges::lower_bound(ring, other) - ring.begin());
        photometric_[place] +=
            static_cast<float>(terms.curvatures[CurvatureIndex(k, l)] * along *
                               facet_normal.dot(normals[other].cast<double>()));
      }
    }
  });
}

// The residuals are N_V . (weighted mean of the neighbors - V); their changes
// are taken with the normals and the shares held.
void NormalEquations::FindSmoothnessChanges() {
  outgoing_.resize(domain_.rings.neighbors.values.size());
  incoming_.resize(domain_.rings.neighbors.values.size());
  tbb::parallel_for(size_t{0}, gradient_.size(), [&](size_t vertex) {
    const auto ring = domain_.rings.neighbors[vertex];
    const size_t row = domain_.rings.neighbors.offsets[vertex];
    for (size_t i = 0; i < ring.size(); ++i) {
      const auto other_ring = domain_.rings.neighbors[ring[i]];
      const size_t back =
          domain_.rings.neighbors.offsets[ring[i]] +
          (std::ranges::lower_bound(other_ring, vertex) - other_ring.begin());
      const float cosine =
          surface_.normals[vertex].dot(surface_.normals[ring[i]]);
      outgoing_[row + i] = plate_.shares[row + i] * cosine;
      incoming_[row + i] = plate_.shares[back] * cosine;
    }
  });
}

void NormalEquations::AddSmoothness() {
  diagonal_ = photometric_diagonal_;
  tbb::parallel_for(size_t{0}, gradient_.size(), [&](size_t vertex) {
    double gradient = -plate_.coefficients[vertex] * plate_.residuals[vertex];
    double diagonal = plate_.coefficients[vertex];
    const auto ring = domain_.rings.neighbors[vertex];
    const size_t row = domain_.rings.neighbors.offsets[vertex];
    for (size_t i = 0; i < ring.size(); ++i) {
      const uint32_t other = ring[i];
      const double share = incoming_[row + i];
      gradient += plate_.coefficients[other] * plate_.residuals[other] * share;
      diagonal += plate_.coefficients[other] * share * share;
    }
    gradient_[vertex] += gradient;
    diagonal_[vertex] += diagonal;
  });
}

void NormalEquations::Multiply(const std::vector<double>& in,
                               bool is_photometric_only,
                               std::vector<double>* out) const {
  const tbb::blocked_range<size_t> all(0, in.size(), 4096);
  tbb::parallel_for(all, [&](const tbb::blocked_range<size_t>& range) {
    for (size_t i = range.begin(); i != range.end(); ++i) {
      const auto ring = domain_.rings.neighbors[i];
      const size_t row = domain_.rings.neighbors.offsets[i];
      double photometric = photometric_diagonal_[i] * in[i];
      double mean = 0;
      for (size_t k = 0; k < ring.size(); ++k) {
        photometric += photometric_[row + k] * in[ring[k]];
        mean += outgoing_[row + k] * in[ring[k]];
      }
      (*out)[i] = photometric;
      weighted_changes_[i] = plate_.coefficients[i] * (mean - in[i]);
    }
  });
  if (is_photometric_only) {
    return ClearFixed(out);
  }
  tbb::parallel_for(all, [&](const tbb::blocked_range<size_t>& range) {
    for (size_t i = range.begin(); i != range.end(); ++i) {
      const auto ring = domain_.rings.neighbors[i];
      const size_t row = domain_.rings.neighbors.offsets[i];
      double sum = -weighted_changes_[i];
      for (size_t k = 0; k < ring.size(); ++k) {
        sum += incoming_[row + k] * weighted_changes_[ring[k]];
      }
      (*out)[i] += sum;
    }
  });
  ClearFixed(out);
}

std::vector<double> NormalEquations::Solve(const SolverOptions& options) const {
  std::vector<double> descent(gradient_.size());
  std::ranges::transform(gradient_, descent.begin(), std::negate());
  return Solve(std::move(descent), options);
}

std::vector<double> NormalEquations::Determined(
    const SolverOptions& options) const {
  std::vector<double> signs(gradient_.size());
  for (size_t i = 0; i < signs.size(); ++i) {
    signs[i] = RandomSign(i);
  }
  ClearFixed(&signs);
  std::vector<double> image(signs.size());
  Multiply(signs, true, &image);
  std::vector<double> determined = Solve(std::move(image), options);
  for (size_t i = 0; i < signs.size(); ++i) {
    determined[i] = plate_.coefficients[i] > 0 ? signs[i] * determined[i] : 0;
  }
  ClearFixed(&determined);
  return determined;
}

std::vector<double> NormalEquations::Solve(std::vector<double> right_hand_side,
                                           const SolverOptions& options) const {
  using Vector = std::vector<double>;
  SolverVectors vectors;
  vectors.residual = std::move(right_hand_side);
  SolveByConjugateGradients(
      options, [&](const Vector& in, Vector* out) { Multiply(in, false, out); },
      [&](const Vector& residual, Vector* out) {
        tbb::parallel_for(size_t{0}, residual.size(), [&](size_t i) {
          (*out)[i] = diagonal_[i] > 0 ? residual[i] / diagonal_[i] : 0.0;
        });
      },
      &vectors);
  return std::move(vectors.values);
}

namespace {

constexpr double kMaxEdgeShare = 0.4;  // of the edges' mean length
constexpr float kMinCosine = 0.5F;     // between a facet's old and new normal
constexpr int kMaxHalvings = 4;        // 1/16 of a motion is next to none

// A motion that is shortened until it is safe.
class SafeMotion {
 public:
  SafeMotion(const TriangleMesh& mesh, const VertexRings& rings,
             const std::vector<Eigen::Vector3f>& normals,
             std::vector<double> motion)
      : mesh_(mesh),
        rings_(rings),
        normals_(normals),
        facet_normals_(FacetNormals(mesh)),
        num_halvings_(mesh.vertices.size(), 0),
        moved_{mesh, std::move(motion)} {
    tbb::parallel_for(size_t{0}, mesh.vertices.size(),
                      [&](size_t vertex) { Place(vertex); });
  }

  MovedMesh Run(FacetTree* tree) {
    ShortenTurned(TurnedFacets());
    // Undoing turns can leave crossings, and undoing crossings can turn facets:
    // repeat until there are neither.
    tree->Enclose(mesh_, moved_.mesh);
    std::vector<uint32_t> facets =
        ShortenCrossing(FindSelfIntersections(moved_.mesh, *tree));
    while (!facets.empty()) {
      Append(ShortenTurned(facets), &facets);
      SortUnique(&facets);
      facets =
          ShortenCrossing(FindSelfIntersections(moved_.mesh, *tree, facets));
    }
    return std::move(moved_);
  }

 private:
  void Place(size_t vertex) {
    moved_.mesh.vertices[vertex] =
        mesh_.vertices[vertex] +
        static_cast<float>(moved_.motion[vertex]) * normals_[vertex];
  }

  bool IsTurned(uint32_t facet) const {
    const Eigen::Vector3f& before = facet_normals_[facet];
    return before.dot(FacetNormal(moved_.mesh, facet)) <
           kMinCosine * before.squaredNorm();
  }

  std::vector<uint32_t> TurnedFacets() const {
    std::vector<uint8_t> is_turned(mesh_.facets.size());
    tbb::parallel_for(size_t{0}, is_turned.size(), [&](size_t facet) {
      is_turned[facet] = IsTurned(static_cast<uint32_t>(facet)) ? 1 : 0;
    });
    return Marked(is_turned);
  }

  // Shortens the motion of the facets' vertices.
  // \return the facets whose positions change, ascending
  std::vector<uint32_t> Shorten(const std::vector<uint32_t>& facets) {
    std::vector<uint32_t> vertices = VerticesOf(mesh_, facets);
    std::erase_if(vertices,
                  [&](uint32_t vertex) { return moved_.motion[vertex] == 0; });
    for (const uint32_t vertex : vertices) {
      moved_.motion[vertex] *= num_halvings_[vertex] < kMaxHalvings ? 0.5 : 0;
      ++num_halvings_[vertex];
      Place(vertex);
    }
    return rings_.FacetsAt(vertices);
  }

  // Until none of the given facets, and of those that change, is turned.
  // \return the facets whose positions change
  std::vector<uint32_t> ShortenTurned(std::vector<uint32_t> facets) {
    std::vector<uint32_t> all;
    while (true) {
      std::erase_if(facets, [&](uint32_t facet) { return !IsTurned(facet); });
      facets = Shorten(facets);
      if (facets.empty()) {
        return all;
      }
      Append(facets, &all);
    }
  }

  // Once, where a pair does not intersect in the mesh before the step.
  // \return the facets whose positions change
  std::vector<uint32_t> ShortenCrossing(const std::vector<FacetPair>& pairs) {
    std::vector<uint32_t> facets;
    for (const FacetPair& pair : pairs) {
      if (!DoesPairIntersect(mesh_, pair)) {
        Append(pair, &facets);
      }
    }
    return Shorten(facets);
  }

  const TriangleMesh& mesh_;
  const VertexRings& rings_;
  const std::vector<Eigen::Vector3f>& normals_;
  std::vector<Eigen::Vector3f> facet_normals_;  // [F] before the step
  std::vector<uint8_t> num_halvings_;           // [V]
  MovedMesh moved_;
};

}  // namespace

void LimitMotion(const TriangleMesh& mesh, const VertexRings& rings,
                 const std::vector<float>& footprints,
                 std::vector<double>* motion) {
  const std::vector<Eigen::Vector3f>& vertices = mesh.vertices;
  tbb::parallel_for(size_t{0}, motion->size(), [&](size_t i) {
    const auto ring = rings.neighbors[i];
    double length = 0;
    for (const uint32_t neighbor : ring) {
      length += (vertices[neighbor] - vertices[i]).norm();
    }
    length *=
        kMaxEdgeShare / std::max<double>(1, static_cast<double>(ring.size()));
    const double limit = std::min<double>(length, footprints[i]);
    (*motion)[i] = std::clamp((*motion)[i], -limit, limit);
  });
}

MovedMesh MoveSafely(const TriangleMesh& mesh, const VertexRings& rings,
                     const std::vector<Eigen::Vector3f>& normals,
                     std::vector<double> motion, FacetTree* tree) {
  return SafeMotion(mesh, rings, normals, std::move(motion)).Run(tree);
}

double MeanMotion(const std::vector<double>& motion,
                  const std::vector<float>& footprints,
                  const FixedVertices& fixed) {
  double sum = 0;
  size_t num_free = 0;
  for (uint32_t i = 0; i < motion.size(); ++i) {
    if (!IsFixed(fixed, i)) {
      sum += std::abs(motion[i]) / footprints[i];
      ++num_free;
    }
  }
  return num_free > 0 ? sum / static_cast<double>(num_free) : 0;
}

}  // namespace colmap_ext
