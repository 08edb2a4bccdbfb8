#version 450 core

layout(location = 0) out uint facet;

void main() { facet = uint(gl_PrimitiveID); }
