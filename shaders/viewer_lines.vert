#version 450 core

// Lines of a width in pixels, two triangles each.

#include "viewer_projection.glsl"

layout(std430, binding = 0) readonly buffer Ends { float ends[]; };  // [2 L][3]

uniform float line_width;  // px

vec3 End(int i) {
  return vec3(ends[3 * i], ends[3 * i + 1], ends[3 * i + 2]);
}

void main() {
  int line = gl_VertexID / 6;
  int corner = gl_VertexID % 6;
  bool is_second = corner == 1 || corner == 2 || corner == 4;
  float side = corner == 2 || corner == 4 || corner == 5 ? 0.5 : -0.5;
  vec4 first = Project(FromEye(End(2 * line)));
  vec4 second = Project(FromEye(End(2 * line + 1)));
  if (first.w < near && second.w < near) {
    gl_Position = vec4(0, 0, 2, 1);  // Not to be seen.
    return;
  }
  // What is behind the camera is cut off.
  if (first.w < near) {
    first = mix(first, second, (near - first.w) / (second.w - first.w));
  } else if (second.w < near) {
    second = mix(second, first, (near - second.w) / (first.w - second.w));
  }
  vec2 along = 0.5 * size * (second.xy / second.w - first.xy / first.w);  // px
  vec2 across = vec2(-along.y, along.x) / max(length(along), 1e-6);
  vec4 end = is_second ? second : first;
  end.xy += side * line_width * across * 2 / size * end.w;
  gl_Position = end;
}
