#include "repair/self_intersection_repair.h"

#include <algorithm>
#include <cmath>
#include <numbers>
#include <span>

#include <gtest/gtest.h>

#include "repair/guarded_mesh.h"
#include "spatial/self_intersections.h"
#include "tests/mesh/known_meshes.h"
#include "tests/mesh/manifold_links.h"
#include "tests/threads.h"

namespace colmap_ext::self_intersection_repair_test {

using Eigen::Vector3f;

struct Repaired : SelfIntersectionRepair {
  float max_motion = 0;

  bool operator==(const Repaired&) const = default;
};

// Repairs a mesh and checks what holds for every mesh.
Repaired Repair(TriangleMesh* mesh) {
  const TriangleMesh before = *mesh;
  Repaired repair{RepairSelfIntersections(mesh)};
  EXPECT_EQ(repair.num_before, FindSelfIntersections(before).size());
  EXPECT_EQ(repair.num_after, FindSelfIntersections(*mesh).size());
  EXPECT_LE(repair.num_after, repair.num_before);
  EXPECT_TRUE(Analyze(before).IsManifold());
  ExpectSameTopology(before, *mesh);
  EXPECT_EQ(Analyze(*mesh).num_border_edges, Analyze(before).num_border_edges);
  EXPECT_EQ(mesh->vertices.size(), before.vertices.size());
  EXPECT_EQ(mesh->facets, before.facets);
  for (size_t i = 0; i < before.vertices.size(); ++i) {
    const float motion = (mesh->vertices[i] - before.vertices[i]).norm();
    repair.max_motion = std::max(repair.max_motion, motion);
  }
  return repair;
}

TriangleMesh WithNoise(TriangleMesh mesh, float noise, Random* random) {
  return Moved(std::move(mesh), [&](const Vector3f& point) -> Vector3f {
    return point.array() + noise * (RandomPoint(random).array() - 0.5f);
  });
}

const TriangleMesh kFlat = MakeSheet(20, 20);

Repaired ExpectRepaired(TriangleMesh mesh) {
  const Repaired repair = Repair(&mesh);
  EXPECT_GT(repair.num_before, 0u);
  EXPECT_EQ(repair.num_after, 0u);
  return repair;
}

TEST(RepairSelfIntersections, LeavesMeshesWithoutThemAsTheyAre) {
  Random random(1);
  for (const TriangleMesh& mesh :
       {TriangleMesh(), MakeTetrahedron(), MakeCube(), MakeDisc(),
        MakeJitteredSquare(30, &random), MakeBumpySphere(0.05f),
        MakeRoundTorus(0.1f)}) {
    TriangleMesh repaired = mesh;
    EXPECT_EQ(RepairSelfIntersections(&repaired), SelfIntersectionRepair());
    EXPECT_EQ(repaired, mesh);
  }
}

TEST(RepairSelfIntersections, DrawsASpikeBackThroughASheet) {
  for (const int width : {0, 1, 2}) {
    const auto spike = [&](float x, float y) {
      const float distance = std::max(std::abs(x - 10), std::abs(y - 10));
      return distance <= static_cast<float>(width) ? 2.f : 0.f;
    };
    ExpectRepaired(
        Union(MakeHeightField(20, spike), Shifted(kFlat, {0, 0, 1})));
  }
}

TEST(RepairSelfIntersections, PartsSheetsThatBulgeThroughEachOther) {
  const auto bump = [](float x, float y) {
    return std::exp(-0.1f * ((x - 10) * (x - 10) + (y - 10) * (y - 10)));
  };
  for (const float overlap : {0.05f, 0.1f, 0.3f}) {
    ExpectRepaired(Union(Shifted(MakeHeightField(20, bump), {0, 0, overlap}),
                         MakeHeightField(20, [&](float x, float y) {
                           return 2 - bump(x + 0.3f, y + 0.2f);
                         })));
  }
}

TEST(RepairSelfIntersections, PartsSheetsThatTouch) {
  // At a vertex, along the quads around it, and where two vertices meet.
  ExpectRepaired(Union(
      MakeHeightField(
          20, [](float x, float y) { return x == 10 && y == 10 ? 1.f : 0.f; }),
      Shifted(kFlat, {0, 0, 1})));
  // Both in one plane, each on the matter's side of the other.
  ExpectRepaired(Union(kFlat, Moved(kFlat, [](const Vector3f& p) -> Vector3f {
                         return 0.5f * p + Vector3f(5.3f, 5.2f, 0);
                       })));
}

TEST(RepairSelfIntersections, OpensAPinchedTube) {
  ExpectRepaired(Moved(MakeSheet(40, 12, false, true), [](const Vector3f& p) {
    const float angle = p.x() * std::numbers::pi_v<float> / 6;
    const float z = 0.25f * p.y() - 5;
    const float radius = 1 - 1.1f * std::exp(-4 * z * z);
    return Vector3f(radius * std::cos(angle), radius * std::sin(angle), z);
  }));
}

// A fold: rows of a sheet that run backwards.
TEST(RepairSelfIntersections, UnfoldsASheet) {
  ExpectRepaired(Moved(kFlat, [](const Vector3f& p) {
    const bool is_folded = p.x() == 10 && p.y() > 5 && p.y() < 15;
    return Vector3f(is_folded ? 11.4f : p.x(), p.y(), 0);
  }));
}

// By steps that no picture shows.
TEST(RepairSelfIntersections, MovesCopiesApart) {
  EXPECT_LT(ExpectRepaired(MakeTipToTip()).max_motion, 1e-5);
  // Two cubes that share a vertex, or an edge and so two copies.
  for (const float height : {1.0f, 0.0f}) {
    EXPECT_LT(
        ExpectRepaired(Union(MakeCube(), Shifted(MakeCube(), {1, 1, height})))
            .max_motion,
        1e-4);
  }
}

// What local changes cannot help stays no worse; so does any mesh.
TEST(RepairSelfIntersections, NeverMakesMore) {
  Random random(2);
  const TriangleMesh sphere = MakeBumpySphere(0.15f);
  TriangleMesh spheres = Union(sphere, Shifted(sphere, {0.8f, 0, 0}));
  Repair(&spheres);
  for (int trial = 0; trial < 30; ++trial) {
    TriangleMesh mesh = MakeRandomManifold(&random);
    Repair(&mesh);
  }
  for (const float noise : {0.04f, 0.12f}) {
    TriangleMesh mesh = WithNoise(MakeBumpySphere(0.1f), noise, &random);
    Repair(&mesh);
  }
}

// Noise turns facets over and lets them cross; most of it is repaired.
TEST(RepairSelfIntersections, RepairsMostOfANoisySurface) {
  Random random(3);
  TriangleMesh mesh = WithNoise(MakeBumpySphere(0.07f, 0), 0.042f, &random);
  const Repaired repair = Repair(&mesh);
  EXPECT_GT(repair.num_before, 50u);
  EXPECT_LE(20 * repair.num_after, repair.num_before);
}

// Sheets that cross each other, and copies of vertices at one place.
TriangleMesh CrossingSheets(Random* random) {
  const auto height = [random](float, float) {
    return 0.3f * static_cast<float>(random->Unit());
  };
  const auto other_height = [&](float x, float y) {
    return height(x, y) - (random->Chance(0.05) ? 0.2f : 0.0f);
  };
  TriangleMesh mesh =
      Union(MakeHeightField(12, height),
            Shifted(MakeHeightField(12, other_height), {0.3f, 0, 0.31f}));
  for (int i = 0; i < 4; ++i) {
    const uint32_t a = random->Below(mesh.vertices.size());
    mesh.vertices[a] = mesh.vertices[random->Below(mesh.vertices.size())];
  }
  return mesh;
}

// What is far away is in no patch.
TEST(RepairSelfIntersections, IsThatOfThePartThatCrosses) {
  Random random(3);
  size_t num_removed = 0;
  for (int trial = 0; trial < 30; ++trial) {
    TriangleMesh mesh = CrossingSheets(&random);
    if (random.Chance(0.5)) {
      random.Shuffle(&mesh.facets);
    }
    const TriangleMesh sheet = Shifted(MakeSheet(12, 12), {0, 100, 0});
    TriangleMesh all = Union(sheet, Union(mesh, Shifted(sheet, {0, 0, 1})));
    const Repaired repair = Repair(&mesh);
    const Repaired of_all = Repair(&all);
    EXPECT_EQ(of_all, repair);
    EXPECT_TRUE(std::ranges::equal(
        std::span(all.vertices)
            .subspan(sheet.vertices.size(), mesh.vertices.size()),
        mesh.vertices));
    num_removed += repair.num_before - repair.num_after;
  }
  EXPECT_GT(num_removed, 100u);
}

size_t CountFolds(const TriangleMesh& mesh) {
  size_t num_folds = 0;
  const std::vector<uint32_t> partners = PairHalfEdges(mesh.facets);
  for (uint32_t half = 0; half < partners.size(); ++half) {
    num_folds += partners[half] != kNone && half < partners[half] &&
                 IsFoldedEdge(mesh, half / 3, partners[half] / 3);
  }
  return num_folds;
}

TEST(Unfold, LeavesFewFoldsAndMakesNothingCross) {
  Random random(3);
  TriangleMesh mesh = WithNoise(MakeBumpySphere(0.14f, 0), 0.084f, &random);
  RepairSelfIntersections(&mesh);
  const size_t num_pairs = FindSelfIntersections(mesh).size();
  const TriangleMesh before = mesh;
  Unfold(&mesh);
  ASSERT_GT(CountFolds(before), 20u);
  EXPECT_LE(2 * CountFolds(mesh), CountFolds(before));
  EXPECT_LE(FindSelfIntersections(mesh).size(), num_pairs);
  ExpectSameTopology(before, mesh);

  TriangleMesh fixed = before;
  Unfold(&fixed, FixedVertices(before.vertices.size(), 1));
  EXPECT_EQ(fixed, before);
  TriangleMesh cube = MakeCube();
  Unfold(&cube);
  EXPECT_EQ(cube, MakeCube());
}

Surface MakeSurface(TriangleMesh mesh) {
  Surface surface{std::move(mesh), {}};
  const size_t num_vertices = surface.mesh.vertices.size();
  surface.attributes.views = Rows<uint32_t>(num_vertices);
  surface.attributes.confidences.assign(num_vertices, 1);
  return surface;
}

// A bumpy sphere remains one: closed, of the same genus.
TEST(FinishRepair, ClosesWhatItOpens) {
  Random random(3);
  TriangleMesh mesh = WithNoise(MakeBumpySphere(0.14f, 0), 0.084f, &random);
  size_t num_pairs = RepairSelfIntersections(&mesh).num_after;
  ASSERT_GT(num_pairs, 0u);
  Surface surface = MakeSurface(mesh);
  const Provenance from = FinishRepair(&num_pairs, &surface);
  EXPECT_EQ(num_pairs, 0u);
  EXPECT_EQ(FindSelfIntersections(surface.mesh).size(), 0u);
  EXPECT_TRUE(Analyze(surface.mesh).IsManifold());
  EXPECT_EQ(Analyze(surface.mesh).num_border_edges, 0u);
  ExpectSameTopology(mesh, surface.mesh);
  ASSERT_EQ(from.facets.size(), surface.mesh.facets.size());
  ASSERT_EQ(from.vertices.size(), surface.mesh.vertices.size());
  size_t num_new = 0;
  for (size_t i = 0; i < from.vertices.size(); ++i) {
    const uint32_t source = from.vertices[i][0];
    num_new += source == kNone ? 1 : 0;
    EXPECT_EQ(surface.attributes.confidences[i], source == kNone ? 0 : 1);
  }
  EXPECT_GT(num_new, 0u);
}

TEST(FinishRepair, LeavesFixedFacetsAndSoundMeshes) {
  Random random(3);
  TriangleMesh mesh = WithNoise(MakeBumpySphere(0.14f, 0), 0.084f, &random);
  size_t num_pairs = RepairSelfIntersections(&mesh).num_after;
  Surface fixed = MakeSurface(mesh);
  fixed.fixed_sources =
      SourcesOf(FixedVertices(mesh.vertices.size(), 1), mesh.vertices.size());
  EXPECT_EQ(FinishRepair(&num_pairs, &fixed), IdentityOf(mesh));
  EXPECT_EQ(fixed.mesh, mesh);
  Surface flat = MakeSurface(kFlat);
  num_pairs = 0;
  EXPECT_EQ(FinishRepair(&num_pairs, &flat), IdentityOf(kFlat));
  EXPECT_EQ(flat.mesh, kFlat);
}

TEST(RepairSelfIntersections, IsTheSameForAnyNumberOfThreads) {
  Random random(4);
  const TriangleMesh mesh = WithNoise(MakeRoundTorus(0.08f), 0.048f, &random);
  ExpectSameForAnyThreads([&] {
    TriangleMesh repaired = mesh;
    EXPECT_GT(Repair(&repaired).max_motion, 0);
    return repaired;
  });
}

}  // namespace colmap_ext::self_intersection_repair_test
