#pragma once

#include <cstddef>
#include <cstdint>
#include <filesystem>
#include <string>
#include <vector>

#include "formats/read_ply_cloud.h"
#include "formats/read_visibility.h"
#include "scene/picture_decoder.h"
#include "scene/view.h"
#include "workspace/sparse_model.h"

namespace colmap_ext {

// The image indices in fused.ply.vis are positions in the order in which COLMAP
// registered the images as it read sparse/, and that order differs by version.
// The file does not say which it is, so that it has to be found out.
struct ImageOrder {
  std::string name;     // as the option has it: "file", "image_id", "frame"
  std::string meaning;  // in words
  std::vector<size_t> images;  // index into the model's images, by .vis index
};

// The orders of COLMAP 3.8 to 4.x, each once even if several are the same:
//  file      that of images.bin (3.8 - 3.10)
//  image_id  ascending (3.11)
//  frame     that of frames.bin (3.12 and later), if there is one
//  frame_id  frames by ascending frame_id
std::vector<ImageOrder> CandidateImageOrders(const SparseModel& model);

// How well an order agrees with the cloud, from a sample of it.
struct OrderEvidence {
  size_t num_observations = 0;
  double inside = 0;  // share whose point is in front of and inside the image
  double facing = 0;  // share of which that image also sees the front, by the
                      // point's normal
};

struct VerifiedOrder {
  ImageOrder order;
  OrderEvidence evidence;
  std::string told_by;  // what spoke for it against others, in words
};

// Everything that speaks for or against an order.
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
// \param wanted  an order's name, or "auto".
// \throw FileError if none passes, or it can not be told which is right.
// \throw OptionError if the model has no order of the wanted name.
VerifiedOrder FindImageOrder(const OrderQuestion& question,
                             const std::string& wanted);

}  // namespace colmap_ext
