#pragma once

#include <Eigen/Cholesky>
#include <Eigen/Core>

namespace colmap_ext {

// Weighted sum of squared distances to planes, up to a constant: x' A x + 2 b'
// x (Garland and Heckbert 1997, Surface simplification using quadric error
// metrics).
struct Quadric {
  Eigen::Matrix3d a = Eigen::Matrix3d::Zero();
  Eigen::Vector3d b = Eigen::Vector3d::Zero();

  // \param normal  of any length: its square is the weight.
  void AddPlane(const Eigen::Vector3d& normal, const Eigen::Vector3d& point) {
    a += normal * normal.transpose();
    b -= normal * normal.dot(point);
  }

  Quadric& operator+=(const Quadric& other) {
    a += other.a;
    b += other.b;
    return *this;
  }

  // Where the sum is least. In directions in which it hardly grows (along the
  // planes, if they are nearly parallel, or along their common edge) the point
  // stays where it starts: there the planes' noise alone would move it. Two
  // steps of iterated Tikhonov regularisation, without a threshold to jump at.
  Eigen::Vector3d Minimum(const Eigen::Vector3d& start) const {
    constexpr double kRegularization = 0.01;  // of the trace
    const double trace = a.trace();
    if (!(trace > 0)) {
      return start;
    }
    const Eigen::Matrix3d regular =
        a + kRegularization * trace * Eigen::Matrix3d::Identity();
    const Eigen::LLT<Eigen::Matrix3d> cholesky(regular);
    Eigen::Vector3d x = start;
    for (int step = 0; step < 2; ++step) {
      x -= cholesky.solve(a * x + b);
    }
    return x;
  }

  // By how much the mean of the squared distances grows from the minimum to
  // another place. Finite where there is a plane.
  double Growth(const Eigen::Vector3d& minimum,
                const Eigen::Vector3d& place) const {
    const Eigen::Vector3d way = place - minimum;
    return way.dot(a * way) / a.trace();
  }
};

}  // namespace colmap_ext
