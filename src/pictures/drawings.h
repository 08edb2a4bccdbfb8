#pragma once

#include <vector>

#include "mesh/triangle_mesh.h"
#include "scene/images.h"
#include "scene/point_cloud.h"
#include "scene/view.h"

namespace colmap_ext {

// Returns the color of an error: dark violet for 0 over green to yellow for
// `scale` and beyond, the color map viridis [Smith2015], interpolated linearly.
// It is readable for the color-blind.
// \pre scale > 0
Color ErrorColor(double error, double scale);

// Returns the end of a color scale: the smallest of 1, 2 and 5 times a power of
// ten that is not below the 95th percentile of the errors; 1 if that is 0.
double ErrorScale(std::vector<double> errors);

// Draws a mesh in the colors of its vertices' errors, ErrorColor(), above a
// color scale of 70 px height. Back sides of facets are red.
// \param colors  [V]
// \param scale  error at the end of the scale, scene units
ColorImage DrawErrors(const TriangleMesh& mesh,
                      const std::vector<Color>& colors, const View& view,
                      double scale);

// Draws points as squares of `side` px, the nearest on top. Points without
// colors are gray, where there is none it is white.
// \pre side > 0
ColorImage DrawPoints(const PointCloud& cloud, const View& view, int side);

// Returns a picture at another size; where it gets smaller each pixel is the
// mean of those it covers.
// \pre all sizes are positive
ColorImage ResizePicture(const ColorImage& image, int width, int height);

// Returns a picture whose longer side has at most max_size px, in the same
// proportions; one that is not longer stays as it is.
// \pre max_size > 0
ColorImage ShrinkPicture(ColorImage image, int max_size);

}  // namespace colmap_ext
