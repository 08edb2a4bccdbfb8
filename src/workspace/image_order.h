#pragma once

#include <cstddef>
#include <filesystem>
#include <optional>
#include <vector>

#include "formats/read_ply.h"
#include "scene/images.h"
#include "scene/view.h"
#include "workspace/sparse_model.h"

namespace colmap_ext {

// The image indices in fused.ply.vis are positions in the order in which COLMAP
// registered the images as it read sparse/, and that order differs by version.
// The file does not say which it is, so that it has to be found out.
enum class ImageOrderKind {
  kFile,     // that of images.bin (COLMAP 3.8 - 3.10)
  kImageId,  // ascending (3.11)
  kFrame,    // that of frames.bin (3.12 and later), if there is one
  kFrameId,  // frames by ascending frame_id
};

// "file", "image_id", "frame", "frame_id".
const char* NameOf(ImageOrderKind kind);

struct ImageOrder {
  ImageOrderKind kind = ImageOrderKind::kFile;
  std::vector<size_t> images;  // index into the model's images, by .vis index
};

// The orders of COLMAP 3.8 to 4.x that the model has, even if they are equal.
std::vector<ImageOrder> CandidateImageOrders(const SparseModel& model);

// How well an order agrees with a sample of the cloud.
struct OrderEvidence {
  size_t num_observations = 0;
  // [0, 1] Share of the observations whose point projects inside the image.
  double inside = 0;
  // [0, 1] Share of those whose point's normal also faces the image; as
  // `inside` where the cloud has no normals.
  double facing = 0;
};

// Why an order was taken and no other.
enum class OrderReason {
  kWanted,     // by the caller
  kOnlyOne,    // the others are the same
  kOnlyFit,    // the points do not lie inside the images of the others
  kPositions,  // the points fit its images best by positions and normals
  kColors,     // the points fit its images best by their colours
};

struct VerifiedOrder {
  ImageOrder order;
  OrderEvidence evidence;
  OrderReason reason = OrderReason::kOnlyOne;
};

// What FindImageOrder() needs to compare orders.
struct OrderQuestion {
  const PlyCloud& cloud;
  const Visibility& visibility;
  const SparseModel& model;
  const std::vector<View>& views;  // as the model's images
  const std::filesystem::path& images_path;
  const PictureDecoder& decoder;
  const std::filesystem::path& visibility_path;  // for messages
};

// Finds the order that agrees with the cloud. Points lie inside the images that
// were fused to them, so that nearly all observations must project inside their
// image; if several orders pass, one of them must be clearly better by that and
// the normals, or else by the colours.
//
// \param wanted  the only order that is tried; nothing for all.
// \pre question.visibility has as many rows as the cloud has points
// \throw FileError if none passes, the result is ambiguous, or the
//        model does not have the wanted one.
VerifiedOrder FindImageOrder(const OrderQuestion& question,
                             std::optional<ImageOrderKind> wanted);

}  // namespace colmap_ext
