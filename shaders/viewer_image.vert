#version 450 core

// An image on its plane before its camera: two triangles.

#include "viewer_projection.glsl"

layout(std430, binding = 0) readonly buffer Corners { float corners[]; };

out vec2 place;  // in the image, shares of its width and height

void main() {
  int x = gl_VertexID & 1;
  int y = gl_VertexID >> 1;
  int i = 3 * gl_VertexID;
  place = vec2(x, y);
  // Corners are kept from the eye on, as the camera may lie in it.
  gl_Position = Project(vec3(corners[i], corners[i + 1], corners[i + 2]));
}
