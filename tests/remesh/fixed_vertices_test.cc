// What stays stays: positions, edges and facets between fixed vertices.

#include <array>
#include <numeric>
#include <optional>
#include <vector>

#include <gtest/gtest.h>

#include "mesh/subdivision.h"
#include "remesh/anchored_mesh.h"
#include "remesh/isotropic_remeshing.h"
#include "tests/mesh/known_meshes.h"
#include "tests/mesh/manifold_links.h"
#include "tests/remesh/remeshed.h"

namespace colmap_ext::fixed_vertices_test {

// What lies on one side of a plane.
FixedVertices Half(const TriangleMesh& mesh) {
  FixedVertices fixed;
  for (const Eigen::Vector3f& vertex : mesh.vertices) {
    fixed.push_back(vertex.x() + 0.3F * vertex.y() > 0.1F ? 1 : 0);
  }
  return fixed;
}

TEST(FixedVertices, StayWhenASurfaceIsRemeshed) {
  for (const TriangleMesh& mesh :
       {MakeBumpySphere(0.2F), MakeBumpyCap(0.15F), MakeRoundTorus(0.15F)}) {
    const FixedVertices fixed = Half(mesh);
    for (const float length : {0.1F, 0.15F, 0.4F}) {
      const std::vector<float> lengths(mesh.vertices.size(), length);
      const std::vector<float> tolerances(mesh.vertices.size(), length / 10);
      const RemeshedSurface result =
          RemeshIsotropically(mesh, lengths, tolerances, fixed);
      ExpectSameTopology(mesh, result.mesh);
      ExpectFixed(mesh, fixed, result.mesh, result.fixed_sources);
      EXPECT_NE(mesh.facets.size(), result.mesh.facets.size());
      // Long edges that stay do not make those beside them ever shorter.
      EXPECT_LT(
          result.mesh.facets.size(),
          RemeshIsotropically(mesh, lengths, tolerances).mesh.facets.size() +
              mesh.facets.size());
    }
  }
}

TEST(FixedVertices, StayWhenAnglesImprove) {
  Random random(3);
  const TriangleMesh mesh =
      Moved(MakeBumpyCap(0.1F), [&](const auto& point) -> Eigen::Vector3f {
        return point.array() + 0.06F * RandomPoint(&random).array() - 0.03F;
      });
  const FixedVertices fixed = Half(mesh);
  const RemeshedSurface improved = ImproveAngles(mesh, fixed);
  ExpectSameTopology(mesh, improved.mesh);
  ExpectFixed(mesh, fixed, improved.mesh, improved.fixed_sources);
  EXPECT_NE(mesh.facets, improved.mesh.facets);
}

TEST(FixedVertices, AreNotCutByASubdivision) {
  const TriangleMesh mesh = MakeBumpySphere(0.2F);
  const FixedVertices fixed = Half(mesh);
  const DerivedMesh result =
      Subdivide(mesh, std::vector<uint8_t>(mesh.facets.size(), 1), fixed);
  ExpectSameTopology(mesh, result.mesh);
  for (const auto& [a, b] : result.from.vertices) {
    EXPECT_TRUE(a == b || !IsFixed(fixed, a) || !IsFixed(fixed, b));
  }
  EXPECT_GT(result.mesh.facets.size(), mesh.facets.size());
}

TEST(FixedVertices, NoneLeaveTheBytesAsTheyAre) {
  const TriangleMesh mesh = MakeBumpyCap(0.1F);
  const std::vector<float> lengths(mesh.vertices.size(), 0.07F);
  const std::vector<float> tolerances(mesh.vertices.size(), 0.01F);
  const RemeshedSurface none = RemeshIsotropically(mesh, lengths, tolerances);
  const RemeshedSurface free = RemeshIsotropically(
      mesh, lengths, tolerances, FixedVertices(mesh.vertices.size(), 0));
  EXPECT_EQ(none.mesh, free.mesh);
}

// A ring of numbers. Each in turn grows by a sum of its neighbors unless that
// is a multiple of three, so that it matters what was done before.
class Ring {
 public:
  explicit Ring(uint32_t size) : values_(size) {
    std::iota(values_.begin(), values_.end(), 1);
  }

  struct Plan {
    uint32_t place;
    uint32_t value;
  };

  std::optional<Plan> Propose(uint32_t place) const {
    const auto [before, at, after] = Around(place);
    const uint32_t sum = values_[before] + 2 * values_[after] + values_[at];
    return sum % 3 != 0 ? std::optional<Plan>({place, sum + values_[at]})
                        : std::nullopt;
  }
  void Apply(const Plan& plan) { values_[plan.place] = plan.value; }

  std::array<uint32_t, 3> Around(uint32_t place) const {
    const auto size = static_cast<uint32_t>(values_.size());
    return {(place + size - 1) % size, place, (place + 1) % size};
  }

  const std::vector<uint32_t>& values() const { return values_; }

 private:
  std::vector<uint32_t> values_;
};

void ExpectSameAsOneByOne(const std::vector<uint32_t>& order, uint32_t size) {
  Ring expected(size);
  size_t num_expected = 0;
  for (const uint32_t place : order) {
    if (const auto plan = expected.Propose(place)) {
      expected.Apply(*plan);
      ++num_expected;
    }
  }
  Ring ring(size);
  ChangedVertices changed(size);
  const size_t num_applied = ApplyInOrder(
      order.size(), [&](size_t i) { return ring.Propose(order[i]); },
      [&](size_t i) { return ring.Around(order[i]); },
      [&](const Ring::Plan& plan) {
        ring.Apply(plan);
        changed.Mark(plan.place);
      },
      &changed);
  EXPECT_EQ(num_applied, num_expected);
  EXPECT_GT(num_applied, 0u);
  EXPECT_LT(num_applied, order.size());
  EXPECT_EQ(ring.values(), expected.values());
}

TEST(ApplyInOrder, DoesWhatOneByOneDoesAndNothingForNoItems) {
  constexpr uint32_t kSize = 3000;  // some batches
  std::vector<uint32_t> order(3 * kSize);
  for (uint32_t i = 0; i < order.size(); ++i) {
    order[i] = i % kSize;
  }
  ExpectSameAsOneByOne(order, kSize);  // neighbors one after the other
  Random random(1);
  random.Shuffle(&order);
  ExpectSameAsOneByOne(order, kSize);
  ChangedVertices none(0);
  EXPECT_EQ(ApplyInOrder(
                0, [](size_t i) { return std::optional<size_t>(i); },
                [](size_t) { return std::array<uint32_t, 1>{0}; },
                [](size_t) {}, &none),
            0u);
}

}  // namespace colmap_ext::fixed_vertices_test
