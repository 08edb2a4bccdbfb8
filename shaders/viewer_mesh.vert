#version 450 core

#include "viewer_projection.glsl"

layout(location = 0) in vec3 position;  // world frame

out vec3 from_eye;

void main() {
  from_eye = FromEye(position);
  gl_Position = Project(from_eye);
}
