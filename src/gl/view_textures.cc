#include "gl/pair_passes.h"

#include <algorithm>
#include <cmath>
#include <span>
#include <utility>
#include <vector>

#include <tbb/parallel_for.h>

#include "mesh/mesh_in_image.h"
#include "raster/facet_clusters.h"

namespace colmap_ext {
namespace {

// The largest inverse depth of the facets' vertices before the camera, 1 /
// scene unit; 0 if there is none.
double MaxInverseDepth(const View& view, const TriangleMesh& mesh,
                       std::span<const FacetRange> ranges) {
  const Eigen::RowVector3d axis = view.cam_from_world_rotation.row(2);
  const double offset = view.cam_from_world_translation.z();
  double max = 0;
  ForEachFacet(ranges, [&](uint32_t facet) {
    for (const uint32_t vertex : mesh.facets[facet]) {
      const double z = axis * mesh.vertices[vertex].cast<double>() + offset;
      max = z > 0 ? std::max(max, 1 / z) : max;
    }
  });
  return max;
}

// See FacetsInView. Over much more of the image's plane the values of a card's
// floats change too much. Over less, edges would be cut that other facets have
// whole: their ends are moved to other subpixels, and pixels fall between the
// facets.
std::vector<ClippedCorner> ClipFacets(const View& view,
                                      const TriangleMesh& mesh,
                                      std::span<const FacetRange> ranges) {
  constexpr double kSubpixels = 256;   // 1 / px, as raster/facet_id_buffer.cc
  constexpr double kMargin = 1 << 13;  // px; a choice
  std::vector<ClippedCorner> corners;
  for (const uint32_t facet : FindClippedFacets(view, mesh, ranges)) {
    const std::vector<Eigen::Vector3d> part =
        ClipToImage(view, mesh, mesh.facets[facet], ImageBox(view, -kMargin));
    for (size_t k = 2; k < part.size(); ++k) {
      for (const Eigen::Vector3d& corner : {part[0], part[k - 1], part[k]}) {
        const Eigen::Vector2d pixel = view.ImageFromCam(corner);
        corners.push_back({static_cast<float>(
                               std::round(pixel.x() * kSubpixels) / kSubpixels),
                           static_cast<float>(
                               std::round(pixel.y() * kSubpixels) / kSubpixels),
                           static_cast<float>(1 / corner.z()), facet});
      }
    }
  }
  return corners;
}

// A power of two: scaled with it, inverse depths are below 1 and not rounded.
double DepthScale(double max_inverse_depth) {
  return max_inverse_depth > 0 ? std::exp2(-std::ilogb(max_inverse_depth) - 1)
                               : 1.0;
}

// For projection.glsl.
void SetProjection(const View& view, Program* program) {
  program->Set("cam_from_world_rotation", view.cam_from_world_rotation);
  program->Set("cam_from_world_translation", view.cam_from_world_translation);
  program->Set("focal", Eigen::Vector2d(view.fx, view.fy));
  program->Set("principal", Eigen::Vector2d(view.cx, view.cy));
}

}  // namespace

FacetsInView FindFacetsInView(const View& view, const TriangleMesh& mesh,
                              std::vector<FacetRange> ranges) {
  FacetsInView in_view{std::move(ranges), {}, 1};
  in_view.clipped = ClipFacets(view, mesh, in_view.ranges);
  double max_inverse_depth = MaxInverseDepth(view, mesh, in_view.ranges);
  for (const ClippedCorner& corner : in_view.clipped) {
    max_inverse_depth =
        std::max<double>(max_inverse_depth, corner.inverse_depth);
  }
  in_view.depth_scale = static_cast<float>(DepthScale(max_inverse_depth));
  return in_view;
}

FacetTextures::FacetTextures(int width, int height)
    : facets(GL_R32UI, width, height),
      depths(GL_DEPTH_COMPONENT32F, width, height) {}

FacetDrawer::FacetDrawer(double min_cosine)
    : min_cosine_(min_cosine),
      mask_({"mask.vert", "mask.frag"}),
      ids_({"facet_ids.vert", "facet_ids.frag"}),
      clipped_({"clipped_facets.vert", "clipped_facets.frag"}),
      facing_({"facing.comp"}) {
  constexpr GLuint kPosition = 0;
  constexpr GLuint kFacet = 1;
  for (const GLuint array : {vertex_array_.Name(), clipped_array_.Name()}) {
    glEnableVertexArrayAttrib(array, kPosition);
    glVertexArrayAttribFormat(array, kPosition, 3, GL_FLOAT, GL_FALSE, 0);
    glVertexArrayAttribBinding(array, kPosition, 0);
  }
  const GLuint array = clipped_array_.Name();
  glEnableVertexArrayAttrib(array, kFacet);
  glVertexArrayAttribIFormat(array, kFacet, 1, GL_UNSIGNED_INT,
                             offsetof(ClippedCorner, facet));
  glVertexArrayAttribBinding(array, kFacet, 0);
}

void FacetDrawer::Draw(const View& view, const FacetsInView& in_view,
                       const GlBuffer& vertices, const GlBuffer& facets,
                       FacetTextures* textures, const GrayImage* mask) {
  textures->depth_scale = in_view.depth_scale;
  BeginImages(view, textures);
  if (mask != nullptr) {
    DrawMask(*mask);
  }
  DrawImages(view, in_view.ranges, vertices, facets, textures);
  DrawClipped(view, in_view.clipped, *textures);
  glMemoryBarrier(GL_ALL_BARRIER_BITS);
  FindFacing(view, in_view.ranges, vertices, facets, textures);
}

void FacetDrawer::BeginImages(const View& view, FacetTextures* textures) {
  framebuffer_.Attach(GL_COLOR_ATTACHMENT0, textures->facets);
  framebuffer_.Attach(GL_DEPTH_ATTACHMENT, textures->depths);
  glBindFramebuffer(GL_FRAMEBUFFER, framebuffer_.Name());
  if (glCheckFramebufferStatus(GL_FRAMEBUFFER) != GL_FRAMEBUFFER_COMPLETE) {
    throw GlError("This OpenGL cannot draw into images of numbers");
  }
  glViewport(0, 0, view.width, view.height);
  glClipControl(GL_LOWER_LEFT, GL_ZERO_TO_ONE);
  glEnable(GL_CLIP_DISTANCE0);
  glEnable(GL_DEPTH_TEST);
  glDepthFunc(GL_GREATER);
  glDisable(GL_CULL_FACE);
  glDisable(GL_DITHER);
  const GLuint nothing[4] = {kNone, 0, 0, 0};
  const GLfloat far_away = 0;
  glClearBufferuiv(GL_COLOR, 0, nothing);
  glClearBufferfv(GL_DEPTH, 0, &far_away);
}

void FacetDrawer::DrawMask(const GrayImage& mask) {
  const GlTexture texture(GL_R8UI, mask.width, mask.height);
  texture.Write(GL_RED_INTEGER, GL_UNSIGNED_BYTE, mask.pixels.data());
  texture.BindToSampler(0);
  mask_.Use();
  glBindVertexArray(no_vertices_.Name());
  glDrawArrays(GL_TRIANGLES, 0, 3);
}

void FacetDrawer::DrawImages(const View& view,
                             std::span<const FacetRange> ranges,
                             const GlBuffer& vertices, const GlBuffer& facets,
                             FacetTextures* textures) {
  SetProjection(view, &ids_);
  ids_.Set("size", Eigen::Vector2d(view.width, view.height));
  ids_.Set("depth_scale", textures->depth_scale);
  ids_.Use();
  glVertexArrayVertexBuffer(vertex_array_.Name(), 0, vertices.Name(), 0,
                            sizeof(Eigen::Vector3f));
  glVertexArrayElementBuffer(vertex_array_.Name(), facets.Name());
  glBindVertexArray(vertex_array_.Name());
  for (const auto& [first, end] : ranges) {
    ids_.Set("first_facet", first);
    glDrawElements(GL_TRIANGLES, static_cast<GLsizei>(3 * (end - first)),
                   GL_UNSIGNED_INT,
                   reinterpret_cast<const void*>(sizeof(Facet) * first));
  }
}

void FacetDrawer::DrawClipped(const View& view,
                              const std::vector<ClippedCorner>& clipped,
                              const FacetTextures& textures) {
  GlBuffer corners;
  corners.Assign(clipped);
  clipped_.Set("size", Eigen::Vector2f(view.width, view.height));
  clipped_.Set("depth_scale", textures.depth_scale);
  clipped_.Use();
  glVertexArrayVertexBuffer(clipped_array_.Name(), 0, corners.Name(), 0,
                            sizeof(ClippedCorner));
  glBindVertexArray(clipped_array_.Name());
  glDrawArrays(GL_TRIANGLES, 0, static_cast<GLsizei>(clipped.size()));
}

void FacetDrawer::FindFacing(const View& view,
                             std::span<const FacetRange> ranges,
                             const GlBuffer& vertices, const GlBuffer& facets,
                             FacetTextures* textures) {
  const size_t num_facets = facets.NumBytes() / sizeof(Facet);
  textures->facing.Resize((num_facets + 31) / 32 * sizeof(uint32_t));
  textures->facing.SetZero();
  vertices.BindToStorage(0);
  facets.BindToStorage(1);
  textures->facing.BindToStorage(2);
  SetProjection(view, &facing_);
  facing_.Set("center", view.Center());
  facing_.Set("min_cosine", min_cosine_);
  for (const auto& [first, end] : ranges) {
    facing_.Set("first_facet", first);
    facing_.Set("end_facet", end);
    DispatchWithoutBarrier(facing_, end - first);
  }
  glMemoryBarrier(GL_ALL_BARRIER_BITS);
}

ViewTextures::ViewTextures(const GrayImage& gray_image, int width, int height)
    : image(GL_R8UI, width, height), drawn(width, height) {
  image.Write(GL_RED_INTEGER, GL_UNSIGNED_BYTE, gray_image.pixels.data());
}

size_t ViewTextures::Memory(const View& view, size_t num_facets) {
  constexpr size_t kBytesPerPixel = 9;  // Grey value, facet, depth.
  return kBytesPerPixel * view.width * view.height + num_facets / 8;
}

ViewTextureCache::ViewTextureCache(std::shared_ptr<ImagePyramid> images,
                                   double min_cosine, size_t max_memory)
    : images_(std::move(images)), drawer_(min_cosine), views_(max_memory) {}

void ViewTextureCache::SetMesh(std::shared_ptr<const TriangleMesh> mesh) {
  mesh_ = std::move(mesh);
  in_views_.clear();
  ++num_meshes_;
  vertices_.Assign(mesh_->vertices);
  facets_.Assign(mesh_->facets);
}

void ViewTextureCache::FindInViews() {
  if (!in_views_.empty()) {
    return;
  }
  const std::vector<View>& views = images_->Views();
  const FacetClusters clusters(*mesh_);
  in_views_.resize(views.size());
  tbb::parallel_for(size_t{0}, views.size(), [&](size_t view) {
    in_views_[view] =
        FindFacetsInView(views[view], *mesh_, clusters.InFrustum(views[view]));
  });
}

std::shared_ptr<const ViewTextures> ViewTextureCache::Get(size_t view) {
  const View& size = images_->Views()[view];
  const std::shared_ptr<ViewTextures> textures =
      views_.Get(view, ViewTextures::Memory(size, mesh_->facets.size()), [&] {
        return std::make_shared<ViewTextures>(*images_->Image(view), size.width,
                                              size.height);
      });
  if (textures->drawn_mesh != num_meshes_) {
    FindInViews();
    drawer_.Draw(size, in_views_[view], vertices_, facets_, &textures->drawn,
                 images_->Mask(view).get());
    textures->drawn_mesh = num_meshes_;
  }
  return textures;
}

}  // namespace colmap_ext
