#version 450 core

// Masked pixels show no facet, and nothing is seen behind them: they are nearer
// than every facet.

layout(binding = 0) uniform usampler2D mask;  // 0: masked

layout(location = 0) out uint facet;

void main() {
  if (texelFetch(mask, ivec2(gl_FragCoord.xy), 0).x != 0u) {
    discard;
  }
  facet = kNone;
  gl_FragDepth = 1;
}
