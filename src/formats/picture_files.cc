#include "formats/picture_files.h"

#include <array>
#include <stdexcept>

#include <png.h>

#include "formats/atomic_file.h"
#include "formats/byte_reader.h"
#include "formats/errors.h"

namespace colmap_ext {
namespace {

using Signature = std::array<uint8_t, 8>;

constexpr Signature kPngSignature = {0x89, 'P',  'N',  'G',
                                     '\r', '\n', 0x1a, '\n'};

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

// Goes from segment to segment of a JPEG up to one whose marker is wanted, and
// behind its length.
template <typename IsWanted>
void FindJpegSegment(const IsWanted& is_wanted, ByteReader* reader) {
  reader->Skip(2, "the picture");
  while (true) {
    uint8_t marker = reader->Read<uint8_t>("the picture");
    while (marker == 0xff) {
      marker = reader->Read<uint8_t>("the picture");
    }
    const uint32_t length = ReadBigEndian<2>(reader);
    if (is_wanted(marker)) {
      return;
    }
    reader->Skip(length >= 2 ? length - 2 : reader->Remaining() + 1,
                 "the picture");
  }
}

bool IsFrameHeader(uint8_t marker) {
  return marker >= 0xc0 && marker <= 0xcf && marker != 0xc4 && marker != 0xc8 &&
         marker != 0xcc;
}

PictureSize ReadJpegSize(ByteReader* reader) {
  FindJpegSegment(&IsFrameHeader, reader);
  reader->Skip(1, "the picture");  // bits per sample
  const int height = static_cast<int>(ReadBigEndian<2>(reader));
  const int width = static_cast<int>(ReadBigEndian<2>(reader));
  return {width, height};
}

// Goes from chunk to chunk up to the last, IEND.
void FindPngEnd(ByteReader* reader) {
  constexpr uint32_t kEnd = 0x49454e44;
  reader->Skip(8, "the picture");
  for (uint32_t type = 0; type != kEnd;) {
    const uint32_t length = ReadBigEndian<4>(reader);
    type = ReadBigEndian<4>(reader);
    reader->Skip(uint64_t{length} + 4, "the picture");  // and a checksum
  }
}

// The end marker, which no picture's data hold, behind the first scan's header.
void FindJpegEnd(ByteReader* reader) {
  FindJpegSegment([](uint8_t marker) { return marker == 0xda; }, reader);
  for (uint8_t last = 0, byte = 0; last != 0xff || byte != 0xd9;) {
    last = byte;
    byte = reader->Read<uint8_t>("the picture");
  }
}

enum class PictureFormat { kUnknown, kPng, kJpeg };

// \throw FileError if there is no such file.
PictureFormat FormatOf(const std::filesystem::path& path) {
  const Signature signature = ByteReader(path).Read<Signature>("the picture");
  return signature == kPngSignature ? PictureFormat::kPng
         : signature[0] == 0xff && signature[1] == 0xd8
             ? PictureFormat::kJpeg
             : PictureFormat::kUnknown;
}

}  // namespace

bool IsPictureCutOff(const std::filesystem::path& path) {
  PictureFormat format = PictureFormat::kUnknown;
  try {
    format = FormatOf(path);
    ByteReader reader(path);
    if (format == PictureFormat::kPng) {
      FindPngEnd(&reader);
    } else if (format == PictureFormat::kJpeg) {
      FindJpegEnd(&reader);
    }
  } catch (const FileError&) {
    return format != PictureFormat::kUnknown;
  }
  return false;
}

std::optional<PictureSize> ReadPictureSize(const std::filesystem::path& path) {
  try {
    const PictureFormat format = FormatOf(path);
    ByteReader reader(path);
    if (format != PictureFormat::kUnknown) {
      return format == PictureFormat::kPng ? ReadPngSize(&reader)
                                           : ReadJpegSize(&reader);
    }
  } catch (const FileError&) {  // missing or damaged, as the caller will say
  }
  return std::nullopt;
}

std::string EncodePng(const ColorImage& image) {
  png_image header = {};
  header.version = PNG_IMAGE_VERSION;
  header.width = static_cast<png_uint_32>(image.width);
  header.height = static_cast<png_uint_32>(image.height);
  header.format = PNG_FORMAT_RGB;
  png_alloc_size_t size = PNG_IMAGE_PNG_SIZE_MAX(header);
  std::string bytes(size, '\0');
  if (png_image_write_to_memory(&header, bytes.data(), &size, 0,
                                image.pixels.data(), 0, nullptr) == 0) {
    throw std::runtime_error("a picture cannot be compressed");
  }
  bytes.resize(size);
  return bytes;
}

void WritePng(const std::filesystem::path& path, const ColorImage& image) {
  WriteText(path, EncodePng(image));
}

}  // namespace colmap_ext
