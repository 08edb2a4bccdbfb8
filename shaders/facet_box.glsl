// The facets of a pair, and the pixels of image i that they may be drawn at.

layout(std430, binding = 0) readonly buffer DrawnVertices {
  float drawn_vertices[];
};
layout(std430, binding = 1) readonly buffer Facets { uint facets[]; };
layout(std430, binding = 3) readonly buffer ChosenFacets { uint chosen_facets[]; };

uniform uint first_facet;  // of the pair, in chosen_facets
uniform uint num_facets;
uniform dvec3 center_i;
uniform mat3 pixel_from_world_i;  // from a point relative to camera i to its
                                  // pixel, homogeneous
uniform ivec2 size_i;             // px

vec3 DrawnVertex(uint index) {
  return vec3(drawn_vertices[3 * index], drawn_vertices[3 * index + 1],
              drawn_vertices[3 * index + 2]);
}

// First column and row, last column and row; none if the last are below the
// first.
ivec4 FacetBox(uint facet) {
  // px. More than vertices are rounded to be drawn, 1/512, and than floats are:
  // a few 2^-24 of coordinates up to 2^15.
  const float kMargin = 1.0 / 16;
  vec2 low = vec2(1e9);
  vec2 high = vec2(-1e9);
  for (uint k = 0; k < 3; ++k) {
    dvec3 vertex = dvec3(DrawnVertex(facets[3 * facet + k]));
    vec3 pixel = pixel_from_world_i * vec3(vertex - center_i);
    if (!(pixel.z > 0)) {
      return ivec4(0, 0, -1, -1);
    }
    low = min(low, pixel.xy / pixel.z);
    high = max(high, pixel.xy / pixel.z);
  }
  // The pixels whose centres are within.
  low = clamp(ceil(low - 0.5 - kMargin), vec2(0), vec2(size_i));
  high = clamp(floor(high - 0.5 + kMargin), vec2(-1), vec2(size_i - 1));
  return ivec4(low, high);
}
