#include "refine/level_refinement.h"

#include <algorithm>
#include <cmath>
#include <functional>
#include <limits>
#include <numbers>
#include <optional>

#include <gtest/gtest.h>

#include "mesh/adjacency.h"
#include "mesh/normals.h"
#include "raster/facet_id_buffer.h"
#include "refine/smoothness_model.h"
#include "tests/mesh/known_meshes.h"
#include "tests/refine/refinement_scene.h"

namespace colmap_ext::level_refinement_test {

using Eigen::Vector3d;
using Eigen::Vector3f;

constexpr double kFootprint = 0.02;  // of a pixel, about, scene units

// How far a point lies outside of a surface, and which way it is left fastest.
struct SignedDistance {
  double value;
  Vector3d gradient;
};
using Surface = std::function<SignedDistance(const Vector3d& point)>;

// The unit sphere, its radius longer by so many pixels.
Surface Sphere(double pixels = 0) {
  return [pixels](const Vector3d& point) -> SignedDistance {
    return {point.norm() - 1 - pixels * kFootprint, point.normalized()};
  };
}

// \param height  above z = 0, of a point.
template <typename Height>
Surface HeightField(const Height& height) {
  return [height](const Vector3d& point) -> SignedDistance {
    return {point.z() - height(point), Vector3d::UnitZ()};
  };
}

// What pulls a mesh, and what its energy says of itself.
struct Pull {
  Surface surface = Sphere();
  double stiffness = 10;
  float num_pixels = 5;             // of a facet
  double slope_factor = 1;          // what is said of the slopes that they are
  double curvature_factor = 1;      // and of the curvatures
  std::optional<double> zncc = {};  // that the energy is of, whatever the mesh
};

// Pulls a mesh to a known surface: half the squared distances, px^2, at three
// points of each facet.
class PullingEnergy : public PhotometricEnergy {
 public:
  explicit PullingEnergy(Pull pull) : pull_(std::move(pull)) {}

  void SetLevel(int /*level*/) override {}
  void SetViews(std::vector<View> /*views*/) override {}
  std::shared_ptr<const VisibilityBuffers> Visibility(
      const TriangleMesh& /*mesh*/) override {
    return nullptr;
  }
  void Render(const TriangleMesh& /*mesh*/) override { ++num_renders; }
  std::string Description() const override { return "pulls"; }

  PhotometricTerms Evaluate(const TriangleMesh& mesh,
                            const FacetLabels& labels) override {
    EXPECT_GT(num_renders, 0);
    nums_labels.push_back(labels.labels.values.size());
    const size_t size = mesh.facets.size();
    PhotometricTerms terms{0, std::vector<FacetTerms>(size)};
    const std::vector<FacetFrame> frames = ComputeFacetFrames(mesh);
    double weight = 0;
    for (size_t i = 0; i < size; ++i) {
      if (!labels.labels[i].empty()) {
        AddFacet(mesh, i, frames[i].normal, &terms.facets[i]);
      }
      terms.energy += terms.facets[i].energy;
      weight += terms.facets[i].weight;
    }
    if (pull_.zncc) {
      const double s = 1 + PhotometricOptions().residual_floor;
      terms.energy = weight * s * std::log(1 - *pull_.zncc / s);
    }
    return terms;
  }

  int num_renders = 0;
  std::vector<size_t> nums_labels;  // of each evaluation

 private:
  void AddFacet(const TriangleMesh& mesh, size_t facet, const Vector3d& normal,
                FacetTerms* terms) const {
    terms->weight = 1;
    terms->num_pixels = pull_.num_pixels;
    const double factor = pull_.stiffness / (kFootprint * kFootprint);
    const auto [a, b, c] = CornersOf<double>(mesh, mesh.facets[facet]);
    for (int sample = 0; sample < 3; ++sample) {
      Vector3d shares = Vector3d::Constant(1.0 / 6);
      shares[sample] = 2.0 / 3;
      const auto [distance, gradient] =
          pull_.surface(shares[0] * a + shares[1] * b + shares[2] * c);
      const double along = gradient.dot(normal);
      terms->energy += static_cast<float>(factor * distance * distance / 2);
      int at = 0;
      for (int k = 0; k < 3; ++k) {
        terms->slopes[k] += static_cast<float>(pull_.slope_factor * factor *
                                               distance * along * shares[k]);
        for (int l = k; l < 3; ++l) {
          terms->curvatures[at++] +=
              static_cast<float>(pull_.curvature_factor * factor * along *
                                 along * shares[k] * shares[l]);
        }
      }
    }
  }

