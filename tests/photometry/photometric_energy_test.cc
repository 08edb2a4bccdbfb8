#include <algorithm>
#include <array>
#include <cmath>
#include <numeric>
#include <vector>

#include <gtest/gtest.h>
#include <tbb/global_control.h>
#include <Eigen/Eigenvalues>

#include "photometry/photometric_energy.h"
#include "raster/facet_id_buffer.h"
#include "raster/visibility_buffers.h"
#include "tests/refine/refinement_scene.h"

namespace colmap_ext::photometric_energy_test {

using Eigen::Vector3d;

const RefinementScene& Scene() {
  static const RefinementScene scene = MakeRefinementScene();
  return scene;
}

// As most tests compare it: the truth moved by noise, each facet by all of some
// pairs.
struct CpuPhotometricEnergyTest : testing::Test {
  FacetLabels Label(const std::vector<ViewPair>& pairs) const {
    return LabelAll(pairs, mesh_.facets.size());
  }

  FacetLabels LabelHalf(const std::vector<ViewPair>& pairs) const {
    return LabelWhere(pairs, mesh_.facets.size(), [this](size_t facet) {
      return facet < mesh_.facets.size() / 2;
    });
  }

  // Of drawn meshes.
  static PhotometricTerms Evaluate(
      const TriangleMesh& mesh, const FacetLabels& labels,
      const std::shared_ptr<ImagePyramid>& images = Scene().Pyramid(),
      size_t max_memory = SIZE_MAX) {
    const auto energy = MakeCpuPhotometricEnergy({}, images, max_memory);
    energy->Render(mesh);
    return energy->Evaluate(mesh, labels);
  }

  void ExpectGradient(const PhotometricOptions& options,
                      const std::vector<ViewPair>& pairs) const;

