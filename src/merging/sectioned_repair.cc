#include "merging/sectioned_repair.h"

#include <algorithm>
#include <map>
#include <numeric>
#include <utility>
#include <vector>

#include "merging/facet_rings.h"
#include "mesh/vertex_rings.h"
#include "repair/crossing_clusters.h"
#include "spatial/facet_tree.h"
#include "tiles/box_tree.h"

namespace colmap_ext {
namespace {

using Box = Eigen::AlignedBox3f;

MeshPart ReadSection(const SectionedMesh& mesh, size_t section) {
  const uint32_t begin = mesh.FirstFacet(section);
  const uint32_t end = mesh.FirstFacet(section + 1);
  std::vector<uint32_t> numbers(end - begin);
  std::iota(numbers.begin(), numbers.end(), begin);
  return GatherPart(mesh, std::move(numbers), mesh.ReadFacets(begin, end));
}

// Appends pairs of a part by the mesh's facets, where they count.
template <typename Counts>
void AddPairs(const MeshPart& part, const std::vector<FacetPair>& found,
              const Counts& counts, std::vector<FacetPair>* pairs) {
  for (const auto& [a, b] : found) {
    if (counts(part.facets[a], part.facets[b])) {
      pairs->push_back({part.facets[a], part.facets[b]});
    }
  }
}

// Facets of later sections whose boxes meet those of a section's facets, and
// the latter.
FacetList MeetingLater(const SectionedMesh& mesh, size_t section,
                       const MeshPart& own, const FacetTree& tree) {
  Box box;
  for (const Eigen::Vector3f& position : own.mesh.vertices) {
    box.extend(position);
  }
  FacetList list;
  const auto add_near = [&](uint32_t first, const std::vector<Facet>& facets) {
    std::vector<uint32_t> numbers(facets.size());
    std::iota(numbers.begin(), numbers.end(), first);
    const MeshPart block = GatherPart(mesh, std::move(numbers), facets);
    for (uint32_t i = 0; i < facets.size(); ++i) {
      const size_t count = list.facets.size();
      tree.ForEachNear(BoxOf(block.mesh, i), [&](uint32_t near) {
        Facet facet = own.mesh.facets[near];
        for (uint32_t& vertex : facet) {
          vertex = own.vertices[vertex];
        }
        list.Add(own.facets[near], facet);
      });
      if (list.facets.size() > count) {
        list.Add(first + i, facets[i]);
      }
    }
  };
  for (size_t other = section + 1; other < mesh.NumSections(); ++other) {
    mesh.ForEachBlock(
        other, [&](const Box& block) { return block.intersects(box); },
        add_near);
  }
  return list;
}

class SectionsRepair {
 public:
  explicit SectionsRepair(SectionedMesh* mesh)
      : mesh_(*mesh), pairs_(FindSelfIntersections(*mesh)) {}

  SelfIntersectionRepair Run() {
    repair_.num_before = pairs_.size();
    const size_t max_work = MaxRepairWork(mesh_.NumFacets());
    RunSteps({true, 0, 1, max_work});
    if (work_ <= max_work) {
      RunSteps({false, 1, kMaxRepairRounds, max_work - work_});
    }
    repair_.num_after = pairs_.size();
    for (const auto& [vertex, before] : before_) {
      const auto after = mesh_.ReadPositions(vertex, vertex + 1)[0];
      MeasureMotion(before, after, &repair_);
    }
    return repair_;
  }

 private:
  void RunSteps(const RepairSteps& steps) {
    if (pairs_.empty()) {
      return;
    }
    std::vector<uint32_t> seeds;
    for (const FacetPair& pair : pairs_) {
      seeds.insert(seeds.end(), pair.begin(), pair.end());
    }
    const FacetList around =
        FacetsAround(mesh_, seeds, static_cast<uint8_t>(MovedRings(steps) + 2));
    std::vector<Box> boxes = ReachOf(around, MovedRings(steps));
    while (!TryWithin(steps, around, &boxes)) {
    }
  }

  // Where facets that may move are, and a little around each.
  std::vector<Box> ReachOf(FacetList around, int num_rings) const {
    const MeshPart part = around.Gather(mesh_);
    std::vector<uint32_t> crossing;
    for (const FacetPair& pair : pairs_) {
      for (const uint32_t number : pair) {
        crossing.push_back(static_cast<uint32_t>(
            std::ranges::lower_bound(part.facets, number) -
            part.facets.begin()));
      }
    }
    std::vector<uint8_t> may_move(part.vertices.size(), 0);
    for (const uint32_t vertex : VerticesAround(
             part.mesh, MakeVertexRings(part.mesh), crossing, num_rings)) {
      may_move[vertex] = 1;
    }
    std::vector<Box> boxes;
    for (uint32_t i = 0; i < part.facets.size(); ++i) {
      const auto& [a, b, c] = part.mesh.facets[i];
      if (may_move[a] != 0 || may_move[b] != 0 || may_move[c] != 0) {
        boxes.push_back(Widened(BoxOf(part.mesh, i)));
      }
    }
    return boxes;
  }

