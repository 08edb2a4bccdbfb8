#include "meshing/inherit_attributes.h"

#include <algorithm>
#include <iterator>
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
Attributes OfNeighbors(const std::vector<const Attributes*>& neighbors) {
  Attributes attributes;
  const size_t count = neighbors.size();
  std::vector<uint32_t> views;
  for (int k = 0; k < 3; ++k) {
    size_t sum = count / 2;
    for (const Attributes* neighbor : neighbors) {
      sum += neighbor->color[k];
    }
    attributes.color[k] = static_cast<uint8_t>(sum / count);
  }
  for (const Attributes* neighbor : neighbors) {
    views.insert(views.end(), neighbor->views.begin(), neighbor->views.end());
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

// The neighbors of each vertex whose attributes are not known.
std::vector<std::vector<uint32_t>> NeighborsOfUnknown(
    const TriangleMesh& mesh, const std::vector<uint8_t>& is_known) {
  std::vector<std::vector<uint32_t>> neighbors(mesh.vertices.size());
  for (const Facet& facet : mesh.facets) {
    for (int k = 0; k < 3; ++k) {
      if (!is_known[facet[k]]) {
        neighbors[facet[k]].push_back(facet[(k + 1) % 3]);
      }
    }
  }
  return neighbors;
}

// A round: gives attributes to the vertices that have known neighbors.
// \return whether there were any
bool InheritOnce(const std::vector<std::vector<uint32_t>>& neighbors,
                 std::vector<uint8_t>* is_known,
                 std::vector<Attributes>* attributes) {
  std::vector<std::pair<size_t, Attributes>> found;
  std::vector<const Attributes*> known;
  for (size_t i = 0; i < neighbors.size(); ++i) {
    known.clear();
    for (const uint32_t neighbor : neighbors[i]) {
      if ((*is_known)[neighbor]) {
        known.push_back(&(*attributes)[neighbor]);
      }
    }
    if (!(*is_known)[i] && !known.empty()) {
      found.emplace_back(i, OfNeighbors(known));
    }
  }
  for (auto& [vertex, attribute] : found) {
    (*attributes)[vertex] = std::move(attribute);
    (*is_known)[vertex] = 1;
  }
  return !found.empty();
}

VertexAttributes Flatten(const std::vector<Attributes>& attributes,
                         bool has_colors) {
  VertexAttributes result;
  for (const Attributes& attribute : attributes) {
    if (has_colors) {
      result.colors.push_back(attribute.color);
    }
    result.views.values.insert(result.views.values.end(),
                               attribute.views.begin(), attribute.views.end());
    result.views.EndRow();
  }
  return result;
}

}  // namespace

VertexAttributes InheritAttributes(
    const TriangleMesh& mesh, const PointCloud& cloud,
    const std::vector<std::array<uint32_t, 2>>& points) {
  const size_t num_vertices = mesh.vertices.size();
  std::vector<Attributes> attributes(num_vertices);
  std::vector<uint8_t> is_known(num_vertices, 0);
  for (size_t i = 0; i < num_vertices; ++i) {
    const auto [a, b] = points[i];
    is_known[i] = a != kNoPoint && b != kNoPoint;
    if (is_known[i]) {
      attributes[i] = OfPoints(cloud, a, b);
    }
  }
  const auto neighbors = NeighborsOfUnknown(mesh, is_known);
  // From the known vertices inwards.
  while (InheritOnce(neighbors, &is_known, &attributes)) {
  }
  return Flatten(attributes, !cloud.colors.empty());
}

}  // namespace colmap_ext
