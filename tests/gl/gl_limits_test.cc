#include "gl/egl_context.h"

#include <memory>
#include <string>
#include <vector>

#define EGL_NO_X11
#define MESA_EGL_NO_X11_HEADERS
#include <epoxy/egl.h>
#include <epoxy/gl.h>

#include "gl/gl_photometric_energy.h"
#include "photometry/photometric_energy.h"
#include "tests/gl/gl_test.h"
#include "tests/gl/terms_difference.h"
#include "tests/refine/refinement_scene.h"

namespace colmap_ext::gl_limits_test {

const RefinementScene& Scene() {
  static const RefinementScene scene = MakeRefinementScene("statue", 3, 120);
  return scene;
}

const TriangleMesh& Mesh() {
  static const TriangleMesh mesh = Scene().Perturbed(0.3);
  return mesh;
}

const FacetLabels& Labels() {
  static const FacetLabels labels = Scene().Labels(2);
  return labels;
}

PhotometricTerms DrawAndEvaluate(PhotometricEnergy* energy) {
  energy->Render(Mesh());
  return energy->Evaluate(Mesh(), Labels());
}

bool IsByProcessor(const PhotometricTerms& terms) {
  static const PhotometricTerms expected = DrawAndEvaluate(
      MakeCpuPhotometricEnergy({}, Scene().Pyramid(), SIZE_MAX).get());
  return terms == expected;
}

bool IsByCard(const PhotometricTerms& terms) {
  static const PhotometricTerms expected =
      DrawAndEvaluate(MakeGlPhotometricEnergy({}, Scene().Pyramid(), {}).get());
  return terms == expected;
}

// An energy, and what it warns of.
struct WarningEnergy {
  explicit WarningEnergy(
      GlOptions gl, std::shared_ptr<ImagePyramid> images = Scene().Pyramid()) {
    gl.warn = [this](const std::string& warning) {
      warnings.push_back(warning);
    };
    energy = MakeGlPhotometricEnergy({}, std::move(images), gl);
  }

