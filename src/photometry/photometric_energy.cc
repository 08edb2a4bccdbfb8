#include "photometry/photometric_energy.h"

#include <cmath>

namespace colmap_ext {

double MeanZncc(double energy, double weight,
                const PhotometricOptions& options) {
  const double saturation = 1 + options.residual_floor;
  return weight > 0 ? -saturation * std::expm1(energy / weight / saturation)
                    : 0;
}

}  // namespace colmap_ext
