#include "delaunay/thinning.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <tuple>
#include <utility>

#include <gtest/gtest.h>

#include "base/indices.h"
#include "delaunay/growing_complex.h"
#include "tests/delaunay/random_complex.h"
#include "tests/threads.h"

namespace colmap_ext::thinning_test {

// Points on a wavy sheet, before two views that see each of them, some of them
// one, or none.
struct SeenSheet {
  SeenSheet() {
    for (const double x : {0, 1}) {
      views.push_back({"", 1000, 1000, 1000, 1000, 500, 500});
      views.back().cam_from_world_translation = {x, 0, 10};
    }
    Random random(3);
    for (int i = 0; i < 4000; ++i) {
      const double x = 6 * random.Unit() - 3;
      const double y = 6 * random.Unit() - 3;
      cloud.positions.push_back(
          Eigen::Vector3d(
              x, y, std::sin(3 * x) * std::cos(2 * y) + 0.05 * random.Unit())
              .cast<float>());
      for (uint32_t view = 0; view < 2; ++view) {
        if (random.Chance(0.9)) {
          cloud.views.values.push_back(view);
        }
      }
      cloud.views.EndRow();
    }
  }

  PointCloud cloud;
  std::vector<View> views;
};

// A fifth of the pixels, and the share of the depth, in the nearest view.
double DistanceOf(const SeenSheet& sheet, const ThinningOptions& options,
                  uint32_t point) {
  double distance = std::numeric_limits<double>::infinity();
  for (const uint32_t index : sheet.cloud.views[point]) {
    const View& view = sheet.views[index];
    const double depth =
        view.CamFromWorld(sheet.cloud.positions[point].cast<double>()).z();
    distance =
        std::min({distance, 0.2 * options.max_proj_dist * depth / view.fx,
                  options.max_depth_dist * depth});
  }
  return std::isfinite(distance) ? distance : 0;
}

double Between(const SeenSheet& sheet, uint32_t a, uint32_t b) {
  return (sheet.cloud.positions[a] - sheet.cloud.positions[b]).norm();
}

TEST(Thinning, EveryPointHasItsVertexIfAllAreKept) {
  for (const auto& [name, points] : DifficultPoints()) {
    SCOPED_TRACE(name);
    for (const ThinningOptions& options :
         {ThinningOptions{0, 0.05}, ThinningOptions{20, 0}}) {
      const ThinnedPoints result = ThinPoints(CloudOf(points), {}, options);
      ASSERT_EQ(result.point_vertices.size(), points.size());
      ASSERT_EQ(result.vertex_points.size(), result.positions.size());
      EXPECT_EQ(result.num_duplicate_points,
                points.size() - result.positions.size());
      for (size_t i = 0; i < points.size(); ++i) {
        EXPECT_EQ(result.positions[result.point_vertices[i]], points[i]);
      }
      for (uint32_t vertex = 0; vertex < result.vertex_points.size();
           ++vertex) {
        const uint32_t point = result.vertex_points[vertex];
        EXPECT_EQ(result.point_vertices[point], vertex);
        // Of duplicates the first.
        EXPECT_EQ(std::ranges::find(points, points[point]),
                  points.begin() + point);
      }
    }
  }
}

// By throwing the darts one after the other.
TEST(Thinning, KeepsWhatIsFarFromAllThatIsKeptBefore) {
  const SeenSheet sheet;
  std::vector<uint32_t> representatives;
  const std::vector<uint32_t> points =
      DistinctPoints(sheet.cloud.positions, &representatives);
  for (const double max_proj_dist : {5.0, 20.0, 60.0, 300.0}) {
    for (const double max_depth_dist : {0.002, 0.05}) {
      const ThinningOptions options = {max_proj_dist, max_depth_dist};
      std::vector<uint32_t> kept;
      for (const uint32_t i : InsertionOrder(points.size())) {
        const double distance = DistanceOf(sheet, options, points[i]);
        if (std::ranges::none_of(kept, [&](uint32_t other) {
              return Between(sheet, points[i], other) < distance;
            })) {
          kept.push_back(points[i]);
        }
      }
      const ThinnedPoints result =
          ThinPoints(sheet.cloud, sheet.views, options);
      std::vector<uint32_t> vertex_points = result.vertex_points;
      std::ranges::sort(kept);
      std::ranges::sort(vertex_points);
      EXPECT_EQ(vertex_points, kept);
      EXPECT_LT(kept.size(), points.size());
    }
  }
}

TEST(Thinning, PointsLeftOutHaveTheNearestVertex) {
  const SeenSheet sheet;
  const ThinningOptions options = {40, 0.05};
  const ThinnedPoints result = ThinPoints(sheet.cloud, sheet.views, options);
  size_t num_left_out = 0;
  for (uint32_t point = 0; point < sheet.cloud.size(); ++point) {
    const uint32_t own = result.vertex_points[result.point_vertices[point]];
    num_left_out += own != point ? 1 : 0;
    if (own != point) {
      EXPECT_LE(Between(sheet, point, own),
                (1 + 1e-6) * DistanceOf(sheet, options, point));
    }
    for (const uint32_t vertex_point : result.vertex_points) {
      ASSERT_GE(Between(sheet, point, vertex_point),
                Between(sheet, point, own) - 1e-6);
    }
  }
  EXPECT_EQ(num_left_out + result.vertex_points.size(), sheet.cloud.size());
  EXPECT_GT(num_left_out, sheet.cloud.size() / 4);
}

TEST(Thinning, KeepsWhatNoViewSees) {
  SeenSheet sheet;
  sheet.cloud.views = Rows<uint32_t>(sheet.cloud.size());
  EXPECT_EQ(ThinPoints(sheet.cloud, sheet.views, {}).positions.size(),
            sheet.cloud.size());
}

TEST(Thinning, IsTheSameEveryTime) {
  const SeenSheet sheet;
  ExpectSameForAnyThreads([&] {
    ThinnedPoints thinned = ThinPoints(sheet.cloud, sheet.views, {20, 0.05});
    return std::tuple(std::move(thinned.positions),
                      std::move(thinned.vertex_points),
                      std::move(thinned.point_vertices));
  });
}

}  // namespace colmap_ext::thinning_test
