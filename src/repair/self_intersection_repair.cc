#include "repair/self_intersection_repair.h"

#include <algorithm>
#include <utility>
#include <vector>

#include <tbb/parallel_for.h>
#include <Eigen/Core>
#include <Eigen/Geometry>

#include "base/indices.h"
#include "repair/guarded_mesh.h"
#include "spatial/facet_tree.h"

namespace colmap_ext {
namespace {

// Small changes first, all choices. Pushes are shares of the edges' mean
// length: copies of a vertex come apart by the first, which no picture shows. A
// single outlier is smoothed after a few rounds, a part of the surface takes
// more.
constexpr double kSmallPushes[] = {1e-6, 1e-4};
constexpr int kSmoothingRounds[] = {1, 4, 16, 64};
constexpr double kPushes[] = {0.01, 0.1, 0.5};

// Each round moves one more ring of vertices. Chosen by hand: smoothing more
// than three rings shrinks rims of thin objects instead of removing folds.
constexpr int kMaxRounds = 8;
constexpr int kMaxUnfoldingRounds = 3;

// A choice: more pairs in one cluster are two surfaces that run through each
// other, which pairs by themselves cannot separate.
constexpr size_t kMaxSinglePairs = 64;

// Choices: of the work (GuardedMesh::Work), for each facet of the mesh, and
// besides. Meshes with few self-intersections are far from it.
constexpr size_t kMaxWorkPerFacet = 10;
constexpr size_t kMaxWork = 100'000;

// Changes the facets' surroundings as a whole.
// \return whether a change was allowed
bool SmoothOrPush(const std::vector<uint32_t>& facets, int num_rings,
                  GuardedMesh* mesh) {
  std::vector<uint32_t> vertices =
      mesh->rings().VerticesAround(VerticesOf(mesh->mesh(), facets), num_rings);
  std::erase_if(vertices, [mesh](uint32_t vertex) {
    return IsFixed(mesh->fixed(), vertex);
  });
  const auto push = [&](double share) {
    return mesh->Move(Pushed(*mesh, vertices, -share)) ||
           mesh->Move(Pushed(*mesh, vertices, share));
  };
  const auto smooth = [&](int num_rounds) {
    return mesh->Move(Smoothed(*mesh, vertices, num_rounds));
  };
  return std::ranges::any_of(kSmallPushes, push) ||
         std::ranges::any_of(kSmoothingRounds, smooth) ||
         std::ranges::any_of(kPushes, push);
}

void RunRound(int num_rings, size_t max_work, GuardedMesh* mesh) {
  for (const auto& [lowest, facets] : mesh->Clusters()) {
    if (mesh->Work() > max_work) {
      break;
    }
    const std::vector<FacetPair> pairs = mesh->PairsOf(facets);
    if (!SmoothOrPush(facets, num_rings, mesh) &&
        pairs.size() <= kMaxSinglePairs) {
      for (const auto& [a, b] : pairs) {
        if (!mesh->PairsOf({a, b}).empty()) {
          SmoothOrPush({a, b}, num_rings, mesh);
        }
      }
    }
  }
}

// Marks all facets whose boxes meet any of the given ones, too.
void MarkWithin(const TriangleMesh& mesh,
                const std::vector<Eigen::AlignedBox3f>& boxes,
                std::vector<uint8_t>* is_marked) {
  const BoxTree tree(boxes);
  tbb::parallel_for(
      uint32_t{0}, static_cast<uint32_t>(mesh.facets.size()), [&](uint32_t i) {
        const Eigen::AlignedBox3f box = BoxOf(mesh, i);
        if (tree.AnyOf([&](const auto& b) { return b.intersects(box); })) {
          (*is_marked)[i] = 1;
        }
      });
}

// Facets at folded edges.
std::vector<FacetPair> FindFolds(const TriangleMesh& mesh) {
  return FoldsOf(mesh, PairHalfEdges(mesh.facets), Iota(mesh.facets.size()));
}

// Repairs a mesh patch by patch.
class PatchRepair {
 public:
  PatchRepair(TriangleMesh* mesh, const FixedVertices& fixed,
              bool has_folds = false)
      : mesh_(*mesh),
        fixed_(fixed),
        has_folds_(has_folds),
        pairs_(has_folds ? FindFolds(*mesh) : FindSelfIntersections(*mesh)) {
    DropFixedPairs(*mesh, fixed, &pairs_);
    num_before_ = pairs_.size();
  }

  SelfIntersectionRepair Run(int max_rounds) {
    RunRounds(0, 1);
    RunRounds(1, max_rounds);
    return {num_before_, pairs_.size()};
  }

