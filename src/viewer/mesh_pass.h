#pragma once

#include <map>
#include <memory>

#include "gl/gl_objects.h"
#include "gl/program.h"
#include "viewer/draw_settings.h"
#include "viewer/picture_projection.h"
#include "viewer/shown_scene.h"

namespace colmap_ext {

// Draws meshes, and what facet each pixel shows. What a mode needs of a mesh is
// uploaded when it is first drawn so.
class MeshPass {
 public:
  MeshPass();

  // \param line_width  of the wireframe, px
  void Draw(const std::shared_ptr<const ShownMesh>& mesh,
            const DrawSettings& settings, const PictureProjection& projection,
            float line_width);

  // Drops what was uploaded of meshes that the scene has no more.
  void Forget(const ShownScene& scene);

 private:
  struct Uploaded {
    std::weak_ptr<const ShownMesh> mesh;
    GlBuffer vertices;  // [V][3] float
    GlBuffer facets;    // [F][3] uint
    struct Colors {
      int of = 0;  // see ColorsOf
      float shading = 1;
      GlBuffer colors;  // uint
    };
    std::map<MeshMode, Colors> colors;
  };

  Uploaded& Upload(const std::shared_ptr<const ShownMesh>& mesh);

  Program program_;
  GlVertexArray vertex_array_;
  std::map<const ShownMesh*, Uploaded> uploaded_;
};

}  // namespace colmap_ext
