#version 450 core

// A point as a disc.

in vec3 front;
layout(location = 0) out vec4 color;
layout(location = 1) out uint facet;

void main() {
  if (length(gl_PointCoord - 0.5) > 0.5) {
    discard;
  }
  color = vec4(front, 1);
  facet = kNone;
}
