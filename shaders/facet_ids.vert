#version 450 core

// A vertex of the mesh in a view. Inverse depth is linear in the image, so that
// perspective is done with here: w is 1, and z the inverse depth, scaled to
// [0, 1).

#include "projection.glsl"

layout(location = 0) in vec3 position;  // world frame

uniform dvec2 size;  // of the image, px
uniform float depth_scale;

const double kSubpixels = 256;  // 1 / px, as raster/facet_id_buffer.cc

void main() {
  dvec3 point =
      cam_from_world_rotation * dvec3(position) + cam_from_world_translation;
  dvec2 pixel;
  if (!Project(point, pixel)) {
    // Nothing is left of the vertex' facets but the edges of the others, which
    // have no area. What there is of them is drawn by clipped_facets.vert.
    gl_Position = vec4(0, 0, 0, 1);
    gl_ClipDistance[0] = -1;
    return;
  }
  // As the rasterizer does, but with the same result everywhere.
  pixel = floor(pixel * kSubpixels + 0.5) / kSubpixels;
  gl_Position =
      vec4(vec2(2 * pixel / size - 1), float(depth_scale / point.z), 1);
  gl_ClipDistance[0] = 1e-20;
}
