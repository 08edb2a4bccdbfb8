#pragma once

// The only place that knows how COLMAP's headers and interfaces moved between
// 3.8 and 4.x. What moved is detected, not looked up by version, so that
// development versions work as well.

#if __has_include(<colmap/controllers/option_manager.h>)
#include <colmap/controllers/option_manager.h>
#elif __has_include(<colmap/util/option_manager.h>) && \
    __has_include(<colmap/scene/reconstruction.h>)
#include <colmap/util/option_manager.h>
#else
#include "util/option_manager.h"
#endif

#include <filesystem>
#include <string>

#include "scene/color_image.h"
#include "scene/picture_decoder.h"

namespace colmap_ext {

// Starts COLMAP's logging (glog). To be called once, by main().
void InitializeLogging(char** argv);

// Parses a command's options. As all of COLMAP's commands do, `-h` prints the
// help and ends the program.
// \return false if the options are wrong, which has been said then.
bool ParseOptions(int argc, char** argv, colmap::OptionManager* options);

// Decodes pictures by COLMAP. Grey is (R + 2 G + B) / 4, as many of each as a
// camera's sensor has photosites, which leaves the least of their noise;
// COLMAP's own conversion weighs colours as the eye does.
PictureDecoder ColmapPictureDecoder();

// Writes a picture with COLMAP, in the format that the path's extension names.
// \return whether it is written.
bool WriteColorImage(const std::filesystem::path& path,
                     const ColorImage& image);

}  // namespace colmap_ext
