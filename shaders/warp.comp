#version 450 core

// I_ij: image I_j seen from i by way of the surface, see photometry/pair_warp.h.

layout(local_size_x = kTileWidth, local_size_y = kTileHeight) in;

#include "tiles.glsl"

layout(std430, binding = 1) readonly buffer Facets { uint facets[]; };
layout(std430, binding = 2) readonly buffer Normals { double normals[]; };
layout(std430, binding = 7) readonly buffer Vertices { float vertices[]; };

// See facing.comp.
layout(std430, binding = 9) readonly buffer FacingI { uint facing_i[]; };
layout(std430, binding = 10) readonly buffer FacingJ { uint facing_j[]; };

layout(binding = 0) uniform usampler2D facets_i;
layout(binding = 1) uniform usampler2D image_i;
layout(binding = 2) uniform usampler2D facets_j;
layout(binding = 3) uniform usampler2D image_j;
layout(binding = 4) uniform sampler2D depths_j;  // inverse, scaled
layout(binding = 5) uniform sampler2D depths_i;

// I_i, I_ij, inverse depth drawn in i, motion: the derivative of I_ij by the
// distance that the surface moves along its normal. An inverse depth of 0: not
// valid.
layout(binding = 0, rgba32f) writeonly uniform image2D warped;

uniform ivec2 size_i;  // px
uniform ivec2 size_j;  // px
uniform dvec3 center_i;
uniform dmat3 ray_from_pixel_i;      // (u, v, 1) -> world ray with z 1
uniform dmat3 pixel_j_from_pixel_i;  // of points at infinity, homogeneous
uniform dvec3 epipole;               // of camera i in j, homogeneous
uniform dvec3 i_from_j;              // between the centres, world frame
uniform mat3 rotation_j;             // camera j from world
uniform vec2 focal_j;                // px
uniform float depth_scale_i;
uniform float depth_scale_j;

// IsNearest() of raster/facet_id_buffer.h.
bool IsNearest(uint facet, vec3 normal, float distance_j, ivec2 nearest,
               float inverse_depth) {
  if (texelFetch(facets_j, nearest, 0).x == facet) {
    return true;
  }
  vec2 by_pixel = abs((rotation_j * normal).xy / focal_j);
  float slope = (by_pixel.x + by_pixel.y) / abs(distance_j);
  float footprint = inverse_depth / min(focal_j.x, focal_j.y);
  float scaled = texelFetch(depths_j, nearest, 0).x;
  if (scaled == 1) {  // masked
    return false;
  }
  float drawn = scaled / depth_scale_j;
  return drawn <= inverse_depth + 2 * (slope + footprint);
}

bool FacesBoth(uint facet) {
  return (facing_i[facet / 32] & facing_j[facet / 32] & 1u << facet % 32) != 0;
}

// Weights of the four values around a place between the middle two
// [Catmull1974], and their derivatives by the place.
void Weights(float t, out vec4 weights, out vec4 slopes) {
  weights = vec4(t * (-0.5 + t * (1 - 0.5 * t)), 1 + t * t * (-2.5 + 1.5 * t),
                 t * (0.5 + t * (2 - 1.5 * t)), t * t * (-0.5 + 0.5 * t));
  slopes = vec4(-0.5 + t * (2 - 1.5 * t), t * (-5 + 4.5 * t),
                0.5 + t * (4 - 4.5 * t), t * (-1 + 1.5 * t));
}

// The grey value of image j, and its derivatives by u and v.
vec3 SampleJ(dvec2 pixel) {
  ivec2 first = min(ivec2(pixel - 0.5), size_j - 2);
  vec2 share = vec2(pixel - 0.5 - dvec2(first));
  vec4 by_column, by_row, column_slopes, row_slopes;
  Weights(share.x, by_column, column_slopes);
  Weights(share.y, by_row, row_slopes);
  vec3 sampled = vec3(0);
  for (int k = 0; k < 4; ++k) {
    vec4 row;
    for (int l = 0; l < 4; ++l) {
      ivec2 at = clamp(first + ivec2(l, k) - 1, ivec2(0), size_j - 1);
      row[l] = float(texelFetch(image_j, at, 0).x);
    }
    float value = dot(by_column, row);
    sampled += vec3(by_row[k] * value, by_row[k] * dot(column_slopes, row),
                    row_slopes[k] * value);
  }
  return sampled;
}

dvec3 Normal(uint facet) {
  return dvec3(normals[3 * facet], normals[3 * facet + 1],
               normals[3 * facet + 2]);
}

dvec3 Corner(uint facet) {  // relative to camera i
  uint vertex = 3 * facets[3 * facet];
  return dvec3(vertices[vertex], vertices[vertex + 1], vertices[vertex + 2]) -
         center_i;
}

// IsSaturated() of scene/images.h.
bool IsSaturated(uint gray) { return gray == 0u || gray == 255u; }

// I_ij, inverse depth drawn in i, motion. In double precision up to the pixel in
// j: the derivative by it jumps from pixel to pixel.
vec3 Warp(ivec2 pixel_i) {
  uint facet = texelFetch(facets_i, pixel_i, 0).x;
  if (facet == kNone || !FacesBoth(facet)) {
    return vec3(0);
  }
  dvec3 pixel = dvec3(dvec2(pixel_i) + 0.5, 1);
  dvec3 ray = ray_from_pixel_i * pixel;
  dvec3 normal = Normal(facet);
  double distance_i = dot(normal, Corner(facet));
  double inverse_depth = dot(normal, ray) / distance_i;
  if (!(inverse_depth > 0)) {
    return vec3(0);
  }
  dvec3 ray_in_j = pixel_j_from_pixel_i * pixel;
  dvec3 p = ray_in_j + epipole * inverse_depth;
  if (!(p.z > 0)) {
    return vec3(0);
  }
  dvec2 pixel_j = p.xy / p.z;
  if (!(pixel_j.x >= 0.5 && pixel_j.y >= 0.5 && pixel_j.x < size_j.x - 0.5 &&
        pixel_j.y < size_j.y - 0.5)) {
    return vec3(0);
  }
  float distance_j = float(distance_i + dot(normal, i_from_j));
  if (!IsNearest(facet, vec3(normal), distance_j, ivec2(pixel_j),
                 float(inverse_depth / p.z))) {
    return vec3(0);
  }
  vec3 sampled = SampleJ(pixel_j);
  vec2 shift = vec2((ray_in_j.xy - pixel_j * ray_in_j.z) / (p.z * distance_i));
  float motion = dot(sampled.yz, shift);
  float drawn = texelFetch(depths_i, pixel_i, 0).x / depth_scale_i;
  return vec3(sampled.x, drawn, motion);
}

void main() {
  ivec2 pixel = TilePixel();
  if (pixel.x < size_i.x && pixel.y < size_i.y) {
    uint gray = texelFetch(image_i, pixel, 0).x;
    imageStore(warped, pixel,
               vec4(gray, IsSaturated(gray) ? vec3(0) : Warp(pixel)));
  }
}
