#pragma once

#include <vector>

#include "cameras/surface_patches.h"
#include "cameras/window_shift.h"
#include "photometry/photometric_energy.h"
#include "scene/view.h"

namespace colmap_ext {

// Compares each patch with each of its partners (CompareWindow()).
// \param radius  of the windows, px
// \param views  the cameras as they are now
// \return [values of patches.partners]
std::vector<WindowShift> ComparePatches(const PhotometricOptions& photometric,
                                        int radius, const DrawnScene& scene,
                                        const std::vector<View>& views,
                                        const SurfacePatches& patches);

}  // namespace colmap_ext