 private:
  using Box = Eigen::AlignedBox3f;

  void RunRounds(int first_round, int end_round) {
    if (pairs_.empty() || work_ > MaxWork()) {
      return;
    }
    // Rings of vertices around the facets of a pair that may move.
    const int num_rings = end_round - 1;
    const std::vector<uint8_t> is_around =
        MarkAround(mesh_, pairs_, num_rings + 2);
    std::vector<Box> boxes;  // where facets may move, and a little around
    for (const uint32_t i : Marked(MarkAround(mesh_, pairs_, num_rings))) {
      boxes.push_back(Widened(BoxOf(mesh_, i)));
    }
    while (!TryWithin(first_round, end_round, is_around, &boxes)) {
    }
  }

  size_t MaxWork() const {
    return kMaxWork + kMaxWorkPerFacet * mesh_.facets.size();
  }

  // A choice: what goes farther takes another try.
  static Box Widened(const Box& box) {
    return GrowBox(box, 0.1F * box.diagonal().norm());
  }

  // Does the rounds on a patch with all facets that meet the boxes.
  // \param is_around  [F] facets that are of the patch wherever they are
  // \param boxes  gets those of facets that went out of them
  // \return whether there are none, and all is done
  bool TryWithin(int first_round, int end_round, std::vector<uint8_t> is_around,
                 std::vector<Box>* boxes) {
    MarkWithin(mesh_, *boxes, &is_around);
    const MeshPart patch = TakePart(mesh_, Marked(is_around));
    FixedVertices fixed;
    for (const uint32_t vertex : patch.vertices) {
      fixed.push_back(IsFixed(fixed_, vertex) ? 1 : 0);
    }
    GuardedMesh guarded(patch.mesh, std::move(fixed), has_folds_);
    const size_t max_work = MaxWork() - work_;
    for (int round = first_round; round < end_round && guarded.NumPairs() > 0 &&
                                  guarded.Work() <= max_work;
         ++round) {
      RunRound(round, max_work, &guarded);
    }
    const BoxTree tree(*boxes);
    const size_t num_boxes = boxes->size();
    for (uint32_t i = 0; i < patch.mesh.facets.size(); ++i) {
      const Box box = BoxOf(guarded.mesh(), i);
      if (CornersOf(guarded.mesh(), guarded.mesh().facets[i]) !=
              CornersOf(patch.mesh, patch.mesh.facets[i]) &&
          !tree.AnyOf([&](const Box& b) { return b.contains(box); })) {
        boxes->push_back(Widened(box));
      }
    }
    if (boxes->size() > num_boxes) {
      return false;
    }
    for (size_t i = 0; i < patch.vertices.size(); ++i) {
      mesh_.vertices[patch.vertices[i]] = guarded.mesh().vertices[i];
    }
    pairs_.clear();
    for (const auto& [a, b] : guarded.Pairs()) {
      pairs_.push_back({patch.facets[a], patch.facets[b]});
    }
    work_ += guarded.Work();
    return true;
  }

  TriangleMesh& mesh_;
  const FixedVertices& fixed_;
  bool has_folds_;                // whether facets at a folded edge are a pair
  std::vector<FacetPair> pairs_;  // that are left
  size_t work_ = 0;               // GuardedMesh::Work() so far
  size_t num_before_ = 0;
};

}  // namespace

std::vector<uint8_t> MarkAround(const TriangleMesh& mesh,
                                const std::vector<FacetPair>& pairs,
                                int num_rings) {
  std::vector<uint8_t> is_reached(mesh.vertices.size());
  std::vector<uint8_t> is_marked(mesh.facets.size());
  std::vector<uint32_t> marked;
  for (const FacetPair& pair : pairs) {
    Append(pair, &marked);
  }
  for (int ring = 0; ring <= num_rings; ++ring) {
    for (const uint32_t i : marked) {
      for (const uint32_t vertex : mesh.facets[i]) {
        is_reached[vertex] = 1;
      }
    }
    tbb::parallel_for(size_t{0}, is_marked.size(), [&](size_t i) {
      const auto& [a, b, c] = mesh.facets[i];
      is_marked[i] = is_reached[a] | is_reached[b] | is_reached[c];
    });
    marked = Marked(is_marked);
  }
  return is_marked;
}

SelfIntersectionRepair RepairSelfIntersections(TriangleMesh* mesh,
                                               const FixedVertices& fixed) {
  return PatchRepair(mesh, fixed).Run(kMaxRounds);
}

void Unfold(TriangleMesh* mesh, const FixedVertices& fixed) {
  PatchRepair(mesh, fixed, true).Run(kMaxUnfoldingRounds);
}

}  // namespace colmap_ext
