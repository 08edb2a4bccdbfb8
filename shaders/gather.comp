#version 450 core

// Adds up what a direction of a pair says about each of its facets: one thread
// a facet, pixels in a fixed order.

layout(local_size_x = kGroupSize) in;

#include "thread_index.glsl"
#include "facet_box.glsl"

layout(std430, binding = 7) readonly buffer Vertices { float vertices[]; };

// [F'][12] of facets from first_sum on: energy, weight, number of pixels; slopes; curvatures.
layout(std430, binding = 8) buffer Sums { float sums[]; };

layout(binding = 0) uniform usampler2D facets_i;
layout(binding = 1) uniform sampler2D warped;       // see warp.comp
layout(binding = 2) uniform sampler2D energies;     // see correlate.comp
layout(binding = 3) uniform sampler2D derivatives;  // see differentiate.comp

uniform uint first_sum;
uniform int first_row;  // of image i, of those that are looked at
uniform int end_row;
uniform dmat3 ray_from_pixel_i;  // (u, v, 1) -> world ray with z 1

vec3 Vertex(uint index) {
  return vec3(vertices[3 * index], vertices[3 * index + 1],
              vertices[3 * index + 2]);
}

// The barycentric coordinates of what the pixels show of a facet's plane are
// quotients of functions that are linear over the image. With its corner c
// relative to the camera, gradient g of a coordinate, and ray d,
//   g . ((n . c) / (n . d) d - c) = d . ((n . c) g - (g . c) n) / (n . d).
// As they stand for a small part of the image, they are taken from its first
// pixel on, and up to there in double precision.
struct Barycentric {
  vec3 second;  // by u, by v, at the first pixel's centre
  vec3 third;
  vec3 denominator;
};

vec3 FromPixel(dvec3 by_ray, ivec2 first_pixel) {
  dvec3 by_pixel = by_ray * ray_from_pixel_i;
  return vec3(by_pixel.xy,
              dot(by_pixel, dvec3(dvec2(first_pixel) + 0.5, 1)));
}

Barycentric BarycentricOf(uint facet, ivec2 first_pixel) {
  dvec3 corner = dvec3(Vertex(facets[3 * facet]));
  dvec3 edge_1 = dvec3(Vertex(facets[3 * facet + 1])) - corner;
  dvec3 edge_2 = dvec3(Vertex(facets[3 * facet + 2])) - corner;
  dvec3 normal = cross(edge_1, edge_2);  // Times twice the area.
  corner -= center_i;
  // Times twice the area, as the normal is; its square is the denominator's.
  dvec3 gradient_1 = cross(edge_2, normal);
  dvec3 gradient_2 = cross(normal, edge_1);
  double square = dot(normal, normal);
  double distance = dot(normal, corner);
  return Barycentric(
      FromPixel((distance * gradient_1 - dot(gradient_1, corner) * normal) /
                    square,
                first_pixel),
      FromPixel((distance * gradient_2 - dot(gradient_2, corner) * normal) /
                    square,
                first_pixel),
      FromPixel(normal, first_pixel));
}

vec3 At(Barycentric barycentric, vec2 from_first) {
  vec3 pixel = vec3(from_first, 1);
  float scale = 1 / dot(barycentric.denominator, pixel);
  float second = scale * dot(barycentric.second, pixel);
  float third = scale * dot(barycentric.third, pixel);
  return vec3(1 - second - third, second, third);
}

void main() {
  uint thread = ThreadIndex();
  if (thread >= num_facets) {
    return;
  }
  uint facet = chosen_facets[first_facet + thread];
  ivec4 box = FacetBox(facet);
  box.y = max(box.y, first_row);
  box.w = min(box.w, end_row - 1);
  if (box.w < box.y) {
    return;
  }
  Barycentric barycentric = BarycentricOf(facet, box.xy);
  vec3 energy = vec3(0);  // energy, weight, number of pixels
  vec3 slopes = vec3(0);
  vec3 squares = vec3(0);   // curvatures 00, 11, 22
  vec3 products = vec3(0);  // 01, 02, 12
  for (int y = box.y; y <= box.w; ++y) {
    for (int x = box.x; x <= box.z; ++x) {
      ivec2 pixel = ivec2(x, y);
      if (texelFetch(facets_i, pixel, 0).x != facet ||
          !(texelFetch(warped, pixel, 0).z > 0)) {
        continue;
      }
      vec2 window = texelFetch(energies, pixel, 0).xy;
      energy += vec3(window, window.y > 0 ? 1 : 0);
      vec2 derivative = texelFetch(derivatives, pixel, 0).xy;
      vec3 phi = At(barycentric, vec2(pixel - box.xy));
      slopes += phi * derivative.x;
      squares += phi * phi * derivative.y;
      products += phi.xxy * phi.yzz * derivative.y;
    }
  }
  float sum[12] = float[12](energy.x, energy.y, energy.z, slopes.x, slopes.y,
                            slopes.z, squares.x, products.x, products.y,
                            squares.y, products.z, squares.z);
  for (int k = 0; k < 12; ++k) {
    sums[12 * (facet - first_sum) + k] += sum[k];
  }
}