  // A choice: what goes farther takes another try.
  static Box Widened(Box box) {
    const float margin = 0.1F * box.diagonal().norm();
    box.min().array() -= margin;
    box.max().array() += margin;
    return box;
  }

  // Does the steps with all facets that meet the boxes.
  // \param boxes  gets those of facets that went out of them
  // \return whether there are none, and all is done
  bool TryWithin(const RepairSteps& steps, FacetList around,
                 std::vector<Box>* boxes) {
    AddWithin(*boxes, &around);
    const MeshPart before = around.Gather(mesh_);
    TriangleMesh after = before.mesh;
    const RepairedPart repaired = RepairPart(steps, &after);
    const BoxTree tree(*boxes);
    const size_t num_boxes = boxes->size();
    std::vector<uint32_t> changed;
    for (uint32_t i = 0; i < after.facets.size(); ++i) {
      const Facet& facet = after.facets[i];
      if (facet == before.mesh.facets[i] &&
          std::ranges::all_of(facet, [&](uint32_t vertex) {
            return after.vertices[vertex] == before.mesh.vertices[vertex];
          })) {
        continue;
      }
      changed.push_back(i);
      const Box box = BoxOf(after, i);
      if (!tree.Search([&](const Box& b) { return b.contains(box); },
                       [](uint32_t) { return true; })) {
        boxes->push_back(Widened(box));
      }
    }
    if (boxes->size() > num_boxes) {
      return false;
    }
    Apply(before, after, changed);
    pairs_.clear();
    AddPairs(
        before, repaired.after, [](uint32_t, uint32_t) { return true; },
        &pairs_);
    work_ += repaired.work;
    repair_.num_flipped_edges += repaired.num_flipped_edges;
    return true;
  }

  void AddWithin(const std::vector<Box>& boxes, FacetList* list) const {
    const BoxTree tree(boxes);
    const auto is_within = [&](const Box& box) {
      return tree.Search([&](const Box& b) { return b.intersects(box); },
                         [](uint32_t) { return true; });
    };
    for (size_t section = 0; section < mesh_.NumSections(); ++section) {
      mesh_.ForEachBlock(section, is_within,
                         [&](uint32_t first, const std::vector<Facet>& facets) {
                           std::vector<uint32_t> numbers(facets.size());
                           std::iota(numbers.begin(), numbers.end(), first);
                           const MeshPart block =
                               GatherPart(mesh_, std::move(numbers), facets);
                           for (uint32_t i = 0; i < facets.size(); ++i) {
                             if (is_within(BoxOf(block.mesh, i))) {
                               list->Add(first + i, facets[i]);
                             }
                           }
                         });
    }
  }

  void Apply(const MeshPart& before, const TriangleMesh& after,
             const std::vector<uint32_t>& changed) {
    for (uint32_t i = 0; i < after.vertices.size(); ++i) {
      if (after.vertices[i] != before.mesh.vertices[i]) {
        before_.try_emplace(before.vertices[i], before.mesh.vertices[i]);
        mesh_.Move(before.vertices[i], after.vertices[i]);
      }
    }
    for (const uint32_t i : changed) {
      Facet facet = after.facets[i];
      for (uint32_t& vertex : facet) {
        vertex = before.vertices[vertex];
      }
      mesh_.Replace(before.facets[i], facet, BoxOf(after, i));
    }
  }

  SectionedMesh& mesh_;
  std::vector<FacetPair> pairs_;  // that are left
  size_t work_ = 0;
  SelfIntersectionRepair repair_;
  std::map<uint32_t, Eigen::Vector3f> before_;  // of vertices that moved
};

}  // namespace

std::vector<FacetPair> FindSelfIntersections(const SectionedMesh& mesh) {
  std::vector<FacetPair> pairs;
  for (size_t section = 0; section < mesh.NumSections(); ++section) {
    const MeshPart own = ReadSection(mesh, section);
    if (own.facets.empty()) {
      continue;
    }
    const FacetTree tree(own.mesh);
    AddPairs(
        own, FindSelfIntersections(own.mesh, tree),
        [](uint32_t, uint32_t) { return true; }, &pairs);
    FacetList meeting = MeetingLater(mesh, section, own, tree);
    if (!meeting.facets.empty()) {
      const uint32_t end = mesh.FirstFacet(section + 1);
      const MeshPart part = meeting.Gather(mesh);
      AddPairs(
          part, FindSelfIntersections(part.mesh),
          [&](uint32_t a, uint32_t b) { return a < end && b >= end; }, &pairs);
    }
  }
  std::ranges::sort(pairs);
  return pairs;
}

SelfIntersectionRepair RepairSections(SectionedMesh* mesh) {
  return SectionsRepair(mesh).Run();
}

}  // namespace colmap_ext
