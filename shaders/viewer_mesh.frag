#version 450 core

// A facet, flat, in the colours of its mode. What it needs of its corners it
// fetches, so that they are there once.

layout(std430, binding = 0) readonly buffer Vertices { float vertices[]; };
layout(std430, binding = 1) readonly buffer Facets { uint facets[]; };
layout(std430, binding = 2) readonly buffer Colors { uint colors[]; };

uniform vec3 eye;
uniform vec3 eye_rest;
uniform vec3 sun;         // unit, to the light, world frame
uniform int color_of;     // kPlain, kVertices, kFacets, kNormals
uniform float shading;    // 0: none, 1: full
uniform int wireframe;    // 1: draw the edges
uniform int backfaces;    // 1: draw the backs of facets red
uniform float line_width; // px

const vec3 kPlainColor = vec3(0.78, 0.78, 0.76);
const vec3 kBackColor = vec3(0.85, 0.25, 0.2);
const vec3 kLineColor = vec3(0.1, 0.15, 0.3);

in vec3 from_eye;
layout(location = 0) out vec4 color;
layout(location = 1) out uint facet;

vec3 Corner(int k) {
  uint i = 3 * facets[3 * gl_PrimitiveID + k];
  return (vec3(vertices[i], vertices[i + 1], vertices[i + 2]) - eye) - eye_rest;
}

vec3 VertexColor(int k) {
  return unpackUnorm4x8(colors[facets[3 * gl_PrimitiveID + k]]).rgb;
}

vec3 FrontColor(vec3 normal, vec3 weights) {
  if (color_of == kVertices) {
    return weights.x * VertexColor(0) + weights.y * VertexColor(1) +
           weights.z * VertexColor(2);
  }
  if (color_of == kFacets) {
    return unpackUnorm4x8(colors[gl_PrimitiveID]).rgb;
  }
  return color_of == kNormals ? 0.5 * (normal + 1) : kPlainColor;
}

// A sun from above and to the left of the camera, a light at the camera, and a
// little from everywhere.
float Light(vec3 normal, vec3 direction) {
  return 0.12 + 0.63 * max(0, dot(normal, sun)) + 0.25 * abs(dot(normal, direction));
}

// How much of the pixel is an edge. Facets of few pixels get fainter ones, or
// nothing would be left but lines.
// \param gradients  of the weights, 1 / scene unit; what is fetched has no
//        derivatives where neighbours are other facets.
float Line(vec3 weights, mat3 gradients) {
  vec3 step = max(abs(dFdx(from_eye) * gradients) +
                      abs(dFdy(from_eye) * gradients),
                  1e-12);  // a px
  vec3 distances = weights / step;
  float nearest = min(distances.x, min(distances.y, distances.z));
  float height = 1 / max(step.x, max(step.y, step.z));  // px
  float strength = clamp(height / line_width / 8, 0.15, 1);
  return strength * clamp(0.5 * line_width + 0.5 - nearest, 0, 1);
}

void main() {
  vec3 a = Corner(0), b = Corner(1), c = Corner(2);
  vec3 cross_product = cross(b - a, c - a);
  float doubled_area = length(cross_product);
  vec3 normal = cross_product / max(doubled_area, 1e-37);
  vec3 weights = vec3(dot(cross(b - from_eye, c - from_eye), normal),
                      dot(cross(c - from_eye, a - from_eye), normal),
                      dot(cross(a - from_eye, b - from_eye), normal)) /
                 max(doubled_area, 1e-37);
  bool is_back = dot(normal, from_eye) > 0;
  bool is_marked = is_back && backfaces == 1;
  float light = Light(is_back ? -normal : normal, normalize(from_eye));
  vec3 front = is_marked ? kBackColor : FrontColor(normal, weights);
  front *= mix(1, light, is_marked ? 1 : shading);
  if (wireframe == 1) {
    mat3 gradients = mat3(cross(normal, c - b), cross(normal, a - c),
                          cross(normal, b - a)) /
                     max(doubled_area, 1e-37);
    front = mix(front, kLineColor, Line(weights, gradients));
  }
  color = vec4(front, 1);
  facet = uint(gl_PrimitiveID);
}
