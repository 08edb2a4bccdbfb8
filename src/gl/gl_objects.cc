#include "gl/gl_objects.h"

#include <algorithm>
#include <string>

#include "gl/gl_error.h"

namespace colmap_ext {

void GlBuffer::Resize(size_t num_bytes) {
  if (num_bytes != num_bytes_) {
    // Those of no bytes can not be bound.
    glNamedBufferData(Name(), std::max<size_t>(num_bytes, 4), nullptr,
                      GL_DYNAMIC_COPY);
    ThrowOnGlError("A buffer");
    num_bytes_ = num_bytes;
  }
}

void GlBuffer::SetZero() const {
  glClearNamedBufferData(Name(), GL_R8UI, GL_RED_INTEGER, GL_UNSIGNED_BYTE,
                         nullptr);
}

void GlBuffer::Write(const void* data, size_t num_bytes) const {
  if (num_bytes > 0) {
    glNamedBufferSubData(Name(), 0, num_bytes, data);
  }
}

void GlBuffer::ReadBytes(void* data, size_t num_bytes) const {
  if (num_bytes > 0) {
    glMemoryBarrier(GL_BUFFER_UPDATE_BARRIER_BIT);
    glGetNamedBufferSubData(Name(), 0, num_bytes, data);
  }
}

void GlBuffer::BindToStorage(GLuint index) const {
  GLint64 max_bytes = 0;
  glGetInteger64v(GL_MAX_SHADER_STORAGE_BLOCK_SIZE, &max_bytes);
  if (num_bytes_ > static_cast<size_t>(max_bytes)) {
    throw GlError("The mesh is too large for this OpenGL: it takes " +
                  std::to_string(num_bytes_) + " bytes in one piece, of " +
                  std::to_string(max_bytes));
  }
  glBindBufferBase(GL_SHADER_STORAGE_BUFFER, index, Name());
}

void GlBuffer::BindToStorage(GLuint index, size_t first_byte,
                             size_t num_bytes) const {
  glBindBufferRange(GL_SHADER_STORAGE_BUFFER, index, Name(),
                    static_cast<GLintptr>(first_byte),
                    static_cast<GLsizeiptr>(num_bytes));
}

GlTexture::GlTexture(GLenum format, int width, int height)
    : format_(format), width_(width), height_(height) {
  GLint max_size = 0;
  glGetIntegerv(GL_MAX_TEXTURE_SIZE, &max_size);
  if (std::max(width, height) > max_size) {
    throw GlError("An image is too large for this OpenGL: " +
                  std::to_string(width) + " x " + std::to_string(height) +
                  " pixels, of " + std::to_string(max_size));
  }
  GLuint name = 0;
  glCreateTextures(GL_TEXTURE_2D, 1, &name);
  name_ = GlName<DeleteOne<&glDeleteTextures>>(name);
  glTextureStorage2D(name, 1, format, width, height);
  ThrowOnGlError("A texture");
  glTextureParameteri(name, GL_TEXTURE_MIN_FILTER, GL_NEAREST);
  glTextureParameteri(name, GL_TEXTURE_MAG_FILTER, GL_NEAREST);
}

void GlTexture::Write(GLenum format, GLenum type, const void* pixels) const {
  glPixelStorei(GL_UNPACK_ALIGNMENT, 1);
  glTextureSubImage2D(Name(), 0, 0, 0, width_, height_, format, type, pixels);
}

void GlTexture::ReadBytes(GLenum format, GLenum type, void* pixels,
                          size_t num_bytes) const {
  glMemoryBarrier(GL_TEXTURE_UPDATE_BARRIER_BIT);
  glPixelStorei(GL_PACK_ALIGNMENT, 1);
  glGetTextureImage(Name(), 0, format, type, static_cast<GLsizei>(num_bytes),
                    pixels);
}

void GlTexture::BindToSampler(GLuint index) const {
  glBindTextureUnit(index, Name());
}

void GlTexture::BindToImage(GLuint index, GLenum access) const {
  glBindImageTexture(index, Name(), 0, GL_FALSE, 0, access, format_);
}

}  // namespace colmap_ext
