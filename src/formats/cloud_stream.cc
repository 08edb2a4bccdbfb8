#include "formats/cloud_stream.h"

#include <algorithm>
#include <utility>

#include "formats/byte_reader.h"
#include "formats/errors.h"
#include "formats/ply_header.h"
#include "formats/ply_numbers.h"

namespace colmap_ext {
namespace {

// Reads up to the vertices.
PlyElement SkipToVertices(const PlyHeader& header,
                          const std::filesystem::path& path,
                          PlyNumberReader* numbers) {
  for (const PlyElement& element : header.elements) {
    numbers->ExpectRoomFor(element);
    if (element.name == "vertex") {
      return element;
    }
    numbers->Skip(element);
  }
  throw FileError(path, "not a point cloud: it has no vertices");
}

}  // namespace

uint64_t CountPlyVertices(const std::filesystem::path& path) {
  ByteReader reader(path);
  const PlyHeader header = ReadPlyHeader(&reader);
  PlyNumberReader numbers(&reader, header.format, "the vertices");
  return SkipToVertices(header, path, &numbers).count;
}

void StreamCloud(const std::filesystem::path& path,
                 const std::filesystem::path& visibility_path,
                 size_t max_points,
                 const std::function<void(CloudPiece piece)>& visit) {
  ByteReader reader(path);
  const PlyHeader header = ReadPlyHeader(&reader);
  PlyNumberReader numbers(&reader, header.format, "the vertices");
  PlyElement rest = SkipToVertices(header, path, &numbers);
  VisibilityReader visibility(visibility_path, rest.count);
  while (rest.count > 0) {
    PlyElement piece = rest;
    piece.count = std::min<uint64_t>(rest.count, max_points);
    CloudPiece read;
    read.cloud = ReadPlyVertices(piece, path, &numbers);
    visibility.Read(piece.count, &read.visibility);
    rest.count -= piece.count;
    visit(std::move(read));
  }
  visibility.ExpectEnd();
}

}  // namespace colmap_ext
