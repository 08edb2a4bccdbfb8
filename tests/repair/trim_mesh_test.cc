#include "repair/borders.h"

#include <algorithm>
#include <cmath>

#include <gtest/gtest.h>

#include "mesh/adjacency.h"
#include "mesh/normals.h"
#include "mesh/topology.h"
#include "spatial/self_intersections.h"
#include "tests/mesh/known_meshes.h"
#include "tests/threads.h"

namespace colmap_ext::trim_mesh_test {

float Height(const TriangleMesh& mesh, const Facet& facet) {
  return CentroidOf(mesh, facet).z();
}

// [F] 1 where is_sure(centroid) holds, else 0.
template <typename IsSure>
std::vector<float> SureWhere(const TriangleMesh& mesh, const IsSure& is_sure) {
  std::vector<float> confidences;
  for (const Facet& facet : mesh.facets) {
    confidences.push_back(is_sure(CentroidOf(mesh, facet)) ? 1.0f : 0.0f);
  }
  return confidences;
}

std::vector<float> SureBelow(const TriangleMesh& mesh, float height) {
  return SureWhere(mesh, [&](const auto& p) { return p.z() < height; });
}

// Whether a point is near the upper end of the z axis.
bool IsOnTop(const Eigen::Vector3f& point, float radius) {
  return point.z() > 0 && point.head<2>().norm() < radius;
}

std::vector<float> RandomConfidences(const TriangleMesh& mesh, double share_low,
                                     Random* random) {
  return SureWhere(mesh,
                   [&](const auto&) { return !random->Chance(share_low); });
}

// Trims a mesh and checks what holds for every mesh.
TrimmedMesh Trim(const TriangleMesh& mesh,
                 const std::vector<float>& confidences, float gap_width = 0.1f,
                 double min_confidence = 0.5) {
  const TrimmedMesh trimmed =
      TrimMesh(min_confidence, mesh, confidences,
               std::vector<float>(mesh.vertices.size(), gap_width));
  EXPECT_EQ(Analyze(trimmed.mesh).Defects(), "");
  EXPECT_EQ(trimmed.from.vertices.size(), trimmed.mesh.vertices.size());
  EXPECT_EQ(trimmed.from.facets.size(), trimmed.mesh.facets.size());
  EXPECT_TRUE(std::ranges::is_sorted(trimmed.from.facets));
  for (size_t i = 0; i < trimmed.mesh.facets.size(); ++i) {
    for (int k = 0; k < 3; ++k) {
      const auto& [a, b] = trimmed.from.vertices[trimmed.mesh.facets[i][k]];
      EXPECT_EQ(a, mesh.facets[trimmed.from.facets[i]][k]);
      EXPECT_EQ(b, a);
    }
  }
  const TrimReport& report = trimmed.report;
  EXPECT_EQ(mesh.facets.size() - trimmed.mesh.facets.size(), report.num_facets);
  EXPECT_GE(report.num_facets, report.num_leftover_facets);
  return trimmed;
}

TEST(TrimMesh, LeavesWhatIsConfidentAsItIs) {
  const TriangleMesh mesh = MakeBumpySphere(0.2f);
  const std::vector<float> confidences(mesh.facets.size(), 0.3f);
  for (const double min_confidence : {0.0, 0.2, 0.3}) {
    const TrimmedMesh trimmed = Trim(mesh, confidences, 0.1f, min_confidence);
    EXPECT_EQ(trimmed.mesh, mesh);
  }
}

TEST(TrimMesh, DropsAMembrane) {
  const TriangleMesh mesh = MakeBumpySphere(0.1f);
  const TrimmedMesh trimmed = Trim(mesh, SureBelow(mesh, 0.5f));
  EXPECT_EQ(Analyze(trimmed.mesh).num_border_loops, 1);
  for (const Facet& facet : trimmed.mesh.facets) {
    EXPECT_LT(Height(trimmed.mesh, facet), 0.55);
  }
}

TEST(TrimMesh, MovesNothingButTheBorderThatItOpens) {
  const TriangleMesh mesh = MakeBumpyCap(0.1f);
  const TrimmedMesh trimmed = Trim(mesh, SureBelow(mesh, 0.6f));
  EXPECT_EQ(Analyze(trimmed.mesh).num_border_loops, 2);
  size_t num_moved = 0;
  for (size_t i = 0; i < trimmed.mesh.vertices.size(); ++i) {
    const Eigen::Vector3f& before = mesh.vertices[trimmed.from.vertices[i][0]];
    if (trimmed.mesh.vertices[i] != before) {
      ++num_moved;
      EXPECT_GT(before.z(), 0.4);
    }
  }
  EXPECT_GT(num_moved, 10);
}

TEST(TrimMesh, KeepsSpecksWithinGoodSurface) {
  const TriangleMesh mesh = MakeBumpySphere(0.1f);
  std::vector<float> confidences(mesh.facets.size(), 1);
  for (size_t i = 0; i < confidences.size(); i += 97) {
    confidences[i] = 0;
  }
  const TrimmedMesh trimmed = Trim(mesh, confidences);
  EXPECT_EQ(trimmed.mesh.facets, mesh.facets);
  EXPECT_EQ(trimmed.report.num_kept_facets, (confidences.size() + 96) / 97);
}

TEST(TrimMesh, KeepsGapsUpToTwiceTheWidth) {
  const TriangleMesh mesh = MakeBumpySphere(0.05f);
  for (const float radius : {0.15f, 0.3f}) {
    const std::vector<float> confidences =
        SureWhere(mesh, [&](const auto& p) { return !IsOnTop(p, radius); });
    EXPECT_EQ(Trim(mesh, confidences, 1.5f * radius).mesh, mesh);
    size_t num_facets = 0;
    // With a quarter of the radius and more it is a hollow.
    for (const float gap_width : {0.0f, 0.1f * radius, 0.2f * radius}) {
      const TrimmedMesh trimmed = Trim(mesh, confidences, gap_width);
      EXPECT_LT(trimmed.mesh.facets.size(), mesh.facets.size());
      EXPECT_GE(trimmed.mesh.facets.size(), num_facets);
      num_facets = trimmed.mesh.facets.size();
    }
  }
}

TEST(TrimMesh, KeepsHollowsAsLargeAsADiskOfFourGapWidths) {
  const TriangleMesh mesh = MakeBumpySphere(0.05f);
  const auto is_sure = [](const auto& p) { return !IsOnTop(p, 0.4f); };
  EXPECT_EQ(Trim(mesh, SureWhere(mesh, is_sure), 0.13f).mesh, mesh);
  EXPECT_NE(Trim(mesh, SureWhere(mesh, is_sure), 0.08f).mesh, mesh);
  TriangleMesh open = mesh;  // the same region, but around a border
  std::erase_if(open.facets, [&](const Facet& facet) {
    return IsOnTop(CentroidOf(open, facet), 0.1f);
  });
  EXPECT_NE(Trim(open, SureWhere(open, is_sure), 0.13f).mesh, open);
}

TEST(TrimMesh, DropsShreds) {
  const TriangleMesh sheet =
      MakeHeightField(40, [](float, float) { return 0.0f; });
  // A strip reaches out of the part that is sure.
  for (const float half_width : {2.0f, 10.0f}) {
    const auto is_sure = [=](const auto& p) {
      return p.x() < 10 || (p.x() < 32 && std::abs(p.y() - 20) < half_width);
    };
    const TrimmedMesh trimmed = Trim(sheet, SureWhere(sheet, is_sure), 8);
    float end = 0;
    for (const Facet& facet : trimmed.mesh.facets) {
      end = std::max(end, CentroidOf(trimmed.mesh, facet).x());
    }
    EXPECT_NEAR(end, half_width < 4 ? 10 : 32, 7);
  }
}

TEST(TrimMesh, KeepsStripsThatConnectWhatIsConfident) {
  const TriangleMesh mesh = MakeBumpySphere(0.05f);
  const std::vector<float> confidences =
      SureWhere(mesh, [](const auto& p) { return std::abs(p.z()) > 0.1f; });
  EXPECT_EQ(Trim(mesh, confidences, 0.2f).mesh, mesh);
  EXPECT_EQ(Analyze(Trim(mesh, confidences, 0.05f).mesh).num_components, 2);
}

TEST(TrimMesh, KeepsNoWebsInCorners) {
  TriangleMesh mesh = MakeBumpySphere(0.05f);
  std::erase_if(mesh.facets, [&](const Facet& facet) {
    return CentroidOf(mesh, facet).minCoeff() > 0.5f;  // else it is a hollow
  });
  const std::vector<float> confidences =
      SureWhere(mesh, [](const auto& p) { return p.minCoeff() < 0; });
  const TrimmedMesh trimmed = Trim(mesh, confidences, 0.5f);
  for (const uint32_t facet : trimmed.from.facets) {
    // The plain closing of an octant ends at 0.15 in its corners.
    EXPECT_LT(CentroidOf(mesh, mesh.facets[facet]).minCoeff(), 0.1);
  }
  EXPECT_GT(trimmed.report.num_kept_facets, 0);  // ragged borders are filled
}

TEST(TrimMesh, AddsNothingAlongTheBorder) {
  const TriangleMesh mesh = MakeBumpyCap(0.05f);  // ends at -0.3
  const std::vector<float> confidences =
      SureWhere(mesh, [](const auto& p) { return p.z() > -0.2f; });
  const TrimmedMesh trimmed = Trim(mesh, confidences, 0.3f);
  for (const Facet& facet : trimmed.mesh.facets) {
    EXPECT_GT(Height(trimmed.mesh, facet), -0.23);
  }
  EXPECT_EQ(Analyze(trimmed.mesh).num_border_loops, 1);
}

// How many of the facets without confidence a trimming of a sheet keeps.
template <typename Height, typename IsLow>
size_t NumKept(const Height& height, const IsLow& is_low) {
  const TriangleMesh sheet = MakeHeightField(40, height);
  const auto is_sure = [&](const auto& p) { return !is_low(p); };
  return Trim(sheet, SureWhere(sheet, is_sure), 1).report.num_kept_facets;
}

TEST(TrimMesh, KeepsWhatContinuesTheSurface) {
  const auto flat = [](float x, float y) { return 0.1f * x + 0.2f * y; };
  const auto is_inside = [](const auto& p) {
    return std::hypot(p.x() - 20, p.y() - 20) < 10;
  };
  const size_t num_low = 628;  // 2 facets a quad
  EXPECT_NEAR(NumKept(flat, is_inside), num_low, 20);
  // The same facets as the lid of a box, and as a dome.
  const auto box = [](float x, float y) {
    return std::hypot(x - 20, y - 20) < 10.5f ? 9.0f : 0.0f;
  };
  EXPECT_EQ(NumKept(box, is_inside), 0);
  const auto dome = [](float x, float y) {
    return std::sqrt(
        std::max(0.0f, 144 - std::pow(x - 20, 2.0f) - std::pow(y - 20, 2.0f)));
  };
  EXPECT_EQ(NumKept(dome, is_inside), 0);
  // Walls rise from a quarter or three quarters of the rim.
  for (const bool is_quarter : {true, false}) {
    const auto walls = [=](float x, float y) {
      const bool is_beyond = std::hypot(x - 20, y - 20) > 10.8f;
      const bool is_wall = is_quarter ? x > 20 && y > 20 : x > 20 || y > 20;
      return is_beyond && is_wall ? 9.0f : 0.0f;
    };
    EXPECT_NEAR(NumKept(walls, is_inside), is_quarter ? num_low : 0, 20);
  }
  // Both sides of a ridge; and a lawn, but not the tent that rises from it.
  const auto ridge = [](float x, float) { return std::abs(x - 20); };
  EXPECT_NEAR(NumKept(ridge, is_inside), num_low, 20);
  const auto is_tent = [](const auto& p) {
    return std::abs(p.x() - 20) < 8 && std::abs(p.y() - 20) < 10;
  };
  const auto tent = [](float x, float y) {
    return std::abs(x - 20) < 7.5f && y < 30 ? std::max(0.0f, y - 20) : 0.0f;
  };
  EXPECT_NEAR(NumKept(tent, is_tent), 320, 4);  // but for its corners
  // A bay at the border, and a strip that has more border than rim.
  const auto is_bay = [](const auto& p) {
    return p.x() < 20 && std::abs(p.y() - 20) < 6;
  };
  EXPECT_EQ(NumKept(flat, is_bay), 480);
  const auto is_strip = [](const auto& p) { return p.x() < 12; };
  EXPECT_EQ(NumKept(flat, is_strip), 0);
}

TEST(TrimMesh, DropsIslandsWithinAMembrane) {
  const TriangleMesh mesh = MakeBumpySphere(0.1f);
  const std::vector<float> confidences = SureWhere(
      mesh, [](const auto& p) { return p.z() < 0 || IsOnTop(p, 0.15f); });
  const TrimmedMesh trimmed = Trim(mesh, confidences, 0.2f);
  EXPECT_GT(trimmed.report.num_leftover_facets, 0);
  for (const Facet& facet : trimmed.mesh.facets) {
    EXPECT_LT(Height(trimmed.mesh, facet), 0.1);
  }
}

TEST(TrimMesh, KeepsPiecesThatAreMoreThanBorder) {
  const TriangleMesh mesh = MakeBumpySphere(0.05f);
  const std::vector<float> confidences =
      SureWhere(mesh, [](const auto& p) { return p.z() < 0 || p.z() > 0.5f; });
  const TrimmedMesh trimmed = Trim(mesh, confidences);
  EXPECT_EQ(Analyze(trimmed.mesh).num_components, 2);
}

TEST(TrimMesh, DropsSmallPiecesButTheLargest) {
  const TriangleMesh sphere = MakeBumpySphere(0.2f);
  const size_t num_facets = sphere.facets.size();
  const TriangleMesh mesh =
      Union(sphere, Shifted(Scaled(sphere, 0.2f), {3, 0, 0}));
  std::vector<float> confidences(mesh.facets.size(), 1);
  // The smaller sphere has the area of a disk of the radius 0.4.
  EXPECT_EQ(Trim(mesh, confidences, 0.3f).mesh, mesh);
  EXPECT_EQ(Trim(mesh, confidences, 0.6f).mesh.facets.size(), num_facets);
  EXPECT_EQ(Trim(mesh, confidences, 10).mesh.facets.size(), num_facets);
  // With less confidence it counts as one of the radius 0.6 x 0.4.
  std::fill(confidences.begin() + static_cast<ptrdiff_t>(num_facets),
            confidences.end(), 0.6f);
  EXPECT_EQ(Trim(mesh, confidences, 0.2f).mesh, mesh);
  EXPECT_EQ(Trim(mesh, confidences, 0.3f).mesh.facets.size(), num_facets);
  // So it does where views see it from behind, too; nothing else is dropped.
  const auto trim = [&](float gap_width) {
    return TrimMesh(0.5, mesh, std::vector<float>(mesh.facets.size(), 1),
                    std::vector<float>(mesh.vertices.size(), gap_width),
                    /*front_shares=*/confidences)
        .mesh;
  };
  EXPECT_EQ(trim(0.2f), mesh);
  EXPECT_EQ(trim(0.3f).facets.size(), num_facets);
  std::ranges::fill(confidences, 0.1f);
  EXPECT_EQ(trim(0.1f).facets.size(), num_facets);
}

TEST(TrimMesh, DropsEverythingWhereNothingIsConfident) {
  for (const TriangleMesh& mesh : {MakeBumpyCap(0.2f), MakeBumpySphere(0.2f)}) {
    const TrimmedMesh trimmed =
        Trim(mesh, std::vector<float>(mesh.facets.size(), 0));
    EXPECT_TRUE(trimmed.mesh.facets.empty());
    EXPECT_TRUE(trimmed.mesh.vertices.empty());
  }
}

TEST(TrimMesh, IsManifoldWhateverItGets) {
  Random random(1);
  for (int trial = 0; trial < 60; ++trial) {
    const TriangleMesh mesh =
        trial % 3 == 0 ? MakeBumpySphere(0.15f) : MakeRandomManifold(&random);
    Trim(mesh, RandomConfidences(mesh, 0.7 * random.Unit(), &random),
         static_cast<float>(0.3 * random.Unit()));
  }
}

TEST(TrimMesh, IsTheSameAtAnyNumberOfThreads) {
  Random random(2);
  const TriangleMesh mesh = MakeBumpySphere(0.05f);
  const std::vector<float> confidences = RandomConfidences(mesh, 0.45, &random);
  ExpectSameForAnyThreads([&] { return Trim(mesh, confidences).mesh; });
}

double BorderLength(const TriangleMesh& mesh) {
  const std::vector<uint32_t> partners = PairHalfEdges(mesh.facets);
  double length = 0;
  for (uint32_t half = 0; half < partners.size(); ++half) {
    if (partners[half] == kNone) {
      length += (mesh.vertices[FromVertex(mesh.facets, half)] -
                 mesh.vertices[ToVertex(mesh.facets, half)])
                    .norm();
    }
  }
  return length;
}

std::vector<uint8_t> BorderHalfEdges(const TriangleMesh& mesh) {
  std::vector<uint8_t> is_border;
  for (const uint32_t partner : PairHalfEdges(mesh.facets)) {
    is_border.push_back(partner == kNone);
  }
  return is_border;
}

TEST(SmoothBorders, EvensOutZigzagsAndTurnsNoFacetOver) {
  Random random(3);
  for (int trial = 0; trial < 10; ++trial) {
    TriangleMesh mesh = MakeBumpySphere(0.1f);
    std::erase_if(mesh.facets, [&](const Facet& facet) {
      return Height(mesh, facet) >= 0.5 + 0.05 * random.Unit();
    });
    const TriangleMesh before = Moved(Trim(mesh, SureBelow(mesh, 0.4f)).mesh,
                                      [&](const auto& p) -> Eigen::Vector3f {
                                        return p + 0.01f * RandomPoint(&random);
                                      });
    TriangleMesh smooth = before;
    SmoothBorders(BorderHalfEdges(smooth), &smooth);
    EXPECT_LT(BorderLength(smooth), BorderLength(before));
    EXPECT_LE(FindSelfIntersections(smooth).size(),
              FindSelfIntersections(before).size());
    for (const Facet& facet : smooth.facets) {
      EXPECT_GE(AreaVector(before, facet).dot(AreaVector(smooth, facet)), 0);
    }
  }
}

TEST(SmoothBorders, LeavesOtherVertices) {
  const TriangleMesh mesh = MakeBumpyCap(0.1f);
  TriangleMesh smooth = mesh;
  SmoothBorders(std::vector<uint8_t>(3 * mesh.facets.size(), 0), &smooth);
  EXPECT_EQ(smooth.vertices, mesh.vertices);
}

}  // namespace colmap_ext::trim_mesh_test
