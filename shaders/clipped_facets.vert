#version 450 core

// A corner of the part of a facet that lies before the camera, see
// facet_ids.vert.

layout(location = 0) in vec3 position;  // px, and the inverse depth
layout(location = 1) in uint facet_index;

flat out uint index;

uniform vec2 size;  // of the image, px
uniform float depth_scale;

void main() {
  gl_Position = vec4(2 * position.xy / size - 1, depth_scale * position.z, 1);
  gl_ClipDistance[0] = 1;
  index = facet_index;
}
