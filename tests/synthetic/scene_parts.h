#pragma once

#include <cstdint>

#include <Eigen/Core>

#include "tests/synthetic/scene.h"

// What the solids of the scenes are put together from: about the signed
// distances of a point from simple bodies, in scene units.
namespace colmap_ext::synthetic {

// Smallest of two, rounded off where they differ by less than `width`.
float SmoothMin(float a, float b, float width);

float Ellipsoid(const Eigen::Vector3f& p, const Eigen::Vector3f& center,
                const Eigen::Vector3f& radii);

// A box with rounded edges.
float RoundBox(const Eigen::Vector3f& p, const Eigen::Vector3f& center,
               const Eigen::Vector3f& half, float radius);

// The tube of radius `tube` around a circle that stands upright.
float Ring(const Eigen::Vector3f& p, const Eigen::Vector3f& center,
           float radius, float tube);

// A rod with round ends.
float Rod(const Eigen::Vector3f& p, const Eigen::Vector3f& from,
          const Eigen::Vector3f& to, float radius);

// Rounded relief of several sizes, and ridges; in [-1, 1].
float Relief(const Eigen::Vector3f& p, uint32_t seed);

uint32_t SurfaceSeed(const SceneOptions& options);

}  // namespace colmap_ext::synthetic
