#include "gl/pair_passes.h"

#include <epoxy/gl.h>
#include <algorithm>
#include <array>
#include <cmath>
#include <cstdint>
#include <stdexcept>
#include <string>
#include <string_view>
#include <thread>
#include <utility>
#include <vector>

#include "gl/egl_context.h"
#include "gl/gl_objects.h"
#include "mesh/triangle_mesh.h"
#include "raster/facet_id_buffer.h"
#include "tests/gl/gl_test.h"
#include "tests/mesh/known_meshes.h"
#include "tests/raster/shown_facets.h"
#include "tests/refine/refinement_scene.h"
#include "tests/texts.h"

namespace colmap_ext::view_textures_test {

struct Drawn {
  std::vector<uint32_t> facets;
  std::vector<float> inverse_depths;
};

Drawn Draw(const View& view, const TriangleMesh& mesh) {
  GlBuffer vertices, facets;
  vertices.Assign(mesh.vertices);
  facets.Assign(mesh.facets);
  FacetDrawer drawer(0.1);
  FacetTextures textures(view.width, view.height);
  drawer.Draw(view,
              FindFacetsInView(view, mesh, FacetClusters(mesh).InFrustum(view)),
              vertices, facets, &textures);
  Drawn drawn = {
      textures.facets.Read<uint32_t>(GL_RED_INTEGER, GL_UNSIGNED_INT),
      textures.depths.Read<float>(GL_DEPTH_COMPONENT, GL_FLOAT)};
  for (float& depth : drawn.inverse_depths) {
    depth /= textures.depth_scale;
  }
  ThrowOnGlError("drawing");
  return drawn;
}

// Signed distance of a pixel's centre from the nearest edge of a facet, px;
// positive inside.
double Inside(const View& view, const TriangleMesh& mesh, uint32_t facet,
              size_t pixel) {
  const Eigen::Vector3d center(pixel % view.width + 0.5,
                               pixel / view.width + 0.5, 0);
  auto corners = CornersOf<double>(mesh, mesh.facets[facet]);
  for (Eigen::Vector3d& corner : corners) {
    corner << view.ImageFromCam(view.CamFromWorld(corner)), 0;
  }
  const Eigen::Vector3d normal =
      (corners[1] - corners[0]).cross(corners[2] - corners[0]).normalized();
  double distance = 1e9;
  for (int k = 0; k < 3; ++k) {
    const Eigen::Vector3d edge = corners[(k + 1) % 3] - corners[k];
    distance = std::min(
        distance, normal.dot(edge.cross(center - corners[k])) / edge.norm());
  }
  return distance;
}

class FacetDrawerTest : public CurrentGlTest {};

TEST_F(FacetDrawerTest, DrawsWhatTheProcessorDraws) {
  size_t num_pixels = 0;
  size_t num_different = 0;
  for (const char* shape : {"statue", "grid"}) {
    const RefinementScene scene = MakeRefinementScene(shape, 3, 200);
    const TriangleMesh mesh = scene.Perturbed(0.3);
    for (const View& view : scene.Views()) {
      const Drawn drawn = Draw(view, mesh);
      const DrawnFacets reference = DrawFacets(view, mesh, 0.1);
      num_pixels += drawn.facets.size();
      for (size_t i = 0; i < drawn.facets.size(); ++i) {
        if (drawn.facets[i] != reference.facets[i]) {
          ++num_different;
          for (const uint32_t facet : {drawn.facets[i], reference.facets[i]}) {
            EXPECT_TRUE(facet == kNone ||
                        std::abs(Inside(view, mesh, facet, i)) < 1.0 / 128)
                << "pixel " << i << " facet " << facet;
          }
        } else if (drawn.facets[i] != kNone) {
          EXPECT_NEAR(drawn.inverse_depths[i] / reference.inverse_depths[i], 1,
                      1e-4);
        }
      }
    }
  }
  EXPECT_LT(num_different, 1e-4 * num_pixels);
  RecordProperty("pixels_that_differ", static_cast<int>(num_different));
}

// A triangle that covers the image of 8 x 6.
TriangleMesh Triangle(float z) {
  return {{{-9, -9, z}, {30, -9, z}, {-9, 30, z}}, {{0, 1, 2}}};
}

View SmallView() { return {"", 8, 6, 8, 8, 4, 3}; }

TEST_F(FacetDrawerTest, NearestOfEqualOnesFirstWinsIfThereIsAny) {
  TriangleMesh mesh = Triangle(3);
  for (const float z : {2.0F, 2.0F, 4.0F}) {
    mesh = Union(mesh, Triangle(z));
    std::swap(mesh.facets.back()[1], mesh.facets.back()[2]);
  }
  EXPECT_EQ(Draw(SmallView(), mesh).facets, std::vector<uint32_t>(48, 1));
  EXPECT_EQ(Draw(SmallView(), {}).facets, std::vector<uint32_t>(48, kNone));
}

TEST_F(FacetDrawerTest, FacetsThatReachBehindTheCameraAreDrawnByAPart) {
  for (const float z : {-1.0F, 0.0F, 1e-9F}) {
    TriangleMesh mesh = Triangle(2);
    mesh.vertices[2].z() = z;
    mesh.vertices.emplace_back(0.0F, 0.0F, 5.0F);
    const Drawn drawn = Draw(SmallView(), mesh);
    EXPECT_EQ(drawn.facets, std::vector<uint32_t>(48, 0)) << z;
    EXPECT_EQ(ShownFacets(DrawFacets(SmallView(), mesh, 0.1)), drawn.facets)
        << z;
  }
}

TEST_F(FacetDrawerTest, DrawsARoomFromInsideAsTheProcessorDoes) {
  const RefinementScene scene = MakeRoomScene(6);
  const TriangleMesh& room = scene.Truth();
  for (const View& view : scene.Views()) {
    const Drawn drawn = Draw(view, room);
    const DrawnFacets reference = DrawFacets(view, room, 0.1);
    size_t num_different = 0;
    for (size_t i = 0; i < drawn.facets.size(); ++i) {
      ASSERT_NE(reference.facets[i], kNone);
      // On an edge either facet will do, but no pixel falls between them.
      num_different += drawn.facets[i] != reference.facets[i] ? 1 : 0;
      EXPECT_NEAR(drawn.inverse_depths[i] / reference.inverse_depths[i], 1,
                  1e-4)
          << "pixel " << i;
    }
    EXPECT_LT(num_different, 1e-4 * drawn.facets.size());
  }
}

class GlObjectsTest : public CurrentGlTest {};

TEST_F(GlObjectsTest, BufferKeepsWhatIsWritten) {
  GlBuffer buffer;
  const std::vector<float> values = {1, 2, 3};
  buffer.Assign(values);
  EXPECT_EQ(buffer.NumBytes(), 12);
  EXPECT_EQ(buffer.Read<float>(3), values);
  buffer.SetZero();
  EXPECT_EQ(buffer.Read<float>(3), std::vector<float>(3, 0));
  buffer.Assign(std::vector<float>());
  EXPECT_EQ(buffer.NumBytes(), 0);
  EXPECT_TRUE(buffer.Read<float>(0).empty());
  EXPECT_NO_THROW(ThrowOnGlError("buffer"));
}

TEST_F(GlObjectsTest, TextureKeepsWhatIsWrittenAndThrowsIfTooLarge) {
  GlTexture texture(GL_R8UI, 5, 3);
  std::vector<uint8_t> pixels(15);
  for (uint8_t i = 0; i < 15; ++i) {
    pixels[i] = 17 * i;
  }
  texture.Write(GL_RED_INTEGER, GL_UNSIGNED_BYTE, pixels.data());
  EXPECT_EQ(texture.Read<uint8_t>(GL_RED_INTEGER, GL_UNSIGNED_BYTE), pixels);
  EXPECT_NO_THROW(ThrowOnGlError("texture"));
  EXPECT_THROW(GlTexture(GL_R8UI, 1 << 20, 1), GlError);
}

TEST_F(GlObjectsTest, MoveTheirNames) {
  GlBuffer first;
  first.Assign(std::vector<float>{1, 2});
  const GLuint name = first.Name();
  GlBuffer second(std::move(first));
  EXPECT_EQ(second.Name(), name);
  EXPECT_EQ(second.Read<float>(2), (std::vector<float>{1, 2}));
  { const GlBuffer third(std::move(second)); }
  EXPECT_FALSE(glIsBuffer(name));
}

std::string Version() {
  const GLubyte* version = glGetString(GL_VERSION);
  return version == nullptr ? "" : reinterpret_cast<const char*>(version);
}

TEST(EglContext, GraphicsCardThatIsNotThereThrows) {
  EXPECT_TRUE(
      Has(MessageOf<NoGlError>([] { const EglContext context(1000); }), "No "));
}

class EglContextTest : public GlTest {};

TEST_F(EglContextTest, IsNamed) {
  EXPECT_FALSE(context_->RendererName().empty());
  const bool is_llvmpipe =
      context_->RendererName().find("llvmpipe") != std::string::npos;
  EXPECT_TRUE(!is_llvmpipe || context_->IsSoftware());
  RecordProperty("renderer", context_->RendererName());
}

TEST_F(EglContextTest, IsCurrentInItsScopeOnly) {
  {
    const EglContext::Scope scope = context_->MakeCurrent();
    EXPECT_GE(Version(), "4.5");
  }
  const EglContext other;
  const EglContext::Scope outer = other.MakeCurrent();
  GLuint buffer = 0;
  glCreateBuffers(1, &buffer);
  {
    const EglContext::Scope inner = context_->MakeCurrent();
    EXPECT_FALSE(glIsBuffer(buffer));
  }
  EXPECT_TRUE(glIsBuffer(buffer));
  glDeleteBuffers(1, &buffer);
}

TEST_F(EglContextTest, OutlivesOthersOfItsDisplay) {
  { const EglContext other; }
  const EglContext::Scope scope = context_->MakeCurrent();
  EXPECT_GE(Version(), "4.5");
}

TEST_F(EglContextTest, GoesFromThreadToThread) {
  std::string version;
  std::thread([&] {
    const EglContext::Scope scope = context_->MakeCurrent();
    version = Version();
  }).join();
  EXPECT_GE(version, "4.5");
}

TEST_F(EglContextTest, TwoThreadsAtATimeThrow) {
  const EglContext::Scope scope = context_->MakeCurrent();
  std::thread([&] {
    EXPECT_THROW(const auto second = context_->MakeCurrent(), GlError);
  }).join();
}

TEST_F(EglContextTest, ErrorsThrowOnce) {
  const EglContext::Scope scope = context_->MakeCurrent();
  EXPECT_NO_THROW(ThrowOnGlError("here"));
  glEnable(GL_TRIANGLES);
  EXPECT_TRUE(MessageOf<GlError>([] {
                ThrowOnGlError("here");
              }).starts_with("here: OpenGL: "));
  EXPECT_NO_THROW(ThrowOnGlError("here"));
}

class ProgramTest : public CurrentGlTest {};

TEST_F(ProgramTest, UnknownUniformOrOneOfAnotherTypeThrows) {
  Program program({"facet_normals.comp"});
  program.Set("num_facets", 1U);
  EXPECT_EQ(MessageOf<GlError>([&] { program.Set("num_faces", 1U); }),
            "The shader facet_normals.comp has no uniform num_faces");
  program.Set("num_facets", 1.0F);
  EXPECT_THROW(ThrowOnGlError("uniform"), GlError);
}

TEST_F(ProgramTest, WhatDoesNotCompileOrLinkThrows) {
  EXPECT_TRUE(MessageOf<GlError>([] {
                const Program program({"facet_normals.comp"}, {{"1st", 1}});
              })
                  .starts_with("The shader facet_normals.comp does not "
                               "compile:\n"));
  EXPECT_THROW(Program({"facet_ids.vert", "facet_normals.comp"}), GlError);
}

TEST_F(ProgramTest, Moves) {
  Program first({"facet_normals.comp"});
  Program second(std::move(first));
  first = std::move(second);
  first.Set("num_facets", 1U);
  EXPECT_NO_THROW(ThrowOnGlError("moved program"));
}

// Of more workgroups than one dimension is sure to hold.
TEST_F(ProgramTest, DispatchesMillionsOfThreads) {
  const size_t num_facets = kGroupSize * 65535 + 100;
  GlBuffer vertices, facets, normals;
  vertices.Assign(
      std::vector<Eigen::Vector3f>{{0, 0, 0}, {3, 0, 0}, {0, 0, 2}, {0, 1, 0}});
  std::vector<Facet> indices(num_facets, Facet{0, 1, 2});
  indices.back() = {0, 1, 3};
  facets.Assign(indices);
  normals.Resize(num_facets * 3 * sizeof(double));
  normals.SetZero();
  vertices.BindToStorage(0);
  facets.BindToStorage(1);
  normals.BindToStorage(2);
  Program program({"facet_normals.comp"});
  program.Set("num_facets", static_cast<unsigned int>(num_facets));
  Dispatch(program, num_facets);
  const auto result = normals.Read<std::array<double, 3>>(num_facets);
  ThrowOnGlError("dispatch");
  const std::array<double, 3> down = {0, -1, 0};
  const std::array<double, 3> up = {0, 0, 1};
  EXPECT_TRUE(std::all_of(result.begin(), result.end() - 1,
                          [&](const auto& normal) { return normal == down; }));
  EXPECT_EQ(result.back(), up);
}

TEST(ShaderSources, HoldTheirVersionAndWhatTheyInclude) {
  for (const char* name : {"facet_ids.vert", "facet_ids.frag", "warp.comp"}) {
    EXPECT_TRUE(ShaderSource(name).starts_with("#version 450 core\n")) << name;
  }
  const std::string_view source = ShaderSource("gather.comp");
  EXPECT_FALSE(Has(source, "#include"));
  EXPECT_TRUE(HasAll(
      source, {"ivec4 FacetBox(uint facet)", "float sum[12] = float[12]("}));
  EXPECT_TRUE(Has(ShaderSource("facet_ids.frag"),
                  "facet = first_facet + uint(gl_PrimitiveID);"));
  EXPECT_THROW(ShaderSource("no.comp"), std::out_of_range);
}

}  // namespace colmap_ext::view_textures_test
