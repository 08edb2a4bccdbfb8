#version 450 core

layout(binding = 0) uniform sampler2D image;
uniform float opacity;

in vec2 place;
layout(location = 0) out vec4 color;

void main() { color = vec4(texture(image, place).rgb, opacity); }
