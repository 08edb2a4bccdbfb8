// Based on: ISO/IEC 15948:2004, Portable Network Graphics.

#include "formats/encode_png.h"

#include <cstddef>
#include <cstdint>
#include <cstdlib>
#include <stdexcept>
#include <string_view>
#include <vector>

#include <zlib.h>

namespace colmap_ext {

namespace {

constexpr size_t kChannels = 3;

using Bytes = std::vector<uint8_t>;

std::string BigEndian(uint32_t number) {
  std::string bytes;
  for (const int shift : {24, 16, 8, 0}) {
    bytes += static_cast<char>(number >> shift);
  }
  return bytes;
}

std::string Chunk(std::string_view type, std::string_view data) {
  const std::string body = std::string(type) + std::string(data);
  const uLong sum =
      crc32_z(0, reinterpret_cast<const Bytef*>(body.data()), body.size());
  return BigEndian(static_cast<uint32_t>(data.size())) + body +
         BigEndian(static_cast<uint32_t>(sum));
}

Bytes RowOf(const ColorImage& image, int row) {
  Bytes bytes;
  bytes.reserve(kChannels * image.width);
  for (int col = 0; col < image.width; ++col) {
    const Color& color = image.At(row, col);
    bytes.insert(bytes.end(), color.begin(), color.end());
  }
  return bytes;
}

int Paeth(int left, int up, int corner) {
  const int estimate = left + up - corner;
  const int to_left = std::abs(estimate - left);
  const int to_up = std::abs(estimate - up);
  const int to_corner = std::abs(estimate - corner);
  if (to_left <= to_up && to_left <= to_corner) {
    return left;
  }
  return to_up <= to_corner ? up : corner;
}

int Predict(int filter, int left, int up, int corner) {
  switch (filter) {
    case 1:
      return left;
    case 2:
      return up;
    case 3:
      return (left + up) / 2;
    case 4:
      return Paeth(left, up, corner);
    default:
      return 0;
  }
}

// A row less what a filter predicts of it from its left and upper neighbors,
// below the filter's number.
Bytes Filter(int filter, const Bytes& row, const Bytes& above) {
  Bytes filtered = {static_cast<uint8_t>(filter)};
  filtered.reserve(row.size() + 1);
  for (size_t i = 0; i < row.size(); ++i) {
    const int left = i < kChannels ? 0 : row[i - kChannels];
    const int corner = i < kChannels ? 0 : above[i - kChannels];
    filtered.push_back(
        static_cast<uint8_t>(row[i] - Predict(filter, left, above[i], corner)));
  }
  return filtered;
}

// By the standard's own rule (section 12.8): what is left is least as signed
// bytes.
Bytes BestFilter(const Bytes& row, const Bytes& above) {
  Bytes best;
  int64_t least = -1;
  for (int filter = 0; filter < 5; ++filter) {
    Bytes filtered = Filter(filter, row, above);
    int64_t sum = 0;
    for (size_t i = 1; i < filtered.size(); ++i) {
      sum += std::abs(static_cast<int8_t>(filtered[i]));
    }
    if (least < 0 || sum < least) {
      least = sum;
      best = std::move(filtered);
    }
  }
  return best;
}

std::string Deflate(const Bytes& bytes) {
  uLongf size = compressBound(bytes.size());
  std::string deflated(size, '\0');
  if (compress2(reinterpret_cast<Bytef*>(deflated.data()), &size, bytes.data(),
                bytes.size(), Z_DEFAULT_COMPRESSION) != Z_OK) {
    throw std::runtime_error("a picture can not be compressed");
  }
  deflated.resize(size);
  return deflated;
}

}  // namespace

std::string EncodePng(const ColorImage& image) {
  // 8 bits, true colour, and the only compression, filters and order.
  const std::string header = BigEndian(image.width) + BigEndian(image.height) +
                             std::string("\x08\x02\x00\x00\x00", 5);
  Bytes rows;
  Bytes above(kChannels * image.width, 0);
  for (int i = 0; i < image.height; ++i) {
    Bytes row = RowOf(image, i);
    const Bytes filtered = BestFilter(row, above);
    rows.insert(rows.end(), filtered.begin(), filtered.end());
    above = std::move(row);
  }
  return "\x89PNG\r\n\x1a\n" + Chunk("IHDR", header) +
         Chunk("IDAT", Deflate(rows)) + Chunk("IEND", "");
}

}  // namespace colmap_ext
