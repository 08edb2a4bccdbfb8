#pragma once

#include <cstdlib>
#include <optional>
#include <string_view>

#include <gtest/gtest.h>

#include "gl/egl_context.h"

namespace colmap_ext {

// Whether it is a failure if there is no OpenGL: in continuous integration,
// where Mesa is installed.
inline bool IsGlRequired() {
  const char* value = std::getenv("COLMAP_EXT_REQUIRE_GL");
  return value != nullptr && std::string_view(value) == "1";
}

// A test that needs OpenGL. Where there is none it is skipped and says why, or
// fails if COLMAP_EXT_REQUIRE_GL is 1.
struct GlTest : testing::Test {
  void SetUp() override {
    try {
      context_.emplace();
    } catch (const NoGlError& error) {
      if (IsGlRequired()) {
        FAIL() << "COLMAP_EXT_REQUIRE_GL is 1, but: " << error.what();
      }
      GTEST_SKIP() << "OpenGL is NOT TESTED here: " << error.what();
    }
  }

  std::optional<EglContext> context_;
};

// With the context current.
struct CurrentGlTest : GlTest {
  void SetUp() override {
    GlTest::SetUp();
    if (context_) {
      current_.emplace(*context_);
    }
  }
  void TearDown() override { current_.reset(); }

 private:
  struct Current {
    explicit Current(const EglContext& context)
        : scope(context.MakeCurrent()) {}

    EglContext::Scope scope;
  };

  std::optional<Current> current_;
};

}  // namespace colmap_ext