  Pull pull_;
};

// Seen by both views wherever `is_seen` says so of the facet's first corner.
template <typename Predicate>
FacetLabels LabelWhere(const TriangleMesh& mesh, const Predicate& is_seen) {
  return colmap_ext::LabelWhere(
      {{0, 1}}, mesh.facets.size(), [&](size_t facet) {
        return is_seen(mesh.vertices[mesh.facets[facet][0]]);
      });
}

FacetLabels LabelUpperHalf(const TriangleMesh& mesh) {
  return LabelWhere(mesh,
                    [](const Vector3f& corner) { return corner.z() > 0; });
}

// From afar, so that pixels have the same footprint everywhere.
std::vector<View> FarViews() {
  constexpr double kDistance = 100;
  return {
      LookAt({0, 0, kDistance}, {0, 0, 0}, 500, 500, kDistance / kFootprint),
      LookAt({kDistance, 0, 0}, {0, 0, 0}, 500, 500, kDistance / kFootprint)};
}

struct Refined {
  std::vector<TriangleMesh> meshes;  // at the start and after each step
  std::vector<RefinementStep> steps;
  int num_renders = 0;              // see PullingEnergy
  std::vector<size_t> nums_labels;  // likewise

  const TriangleMesh& Result() const { return meshes.back(); }
};

// \param labels, origins  none: all facets, and the vertices
// \param last  the iteration after which it stops
Refined Refine(FacetwiseRefinementOptions options, int level,
               const TriangleMesh& mesh, const Pull& pull,
               const std::optional<FacetLabels>& labels = {},
               const std::vector<Vector3f>& origins = {},
               int last = std::numeric_limits<int>::max()) {
  options.min_zncc = -1;  // The energies of these tests are no correlations.
  PullingEnergy energy(pull);
  Refined result;
  const RefinedLevel refined = RefineLevel(
      options,
      {level, labels ? *labels : LabelAll({{0, 1}}, mesh.facets.size()),
       FarViews(), origins.empty() ? mesh.vertices : origins},
      mesh, &energy,
      [&](const RefinementStep& step, const TriangleMesh& stepped) {
        result.steps.push_back(step);
        result.meshes.push_back(stepped);
        return step.iteration < last;
      });
  result.num_renders = energy.num_renders;
  result.nums_labels = energy.nums_labels;
  EXPECT_EQ(refined.is_stopped, last < std::numeric_limits<int>::max());
  EXPECT_EQ(refined.mesh.vertices, result.Result().vertices);
  EXPECT_EQ(refined.mesh.facets, mesh.facets);
  return result;
}

FacetwiseRefinementOptions WithoutSmoothness() {
  FacetwiseRefinementOptions options;
  options.smoothness_weight = 0;
  return options;
}

// The unit sphere, or the part of it above z = -0.3, its radius changed by
// smooth waves of so many pixels.
TriangleMesh WavySphere(double pixels, bool is_whole = true) {
  return Moved(is_whole ? MakeBumpySphere(0.13f, 0) : MakeBumpyCap(0.1f, 0),
               [&](const Vector3f& vertex) -> Vector3f {
                 const double wave = (4 * vertex.array()).sin().sum() / 3;
                 return static_cast<float>(1 + pixels * kFootprint * wave) *
                        vertex;
               });
}

// From the vertices to a surface, px, root mean square.
double Error(const TriangleMesh& mesh, const Surface& surface) {
  double sum = 0;
  for (const Vector3f& vertex : mesh.vertices) {
    sum += std::pow(surface(vertex.cast<double>()).value / kFootprint, 2);
  }
  return std::sqrt(sum / static_cast<double>(mesh.vertices.size()));
}

double SphereError(const TriangleMesh& mesh) { return Error(mesh, Sphere()); }

// Half the sum of the squared curvatures, 1 / px^2, where x is below a limit.
double Roughness(const TriangleMesh& mesh, float max_x = 1e9f) {
  const VertexRings rings = MakeVertexRings(mesh);
  const size_t size = mesh.vertices.size();
  std::vector<double> weights(size);
  for (size_t i = 0; i < size; ++i) {
    weights[i] = mesh.vertices[i].x() < max_x ? 1 : 0;
  }
  return MakeThinPlate({mesh.vertices, VertexNormals(mesh, rings), rings,
                        std::vector<float>(size, kFootprint),
                        std::vector<float>(size, 0)},
                       weights, std::vector<double>(size, 0))
      .Energy();
}

// Relief of a third of a pixel; another one for each seed.
double Rubble(const Vector3d& point, int seed = 0) {
  const Vector3d place(point.x(), point.y(), 100 * kFootprint * seed);
  return kFootprint / 3 *
         synthetic::ValueNoise((place / (3 * kFootprint)).cast<float>(), 1);
}

double Relief(const Vector3d& point) {
  return 2 * kFootprint * std::sin(point.x() / (3 * kFootprint)) *
         std::sin(point.y() / (3 * kFootprint));
}

// Of edges of two pixels.
template <typename Height>
TriangleMesh SheetOf(const Height& height) {
  return Moved(MakeSheet(30, 30), [&](const Vector3f& corner) -> Vector3f {
    const Vector3f at = 2 * kFootprint * (corner - Vector3f(15, 15, 0));
    return {at.x(), at.y(), static_cast<float>(height(at.cast<double>()))};
  });
}

TriangleMesh FlatSheet() {
  return SheetOf([](const Vector3d&) { return 0.0; });
}

TriangleMesh RubbleSheet(int seed = 0) {
  return SheetOf([&](const Vector3d& point) { return Rubble(point, seed); });
}

TEST(RefineLevel, FindsTheSurfaceThatItIsPulledTo) {
  const TriangleMesh mesh = WavySphere(2);
  EXPECT_GT(SphereError(mesh), 0.5);
  FacetwiseRefinementOptions options = WithoutSmoothness();
  options.iterations = 30;
  for (const int level : {0, 1}) {
    EXPECT_LT(SphereError(Refine(options, level, mesh, {}).Result()), 0.1);
    const Refined smooth = Refine({}, level, mesh, {});
    EXPECT_LT(SphereError(smooth.Result()), 0.15) << level;
  }
  options.solver = RefinementSolver::kDescent;
  EXPECT_LT(SphereError(Refine(options, 0, mesh, {}).Result()), 0.1);
}

// At level 0 the weight of the smoothness changes from step to step.
TEST(RefineLevel, LowersTheEnergyWithEachStep) {
  const TriangleMesh mesh = WavySphere(2);
  for (const RefinementSolver solver :
       {RefinementSolver::kGaussNewton, RefinementSolver::kDescent}) {
    for (const double curvature_factor : {1.0, 0.1, 10.0}) {
      FacetwiseRefinementOptions options;
      options.solver = solver;
      const std::vector<RefinementStep> steps =
          Refine(options, 1, mesh, {.curvature_factor = curvature_factor})
              .steps;
      ASSERT_GT(steps.size(), 2);
      EXPECT_LE(steps.size(), 1 + options.iterations);
      for (size_t i = 1; i < steps.size(); ++i) {
        EXPECT_LT(steps[i].energy, steps[i - 1].energy);
      }
      EXPECT_LT(steps.back().photometric_energy,
                0.5 * steps.front().photometric_energy);
    }
  }
}

TEST(RefineLevel, TakesAllLabelsInTheLastIterations) {
  const TriangleMesh mesh = WavySphere(2);
  FacetLabels labels{{{0, 1}, {0, 1}, {0, 1}}, {}, {}};
  for (size_t i = 0; i < mesh.facets.size(); ++i) {
    labels.labels.AddRow(std::vector<uint32_t>{2, 0, 1});
  }
  for (const int pairs_per_facet : {1, 2, 3}) {
    FacetwiseRefinementOptions options;
    options.labeling.pairs_per_facet = pairs_per_facet;
    const Refined refined = Refine(options, 0, mesh, {}, labels);
    const std::vector<size_t>& nums = refined.nums_labels;
    EXPECT_TRUE(std::ranges::is_sorted(nums));
    EXPECT_EQ(nums.front(), pairs_per_facet * mesh.facets.size());
    EXPECT_EQ(nums.back(), labels.labels.values.size());
    const auto num_final = std::ranges::count_if(
        refined.steps, [](const auto& step) { return step.is_final; });
    EXPECT_EQ(refined.steps.back().is_final, pairs_per_facet < 3);
    EXPECT_LE(num_final, pairs_per_facet < 3 ? 1 + 4 : 0);
    EXPECT_LT(SphereError(refined.Result()), 0.15);
  }
}

TEST(RefineLevel, StaysWhereNoStepLowersTheEnergy) {
  const TriangleMesh mesh = WavySphere(1);
  for (const int level : {0, 1}) {
    const Refined refined =
        Refine(WithoutSmoothness(), level, mesh, {.slope_factor = -1});
    EXPECT_EQ(refined.steps.size(), 1);
    EXPECT_EQ(refined.Result().vertices, mesh.vertices);
  }
}

TEST(RefineLevel, LeavesWhatNothingIsKnownOfAsItIs) {
  const TriangleMesh mesh = MakeBumpyCap(0.1f);
  const Pull none{.stiffness = 0, .num_pixels = 0};
  const FacetLabels no_labels =
      LabelWhere(mesh, [](const Vector3f&) { return false; });
  for (const int level : {0, 1}) {
    EXPECT_EQ(Refine({}, level, mesh, none).Result().vertices, mesh.vertices);
    EXPECT_EQ(Refine({}, level, mesh, none, no_labels).Result().vertices,
              mesh.vertices);
  }
}

// Where there is no texture, what differs from vertex to vertex is noise at the
// finest level, and relief that is not known yet before.
TEST(RefineLevel, SmoothsWhatIsSeenAtTheFinestLevelAlone) {
  const TriangleMesh mesh = RubbleSheet();
  const Pull none{.stiffness = 0};
  EXPECT_EQ(Refine({}, 1, mesh, none).Result().vertices, mesh.vertices);
  EXPECT_LT(Roughness(Refine({}, 0, mesh, none).Result()),
            0.2 * Roughness(mesh));
}

// However accurate it is.
TEST(RefineLevel, KeepsNoReliefThatTheImagesDoNotConfirm) {
  const TriangleMesh mesh = SheetOf([](const Vector3d& point) {
    return kFootprint * std::sin(point.x() / (5 * kFootprint));
  });
  FacetwiseRefinementOptions options;
  options.iterations = 15;  // relief fades step by step
  EXPECT_LT(Roughness(Refine(options, 0, mesh, {.stiffness = 0}).Result()),
            0.2 * Roughness(mesh));
}

// In one step: those around what is pulled, or all.
TEST(RefineLevel, MovesEachVertexByItselfInDescent) {
  const TriangleMesh mesh = MakeBumpySphere(0.1f, 0);
  const FacetLabels labels = LabelUpperHalf(mesh);
  for (const RefinementSolver solver :
       {RefinementSolver::kGaussNewton, RefinementSolver::kDescent}) {
    FacetwiseRefinementOptions options;
    options.solver = solver;
    options.iterations = 1;
    const TriangleMesh refined =
        Refine(options, 1, mesh, {.surface = Sphere(1)}, labels).Result();
    int num_moved = 0;
    for (size_t i = 0; i < mesh.vertices.size(); ++i) {
      const bool is_moved = refined.vertices[i] != mesh.vertices[i];
      if (mesh.vertices[i].z() > 0.1f) {
        EXPECT_TRUE(is_moved);
      } else if (mesh.vertices[i].z() < -0.3f) {
        num_moved += is_moved;
      }
    }
    EXPECT_EQ(num_moved > 0, solver == RefinementSolver::kGaussNewton);
  }
}

// The upper half is pulled outwards, the lower one goes with it at the seam.
TEST(RefineLevel, LetsWhatIsNotSeenFollow) {
  const TriangleMesh mesh = MakeBumpySphere(0.1f, 0);
  const FacetLabels labels = LabelUpperHalf(mesh);
  for (const int level : {0, 1}) {
    const TriangleMesh refined =
        Refine({}, level, mesh, {.surface = Sphere(1)}, labels).Result();
    int num_near = 0;
    for (size_t i = 0; i < mesh.vertices.size(); ++i) {
      const double motion =
          (refined.vertices[i].norm() - mesh.vertices[i].norm()) / kFootprint;
      EXPECT_LT(std::abs(motion), 3);
      if (mesh.vertices[i].z() < -0.1 && mesh.vertices[i].z() > -0.2) {
        ++num_near;
        EXPECT_GT(motion, 0.2);
      }
    }
    EXPECT_GT(num_near, 20);
  }
}

TEST(RefineLevel, DoesNotPullTheBorderInwards) {
  const TriangleMesh mesh = WavySphere(1, /*is_whole=*/false);
  const VertexRings rings = MakeVertexRings(mesh);
  for (const int level : {0, 1}) {
    const TriangleMesh refined = Refine({}, level, mesh, {}).Result();
    int num_border = 0;
    for (size_t i = 0; i < mesh.vertices.size(); ++i) {
      if (rings.is_border[i] != 0) {
        ++num_border;
        const Vector3d before = mesh.vertices[i].cast<double>().normalized();
        const Vector3d after = refined.vertices[i].cast<double>();
        EXPECT_NEAR(after.norm(), 1, 0.5 * kFootprint);
        EXPECT_LT((after.normalized() - before).norm(), 0.5 * kFootprint);
      }
    }
    EXPECT_GT(num_border, 30);
  }
}

// A narrow sheet whose rows are pulled to opposite sides.
TEST(RefineLevel, ShortensStepsThatWouldTurnFacetsOver) {
  constexpr double kSpacing = 0.1 * kFootprint;
  TriangleMesh mesh = MakeSheet(10, 10);
  for (Vector3f& vertex : mesh.vertices) {
    vertex.x() *= 2 * kFootprint;
    vertex.y() *= kSpacing;
  }
  const Surface waves = HeightField([](const Vector3d& point) {
    return 5 * kFootprint * std::cos(point.y() / kSpacing * std::numbers::pi);
  });
  const Refined refined = Refine(WithoutSmoothness(), 0, mesh, {waves});
  ASSERT_GT(refined.meshes.size(), 1);
  for (size_t step = 1; step < refined.meshes.size(); ++step) {
    const std::vector<Vector3f> before = FacetNormals(refined.meshes[step - 1]);
    const std::vector<Vector3f> after = FacetNormals(refined.meshes[step]);
    for (size_t i = 0; i < before.size(); ++i) {
      EXPECT_GT(before[i].dot(after[i]), 0.499);
    }
  }
}

TEST(RefineLevel, MovesByAPixelAndAPartOfTheEdgesAtMost) {
  for (const double pixels : {5.0, 40.0}) {
    // Edges of more than a pixel, and of less.
    const float cell_size = pixels < 10 ? 0.2f : 0.05f;
    const TriangleMesh mesh = MakeBumpySphere(cell_size, 0);
    const VertexRings rings = MakeVertexRings(mesh);
    FacetwiseRefinementOptions options = WithoutSmoothness();
    options.iterations = 4;
    const Refined refined = Refine(options, 1, mesh, {Sphere(pixels)});
    ASSERT_GT(refined.meshes.size(), 2);
    double largest = 0;
    for (size_t step = 1; step < refined.meshes.size(); ++step) {
      const std::vector<Vector3f>& before = refined.meshes[step - 1].vertices;
      double sum = 0;
      for (size_t i = 0; i < before.size(); ++i) {
        const auto ring = rings.neighbors[i];
        double length = 0;
        for (const uint32_t neighbor : ring) {
          length += (before[neighbor] - before[i]).norm();
        }
        length /= static_cast<double>(ring.size());
        const double motion =
            (refined.meshes[step].vertices[i] - before[i]).norm();
        EXPECT_LT(motion, 1.03 * kFootprint);
        EXPECT_LT(motion, 0.5 * length);
        largest = std::max(largest, motion);
        sum += motion / kFootprint;
      }
      EXPECT_NEAR(refined.steps[step].mean_step,
                  sum / static_cast<double>(before.size()), 0.02);
    }
    EXPECT_GT(largest, 0.4 * kFootprint);
  }
}

TEST(RefineLevel, DrawsTheMeshAgainWhenItHasMoved) {
  const TriangleMesh mesh = MakeBumpySphere(0.1f, 0);
  for (const double pixels : {0.001, 3.0}) {
    const Refined refined =
        Refine(WithoutSmoothness(), 0, mesh, {Sphere(pixels)});
    EXPECT_GT(refined.steps.size(), 1);
    EXPECT_EQ(refined.num_renders > 1, pixels > 1);
  }
}

TEST(RefineLevel, TellsOfEachStepAndStopsWhenTold) {
  const TriangleMesh mesh = WavySphere(2);
  for (const int last : {0, 2}) {
    const Refined refined = Refine({}, 1, mesh, {}, {}, {}, last);
    const std::vector<RefinementStep>& steps = refined.steps;
    ASSERT_EQ(steps.size(), last + 1);
    for (int i = 0; i <= last; ++i) {
      EXPECT_EQ(steps[i].iteration, i);
      EXPECT_EQ(steps[i].level, 1);
      EXPECT_EQ(steps[i].num_vertices, mesh.vertices.size());
      EXPECT_EQ(steps[i].num_facets, mesh.facets.size());
      EXPECT_EQ(steps[i].mean_step > 0, i > 0);
    }
    EXPECT_EQ(refined.Result().vertices == mesh.vertices, last == 0);
  }
}

// All windows alike: their correlation is the mean.
TEST(RefineLevel, TellsTheMeanCorrelation) {
  const TriangleMesh mesh = MakeBumpySphere(0.3f, 0);
  for (const double zncc : {-0.5, 0.0, 0.8, 1.0}) {
    EXPECT_NEAR(Refine({}, 0, mesh, {.zncc = zncc}).steps[0].mean_zncc, zncc,
                1e-6);
  }
}

// A mesh that was given as flat: the images can confirm no relief of it.
TEST(RefineLevel, IsTheSmootherTheMoreItIsToBe) {
  const TriangleMesh mesh = RubbleSheet();
  const TriangleMesh flat = FlatSheet();
  std::vector<double> roughness;
  for (const double weight : {0.001, 0.01, 0.1, 0.2, 1.0}) {
    FacetwiseRefinementOptions options;
    options.smoothness_weight = weight;
    const Refined refined = Refine(
        options, 0, mesh,
        {HeightField([](const Vector3d& point) { return Rubble(point); }), 100},
        {}, flat.vertices);
    roughness.push_back(Roughness(refined.Result()));
  }
  EXPECT_GT(roughness.front(), Roughness(mesh));
  EXPECT_TRUE(std::is_sorted(roughness.rbegin(), roughness.rend()));
  EXPECT_LT(roughness.back(), 0.1 * Roughness(mesh));
}

double ReliefError(const TriangleMesh& mesh) {
  return Error(mesh, HeightField(Relief));
}

// Relief that the images are sure of is no noise.
TEST(RefineLevel, KeepsReliefThatTheImagesShow) {
  const Pull pull{HeightField(Relief), 100};
  EXPECT_LT(ReliefError(Refine({}, 0, RubbleSheet(), pull).Result()),
            0.3 * ReliefError(FlatSheet()));
}

// The images pull to the relief and noise.
TEST(RefineLevel, KeepsReliefOfTheMeshThatTheImagesConfirm) {
  const TriangleMesh mesh = SheetOf(Relief);
  const Pull pull{HeightField([](const Vector3d& point) {
                    return Relief(point) + 2 * Rubble(point);
                  }),
                  1};
  const auto error = [&](const TriangleMesh& given) {
    return ReliefError(Refine({}, 0, mesh, pull, {}, given.vertices).Result());
  };
  const double of_none = error(FlatSheet());
  EXPECT_LT(error(mesh), 0.75 * of_none);
  EXPECT_LT(error(RubbleSheet(1)), 1.1 * of_none);
  // Bumps where there are hollows.
  EXPECT_LT(
      error(SheetOf([](const Vector3d& point) { return -Relief(point); })),
      1.02 * of_none);
}

// Edges of 40 pixels, and each vertex pulled to another height.
TEST(RefineLevel, RaisesNoTentsWhereLittleIsSeen) {
  const TriangleMesh mesh = Scaled(FlatSheet(), 20);
  const VertexRings rings = MakeVertexRings(mesh);
  const auto height = [](const Vector3d& point) {
    return 12 * Rubble(point / 20);
  };
  for (const int level : {0, 1}) {
    const TriangleMesh refined =
        Refine({}, level, mesh, {HeightField(height), 0.001, 1}).Result();
    double sum = 0;
    double sum_pulled = 0;
    for (size_t i = 0; i < mesh.vertices.size(); ++i) {
      if (rings.is_border[i] == 0) {
        sum += std::pow(refined.vertices[i].z(), 2);
        sum_pulled += std::pow(height(mesh.vertices[i].cast<double>()), 2);
      }
    }
    EXPECT_LT(sum, 0.3 * sum_pulled);
  }
}

// A plastered wall beside a carved one.
TEST(RefineLevel, KeepsNoNoiseForTheSakeOfReliefElsewhere) {
  const TriangleMesh mesh = RubbleSheet(1);
  const Surface walls = HeightField([](const Vector3d& point) {
    return point.x() < 0 ? Rubble(point) : Relief(point);
  });
  const TriangleMesh refined = Refine({}, 0, mesh, {walls}).Result();
  constexpr float kMaxX = -10 * kFootprint;
  EXPECT_LT(Roughness(refined, kMaxX), 0.05 * Roughness(mesh, kMaxX));
}

}  // namespace colmap_ext::level_refinement_test
