#pragma once

#include <cstddef>
#include <cstdint>
#include <filesystem>
#include <optional>

#include "base/rows.h"
#include "formats/byte_reader.h"
#include "formats/errors.h"

namespace colmap_ext {

// The images that see each point, as the file has them: [P] image indices, not
// sorted, not checked.
using Visibility = Rows<uint32_t>;

// What a .vis lies beside, and what to do where the two do not fit.
struct VisibilityOwner {
  const char* name;
  const char* what_to_do;
  std::optional<Alternative> alternative;
};

// What users bring: a cloud that was cropped or cleaned in an editor, which
// leaves the .vis behind (COLMAP's issue 592), or that never had one (966).
inline constexpr VisibilityOwner kFusedCloud = {
    "cloud",
    "run `colmap stereo_fusion` again, whose two files belong together, or "
    "crop with a tool that drops the same points from both",
    Alternative::kUseSparsePoints};

// Reads a fused.ply.vis: uint64 P, then for each point uint32 n and n times
// uint32 image index, little-endian.
//
// \param num_points  of the cloud beside it.
// \param owner  what it lies beside, for the messages.
// \throw FileError if the file is missing, truncated, too long, or of another
//        number of points; it says what to do. Never allocates more than the
//        file's size justifies.
Visibility ReadVisibility(const std::filesystem::path& path, size_t num_points,
                          const VisibilityOwner& owner = kFusedCloud);

// Reads the same piece by piece.
class VisibilityReader {
 public:
  // \throw FileError as ReadVisibility(), for what the header shows
  VisibilityReader(const std::filesystem::path& path, size_t num_points,
                   const VisibilityOwner& owner = kFusedCloud);

  // Appends the rows of the next points.
  // \throw FileError if the file ends before
  void Read(size_t num_points, Visibility* visibility);

  uint64_t RemainingBytes() const { return reader_.Remaining(); }
  void ExpectEnd() const { reader_.ExpectEnd(); }

 private:
  ByteReader reader_;
  size_t point_ = 0;  // the next one
};

}  // namespace colmap_ext
