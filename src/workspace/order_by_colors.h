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

// Tells orders in which a .vis may count the images apart by the colours of
// the points: those of the pixels that they project to are more alike in the
// right images. A handful of images in which the orders differ is read, and
// some points of each are compared.
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
