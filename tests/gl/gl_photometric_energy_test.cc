#include "gl/gl_photometric_energy.h"

#include <cmath>
#include <memory>
#include <thread>
#include <vector>

#include "gl/egl_context.h"
#include "labeling/view_pairs.h"
#include "photometry/photometric_energy.h"
#include "raster/facet_id_buffer.h"
#include "tests/gl/gl_test.h"
#include "tests/gl/terms_difference.h"
#include "tests/mesh/known_meshes.h"
#include "tests/refine/refinement_scene.h"

namespace colmap_ext::gl_photometric_energy_test {

const RefinementScene& Statue() {
  static const RefinementScene scene = MakeRefinementScene("statue", 4);
  return scene;
}

std::unique_ptr<PhotometricEnergy> MakeGl(const RefinementScene& scene,
                                          size_t max_memory = SIZE_MAX) {
  return MakeGlPhotometricEnergy({}, scene.Pyramid(),
                                 {.max_memory = max_memory});
}

bool IsZero(const PhotometricTerms& terms, size_t facet) {
  return terms.facets[facet] == FacetTerms();
}

// The energy by OpenGL, and by the processor.
struct BothEnergies {
  explicit BothEnergies(const std::shared_ptr<ImagePyramid>& images,
                        const PhotometricOptions& options = {})
      : gl(MakeGlPhotometricEnergy(options, images, {})),
        cpu(MakeCpuPhotometricEnergy(options, images, SIZE_MAX)) {}

  void Render(const TriangleMesh& mesh) const {
    gl->Render(mesh);
    cpu->Render(mesh);
  }

  // Of a mesh that was drawn, or of another one.
  // \return the processor's terms
  PhotometricTerms ExpectAgreement(const TriangleMesh& mesh,
                                   const FacetLabels& labels) const {
    const PhotometricTerms expected = cpu->Evaluate(mesh, labels);
    const PhotometricTerms terms = gl->Evaluate(mesh, labels);
    const TermsDifference difference = Compare(terms, expected);
    // Of hidden facets both say nothing, and of those without labels.
    size_t num_different = 0;
    for (size_t facet = 0; facet < mesh.facets.size(); ++facet) {
      num_different += IsZero(terms, facet) != IsZero(expected, facet);
      EXPECT_TRUE(!labels.labels[facet].empty() || IsZero(terms, facet));
    }
    EXPECT_LT(num_different, 1e-3 * mesh.facets.size());
    EXPECT_LT(expected.energy, -100);
    EXPECT_NEAR(difference.relative_energy, 0, 1e-4);
    EXPECT_NEAR(difference.relative_weight, 0, 1e-4);
    EXPECT_NEAR(difference.relative_pixels, 0, 1e-4);
    EXPECT_GT(difference.gradient_cosine, 0.9999);
    EXPECT_NEAR(difference.gradient_ratio, 1, 1e-3);
    EXPECT_GT(difference.curvature_cosine, 0.9999);
    return expected;
  }

