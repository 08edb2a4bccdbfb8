#pragma once

#include <cstdint>

#include <Eigen/Core>

namespace colmap_ext::synthetic {

// Random numbers without state: each is a hash of its purpose (a seed, an
// image, a pixel ...), so that none depends on the order of the work.
uint64_t Hash(uint64_t seed, uint64_t a = 0, uint64_t b = 0, uint64_t c = 0);

// Uniform in [0, 1), of a hash.
double Uniform(uint64_t hash);

// Normal with mean 0 and deviation 1, of a hash.
double Gaussian(uint64_t hash);

// Smooth noise on a lattice of unit cells, uniform in [-1, 1] at its nodes.
float ValueNoise(const Eigen::Vector3f& point, uint32_t seed);

// Octaves of ValueNoise, each of 1.9 times the frequency of the one before and
// of `gain` times its amplitude; the first has unit cells and unit amplitude.
// Every octave is turned and shifted, so that lattices do not show.
float FractalNoise(const Eigen::Vector3f& point, int num_octaves, float gain,
                   uint32_t seed);

// ValueNoise of the plane scaled to deviation 1 on average: the part of an
// error that neighboring pixels share.
float SmoothNoise(float x, float y, uint32_t seed);

}  // namespace colmap_ext::synthetic
