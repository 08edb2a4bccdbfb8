#version 450 core

// Which facets face the camera, enough to be compared: DrawFacets() of
// raster/facet_id_buffer.h.

layout(local_size_x = kGroupSize) in;

#include "projection.glsl"
#include "thread_index.glsl"

layout(std430, binding = 0) readonly buffer Vertices { float vertices[]; };
layout(std430, binding = 1) readonly buffer Facets { uint facets[]; };

// One bit a facet, the lowest bits first; one thread for each facet.
layout(std430, binding = 2) writeonly buffer Facing { uint facing[]; };

uniform uint first_facet;  // a multiple of 32
uniform uint end_facet;    // behind the last
uniform dvec3 center;  // of the camera, world frame
uniform double min_cosine;

dvec3 Vertex(uint index) {
  return dvec3(vertices[3 * index], vertices[3 * index + 1],
               vertices[3 * index + 2]);
}

dvec3 InCamera(dvec3 vertex) {
  return cam_from_world_rotation * vertex + cam_from_world_translation;
}

bool IsFacing(uint facet) {
  dvec3 a = Vertex(facets[3 * facet]);
  dvec3 b = Vertex(facets[3 * facet + 1]);
  dvec3 c = Vertex(facets[3 * facet + 2]);
  dvec3 a_in = InCamera(a);
  dvec3 b_in = InCamera(b);
  dvec3 c_in = InCamera(c);
  if (max(a_in.z, max(b_in.z, c_in.z)) <= 0) {
    return false;
  }
  dvec2 pixel;
  bool is_whole =
      Project(a_in, pixel) && Project(b_in, pixel) && Project(c_in, pixel);
  dvec3 normal = cross(b - a, c - a);
  dvec3 to_camera = center - (a + b + c) / 3;
  return dot(normal, to_camera) >
         (is_whole ? min_cosine : 0) * sqrt(dot(normal, normal) * dot(to_camera, to_camera));
}

shared uint group_bits[kGroupSize / 32];

void main() {
  uint thread = gl_LocalInvocationIndex;
  if (thread % 32 == 0) {
    group_bits[thread / 32] = 0;
  }
  barrier();
  uint facet = first_facet + ThreadIndex();
  if (facet < end_facet && IsFacing(facet)) {
    atomicOr(group_bits[thread / 32], 1u << facet % 32);
  }
  barrier();
  if (facet < end_facet && thread % 32 == 0) {
    facing[facet / 32] = group_bits[thread / 32];
  }
}
