#pragma once

#include "scene/picture_decoder.h"

namespace colmap_ext {

// Decodes the binary pictures of 8 bits of Netpbm, PPM and PGM.
PictureDecoder NetpbmDecoder();

}  // namespace colmap_ext
