#pragma once

#include <cstdint>
#include <filesystem>
#include <string>
#include <vector>

#include <Eigen/Core>

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

  void Write(const std::filesystem::path& folder) const;

  std::string CamerasBinary() const;
  std::string ImagesBinary() const;
  std::string Points3DBinary() const;
  std::string FramesBinary() const;
  std::string CamerasText() const;
  std::string ImagesText() const;
  std::string Points3DText() const;
  std::string FramesText() const;
  std::string Ply() const;
  std::string Vis() const;
  std::string Ppm(size_t image) const;

 private:
  size_t NumSparsePoints() const;

  // The sparse points that an image sees.
  std::vector<size_t> SparsePointsOf(size_t image) const;

  // Which of the image's observations is that of a sparse point that it sees,
  // and where it lies.
  uint32_t Observation(size_t image, size_t point) const;
  Eigen::Vector2d Pixel(size_t image, size_t point) const;
};

// Colour of the sphere at a point of it.
Color SphereColor(const Eigen::Vector3d& point);

}  // namespace colmap_ext