  const TriangleMesh mesh_ = Scene().Perturbed(0.3);
  const size_t num_pixels_ =  // of an image
      size_t{1} * Scene().Views()[0].width * Scene().Views()[0].height;
  const std::unique_ptr<PhotometricEnergy> energy_ =
      MakeCpuPhotometricEnergy({}, Scene().Pyramid(), SIZE_MAX);
};

// dE / dV, [V].
std::vector<Vector3d> Gradient(const TriangleMesh& mesh,
                               const PhotometricTerms& terms) {
  const std::vector<FacetFrame> frames = ComputeFacetFrames(mesh);
  std::vector<Vector3d> gradient(mesh.vertices.size(), Vector3d::Zero());
  for (size_t i = 0; i < mesh.facets.size(); ++i) {
    for (int k = 0; k < 3; ++k) {
      gradient[mesh.facets[i][k]] +=
          terms.facets[i].slopes[k] * frames[i].normal;
    }
  }
  return gradient;
}

Vector3d NumericGradient(const TriangleMesh& mesh, uint32_t vertex,
                         const FacetLabels& labels, PhotometricEnergy* energy) {
  const float step = 0.01F * Scene().dense.scene.footprint;
  Vector3d gradient;
  for (int axis = 0; axis < 3; ++axis) {
    TriangleMesh moved = mesh;
    moved.vertices[vertex][axis] += step;
    const double upper = moved.vertices[vertex][axis];
    const double above = energy->Evaluate(moved, labels).energy;
    moved.vertices[vertex][axis] = mesh.vertices[vertex][axis] - step;
    const double lower = moved.vertices[vertex][axis];
    const double below = energy->Evaluate(moved, labels).energy;
    gradient[axis] = (above - below) / (upper - lower);
  }
  return gradient;
}

// At vertices from the steepest one down to those with a tenth of its slope.
void CpuPhotometricEnergyTest::ExpectGradient(
    const PhotometricOptions& options,
    const std::vector<ViewPair>& pairs) const {
  constexpr int kNumVertices = 12;
  const auto energy =
      MakeCpuPhotometricEnergy(options, Scene().Pyramid(), SIZE_MAX);
  energy->Render(mesh_);
  const FacetLabels labels = Label(pairs);
  const std::vector<Vector3d> gradient =
      Gradient(mesh_, energy->Evaluate(mesh_, labels));
  std::vector<uint32_t> order = Iota(mesh_.vertices.size());
  std::ranges::sort(order, [&](uint32_t a, uint32_t b) {
    return gradient[a].norm() > gradient[b].norm();
  });
  size_t num_steep = 0;
  while (gradient[order[num_steep]].norm() > 0.1 * gradient[order[0]].norm()) {
    ++num_steep;
  }
  ASSERT_GT(num_steep, 2 * kNumVertices);
  std::vector<double> ratios;
  for (int i = 0; i < kNumVertices; ++i) {
    const uint32_t vertex = order[i * num_steep / kNumVertices];
    const Vector3d numeric =
        NumericGradient(mesh_, vertex, labels, energy.get());
    EXPECT_GT(numeric.dot(gradient[vertex]),
              0.99 * numeric.norm() * gradient[vertex].norm())
        << "vertex " << vertex;
    ratios.push_back(gradient[vertex].norm() / numeric.norm());
    EXPECT_NEAR(ratios.back(), 1, 0.1) << "vertex " << vertex;
  }
  // Within 2 % but for one vertex, whose difference quotient may run over the
  // border between two pixels.
  std::ranges::sort(ratios, [](double a, double b) {
    return std::abs(a - 1) < std::abs(b - 1);
  });
  EXPECT_NEAR(ratios[kNumVertices - 2], 1, 0.02);
}

TEST_F(CpuPhotometricEnergyTest, GradientIsThatOfFiniteDifferences) {
  ExpectGradient({}, {{0, 1}});
  ExpectGradient({}, {{0, 1}, {0, 7}, {1, 2}});
  ExpectGradient({.residual_floor = 1000}, {{0, 1}});  // as in the paper
  for (const int radius : {1, 3}) {
    ExpectGradient({.window_radius = radius, .occlusion_masking = radius == 1},
                   {{1, 2}});
  }
}

TEST_F(CpuPhotometricEnergyTest, IsLowestNearTheTruth) {
  double last = -INFINITY;
  for (const float pixels : {0.0F, 0.25F, 0.5F, 1.0F}) {
    const TriangleMesh mesh = Scene().Perturbed(pixels);
    const double value =
        Evaluate(mesh, LabelAll({{0, 1}}, mesh.facets.size())).energy;
    EXPECT_GT(value, last) << pixels;
    last = value;
  }
}

// Pairs that are compared in both directions add what each of them says.
TEST_F(CpuPhotometricEnergyTest, DirectionsAddUp) {
  energy_->Render(mesh_);
  FacetLabels labels = Label({{0, 1}, {0, 7}});
  const PhotometricTerms both = energy_->Evaluate(mesh_, labels);
  labels.directions.assign(labels.labels.values.size(), kInFirst);
  const PhotometricTerms first = energy_->Evaluate(mesh_, labels);
  labels.directions.assign(labels.labels.values.size(), kInSecond);
  const PhotometricTerms second = energy_->Evaluate(mesh_, labels);
  EXPECT_LT(first.energy, 0);
  EXPECT_LT(second.energy, 0);
  for (size_t i = 0; i < mesh_.facets.size(); ++i) {
    EXPECT_EQ(first.facets[i].num_pixels + second.facets[i].num_pixels,
              both.facets[i].num_pixels);
    EXPECT_NEAR(first.facets[i].energy + second.facets[i].energy,
                both.facets[i].energy, 1e-5 * std::abs(both.facets[i].energy));
    EXPECT_NEAR(first.facets[i].curvatures[0] + second.facets[i].curvatures[0],
                both.facets[i].curvatures[0],
                1e-5 * both.facets[i].curvatures[0]);
  }
}

TEST_F(CpuPhotometricEnergyTest, SaysNothingOfFacetsWithoutLabel) {
  const size_t num_labeled = mesh_.facets.size() / 2;
  const PhotometricTerms terms = Evaluate(mesh_, LabelHalf({{0, 1}}));
  size_t num_seen = 0;
  for (size_t i = 0; i < mesh_.facets.size(); ++i) {
    if (i < num_labeled) {
      num_seen += terms.facets[i].num_pixels > 0 ? 1 : 0;
      continue;
    }
    EXPECT_TRUE(terms.facets[i] == FacetTerms());
  }
  EXPECT_GT(num_seen, num_labeled / 10);
}

// A triangle close before the second camera hides everything from it.
TEST_F(CpuPhotometricEnergyTest, SaysNothingOfHiddenFacets) {
  TriangleMesh mesh = Scene().Truth();
  const size_t num_facets = mesh.facets.size();
  const View& view = Scene().Views()[1];
  const Eigen::Matrix3d to_world = view.cam_from_world_rotation.transpose();
  const auto first = static_cast<uint32_t>(mesh.vertices.size());
  for (const Vector3d& corner :
       {Vector3d(-9, -9, 1), Vector3d(20, -9, 1), Vector3d(-9, 20, 1)}) {
    mesh.vertices.push_back(
        (view.Center() + to_world * (0.1 * corner)).cast<float>());
  }
  mesh.facets.push_back({first, first + 2, first + 1});
  const PhotometricTerms terms =
      Evaluate(mesh, LabelAll({{0, 1}}, mesh.facets.size()));
  for (size_t i = 0; i < num_facets; ++i) {
    EXPECT_TRUE(terms.facets[i] == FacetTerms());
  }
}

TEST_F(CpuPhotometricEnergyTest, SecondDerivativesAreNotNegative) {
  const PhotometricTerms terms = Evaluate(mesh_, Label({{0, 1}}));
  for (const FacetTerms& facet : terms.facets) {
    const auto& [aa, ab, ac, bb, bc, cc] = facet.curvatures;
    Eigen::Matrix3d matrix;
    matrix << aa, ab, ac, ab, bb, bc, ac, bc, cc;
    const Eigen::SelfAdjointEigenSolver<Eigen::Matrix3d> solver(matrix);
    EXPECT_GE(solver.eigenvalues()[0], -1e-5 * solver.eigenvalues()[2]);
  }
}

TEST_F(CpuPhotometricEnergyTest, DependsNeitherOnThreadsNorOnMemory) {
  const FacetLabels labels = Label({{0, 1}, {2, 3}, {2, 4}});
  const auto evaluate = [&](int num_threads, size_t max_memory) {
    const tbb::global_control control(
        tbb::global_control::max_allowed_parallelism, num_threads);
    return Evaluate(mesh_, labels, Scene().Pyramid(max_memory), max_memory);
  };
  const PhotometricTerms terms = evaluate(1, SIZE_MAX);
  EXPECT_TRUE(evaluate(2, SIZE_MAX) == terms);
  EXPECT_TRUE(evaluate(3, SIZE_MAX) == terms);
  EXPECT_TRUE(evaluate(2, 1) == terms);
}

// \param num_reads  goes up by one with each image that is read.
std::shared_ptr<ImagePyramid> CountingPyramid(size_t max_memory,
                                              size_t max_borrowed,
                                              size_t* num_reads) {
  return std::make_shared<ImagePyramid>(
      Scene().Views(),
      [num_reads](size_t view) {
        ++*num_reads;
        return Scene().images[view];
      },
      max_memory, ReadGrayImage(), max_borrowed);
}

// Views are compared with their neighbours, in turn: room for three of them
// does, in images and in buffers.
TEST_F(CpuPhotometricEnergyTest, ReadsImagesOnceAnEvaluationWhereNeighborsFit) {
  const FacetLabels labels = Label(Scene().Labels(1).pairs);
  size_t num_reads = 0;
  const tbb::global_control control(
      tbb::global_control::max_allowed_parallelism, 1);
  const auto energy = MakeCpuPhotometricEnergy(
      {}, CountingPyramid(3 * num_pixels_, 0, &num_reads),
      3 * (8 * num_pixels_ + mesh_.facets.size() / 8));
  energy->Render(mesh_);
  for (size_t i = 1; i <= 3; ++i) {
    energy->Evaluate(mesh_, labels);
    EXPECT_LE(num_reads, i * Scene().Views().size());
  }
}

// Memory that the images borrow is not the visibility buffers'.
TEST_F(CpuPhotometricEnergyTest, LendsMemoryToImages) {
  const FacetLabels labels = Label({{0, 1}, {2, 3}});
  std::array<size_t, 2> num_reads = {0, 0};
  std::vector<PhotometricTerms> terms;
  const tbb::global_control control(
      tbb::global_control::max_allowed_parallelism, 1);
  for (const size_t i : {0, 1}) {
    const auto energy = MakeCpuPhotometricEnergy(
        {},
        CountingPyramid(num_pixels_, i * Scene().Views().size() * num_pixels_,
                        &num_reads[i]),
        num_pixels_);
    energy->Render(mesh_);
    terms.push_back(energy->Evaluate(mesh_, labels));
    energy->Evaluate(mesh_, labels);
  }
  EXPECT_TRUE(terms[1] == terms[0]);
  EXPECT_EQ(num_reads[1], 4);
  EXPECT_GE(num_reads[0], 8);
}

// Subdivision and labelling have drawn the mesh before Render() is called.
TEST_F(CpuPhotometricEnergyTest, TakesOverDrawingsOfTheSameMeshOnly) {
  const auto buffers = energy_->Visibility(mesh_);
  energy_->Render(mesh_);
  EXPECT_EQ(energy_->Visibility(mesh_), buffers);
  TriangleMesh moved = mesh_;
  moved.vertices.back().x() += Scene().dense.scene.footprint;
  EXPECT_NE(energy_->Visibility(moved), buffers);
  energy_->SetLevel(0);
  const auto full_size = energy_->Visibility(mesh_);
  energy_->SetLevel(1);
  EXPECT_NE(energy_->Visibility(mesh_), full_size);
  EXPECT_EQ(energy_->Visibility(mesh_)->Views()[0].width,
            (Scene().Views()[0].width + 1) / 2);
}

// What is found out about labels is not taken for other ones.
TEST_F(CpuPhotometricEnergyTest, LabelsMayChangeFromOneEvaluationToTheNext) {
  const std::vector<FacetLabels> all_labels = {Label({{0, 1}}), Label({{2, 3}}),
                                               LabelHalf({{0, 1}}),
                                               Label({{0, 1}, {2, 3}})};
  std::vector<PhotometricTerms> expected;
  for (const FacetLabels& labels : all_labels) {
    expected.push_back(Evaluate(mesh_, labels));
  }
  energy_->Render(mesh_);
  for (const size_t i : {0, 0, 1, 2, 3, 2, 0}) {
    EXPECT_TRUE(energy_->Evaluate(mesh_, all_labels[i]) == expected[i]);
  }
  EXPECT_NE(expected[0].energy, expected[1].energy);
}

TEST_F(CpuPhotometricEnergyTest, IsTheSameWhateverTheLevelsOrder) {
  const TriangleMesh& mesh = Scene().Truth();
  const FacetLabels labels = LabelAll({{0, 1}}, mesh.facets.size());
  energy_->Render(mesh);
  const PhotometricTerms full = energy_->Evaluate(mesh, labels);
  energy_->SetLevel(1);
  energy_->Render(mesh);
  const PhotometricTerms half = energy_->Evaluate(mesh, labels);
  const auto num_pixels = [](const PhotometricTerms& terms) {
    return std::accumulate(terms.facets.begin(), terms.facets.end(), 0.0,
                           [](double sum, const FacetTerms& facet) {
                             return sum + facet.num_pixels;
                           });
  };
  EXPECT_NEAR(num_pixels(half), num_pixels(full) / 4, 0.1 * num_pixels(half));
  energy_->SetLevel(0);
  energy_->Render(mesh);
  EXPECT_TRUE(energy_->Evaluate(mesh, labels) == full);
}

// The upper half of the first image.
GrayImage UpperHalfMask(size_t view) {
  if (view != 0) {
    return {};
  }
  GrayImage mask = Scene().images[0];
  std::ranges::fill(mask.pixels, 255);
  std::fill_n(mask.pixels.begin(), mask.height / 2 * mask.width, 0);
  return mask;
}

// The scene's images with other pixels under the mask, away from its border,
// which sampling between pixels reaches.
std::shared_ptr<ImagePyramid> MaskedPyramid(bool is_painted_over) {
  const auto read = [is_painted_over](size_t view) {
    GrayImage image = Scene().images[view];
    if (is_painted_over && view == 0) {
      const auto end =
          static_cast<ptrdiff_t>(image.height / 2 - 3) * image.width;
      std::iota(image.pixels.begin(), image.pixels.begin() + end, uint8_t{1});
    }
    return image;
  };
  return std::make_shared<ImagePyramid>(Scene().Views(), read, SIZE_MAX,
                                        &UpperHalfMask);
}

TEST_F(CpuPhotometricEnergyTest, MaskedPixelsAreNotCompared) {
  const FacetLabels labels = Label({{0, 1}});
  const PhotometricTerms whole = Evaluate(mesh_, labels);
  const PhotometricTerms masked = Evaluate(mesh_, labels, MaskedPyramid(false));
  EXPECT_TRUE(masked == Evaluate(mesh_, labels, MaskedPyramid(true)));
  double num_whole = 0;
  double num_masked = 0;
  for (size_t i = 0; i < mesh_.facets.size(); ++i) {
    EXPECT_LE(masked.facets[i].num_pixels, whole.facets[i].num_pixels);
    num_whole += whole.facets[i].num_pixels;
    num_masked += masked.facets[i].num_pixels;
  }
  EXPECT_LT(num_masked, 0.95 * num_whole);
  EXPECT_GT(num_masked, 0.1 * num_whole);
}

TEST_F(CpuPhotometricEnergyTest, FacetsAreNotSeenInMaskedPixels) {
  const auto energy =
      MakeCpuPhotometricEnergy({}, MaskedPyramid(false), SIZE_MAX);
  const TriangleMesh mesh = Scene().Truth();
  const View& view = Scene().Views()[0];
  const FacetVisibility visibility =
      FindVisibleFacets(*energy->Visibility(mesh));
  size_t num_seen = 0;
  for (size_t i = 0; i < mesh.facets.size(); ++i) {
    if (visibility[i].empty() || visibility[i][0] != 0) {
      continue;
    }
    ++num_seen;
    const Vector3d centroid = CentroidOf(mesh, mesh.facets[i]).cast<double>();
    EXPECT_GE(view.ImageFromCam(view.CamFromWorld(centroid)).y(),
              view.height / 2);
  }
  EXPECT_GT(num_seen, 10u);
}

TEST_F(CpuPhotometricEnergyTest, ComparesWallsThatReachBehindTheCameras) {
  const RefinementScene scene = MakeRoomScene(3);
  const TriangleMesh& room = scene.Truth();
  const PhotometricTerms terms =
      Evaluate(room, LabelAll({{0, 1}}, room.facets.size()), scene.Pyramid());
  const auto clipped = DrawFacets(scene.Views()[0], room, 0.1).clipped;
  float num_pixels = 0;
  for (const uint32_t facet : clipped) {
    num_pixels += terms.facets[facet].num_pixels;
    EXPECT_TRUE(std::isfinite(terms.facets[facet].energy));
    if (terms.facets[facet].weight > 0) {
      EXPECT_GT(
          MeanZncc(terms.facets[facet].energy, terms.facets[facet].weight, {}),
          0.9);
    }
  }
  EXPECT_GT(num_pixels, 1000);
}

}  // namespace colmap_ext::photometric_energy_test
