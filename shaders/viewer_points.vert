#version 450 core

#include "viewer_projection.glsl"

layout(location = 0) in vec3 position;  // world frame
layout(location = 1) in vec4 point_color;

uniform float diameter;  // px

out vec3 front;

void main() {
  front = point_color.rgb;
  gl_Position = Project(FromEye(position));
  gl_PointSize = diameter;
}
