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
  const float kFar = 1e9;  // px
  vec2 low = vec2(kFar);
  vec2 high = vec2(-kFar);
  vec3 pixels[3];  // homogeneous
  for (uint k = 0; k < 3; ++k) {
    dvec3 vertex = dvec3(DrawnVertex(facets[3 * facet + k]));
    pixels[k] = pixel_from_world_i * vec3(vertex - center_i);
    if (pixels[k].z > 0) {
      low = min(low, pixels[k].xy / pixels[k].z);
      high = max(high, pixels[k].xy / pixels[k].z);
    }
  }
  // Where an edge passes the camera's plane it goes to infinity in the image.
  for (uint k = 0; k < 3; ++k) {
    vec3 from = pixels[k];
    vec3 to = pixels[(k + 1) % 3];
    if ((from.z > 0) != (to.z > 0)) {
      vec2 direction = (from.xy * to.z - to.xy * from.z) * (to.z - from.z);
      low = mix(low, vec2(-kFar), lessThanEqual(direction, vec2(0)));
      high = mix(high, vec2(kFar), greaterThanEqual(direction, vec2(0)));
    }
  }
  // The pixels whose centres are within.
  low = clamp(ceil(low - 0.5 - kMargin), vec2(0), vec2(size_i));
  high = clamp(floor(high - 0.5 + kMargin), vec2(-1), vec2(size_i - 1));
  return ivec4(low, high);
}
