#version 450 core

uniform vec3 line_color;

layout(location = 0) out vec4 color;
layout(location = 1) out uint facet;

void main() {
  color = vec4(line_color, 1);
  facet = kNone;
}
