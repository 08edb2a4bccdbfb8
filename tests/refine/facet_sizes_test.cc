#include "refine/facet_sizes.h"

#include <algorithm>
#include <cstdint>
#include <memory>
#include <numeric>
#include <vector>

#include <gtest/gtest.h>
#include <Eigen/Geometry>

#include "base/indices.h"
#include "mesh/mesh_in_image.h"
#include "tests/mesh/known_meshes.h"
#include "tests/mesh/manifold_links.h"
#include "tests/raster/shown_facets.h"
#include "tests/raster/visible_facets.h"

namespace colmap_ext::facet_sizes_test {

using Eigen::Vector3f;

constexpr double kMinCosine = 0.1;

// Two of the upper side, one of the lower.
std::vector<View> Views() {
  return {LookAt({0.5, 0.5, 4}, {0, 0, 0}, 160, 120, 150),
          LookAt({-0.8, 0.1, 4}, {0, 0, 0}, 160, 120, 150),
          LookAt({0.2, 0.1, -4}, {0, 0, 0}, 160, 120, 150)};
}

// The second largest of the areas in the views that see each facet, px^2.
std::vector<double> SecondAreas(const TriangleMesh& mesh,
                                const std::vector<View>& views) {
  const FacetVisibility visibility = VisibleFacets(mesh, views, kMinCosine);
  std::vector<double> seconds;
  for (size_t i = 0; i < mesh.facets.size(); ++i) {
    std::vector<double> areas(2, 0.0);
    for (const uint32_t view : visibility[i]) {
      areas.push_back(AreaInImage(mesh, mesh.facets[i], views[view]));
    }
    std::ranges::sort(areas, std::greater());
    seconds.push_back(areas[1]);
  }
  return seconds;
}

// Of view i % 3, and of view 7.
VertexAttributes MakeAttributes(size_t num_vertices) {
  VertexAttributes attributes;
  for (uint32_t i = 0; i < num_vertices; ++i) {
    attributes.colors.push_back({static_cast<uint8_t>(i % 3), 50, 200});
    attributes.views.values.insert(attributes.views.values.end(), {i % 3, 7});
    attributes.views.EndRow();
  }
  return attributes;
}

auto DrawBy(const std::vector<View>& views) {
  return [views](const TriangleMesh& drawn) {
    return std::make_shared<const VisibilityBuffers>(drawn, views, kMinCosine,
                                                     SIZE_MAX);
  };
}

Surface Subdivide(double max_area, const TriangleMesh& mesh,
                  const std::vector<View>& views) {
  Surface result{mesh, MakeAttributes(mesh.vertices.size())};
  const FacetVisibility visibility =
      SubdivideLargeFacets(max_area, DrawBy(views), &result);
  EXPECT_EQ(visibility, VisibleFacets(result.mesh, views, kMinCosine));
  return result;
}

TEST(SubdivideLargeFacets, LeavesNoneThatIsLargerInTwoViews) {
  for (const TriangleMesh& mesh :
       {MakeBumpySphere(0.5f), MakeRoundTorus(0.3f), MakeBumpyCap(0.4f)}) {
    EXPECT_GT(std::ranges::max(SecondAreas(mesh, Views())), 16);
    for (const double max_area : {16.0, 3.0}) {
      const Surface result = Subdivide(max_area, mesh, Views());
      const std::vector<double> after = SecondAreas(result.mesh, Views());
      EXPECT_LE(std::ranges::max(after), max_area);
      // No more than is needed: not all are much smaller.
      EXPECT_GT(std::ranges::max(after), max_area / 4);
      EXPECT_GT(result.mesh.facets.size(), mesh.facets.size());
    }
  }
}

TEST(SubdivideLargeFacets, CutsWallsThatReachBehindTheCameras) {
  const std::vector<View> views = {RoomViews()[0], RoomViews()[1]};
  const TriangleMesh room = Subdivide(9, MakeRoom(), views).mesh;
  const FacetVisibility visibility = VisibleFacets(room, views, kMinCosine);
  std::vector<int> num_pixels[2];  // that show each facet
  for (int i = 0; i < 2; ++i) {
    num_pixels[i].resize(room.facets.size(), 0);
    for (const uint32_t facet : ShownFacets(DrawFacets(views[i], room, 0.1))) {
      ++num_pixels[i][facet];
    }
  }
  int num_seen = 0;
  for (size_t i = 0; i < room.facets.size(); ++i) {
    if (visibility[i].size() == 2) {
      EXPECT_LT(std::min(num_pixels[0][i], num_pixels[1][i]), 30) << i;
      num_seen += num_pixels[0][i];
    }
  }
  EXPECT_GT(num_seen, 0.5 * views[0].width * views[0].height);
}

void ExpectUnchanged(const Surface& result, const TriangleMesh& mesh) {
  EXPECT_EQ(result.mesh, mesh);
  EXPECT_EQ(result.attributes.views.values,
            MakeAttributes(mesh.vertices.size()).views.values);
}

TEST(SubdivideLargeFacets, ChangesNothingWhereAllAreSmallOrSeenTooRarely) {
  const TriangleMesh mesh = MakeBumpySphere(0.3f);
  const double largest = std::ranges::max(SecondAreas(mesh, Views()));
  ExpectUnchanged(Subdivide(1.001 * largest, mesh, Views()), mesh);
  EXPECT_GT(Subdivide(0.999 * largest, mesh, Views()).mesh.facets.size(),
            mesh.facets.size());
  // Nor of what no view sees, or a single one does.
  ExpectUnchanged(Subdivide(1, mesh, {}), mesh);
  ExpectUnchanged(Subdivide(1, mesh, {Views()[0]}), mesh);
  ExpectUnchanged(Subdivide(1, mesh, {Views()[0], Views()[2]}), mesh);
}

// Two facets of 800 px^2 in both views: cut in four until they are of 12.5.
TEST(SubdivideLargeFacets, CutsASquareInQuarters) {
  TriangleMesh square = {{{0, 0, 4}, {0, 1, 4}, {1, 1, 4}, {1, 0, 4}},
                         {{0, 1, 2}, {0, 2, 3}}};
  const View view{"", 100, 100, 160, 160, 30, 30};
  for (const auto& [max_area, num_facets] :
       {std::pair(801.0, 2), {799.0, 8}, {201.0, 8}, {16.0, 128}}) {
    EXPECT_EQ(Subdivide(max_area, square, {view, view}).mesh.facets.size(),
              num_facets);
  }
}

TEST(SubdivideLargeFacets, DoesNotDependOnTheScale) {
  const TriangleMesh mesh = MakeRoundTorus(0.3f);
  const TriangleMesh expected = Subdivide(4, mesh, Views()).mesh;
  for (const float scale : {1024.0f, 1 / 1024.0f}) {
    const TriangleMesh scaled =
        Subdivide(4, Scaled(mesh, scale), Scaled(Views(), scale)).mesh;
    EXPECT_EQ(Scaled(scaled, 1 / scale), expected);
  }
}

// Two of the upper side, none of the lower.
std::vector<View> FineViews() {
  return {LookAt({0.5, 0.5, 4}, {0, 0, 0}, 320, 240, 300),
          LookAt({-0.8, 0.1, 4}, {0, 0, 0}, 320, 240, 300)};
}

const Vector3f kShift(0.5f, -1, 2);

struct Remeshed : Surface {  // origins: a shifted copy of the vertices
  FacetVisibility visibility;
};

Remeshed Remesh(double area, const TriangleMesh& mesh) {
  Remeshed result{{mesh, {}, mesh.vertices}, {}};
  for (Vector3f& origin : result.origins) {
    origin += kShift;
    result.attributes.views.AddRow(std::vector<uint32_t>{0, 1});
  }
  result.visibility = RemeshForImages(area, DrawBy(FineViews()), &result);
  return result;
}

TEST(RemeshForImages, GivesSeenFacetsTheAreaAndUnseenMore) {
  const TriangleMesh mesh = MakeBumpySphere(0.12F);
  for (const double area : {8.0, 25.0}) {
    const Remeshed result = Remesh(area, mesh);
    ExpectSameTopology(mesh, result.mesh);
    EXPECT_EQ(result.visibility,
              VisibleFacets(result.mesh, FineViews(), kMinCosine));
    const std::vector<float> areas =
        RefinableAreas(result.mesh, FineViews(), result.visibility);
    std::vector<float> seen;
    double seen_size = 0;
    double unseen_size = 0;
    size_t num_unseen = 0;
    for (size_t i = 0; i < areas.size(); ++i) {
      const auto& [a, b, c] = result.mesh.facets[i];
      const float edge =
          (result.mesh.vertices[b] - result.mesh.vertices[a]).norm();
      if (areas[i] > 0) {
        seen.push_back(areas[i]);
        seen_size += edge;
      } else if (result.mesh.vertices[c].z() < -0.5F) {
        unseen_size += edge;
        ++num_unseen;
      }
    }
    std::nth_element(seen.begin(), seen.begin() + seen.size() / 2, seen.end());
    EXPECT_NEAR(seen[seen.size() / 2] / area, 0.8, 0.4);
    ASSERT_GT(num_unseen, 10);
    EXPECT_GT(unseen_size / num_unseen, 1.5 * seen_size / seen.size());
  }
}

TEST(RemeshForImages, CarriesOriginsAndAttributes) {
  const Remeshed result = Remesh(10, MakeBumpySphere(0.12F));
  const size_t num_vertices = result.mesh.vertices.size();
  ASSERT_EQ(result.origins.size(), num_vertices);
  ASSERT_EQ(result.attributes.views.size(), num_vertices);
  for (size_t i = 0; i < num_vertices; ++i) {
    EXPECT_LT((result.origins[i] - kShift - result.mesh.vertices[i]).norm(),
              0.02F);
    EXPECT_EQ(result.attributes.views[i].size(), 2);
  }
}

TEST(ExpectedParts, AreAboutThoseOfTheRemeshedSurface) {
  const TriangleMesh mesh = MakeBumpySphere(0.12F);
  Rows<uint32_t> vertex_views;
  for (const Vector3f& vertex : mesh.vertices) {
    vertex_views.AddRow(Iota(vertex.z() > 0.2F ? 2 : 0));
  }
  for (const double area : {3.0, 12.0}) {
    const std::vector<float> parts =
        ExpectedParts(area, mesh, vertex_views, FineViews());
    const double expected = std::reduce(parts.begin(), parts.end(), 0.0);
    const auto num_facets =
        static_cast<double>(Remesh(area, mesh).mesh.facets.size());
    EXPECT_NEAR(expected, num_facets, 0.35 * num_facets) << area;
  }
  // What no view sees gets larger facets.
  const Rows<uint32_t> unseen(mesh.vertices.size());
  for (const float part : ExpectedParts(1, mesh, unseen, FineViews())) {
    EXPECT_LT(part, 1);
  }
}

}  // namespace colmap_ext::facet_sizes_test
