#include "tests/synthetic/noise.h"

#include <array>
#include <cmath>
#include <numbers>

#include "base/mix_bits.h"

namespace colmap_ext::synthetic {
namespace {

uint64_t Mix(uint64_t x) { return MixBits(x + kSplitMixStep); }

// Value in [-1, 1] of a lattice node; few operations, as it is called often.
float NodeValue(uint32_t x, uint32_t y, uint32_t z, uint32_t seed) {
  uint32_t h = seed + x * 0x8da6b343u + y * 0xd8163841u + z * 0xcb1ab31fu;
  h = (h ^ (h >> 15)) * 0x2c1b3c6du;
  h = (h ^ (h >> 12)) * 0x297a2d39u;
  h ^= h >> 15;
  return static_cast<float>(static_cast<int32_t>(h)) * 0x1p-31f;
}

// As std::floor, which is a call of a function on old machines.
int32_t Floor(float value) {
  const auto truncated = static_cast<int32_t>(value);
  return truncated - (value < truncated);
}

// Weight with vanishing first and second derivative at both ends.
float Fade(float t) { return t * t * t * (t * (t * 6 - 15) + 10); }

float Lerp(float t, float a, float b) { return a + t * (b - a); }

}  // namespace

uint64_t Hash(uint64_t seed, uint64_t a, uint64_t b, uint64_t c) {
  return Mix(Mix(Mix(Mix(seed) ^ a) ^ b) ^ c);
}

double Uniform(uint64_t hash) {
  return static_cast<double>(hash >> 11) * 0x1p-53;
}

double Gaussian(uint64_t hash) {
  // Box and Muller; 1 - u keeps the logarithm finite.
  const double radius = std::sqrt(-2 * std::log(1 - Uniform(hash)));
  return radius * std::cos(2 * std::numbers::pi * Uniform(Mix(hash)));
}

float ValueNoise(const Eigen::Vector3f& point, uint32_t seed) {
  const int32_t x = Floor(point.x());
  const int32_t y = Floor(point.y());
  const int32_t z = Floor(point.z());
  std::array<float, 8> v;
  for (uint32_t i = 0; i < 8; ++i) {
    v[i] = NodeValue(x + (i & 1), y + ((i >> 1) & 1), z + (i >> 2), seed);
  }
  const float s = Fade(point.x() - x);
  const float t = Fade(point.y() - y);
  const float r = Fade(point.z() - z);
  return Lerp(r, Lerp(t, Lerp(s, v[0], v[1]), Lerp(s, v[2], v[3])),
              Lerp(t, Lerp(s, v[4], v[5]), Lerp(s, v[6], v[7])));
}

float FractalNoise(const Eigen::Vector3f& point, int num_octaves, float gain,
                   uint32_t seed) {
  constexpr float kLacunarity = 1.9f;
  Eigen::Vector3f p = point;
  float amplitude = 1;
  float sum = 0;
  for (int octave = 0; octave < num_octaves; ++octave) {
    sum += amplitude * ValueNoise(p, seed + octave);
    amplitude *= gain;
    // A rotation by about 37 degrees around each of two axes.
    const Eigen::Vector3f turned(0.8f * p.x() - 0.6f * p.y(),
                                 0.6f * p.x() + 0.8f * p.y(), p.z());
    p = kLacunarity * Eigen::Vector3f(turned.x(),
                                      0.8f * turned.y() - 0.6f * turned.z(),
                                      0.6f * turned.y() + 0.8f * turned.z());
    p += Eigen::Vector3f(17.3f, -9.1f, 5.7f);
  }
  return sum;
}

float SmoothNoise(float x, float y, uint32_t seed) {
  // The variance of ValueNoise's section averaged over a cell: 1/3 at the
  // nodes, times the mean of Fade^2 + (1 - Fade)^2 = 181/231 for each axis.
  constexpr float kDeviation = 0.4524f;
  return ValueNoise(Eigen::Vector3f(x, y, 0), seed) / kDeviation;
}

}  // namespace colmap_ext::synthetic
