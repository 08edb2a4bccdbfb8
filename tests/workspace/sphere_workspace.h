#pragma once

#include <cstdint>
#include <filesystem>
#include <string>
#include <vector>

#include <Eigen/Core>

#include "scene/images.h"
#include "scene/point_cloud.h"
#include "scene/view.h"

namespace colmap_ext {

// A tiny dense workspace: a coloured sphere and cameras in a ring around it,
// written byte by byte from the formats' documentation, independently of what
// reads it.
struct SphereWorkspace {
  struct Image {
    uint32_t image_id;
    View view;
  };

  SphereWorkspace();

  std::vector<Image> images;      // in the order of images.bin
  std::vector<size_t> vis_order;  // images, by their index in the .vis
  std::vector<std::vector<uint32_t>> frames;      // image ids, for frames.bin
  std::vector<Eigen::Vector3f> points;            // radius 1 around the origin
  std::vector<std::vector<size_t>> point_images;  // indices into images
  bool write_normals = true;
  bool write_images = true;

  // Three images, two sparse points and two frames, so that files are small.
  static SphereWorkspace Small();

  void Write(const std::filesystem::path& folder) const;

  // \param extension  ".bin" or ".txt".
  void WriteModel(const std::filesystem::path& folder,
                  const std::string& extension) const;

  // \param name  cameras, images, points3D or frames, with an extension.
  std::string ModelFile(const std::string& name) const;
  std::string Ply() const;
  std::string Vis() const;
  std::string Ppm(size_t image) const;

 private:
  void AddImages(class ModelWriter* file) const;
  void AddPoints3D(class ModelWriter* file) const;
  void AddFrames(class ModelWriter* file) const;
  size_t NumSparsePoints() const;

  // The sparse points that an image sees.
  std::vector<size_t> SparsePointsOf(size_t image) const;

  // Which of the image's observations is that of a sparse point that it sees,
  // and where it lies.
  uint32_t Observation(size_t image, size_t point) const;
  Eigen::Vector2d Pixel(size_t image, size_t point) const;
};

// Decodes the binary pictures of 8 bits of Netpbm, PPM and PGM.
PictureDecoder NetpbmDecoder();

// Colour of the sphere at a point of it.
Color SphereColor(const Eigen::Vector3d& point);

}  // namespace colmap_ext
