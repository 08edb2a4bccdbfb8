#pragma once

#include <optional>

#include <gtest/gtest.h>

#include "gl/egl_context.h"
#include "gl/gl_error.h"

namespace colmap_ext {

// A test that needs OpenGL; it is skipped, and says why, where there is none.
class GlTest : public testing::Test {
 protected:
  void SetUp() override {
    try {
      context_.emplace();
    } catch (const NoGlError& error) {
      GTEST_SKIP() << error.what();
    }
  }

  std::optional<EglContext> context_;
};

// With the context current.
class CurrentGlTest : public GlTest {
 protected:
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
