// The picture that is drawn: a pinhole camera whose first row is the lowest of
// OpenGL's. Depth is near / z, which is as exact far away as it is near.
uniform vec3 eye;       // world frame, and what floats leave of it
uniform vec3 eye_rest;
uniform mat3 cam_from_world_rotation;
uniform vec2 focal;     // px
uniform vec2 principal; // px
uniform vec2 size;      // of the picture, px
uniform float near;     // scene units

vec3 FromEye(vec3 point) { return (point - eye) - eye_rest; }

// \param from_eye  world frame
vec4 Project(vec3 from_eye) {
  vec3 point = cam_from_world_rotation * from_eye;
  vec2 pixel = focal * point.xy + principal * point.z;  // times z
  return vec4(2 * pixel / size - point.z, near, point.z);
}
