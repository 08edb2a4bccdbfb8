#version 450 core

layout(location = 0) out uint facet;

uniform uint first_facet;  // of those that are drawn now

void main() { facet = first_facet + uint(gl_PrimitiveID); }
