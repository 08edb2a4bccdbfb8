#include "gl/program.h"

#include <stdexcept>

#include <gtest/gtest.h>

namespace colmap_ext {
namespace shader_sources_test {

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

}  // namespace shader_sources_test
}  // namespace colmap_ext
