#include "gl/egl_context.h"

#include <string>
#include <thread>

#include <epoxy/gl.h>

#include "tests/gl/gl_test.h"

namespace colmap_ext {
namespace egl_context_test {

std::string Version() {
  const GLubyte* version = glGetString(GL_VERSION);
  return version == nullptr ? "" : reinterpret_cast<const char*>(version);
}

TEST(EglContext, GraphicsCardThatIsNotThereThrows) {
  try {
    const EglContext context(1000);
    FAIL();
  } catch (const NoGlError& error) {
    EXPECT_NE(std::string(error.what()).find("No "), std::string::npos);
  }
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
  bool has_thrown = false;
  std::thread([&] {
    try {
      const EglContext::Scope second = context_->MakeCurrent();
    } catch (const GlError&) {
      has_thrown = true;
    }
  }).join();
  EXPECT_TRUE(has_thrown);
}

TEST_F(EglContextTest, ErrorsThrowOnce) {
  const EglContext::Scope scope = context_->MakeCurrent();
  EXPECT_NO_THROW(ThrowOnGlError("here"));
  glEnable(GL_TRIANGLES);
  try {
    ThrowOnGlError("here");
    FAIL();
  } catch (const GlError& error) {
    EXPECT_TRUE(std::string(error.what()).starts_with("here: OpenGL: "));
  }
  EXPECT_NO_THROW(ThrowOnGlError("here"));
}

}  // namespace egl_context_test
}  // namespace colmap_ext