  std::vector<std::string> warnings;
  std::unique_ptr<PhotometricEnergy> energy;
};

// The normals of the mesh, which shaders need in one piece.
size_t NormalBytes() { return 24 * Mesh().facets.size(); }

class GlLimitsTest : public GlTest {};

TEST_F(GlLimitsTest, AreNoMoreThanAskedFor) {
  const EglContext::Scope scope = context_->MakeCurrent();
  const GlLimits found = FindGlLimits({}, context_->IsSoftware());
  EXPECT_GE(found.max_block, 1 << 24);  // What OpenGL 4.5 is sure to have.
  EXPECT_LT(found.max_block, SIZE_MAX);
  const GlLimits small = FindGlLimits({100, 200}, context_->IsSoftware());
  EXPECT_EQ(small.max_block, 100);
  EXPECT_EQ(small.max_memory, 200);
}

// The sums are twice as large as the normals.
TEST_F(GlLimitsTest, WhatIsTooLargeForAShaderIsSplit) {
  WarningEnergy split({.limits = {.max_block = NormalBytes()}});
  EXPECT_TRUE(IsByCard(DrawAndEvaluate(split.energy.get())));
  EXPECT_TRUE(split.warnings.empty());
  WarningEnergy other({.limits = {.max_block = NormalBytes() - 1}});
  EXPECT_TRUE(IsByProcessor(DrawAndEvaluate(other.energy.get())));
  EXPECT_EQ(other.warnings.size(), 1);
}

// Into some rows of an image at a time.
TEST_F(GlLimitsTest, WhatTakesTooManyLoopsIsSplit) {
  const PhotometricTerms whole =
      DrawAndEvaluate(MakeGlPhotometricEnergy({}, Scene().Pyramid(), {}).get());
  const PhotometricTerms split = DrawAndEvaluate(
      WarningEnergy({.limits = {.max_loops = 2000}}).energy.get());
  const TermsDifference difference = Compare(split, whole);
  EXPECT_EQ(difference.relative_pixels, 0);
  EXPECT_NEAR(difference.relative_energy, 0, 1e-5);
  EXPECT_GT(difference.gradient_cosine, 1 - 1e-5);
  EXPECT_GT(difference.curvature_cosine, 1 - 1e-5);
}

// Whatever the card's memory, all is computed, and at most one warning given.
TEST_F(GlLimitsTest, ProcessorTakesOverWhereMemoryRunsOut) {
  size_t num_by_card = 0;
  size_t num_by_processor = 0;
  for (size_t memory = 1 << 14; memory <= 1 << 26; memory *= 4) {
    WarningEnergy limited({.limits = {.max_memory = memory}});
    const PhotometricTerms terms = DrawAndEvaluate(limited.energy.get());
    const bool is_by_card = limited.warnings.empty();
    EXPECT_TRUE(is_by_card ? IsByCard(terms) : IsByProcessor(terms));
    ++(is_by_card ? num_by_card : num_by_processor);
    limited.energy->SetLevel(1);
    limited.energy->SetLevel(0);
    limited.energy->SetViews(Scene().Views());
    EXPECT_TRUE(DrawAndEvaluate(limited.energy.get()) == terms);
    EXPECT_EQ(limited.warnings.size(), is_by_card ? 0 : 1);
  }
  EXPECT_GT(num_by_card, 0);
  EXPECT_GT(num_by_processor, 0);
}

// Labels are what is known last.
TEST_F(GlLimitsTest, ProcessorTakesOverWhereLabelsAreTooMany) {
  const FacetLabels none = Labels().Truncated(0);
  const size_t label_bytes = 4 * Labels().labels.values.size();
  size_t too_little = 0;
  size_t enough = 1 << 26;  // to draw the mesh
  while (enough - too_little > label_bytes) {
    const size_t memory = (too_little + enough) / 2;
    WarningEnergy limited({.limits = {.max_memory = memory}});
    limited.energy->Render(Mesh());
    (limited.warnings.empty() ? enough : too_little) = memory;
  }
  WarningEnergy limited({.limits = {.max_memory = enough}});
  limited.energy->Render(Mesh());
  EXPECT_EQ(limited.energy->Evaluate(Mesh(), none).energy, 0);
  EXPECT_TRUE(limited.warnings.empty());
  EXPECT_TRUE(IsByProcessor(limited.energy->Evaluate(Mesh(), Labels())));
  EXPECT_EQ(limited.warnings.size(), 1);
}

TEST_F(GlLimitsTest, MeshThatWillNotFitIsKnownAtTheStart) {
  const GlLimits limits{.max_memory = 50'000'000};
  const WarningEnergy large({.limits = limits,
                             .expected_facets = 1'000'000,
                             .expected_directions = 18});
  ASSERT_EQ(large.warnings.size(), 1);
  EXPECT_TRUE(large.warnings[0].starts_with("the finest level may not fit"));
  EXPECT_TRUE(large.energy->Description().starts_with("OpenGL, "));
  const WarningEnergy small({.limits = limits,
                             .expected_facets = 100'000,
                             .expected_directions = 18});
  EXPECT_TRUE(small.warnings.empty());
}

// Does harm to OpenGL while images are read for it.
struct HarmfulImages {
  void (*harm)() = nullptr;
  std::shared_ptr<ImagePyramid> images = std::make_shared<ImagePyramid>(
      Scene().Views(),
      [this, unharmed = Scene().Pyramid()](size_t view) {
        if (harm != nullptr && eglGetCurrentContext() != EGL_NO_CONTEXT) {
          harm();
        }
        return *unharmed->Image(view);
      },
      0);
};

void MakeAnError() { glEnable(GL_INVALID_ENUM); }

void LoseContext() {
  eglDestroyContext(eglGetCurrentDisplay(), eglGetCurrentContext());
}

TEST_F(GlLimitsTest, ProcessorTakesOverWhereTheCardFails) {
  struct Harm {
    const char* name;
    void (*harm)();
  };
  for (const auto& [name, harm] :
       {Harm{"error", MakeAnError}, Harm{"context lost", LoseContext}}) {
    SCOPED_TRACE(name);
    HarmfulImages harmful;
    WarningEnergy failing({}, harmful.images);
    EXPECT_TRUE(IsByCard(DrawAndEvaluate(failing.energy.get())));
    harmful.harm = harm;
    failing.energy->SetLevel(0);  // so that the images are read anew
    const PhotometricTerms first = failing.energy->Evaluate(Mesh(), Labels());
    EXPECT_TRUE(IsByCard(first) || IsByProcessor(first));
    EXPECT_TRUE(IsByProcessor(failing.energy->Evaluate(Mesh(), Labels())));
    ASSERT_EQ(failing.warnings.size(), 1);
    EXPECT_EQ(failing.warnings[0].find("the graphics card gave up ("), 0);
    EXPECT_TRUE(IsByProcessor(DrawAndEvaluate(failing.energy.get())));
    EXPECT_EQ(failing.warnings.size(), 1);
  }
}

// Wider than textures may be, at one level.
TEST_F(GlLimitsTest, ProcessorTakesOverWhereImagesAreTooLarge) {
  const EglContext::Scope scope = context_->MakeCurrent();
  GLint max_size = 0;
  glGetIntegerv(GL_MAX_TEXTURE_SIZE, &max_size);
  std::vector<View> views = Scene().Views();
  for (View& view : views) {
    view.width = max_size + 2;
    view.height = 4;
  }
  const auto images = std::make_shared<ImagePyramid>(
      views,
      [&](size_t) {
        return GrayImage{max_size + 2, 4,
                         std::vector<uint8_t>(4 * (max_size + 2), 100)};
      },
      SIZE_MAX);
  WarningEnergy wide({}, images);
  for (const int level : {1, 0}) {
    wide.energy->SetLevel(level);
    DrawAndEvaluate(wide.energy.get());
    EXPECT_EQ(wide.warnings.size(), level == 1 ? 0 : 1);
  }
}

}  // namespace colmap_ext::gl_limits_test
