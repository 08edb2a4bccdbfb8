#include "spatial/orientation.h"

#include <array>
#include <cmath>
#include <limits>

namespace colmap_ext {
namespace {

using Eigen::Vector3d;
using Eigen::Vector3f;

// A sum of doubles without rounding: an expansion of parts that do not overlap,
// in ascending order [Shewchuk1997, theorem 10, Grow-Expansion with zero
// elimination].
template <int kMaxTerms>
class ExactSum {
 public:
  // \pre called kMaxTerms times at most; nothing underflows
  void Add(double term) {
    int size = 0;
    for (int i = 0; i < size_; ++i) {
      const double sum = term + parts_[i];
      const double shared = sum - term;
      const double rest = (term - (sum - shared)) + (parts_[i] - shared);
      if (rest != 0) {
        parts_[size++] = rest;
      }
      term = sum;
    }
    if (term != 0) {
      parts_[size++] = term;
    }
    size_ = size;
  }

  // The largest part outweighs all others together.
  int Sign() const { return size_ == 0 ? 0 : parts_[size_ - 1] > 0 ? 1 : -1; }

 private:
  std::array<double, kMaxTerms> parts_{};
  int size_ = 0;
};

using DeterminantSum = ExactSum<48>;

// Adds scale * x y z. The product of two floats is exact in a double, that of
// three is the sum of two doubles.
void AddProduct(double scale, float x, float y, float z, DeterminantSum* sum) {
  const double xy = scale * x * y;
  const double high = xy * z;
  sum->Add(std::fma(xy, z, -high));
  sum->Add(high);
}

// Adds scale * det(a, b, c).
void AddDeterminant(double scale, const Vector3f& a, const Vector3f& b,
                    const Vector3f& c, DeterminantSum* sum) {
  for (int i = 0; i < 3; ++i) {
    const int j = (i + 1) % 3;
    const int k = (i + 2) % 3;
    AddProduct(scale, a[i], b[j], c[k], sum);
    AddProduct(-scale, a[i], b[k], c[j], sum);
  }
}

int ExactSide(const Vector3f& a, const Vector3f& b, const Vector3f& c,
              const Vector3f& d) {
  // Common where vertices share a position, and quick to tell.
  if (a == b || a == c || a == d || b == c || b == d || c == d) {
    return 0;
  }
  DeterminantSum sum;
  AddDeterminant(1, a, b, c, &sum);
  AddDeterminant(-1, d, b, c, &sum);
  AddDeterminant(-1, a, d, c, &sum);
  AddDeterminant(-1, a, b, d, &sum);
  return sum.Sign();
}

int ExactTurn(const Vector3f& a, const Vector3f& b, const Vector3f& c, int i,
              int j) {
  ExactSum<6> sum;
  const auto add_cross = [&](const Vector3f& u, const Vector3f& v) {
    sum.Add(static_cast<double>(u[i]) * v[j]);
    sum.Add(-static_cast<double>(u[j]) * v[i]);
  };
  add_cross(a, b);
  add_cross(b, c);
  add_cross(c, a);
  return sum.Sign();
}

constexpr double kEpsilon = std::numeric_limits<double>::epsilon();

}  // namespace

// The bound on the error is (7 + 56 e) e with e = 2^-53 [Shewchuk1997, bound A
// of orient3d]; here it is 16 e.
int Side(const Vector3f& a, const Vector3f& b, const Vector3f& c,
         const Vector3f& d) {
  const Vector3d apex = d.cast<double>();
  const Vector3d u = a.cast<double>() - apex;
  const Vector3d v = b.cast<double>() - apex;
  const Vector3d w = c.cast<double>() - apex;
  const double vw_x = v.y() * w.z(), wv_x = v.z() * w.y();
  const double vw_y = v.z() * w.x(), wv_y = v.x() * w.z();
  const double vw_z = v.x() * w.y(), wv_z = v.y() * w.x();
  const double determinant =
      u.x() * (vw_x - wv_x) + u.y() * (vw_y - wv_y) + u.z() * (vw_z - wv_z);
  const double bound = 8 * kEpsilon *
                       (std::abs(u.x()) * (std::abs(vw_x) + std::abs(wv_x)) +
                        std::abs(u.y()) * (std::abs(vw_y) + std::abs(wv_y)) +
                        std::abs(u.z()) * (std::abs(vw_z) + std::abs(wv_z)));
  if (std::abs(determinant) > bound) {
    return determinant > 0 ? 1 : -1;
  }
  return ExactSide(a, b, c, d);
}

// The bound on the error is (3 + 16 e) e [Shewchuk1997, bound A of orient2d];
// here it is 4 e.
int Turn(const Vector3f& a, const Vector3f& b, const Vector3f& c, int axis) {
  const int i = (axis + 1) % 3;
  const int j = (axis + 2) % 3;
  const Vector3d u = b.cast<double>() - a.cast<double>();
  const Vector3d v = c.cast<double>() - a.cast<double>();
  const double left = u[i] * v[j];
  const double right = u[j] * v[i];
  if (std::abs(left - right) >
      2 * kEpsilon * (std::abs(left) + std::abs(right))) {
    return left > right ? 1 : -1;
  }
  return ExactTurn(a, b, c, i, j);
}

bool AreCollinear(const Vector3f& a, const Vector3f& b, const Vector3f& c) {
  return Turn(a, b, c, 0) == 0 && Turn(a, b, c, 1) == 0 &&
         Turn(a, b, c, 2) == 0;
}

}  // namespace colmap_ext
