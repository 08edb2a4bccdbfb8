#include "repair/self_intersection_repair.h"

#include <algorithm>
#include <unordered_set>
#include <utility>
#include <vector>

#include <Eigen/Core>

#include "repair/crossing_clusters.h"
#include "repair/guarded_mesh.h"
#include "repair/local_motions.h"
#include "repair/separate_copies.h"

namespace colmap_ext {
namespace {

// Little first. Both are choices: a vertex that goes astray is back after a few
// rounds of smoothing, a part of the surface takes more.
constexpr int kSmoothingRounds[] = {1, 4, 16, 64};
constexpr double kPushes[] = {0.01, 0.1, 0.5};  // of the edges' mean length

// A choice: more pairs in one cluster are two surfaces that run through each
// other, which no pair by itself tells how to part.
constexpr size_t kMaxSinglePairs = 64;

// Choices: of the work (GuardedMesh::Work), for each facet of the mesh, and
// besides. Meshes with few self-intersections are far from it.
constexpr size_t kMaxWorkPerFacet = 10;
constexpr size_t kMaxWork = 100'000;

// Changes the facets' surroundings as a whole.
bool SmoothOrPush(const std::vector<uint32_t>& facets, int num_rings,
                  GuardedMesh* mesh) {
  std::vector<uint32_t> vertices =
      VerticesAround(mesh->mesh(), mesh->rings(), facets, num_rings);
  std::erase_if(vertices, [mesh](uint32_t vertex) {
    return IsFixed(mesh->fixed(), vertex);
  });
  for (const int num_rounds : kSmoothingRounds) {
    if (mesh->Move(
            Smoothed(mesh->mesh(), mesh->rings(), vertices, num_rounds))) {
      return true;
    }
  }
  for (const double share : kPushes) {
    for (const double sign : {1.0, -1.0}) {
      if (mesh->Move(
              Pushed(mesh->mesh(), mesh->rings(), vertices, sign * share))) {
        return true;
      }
    }
  }
  return false;
}

// Changes the surroundings of each pair by itself.
// \return whether a pair was removed
bool SmoothOrPushPairs(const std::vector<FacetPair>& pairs, int num_rings,
                       GuardedMesh* mesh) {
  if (pairs.size() > kMaxSinglePairs) {
    return false;
  }
  const size_t num_pairs = mesh->NumPairs();
  for (const FacetPair& pair : pairs) {
    if (DoesPairIntersect(mesh->mesh(), pair)) {
      SmoothOrPush({pair[0], pair[1]}, num_rings, mesh);
    }
  }
  return mesh->NumPairs() < num_pairs;
}

// Flips edges of facets, such that no two flips of a round touch each other.
class EdgeFlips {
 public:
  // \return the number of edges flipped
  size_t FlipEdges(const std::vector<uint32_t>& facets, GuardedMesh* mesh) {
    size_t num_flips = 0;
    for (const uint32_t facet : facets) {
      for (uint32_t half = 3 * facet; half < 3 * facet + 3; ++half) {
        if (AreFree(facet, *mesh) && mesh->Flip(half)) {
          ++num_flips;
          Mark(facet, *mesh);
          Mark(mesh->partners()[half] / 3, *mesh);
        }
      }
    }
    return num_flips;
  }

 private:
  // Whether what rings() and partners() tell of the facet and its neighbors
  // still holds: no flip was at a vertex of it.
  bool AreFree(uint32_t facet, const GuardedMesh& mesh) const {
    const Facet& vertices = mesh.mesh().facets[facet];
    return std::none_of(vertices.begin(), vertices.end(), [&](uint32_t vertex) {
      return touched_.contains(vertex);
    });
  }

  void Mark(uint32_t facet, const GuardedMesh& mesh) {
    const Facet& vertices = mesh.mesh().facets[facet];
    touched_.insert(vertices.begin(), vertices.end());
  }

  std::unordered_set<uint32_t> touched_;  // vertices
};

void RunRound(int num_rings, size_t max_work, GuardedMesh* mesh,
              size_t* num_flips) {
  std::vector<std::vector<uint32_t>> hard;
  for (auto& facets : CrossingClusters(mesh->mesh(), mesh->Pairs())) {
    if (mesh->Work() > max_work) {
      break;
    }
    if (!SmoothOrPush(facets, num_rings, mesh) &&
        !SmoothOrPushPairs(mesh->PairsOf(facets), num_rings, mesh)) {
      hard.push_back(std::move(facets));
    }
  }
  EdgeFlips flips;
  const size_t flips_before = *num_flips;
  for (const std::vector<uint32_t>& facets : hard) {
    *num_flips += flips.FlipEdges(facets, mesh);
  }
  if (*num_flips > flips_before) {
    mesh->Update();
  }
}

}  // namespace

size_t MaxRepairWork(size_t num_facets) {
  return kMaxWork + kMaxWorkPerFacet * num_facets;
}

RepairedPart RepairPart(const RepairSteps& steps, TriangleMesh* mesh,
                        const FixedVertices& fixed) {
  RepairedPart part;
  GuardedMesh guarded(std::move(*mesh), fixed);
  part.before = guarded.Pairs();
  if (steps.separates_copies && !part.before.empty()) {
    SeparateCopies(&guarded, steps.max_work);
  }
  for (int round = steps.first_round;
       round < steps.end_round && guarded.NumPairs() > 0 &&
       guarded.Work() <= steps.max_work;
       ++round) {
    RunRound(round, steps.max_work, &guarded, &part.num_flipped_edges);
  }
  part.after = guarded.Pairs();
  part.work = guarded.Work();
  *mesh = guarded.mesh();
  return part;
}

void MeasureMotion(const Eigen::Vector3f& before, const Eigen::Vector3f& after,
                   SelfIntersectionRepair* repair) {
  if (before != after) {
    const double distance =
        (before.cast<double>() - after.cast<double>()).norm();
    // The mean so far.
    ++repair->num_moved_vertices;
    repair->mean_motion += (distance - repair->mean_motion) /
                           static_cast<double>(repair->num_moved_vertices);
    repair->max_motion = std::max(repair->max_motion, distance);
  }
}

SelfIntersectionRepair RepairSelfIntersections(TriangleMesh* mesh,
                                               int max_rounds,
                                               const FixedVertices& fixed) {
  const std::vector<Eigen::Vector3f> before = mesh->vertices;
  const RepairedPart part = RepairPart(
      {true, 0, max_rounds, MaxRepairWork(mesh->facets.size())}, mesh, fixed);
  SelfIntersectionRepair repair;
  repair.num_before = part.before.size();
  repair.num_after = part.after.size();
  repair.num_flipped_edges = part.num_flipped_edges;
  for (size_t i = 0; i < before.size(); ++i) {
    MeasureMotion(before[i], mesh->vertices[i], &repair);
  }
  return repair;
}

}  // namespace colmap_ext
