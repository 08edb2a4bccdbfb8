#pragma once

#include <cstdint>
#include <filesystem>

#include "formats/byte_reader.h"
#include "scene/depth_map.h"

namespace colmap_ext {

// The header of a depth map of patch_match_stereo, the text
// "WIDTH&HEIGHT&CHANNELS&".
// \return a map of this size, without depths.
// \throw FileError if it is not that, or not of one channel.
DepthMap ReadDepthMapHeader(ByteReader* reader);

// A depth map in COLMAP's format, of the whole image.
// \throw FileError if the file is missing, truncated, or not such a map.
DepthMap ReadDepthMap(const std::filesystem::path& path);

// The file of an image's depth map in a folder of such: NAME.geometric.bin,
// NAME.photometric.bin or NAME.bin, the first that is there.
// \return an empty path if there is none.
std::filesystem::path FindDepthMap(const std::filesystem::path& folder,
                                   const std::string& image_name);

}  // namespace colmap_ext
