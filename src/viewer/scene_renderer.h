#pragma once

#include <cstdint>
#include <optional>

#include "gl/gl_objects.h"
#include "scene/color_image.h"
#include "scene/view.h"
#include "viewer/draw_passes.h"
#include "viewer/shown_scene.h"

namespace colmap_ext {

// Draws scenes by OpenGL into its own pictures. Its context has to be current
// whenever it is used.
class SceneRenderer {
 public:
  SceneRenderer() = default;

  // Draws the view of a camera with exactly its size and intrinsics.
  // \throw GlError if OpenGL fails, or the picture is too large for it.
  void Draw(const ShownScene& scene, const View& view,
            const DrawSettings& settings);

  // The last picture.
  ColorImage Read() const;

  // The facet of the mesh at a pixel, or kNone.
  uint32_t FacetAt(int row, int col) const;

  // Copies the picture to a framebuffer of the context, 0: the window's.
  void ShowIn(GLuint framebuffer) const;

 private:
  // Textures to draw into, and the downsampled picture.
  struct Targets {
    Targets(int the_width, int the_height, int the_samples);

    int width, height;  // of the picture, px
    int samples;        // pixels drawn for one of the picture, a side
    GlTexture colors, facets, depths;  // of width * samples, ...
    GlTexture picture;
    GlFramebuffer drawn;  // colors, facets, depths
    GlFramebuffer shown;  // the picture
  };

  void Prepare(const View& view, const DrawSettings& settings);
  void DrawMesh(const ShownScene& scene, const DrawSettings& settings,
                const PictureProjection& projection);
  void DrawCameras(const ShownScene& scene,
                   const PictureProjection& projection);
  void DrawPicked(const TriangleMesh& mesh, uint32_t facet,
                  const PictureProjection& projection);
  void DrawImage(const ShownScene& scene, const DrawSettings& settings,
                 const PictureProjection& projection);

  MeshPass mesh_pass_;
  PointPass point_pass_;
  PointPass mesh_point_pass_;  // for meshes without facets
  LinePass line_pass_;
  ImagePass image_pass_;
  std::optional<Targets> targets_;
};

}  // namespace colmap_ext
