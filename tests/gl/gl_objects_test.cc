#include "gl/gl_objects.h"

#include <cstdint>
#include <utility>
#include <vector>

#include "gl/egl_context.h"
#include "tests/gl/gl_test.h"

namespace colmap_ext {
namespace gl_objects_test {

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

TEST_F(GlObjectsTest, TextureKeepsWhatIsWritten) {
  GlTexture texture(GL_R8UI, 5, 3);
  std::vector<uint8_t> pixels(15);
  for (uint8_t i = 0; i < 15; ++i) {
    pixels[i] = 17 * i;
  }
  texture.Write(GL_RED_INTEGER, GL_UNSIGNED_BYTE, pixels.data());
  EXPECT_EQ(texture.Read<uint8_t>(GL_RED_INTEGER, GL_UNSIGNED_BYTE), pixels);
  EXPECT_NO_THROW(ThrowOnGlError("texture"));
}

TEST_F(GlObjectsTest, TooLargeTextureThrows) {
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

}  // namespace gl_objects_test
}  // namespace colmap_ext
