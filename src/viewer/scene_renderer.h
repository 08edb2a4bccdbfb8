#pragma once

#include <cstdint>
#include <map>
#include <memory>
#include <optional>
#include <span>
#include <utility>
#include <vector>

#include <Eigen/Core>

#include "gl/gl_objects.h"
#include "scene/images.h"
#include "scene/point_cloud.h"
#include "scene/view.h"
#include "viewer/shown_scene.h"

namespace colmap_ext {

// The camera of a picture, and its near plane.
struct PictureProjection {
  View view;
  double near = 1e-3;  // scene units
};

// A picture as a texture with linear interpolation.
GlTexture ImageTexture(const ColorImage& image);

// What the graphics card holds of shared objects, by their addresses.
template <typename Object, typename Uploaded>
class Uploads {
 public:
  // Uploads an object at its first use, and drops those that no longer exist.
  // \param upload  returns what is uploaded
  template <typename Upload>
  Uploaded& Get(const std::shared_ptr<const Object>& object,
                const Upload& upload) {
    std::erase_if(
        all_, [](const auto& entry) { return entry.second.first.expired(); });
    auto place = all_.find(object.get());
    if (place == all_.end()) {
      place = all_.try_emplace(object.get(), object, upload()).first;
    }
    return place->second.second;
  }

 private:
  std::map<const Object*, std::pair<std::weak_ptr<const Object>, Uploaded>>
      all_;
};

// Draws images on planes in front of their cameras. From its own camera, an
// image covers exactly the scene that it shows.
class ImagePass {
 public:
  ImagePass();

  // \param view  the camera of the image, which may have another size.
  // \param depth  of the plane, scene units
  // \param opacity  0 ... 1
  void Draw(const std::shared_ptr<const ColorImage>& image, const View& view,
            double depth, double opacity, const PictureProjection& projection);

 private:
  Program program_;
  GlVertexArray vertex_array_;
  GlBuffer corners_;  // [4][3] float, from the eye on, world frame
  Uploads<ColorImage, GlTexture> textures_;
};

// Draws points as discs; uploads them at first use.
class PointPass {
 public:
  PointPass();

  // \param owner  of the points; the same owner has the same points.
  // \param colors  [P] or empty: gray
  // \param diameter  of the discs, px
  void Draw(const std::shared_ptr<const void>& owner,
            std::span<const Eigen::Vector3f> positions,
            std::span<const Color> colors, const PictureProjection& projection,
            float diameter);

 private:
  Program program_;
  GlVertexArray vertex_array_;
  std::shared_ptr<const void> owner_;  // of the uploaded points
  GlBuffer positions_;                 // [P][3] float
  GlBuffer colors_;                    // [P][4] uchar
};

// Draws lines of a width in pixels.
class LinePass {
 public:
  LinePass();

  // \param ends  [2 L] world frame, scene units
  // \param color  red, green, blue, 0 ... 1
  // \param width  px
  void Draw(const std::vector<Eigen::Vector3f>& ends,
            const Eigen::Vector3f& color, const PictureProjection& projection,
            float width);

 private:
  Program program_;
  GlVertexArray vertex_array_;
  GlBuffer ends_;  // [2 L][3] float
};

// Draws meshes, and the index of the facet at each pixel. Uploads the data of a
// mode at its first use.
class MeshPass {
 public:
  MeshPass();

  // \param line_width  of the wireframe, px
  void Draw(const std::shared_ptr<const ShownMesh>& mesh,
            const DrawSettings& settings, const PictureProjection& projection,
            float line_width);

 private:
  struct Uploaded {
    GlBuffer vertices;  // [V][3] float
    GlBuffer facets;    // [F][3] uint
    struct Colors {
      int of = 0;  // see ColorsOf
      float shading = 1;
      GlBuffer colors;  // uint
    };
    std::map<MeshMode, Colors> colors;
  };

  Program program_;
  GlVertexArray vertex_array_;
  Uploads<ShownMesh, Uploaded> uploads_;
};

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
