#include "photometry/photometric_energy.h"

namespace colmap_ext {

std::string PhotometricOptions::Check() const {
  if (window_radius < 1 || window_radius > 7) {
    return "FacetwiseRefinement.window has to be odd and from 3 to 15";
  }
  if (!(noise_variance > 0)) {
    return "FacetwiseRefinement.noise_variance has to be positive";
  }
  if (!(residual_floor > 0)) {
    return "FacetwiseRefinement.residual_floor has to be positive";
  }
  if (!(min_cosine >= 0 && min_cosine < 1)) {
    return "FacetwiseRefinement.min_cosine has to be from 0 to 1";
  }
  return "";
}

}  // namespace colmap_ext
