#version 450 core

// The unit normals of all facets.

layout(local_size_x = kGroupSize) in;

#include "thread_index.glsl"

layout(std430, binding = 0) readonly buffer Vertices { float vertices[]; };
layout(std430, binding = 1) readonly buffer Facets { uint facets[]; };

// [F][3], towards free space; 0 where the facet is degenerate.
layout(std430, binding = 2) writeonly buffer Normals { double normals[]; };

uniform uint num_facets;

vec3 Vertex(uint index) {
  return vec3(vertices[3 * index], vertices[3 * index + 1],
              vertices[3 * index + 2]);
}

void main() {
  uint facet = ThreadIndex();
  if (facet >= num_facets) {
    return;
  }
  dvec3 corner = dvec3(Vertex(facets[3 * facet]));
  dvec3 edge_1 = dvec3(Vertex(facets[3 * facet + 1])) - corner;
  dvec3 edge_2 = dvec3(Vertex(facets[3 * facet + 2])) - corner;
  dvec3 normal = cross(edge_1, edge_2);
  double area = sqrt(dot(normal, normal));  // twice
  normal = area > 0 ? normal / area : dvec3(0);
  normals[3 * facet] = normal.x;
  normals[3 * facet + 1] = normal.y;
  normals[3 * facet + 2] = normal.z;
}
