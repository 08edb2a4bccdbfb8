#include "photometry/photometric_energy.h"

#include <cmath>

namespace colmap_ext {

std::string PhotometricOptions::Check() const {
  if (window_radius < 1 || window_radius > 7) {
    return "window has to be odd and from 3 to 15";
  }
  if (!(noise_variance > 0)) {
    return "noise_variance has to be positive";
  }
  if (!(residual_floor > 0)) {
    return "residual_floor has to be positive";
  }
  if (!(min_cosine >= 0 && min_cosine < 1)) {
    return "min_cosine has to be from 0 to 1";
  }
  return "";
}

double MeanZncc(double energy, double weight,
                const PhotometricOptions& options) {
  const double saturation = 1 + options.residual_floor;
  return weight > 0 ? -saturation * std::expm1(energy / weight / saturation)
                    : 0;
}

}  // namespace colmap_ext
