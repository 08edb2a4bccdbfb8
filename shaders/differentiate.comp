#version 450 core

// The energy's derivatives by the distance that the surface moves along its
// normal at each of the pair's pixels: through I_ij there, from all windows that
// the pixel takes part in.

layout(local_size_x = kTileWidth, local_size_y = kTileHeight) in;

#include "labels.glsl"
#include "tiles.glsl"
#include "window.glsl"

layout(binding = 2) uniform sampler2D windows;  // see correlate.comp

// First, second.
layout(binding = 0, rg32f) writeonly uniform image2D derivatives;

void main() {
  ivec2 pixel = TilePixel();
  if (pixel.x >= size_i.x || pixel.y >= size_i.y ||
      !IsLabeled(texelFetch(facets_i, pixel, 0).x)) {
    return;
  }
  vec4 value = texelFetch(warped, pixel, 0);
  ivec2 first = max(pixel - kWindowRadius, 0);
  ivec2 last = min(pixel + kWindowRadius, size_i - 1);
  float derivative = 0;
  float curvature = 0;
  for (int y = first.y; y <= last.y; ++y) {
    for (int x = first.x; x <= last.x; ++x) {
      float center = texelFetch(warped, ivec2(x, y), 0).z;
      if (center > 0 && TakesPart(value.z, center)) {
        vec4 window = texelFetch(windows, ivec2(x, y), 0);
        derivative += dot(window.xyz, vec3(value.xy, 1));
        curvature += window.w;
      }
    }
  }
  imageStore(derivatives, pixel,
             vec4(derivative * value.w, curvature * value.w * value.w, 0, 0));
}
