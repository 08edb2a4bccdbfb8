#include "colmap_ext/options/image_order_option.h"

#include "colmap_ext/options/words.h"

namespace colmap_ext {

std::optional<ImageOrderKind> ParseImageOrder(const std::string& word) {
  using Order = std::optional<ImageOrderKind>;
  return ParseWord<Order>("image_order", word,
                          {{"auto", std::nullopt},
                           {"file", ImageOrderKind::kFile},
                           {"image_id", ImageOrderKind::kImageId},
                           {"frame", ImageOrderKind::kFrame},
                           {"frame_id", ImageOrderKind::kFrameId}});
}

}  // namespace colmap_ext
