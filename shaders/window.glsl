// The pixels that a window is made of.

layout(binding = 0) uniform usampler2D facets_i;
layout(binding = 1) uniform sampler2D warped;  // see warp.comp

uniform ivec2 size_i;              // px
uniform float max_relative_depth;  // the largest relative difference of inverse
                                   // depths within one surface

bool TakesPart(float inverse_depth, float center) {
  return inverse_depth > 0 &&
         abs(inverse_depth - center) <= max_relative_depth * center;
}