  std::unique_ptr<PhotometricEnergy> gl;
  std::unique_ptr<PhotometricEnergy> cpu;
};

void ExpectAgreement(const std::shared_ptr<ImagePyramid>& images,
                     const TriangleMesh& mesh, const FacetLabels& labels,
                     const PhotometricOptions& options = {}) {
  const BothEnergies both(images, options);
  both.Render(mesh);
  both.ExpectAgreement(mesh, labels);
}

struct GlPhotometricEnergyTest : GlTest {
  const RefinementScene& scene_ = Statue();
  const TriangleMesh mesh_ = scene_.Perturbed(0.3);
  const FacetLabels labels_ = scene_.Labels(2);
};

TEST(GlPhotometricEnergy, GraphicsCardThatIsNotThereThrows) {
  EXPECT_THROW(
      MakeGlPhotometricEnergy({}, Statue().Pyramid(), {.gpu_index = 1000}),
      NoGlError);
}

// Drawn at one place, evaluated at others.
TEST_F(GlPhotometricEnergyTest, AgreesWithTheProcessorAtAllLevels) {
  const BothEnergies both(scene_.Pyramid());
  for (const int level : {2, 1, 0}) {
    SCOPED_TRACE(level);
    both.gl->SetLevel(level);
    both.cpu->SetLevel(level);
    both.Render(mesh_);
    for (const uint32_t seed : {2, 3}) {
      both.ExpectAgreement(scene_.Perturbed(0.3, seed), labels_);
    }
  }
}

// Stripes of every second image are masked.
GrayImage StripedMask(const View& view, size_t index) {
  if (index % 2 != 0) {
    return {};
  }
  GrayImage mask{view.width, view.height, {}};
  ForEachPixel(view, [&](int, int col) {
    mask.pixels.push_back(col / 16 % 3 == 0 ? 0 : 255);
  });
  return mask;
}

TEST_F(GlPhotometricEnergyTest, AgreesWithTheProcessorUnderMasks) {
  const auto read_mask = [&](size_t view) {
    return StripedMask(scene_.Views()[view], view);
  };
  const BothEnergies both(scene_.Pyramid(SIZE_MAX, read_mask));
  const auto whole = MakeCpuPhotometricEnergy({}, scene_.Pyramid(), SIZE_MAX);
  for (const int level : {1, 0}) {
    SCOPED_TRACE(level);
    for (PhotometricEnergy* energy :
         {both.gl.get(), both.cpu.get(), whole.get()}) {
      energy->SetLevel(level);
      energy->Render(mesh_);
    }
    EXPECT_GT(both.ExpectAgreement(mesh_, labels_).energy,
              whole->Evaluate(mesh_, labels_).energy);
  }
}

TEST_F(GlPhotometricEnergyTest, AgreesWithTheProcessorWhateverTheOptions) {
  const RefinementScene scene = MakeRefinementScene("grid", 3);
  const TriangleMesh mesh = scene.Perturbed(0.3);
  const FacetLabels labels = scene.Labels(1);
  for (const int radius : {1, 2, 4}) {
    for (const bool masking : {false, true}) {
      PhotometricOptions options;
      options.window_radius = radius;
      options.occlusion_masking = masking;
      options.noise_variance = 3;
      options.min_cosine = 0.3;
      ExpectAgreement(scene.Pyramid(), mesh, labels, options);
    }
  }
}

TEST_F(GlPhotometricEnergyTest, AgreesWithTheProcessorInOneDirection) {
  const FacetLabels labels = InSmallerView(labels_, mesh_, scene_.Views());
  const BothEnergies both(scene_.Pyramid());
  both.Render(mesh_);
  EXPECT_GT(both.ExpectAgreement(mesh_, labels).energy,
            both.cpu->Evaluate(mesh_, labels_).energy);
}

TEST_F(GlPhotometricEnergyTest, FacetsOfOtherLabelsGetNothing) {
  const BothEnergies both(scene_.Pyramid());
  both.Render(mesh_);
  // Each second facet of the others loses its label. What the windows of the
  // others reach is drawn for them, labelled or not.
  std::vector<uint8_t> is_kept(labels_.NumFacets(), 1);
  for (size_t facet = 1; facet < is_kept.size(); facet += 2) {
    is_kept[facet] = 0;
  }
  both.ExpectAgreement(mesh_, labels_);
  FacetLabels kept = labels_;
  kept.KeepOf(is_kept);
  both.ExpectAgreement(mesh_, kept);
}

// Walls that reach behind both cameras. They are large: Mesa's software would
// not run over all their pixels at once, see FindGlLimits().
TEST_F(GlPhotometricEnergyTest, AgreesWithTheProcessorInARoom) {
  const RefinementScene scene = MakeRoomScene(6);
  const BothEnergies both(scene.Pyramid());
  both.Render(scene.Truth());
  const TriangleMesh room = Scaled(scene.Truth(), 1.002F);
  both.ExpectAgreement(room, LabelAll({{0, 1}}, room.facets.size()));
}

// Every second image is half the size.
TEST_F(GlPhotometricEnergyTest, ImagesMayBeOfSeveralSizes) {
  std::vector<View> views = scene_.Views();
  for (size_t i = 0; i < views.size(); i += 2) {
    views[i] = ViewsAtLevel({views[i]}, 1)[0];
  }
  const auto images = std::make_shared<ImagePyramid>(
      views,
      ResizedImages([&](size_t view) { return scene_.images[view]; },
                    scene_.Views(), views),
      SIZE_MAX);
  ExpectAgreement(images, mesh_, labels_);
}

TEST_F(GlPhotometricEnergyTest, AgreesWithTheProcessorFarFromTheOrigin) {
  const Eigen::Vector3d shift(1000, -2000, 500);
  std::vector<View> views = scene_.Views();
  for (View& view : views) {
    view.cam_from_world_translation -= view.cam_from_world_rotation * shift;
  }
  ExpectAgreement(scene_.PyramidOf(views), Shifted(mesh_, shift.cast<float>()),
                  labels_);
}

TEST_F(GlPhotometricEnergyTest, SameBytesFromRunToRunAndInLittleMemory) {
  const auto first = MakeGl(scene_);
  const auto second = MakeGl(scene_, 0);
  first->Render(mesh_);
  second->Render(mesh_);
  const PhotometricTerms terms = first->Evaluate(mesh_, labels_);
  EXPECT_TRUE(first->Evaluate(mesh_, labels_) == terms);
  EXPECT_TRUE(second->Evaluate(mesh_, labels_) == terms);
  first->Render(scene_.Truth());
  first->Evaluate(scene_.Truth(), labels_);
  first->SetLevel(1);
  first->Render(mesh_);
  first->Evaluate(mesh_, labels_);
  first->SetLevel(0);
  first->Render(mesh_);
  EXPECT_TRUE(first->Evaluate(mesh_, labels_) == terms);
}

TEST_F(GlPhotometricEnergyTest, ScaledSceneHasTheSameEnergy) {
  const FacetLabels labels = scene_.Labels(1);
  const auto energy = MakeGl(scene_);
  energy->Render(scene_.Truth());
  const PhotometricTerms terms = energy->Evaluate(scene_.Truth(), labels);
  for (const int exponent : {-10, 10}) {
    const float scale = std::ldexp(1.0F, exponent);
    const TriangleMesh mesh = Scaled(scene_.Truth(), scale);
    const auto scaled = MakeGlPhotometricEnergy(
        {}, scene_.PyramidOf(Scaled(scene_.Views(), scale)), {.max_memory = 0});
    scaled->Render(mesh);
    PhotometricTerms scaled_terms = scaled->Evaluate(mesh, labels);
    for (size_t facet = 0; facet < mesh.facets.size(); ++facet) {
      for (float& slope : scaled_terms.facets[facet].slopes) {
        slope *= scale;
      }
      for (float& curvature : scaled_terms.facets[facet].curvatures) {
        curvature *= scale * scale;
      }
    }
    EXPECT_TRUE(scaled_terms == terms) << exponent;
  }
}

TEST_F(GlPhotometricEnergyTest, AnyThreadMayUseIt) {
  const FacetLabels labels = scene_.Labels(1);
  auto energy = MakeGl(scene_);
  energy->Render(scene_.Truth());
  const PhotometricTerms terms = energy->Evaluate(scene_.Truth(), labels);
  std::thread([&] {
    EXPECT_TRUE(energy->Evaluate(scene_.Truth(), labels) == terms);
    energy.reset();
  }).join();
}

TEST_F(GlPhotometricEnergyTest, NothingToCompareIsZero) {
  const auto energy = MakeGl(scene_);
  for (const TriangleMesh& mesh : {TriangleMesh(), scene_.Truth()}) {
    energy->Render(mesh);
    const size_t size = mesh.facets.size();
    EXPECT_TRUE(energy->Evaluate(mesh, {{{0, 1}}, Rows<uint32_t>(size), {}}) ==
                (PhotometricTerms{0, std::vector<FacetTerms>(size)}));
  }
}

}  // namespace colmap_ext::gl_photometric_energy_test
