#version 450 core

// Correlates the windows around the pair's pixels (docs/method.md, sections 5.3
// and 5.5), as WindowCorrelation::Correlate() of
// photometry/window_correlation.cc.

layout(local_size_x = kTileWidth, local_size_y = kTileHeight) in;

#include "labels.glsl"
#include "tiles.glsl"
#include "window.glsl"

// By I_i, by I_ij, constant of the derivative; second derivative.
layout(binding = 0, rgba32f) writeonly uniform image2D windows;
// Energy, weight.
layout(binding = 1, rg32f) writeonly uniform image2D energies;

uniform float noise_variance;  // grey values squared
uniform float saturation;      // s
uniform float min_variance;    // grey values squared

const float kMinShare = 0.5;  // of a window's pixels

void Correlate(ivec2 center, vec4 center_value) {
  ivec2 first = max(center - kWindowRadius, 0);
  ivec2 last = min(center + kWindowRadius, size_i - 1);
  // Of the differences from the centre: less is lost to rounding.
  float count = 0;
  vec2 sum = vec2(0);
  vec3 products = vec3(0);  // I_i^2, I_ij^2, I_i I_ij
  for (int y = first.y; y <= last.y; ++y) {
    for (int x = first.x; x <= last.x; ++x) {
      vec4 pixel = texelFetch(warped, ivec2(x, y), 0);
      if (TakesPart(pixel.z, center_value.z)) {
        vec2 values = pixel.xy - center_value.xy;
        count += 1;
        sum += values;
        products += vec3(values * values, values.x * values.y);
      }
    }
  }
  vec2 mean = sum / count;
  vec3 moments =
      products / count - vec3(mean * mean, mean.x * mean.y);
  float smaller = min(moments.x, moments.y);
  float side = 2 * kWindowRadius + 1;
  if (!(count > kMinShare * side * side && smaller > min_variance)) {
    imageStore(windows, center, vec4(0));
    imageStore(energies, center, vec4(0));
    return;
  }
  float root = sqrt(moments.x * moments.y);
  float zncc = clamp(moments.z / root, -1, 1);
  float noisy = smaller + noise_variance;
  float weight = smaller / noisy;
  float weight_slope =
      moments.y < moments.x ? noise_variance / (noisy * noisy) : 0;
  float slope = saturation / (saturation - zncc);
  float cost = saturation * log(1 - zncc / saturation);
  float by_image = -weight * slope / (count * root);
  float by_warped =
      (zncc * weight * slope / moments.y + 2 * cost * weight_slope) / count;
  vec2 means = center_value.xy + mean;
  imageStore(windows, center,
             vec4(by_image, by_warped,
                  -by_image * means.x - by_warped * means.y,
                  weight * slope / (count * moments.y)));
  imageStore(energies, center, vec4(weight * cost, weight, 0, 0));
}

void main() {
  ivec2 center = TilePixel();
  if (center.x >= size_i.x || center.y >= size_i.y) {
    return;
  }
  vec4 center_value = texelFetch(warped, center, 0);
  if (center_value.z > 0 && IsLabeled(texelFetch(facets_i, center, 0).x)) {
    Correlate(center, center_value);
  } else {
    imageStore(windows, center, vec4(0));
    imageStore(energies, center, vec4(0));
  }
}
