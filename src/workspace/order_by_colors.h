#pragma once

#include <cstddef>
#include <filesystem>
#include <optional>
#include <vector>

#include "formats/read_ply_cloud.h"
#include "formats/read_visibility.h"
#include "scene/picture_decoder.h"
#include "scene/view.h"

namespace colmap_ext {

// Finds the order in which a .vis counts the images by the colours of the
// points: a point's colour is nearest to the pixels that it projects to in the
// right images. Reads a handful of the images in which the orders differ, and
// compares some points of each.
//
// \param orders  index into the views by .vis index, for each order.
// \return the order that is clearly better than every other; nothing if there
//         is none, or no colours or pictures to compare.
std::optional<size_t> FindOrderByColors(
    const PlyCloud& cloud, const Visibility& visibility,
    const std::vector<View>& views, const std::filesystem::path& images_path,
    const PictureDecoder& decoder,
    const std::vector<std::vector<size_t>>& orders);

}  // namespace colmap_ext
