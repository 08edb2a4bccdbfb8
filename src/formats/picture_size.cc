#include "formats/picture_size.h"

#include <array>
#include <cstring>

#include "formats/byte_reader.h"
#include "formats/errors.h"

namespace colmap_ext {

namespace {

using Bytes = std::array<uint8_t, 8>;

constexpr Bytes kPngSignature = {0x89, 'P', 'N', 'G', '\r', '\n', 0x1a, '\n'};

template <size_t kNumBytes>
uint32_t ReadBigEndian(ByteReader* reader) {
  uint32_t value = 0;
  for (size_t i = 0; i < kNumBytes; ++i) {
    value = value << 8 | reader->Read<uint8_t>("the picture");
  }
  return value;
}

// The first chunk is IHDR, which starts with the size.
PictureSize ReadPngSize(ByteReader* reader) {
  reader->Skip(8 + 8, "the picture");
  const int width = static_cast<int>(ReadBigEndian<4>(reader));
  const int height = static_cast<int>(ReadBigEndian<4>(reader));
  return {width, height};
}

// Goes from segment to segment up to the frame header (SOF).
PictureSize ReadJpegSize(ByteReader* reader) {
  reader->Skip(2, "the picture");
  while (true) {
    uint8_t marker = reader->Read<uint8_t>("the picture");
    while (marker == 0xff) {
      marker = reader->Read<uint8_t>("the picture");
    }
    const bool is_frame_header = marker >= 0xc0 && marker <= 0xcf &&
                                 marker != 0xc4 && marker != 0xc8 &&
                                 marker != 0xcc;
    const uint32_t length = ReadBigEndian<2>(reader);
    if (is_frame_header) {
      reader->Skip(1, "the picture");  // bits per sample
      const int height = static_cast<int>(ReadBigEndian<2>(reader));
      const int width = static_cast<int>(ReadBigEndian<2>(reader));
      return {width, height};
    }
    reader->Skip(length >= 2 ? length - 2 : reader->Remaining() + 1,
                 "the picture");
  }
}

}  // namespace

std::optional<PictureSize> ReadPictureSize(const std::filesystem::path& path) {
  try {
    ByteReader signature_reader(path);
    const Bytes signature = signature_reader.Read<Bytes>("the picture");
    ByteReader reader(path);
    if (signature == kPngSignature) {
      return ReadPngSize(&reader);
    }
    if (signature[0] == 0xff && signature[1] == 0xd8) {
      return ReadJpegSize(&reader);
    }
  } catch (const FileError&) {  // missing or damaged, as the caller will say
  }
  return std::nullopt;
}

}  // namespace colmap_ext
