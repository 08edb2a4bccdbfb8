#include "meshing/inherit_attributes.h"

#include <algorithm>
#include <iterator>
#include <unordered_map>
#include <utility>

namespace colmap_ext {
namespace {

// The attributes of one vertex.
struct Attributes {
  Color color{0, 0, 0};
  std::vector<uint32_t> views;
};

// The mean colour of two points, and the views of either.
Attributes OfPoints(const PointCloud& cloud, uint32_t a, uint32_t b) {
  Attributes attributes;
  if (!cloud.colors.empty()) {
    for (int k = 0; k < 3; ++k) {
      attributes.color[k] = static_cast<uint8_t>(
          (cloud.colors[a][k] + cloud.colors[b][k] + 1) / 2);
    }
  }
  const auto views_a = cloud.views[a];
  const auto views_b = cloud.views[b];
  std::set_union(views_a.begin(), views_a.end(), views_b.begin(), views_b.end(),
                 std::back_inserter(attributes.views));
  return attributes;
}

// The mean colour, and the views that at least half of the neighbors have.
Attributes OfNeighbors(const std::vector<Attributes>& neighbors) {
  Attributes attributes;
  const size_t count = neighbors.size();
  std::vector<uint32_t> views;
  for (int k = 0; k < 3; ++k) {
    size_t sum = count / 2;
    for (const Attributes& neighbor : neighbors) {
      sum += neighbor.color[k];
    }
    attributes.color[k] = static_cast<uint8_t>(sum / count);
  }
  for (const Attributes& neighbor : neighbors) {
    views.insert(views.end(), neighbor.views.begin(), neighbor.views.end());
  }
  std::sort(views.begin(), views.end());
  for (auto first = views.begin(); first != views.end();) {
    const auto last = std::upper_bound(first, views.end(), *first);
    if (2 * static_cast<size_t>(last - first) >= count) {
      attributes.views.push_back(*first);
    }
    first = last;
  }
  return attributes;
}

// Gives attributes to all vertices; holds those alone that are inherited.
class Inheritance {
 public:
  Inheritance(const TriangleMesh& mesh, const PointCloud& cloud,
              const std::vector<std::array<uint32_t, 2>>& points)
      : mesh_(mesh), cloud_(cloud), points_(points) {
    for (const Facet& facet : mesh.facets) {
      for (int k = 0; k < 3; ++k) {
        if (!IsOfPoints(facet[k])) {
          neighbors_[facet[k]].push_back(facet[(k + 1) % 3]);
        }
      }
    }
    for (const auto& [vertex, neighbors] : neighbors_) {
      unknown_.push_back(vertex);
    }
    std::ranges::sort(unknown_);
  }

  VertexAttributes Run() {
    // From the known vertices inwards.
    while (InheritOnce()) {
    }
    VertexAttributes result;
    result.views.offsets.reserve(mesh_.vertices.size() + 1);
    for (uint32_t i = 0; i < mesh_.vertices.size(); ++i) {
      const Attributes attributes = IsKnown(i) ? Of(i) : Attributes();
      if (!cloud_.colors.empty()) {
        result.colors.push_back(attributes.color);
      }
      result.views.AddRow(attributes.views);
    }
    return result;
  }

 private:
  bool IsOfPoints(uint32_t vertex) const {
    const auto& [a, b] = points_[vertex];
    return a != kNone && b != kNone;
  }

  bool IsKnown(uint32_t vertex) const {
    return IsOfPoints(vertex) || inherited_.contains(vertex);
  }

  // \pre it is known
  Attributes Of(uint32_t vertex) const {
    return IsOfPoints(vertex)
               ? OfPoints(cloud_, points_[vertex][0], points_[vertex][1])
               : inherited_.at(vertex);
  }

  // A round: gives attributes to the vertices that have known neighbors.
  // \return whether there were any
  bool InheritOnce() {
    std::vector<std::pair<uint32_t, Attributes>> found;
    std::vector<Attributes> known;
    for (const uint32_t vertex : unknown_) {
      known.clear();
      for (const uint32_t neighbor : neighbors_.at(vertex)) {
        if (IsKnown(neighbor)) {
          known.push_back(Of(neighbor));
        }
      }
      if (!known.empty()) {
        found.emplace_back(vertex, OfNeighbors(known));
      }
    }
    for (auto& [vertex, attributes] : found) {
      inherited_[vertex] = std::move(attributes);
    }
    std::erase_if(unknown_,
                  [&](uint32_t vertex) { return inherited_.contains(vertex); });
    return !found.empty();
  }

  const TriangleMesh& mesh_;
  const PointCloud& cloud_;
  const std::vector<std::array<uint32_t, 2>>& points_;
  std::vector<uint32_t> unknown_;  // vertices, ascending
  std::unordered_map<uint32_t, std::vector<uint32_t>> neighbors_;  // of those
  std::unordered_map<uint32_t, Attributes> inherited_;
};

}  // namespace

VertexAttributes InheritAttributes(
    const TriangleMesh& mesh, const PointCloud& cloud,
    const std::vector<std::array<uint32_t, 2>>& points) {
  return Inheritance(mesh, cloud, points).Run();
}

}  // namespace colmap_ext
