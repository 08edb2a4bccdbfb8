// The view that is drawn.
uniform dmat3 cam_from_world_rotation;
uniform dvec3 cam_from_world_translation;
uniform dvec2 focal;      // px
uniform dvec2 principal;  // px

// The pixel coordinates of a point in the camera's frame. False if it is not
// before the camera, or too far outside of the image for its facets to be drawn.
bool Project(dvec3 point, out dvec2 pixel) {
  const double kFar = 1048576;  // px, as raster/facet_id_buffer.cc
  bool is_before = point.z > 0;
  pixel = focal * point.xy / (is_before ? point.z : 1) + principal;
  return is_before && max(abs(pixel.x), abs(pixel.y)) < kFar;
}
