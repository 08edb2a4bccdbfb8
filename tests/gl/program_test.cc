#include "gl/gl_objects.h"

#include <algorithm>
#include <array>
#include <stdexcept>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

#include "gl/egl_context.h"
#include "mesh/triangle_mesh.h"
#include "tests/gl/gl_test.h"

namespace colmap_ext {
namespace program_test {

class ProgramTest : public CurrentGlTest {};

TEST_F(ProgramTest, UnknownUniformThrows) {
  Program program({"facet_normals.comp"});
  program.Set("num_facets", 1U);
  try {
    program.Set("num_faces", 1U);
    FAIL();
  } catch (const GlError& error) {
    EXPECT_STREQ(error.what(),
                 "The shader facet_normals.comp has no uniform num_faces");
  }
}

TEST_F(ProgramTest, UniformOfAnotherTypeThrows) {
  Program program({"facet_normals.comp"});
  program.Set("num_facets", 1.0F);
  EXPECT_THROW(ThrowOnGlError("uniform"), GlError);
}

TEST_F(ProgramTest, WhatDoesNotCompileThrows) {
  try {
    const Program program({"facet_normals.comp"}, {{"1st", 1}});
    FAIL();
  } catch (const GlError& error) {
    EXPECT_TRUE(std::string(error.what())
                    .starts_with("The shader facet_normals.comp does not "
                                 "compile:\n"));
  }
}

TEST_F(ProgramTest, WhatDoesNotLinkThrows) {
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

TEST(ShaderSources, StartWithTheirVersion) {
  for (const char* name : {"facet_ids.vert", "facet_ids.frag", "warp.comp"}) {
    EXPECT_TRUE(ShaderSource(name).starts_with("#version 450 core\n")) << name;
  }
}

TEST(ShaderSources, HoldWhatTheyInclude) {
  const std::string_view source = ShaderSource("gather.comp");
  EXPECT_EQ(source.find("#include"), std::string_view::npos);
  EXPECT_NE(source.find("ivec4 FacetBox(uint facet)"), std::string_view::npos);
}

TEST(ShaderSources, KeepSemicolonsAndBrackets) {
  const std::string_view source = ShaderSource("facet_ids.frag");
  EXPECT_NE(source.find("facet = uint(gl_PrimitiveID);"),
            std::string_view::npos);
  EXPECT_NE(ShaderSource("gather.comp").find("float sum[12] = float[12]("),
            std::string_view::npos);
}

TEST(ShaderSources, UnknownOneThrows) {
  EXPECT_THROW(ShaderSource("no.comp"), std::out_of_range);
}

}  // namespace program_test
}  // namespace colmap_ext
