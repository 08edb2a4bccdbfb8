#pragma once

// The only place that handles differences between the headers and interfaces of
// COLMAP 3.8 to 4.x. Differences are detected, not looked up by version, so
// that development versions work as well.

#include <string>

#include "scene/images.h"

namespace colmap_ext {

// Starts COLMAP's logging (glog). To be called once, by main().
void InitializeLogging(char** argv);

// Our version and COLMAP's, with the commits where they are known:
// "colmap_ext 1.0.0 (0123abc) with COLMAP 3.8 (Commit ...)".
std::string Versions();

// Decodes pictures by COLMAP. Grey is (R + 2 G + B) / 4, as many of each as a
// camera's sensor has photosites, which leaves the least of their noise;
// COLMAP's own conversion weighs colours as the eye does.
PictureDecoder ColmapPictureDecoder();

}  // namespace colmap_ext
