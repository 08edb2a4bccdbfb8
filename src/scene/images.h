#pragma once

#include <cstddef>
#include <cstdint>
#include <filesystem>
#include <functional>
#include <optional>
#include <vector>

#include "scene/point_cloud.h"

namespace colmap_ext {

// Pixel (row, col) has its centre at (u, v) = (col + 0.5, row + 0.5), see View.
template <typename Pixel>
struct Image {
  int width = 0;              // px
  int height = 0;             // px
  std::vector<Pixel> pixels;  // [height * width], rows from the top

  const Pixel* Row(int row) const {
    return pixels.data() + static_cast<size_t>(row) * width;
  }

  const Pixel& At(int row, int col) const { return Row(row)[col]; }
};

using GrayImage = Image<uint8_t>;
using ColorImage = Image<Color>;

// Whether a grey value may stand for a brighter or darker one. What such pixels
// show is no texture.
inline bool IsSaturated(uint8_t gray) { return gray == 0 || gray == 255; }

// Reads the image of a view, in the size that the view has.
using ReadGrayImage = std::function<GrayImage(size_t view)>;

// Depths along the z axis of a view, of all pixels or of every `stride`-th
// pixel of every `stride`-th row, starting in the middle of the first `stride`.
// They belong to the centres of the pixels, (col + 0.5, row + 0.5), see View.
struct DepthMap {
  int width = 0;              // samples a row
  int height = 0;             // rows of samples
  int stride = 1;             // px
  std::vector<float> depths;  // [height * width], scene units; 0: nothing seen

  // The row (or column) of pixels that a row (or column) of samples is of.
  int Pixel(int sample) const { return sample * stride + stride / 2; }

  size_t Index(int row, int col) const {
    return static_cast<size_t>(row) * width + col;
  }
};

// Decodes picture files. Handed in, so that nothing but the program depends on
// a library of picture formats. Called by several threads at a time.
struct PictureDecoder {
  // \return nothing if there is no such file, or it is no picture.
  std::function<std::optional<ColorImage>(const std::filesystem::path&)>
      read_color;
  std::function<std::optional<GrayImage>(const std::filesystem::path&)>
      read_gray;
};

}  // namespace colmap_ext
