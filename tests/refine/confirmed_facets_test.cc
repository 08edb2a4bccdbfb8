#include "refine/confirmed_facets.h"

#include <algorithm>
#include <cmath>

#include <gtest/gtest.h>

#include "tests/mesh/shapes.h"

namespace colmap_ext {
namespace confirmed_facets_test {

// Terms of weight 1 whose correlation is that of a function of the facet's
// first corner.
template <typename Zncc>
PhotometricTerms TermsOf(const TriangleMesh& mesh, const Zncc& zncc) {
  const double saturation = 1 + PhotometricOptions().residual_floor;
  PhotometricTerms terms;
  for (const Facet& facet : mesh.facets) {
    const double correlation = zncc(mesh.vertices[facet[0]]);
    terms.facets.push_back(
        {static_cast<float>(saturation *
                            std::log(1 - correlation / saturation)),
         1});
  }
  return terms;
}

std::vector<uint8_t> Confirmed(const TriangleMesh& mesh,
                               const PhotometricTerms& terms,
                               double min_zncc = 0.5) {
  return ConfirmedFacets(mesh, MakeVertexRings(mesh), terms, {}, min_zncc);
}

TEST(ConfirmedFacets, AreThoseOfTheHalfThatCorrelates) {
  const TriangleMesh mesh = MakeBumpySphere(0.06F);
  const std::vector<uint8_t> is_confirmed =
      Confirmed(mesh, TermsOf(mesh, [](const Eigen::Vector3f& at) {
                  return at.x() > 0 ? 0.9 : 0.05;
                }));
  for (size_t i = 0; i < mesh.facets.size(); ++i) {
    const float x = mesh.vertices[mesh.facets[i][0]].x();
    if (std::abs(x) > 0.3F) {
      EXPECT_EQ(is_confirmed[i] != 0, x > 0) << x;
    }
  }
}

// One bad facet among good ones, as a highlight makes it, is no reason.
TEST(ConfirmedFacets, DependOnTheSurroundings) {
  const TriangleMesh mesh = MakeBumpySphere(0.06F);
  PhotometricTerms terms =
      TermsOf(mesh, [](const Eigen::Vector3f& /*at*/) { return 0.9; });
  terms.facets[7].energy = 0;
  const std::vector<uint8_t> is_confirmed = Confirmed(mesh, terms);
  EXPECT_EQ(std::count(is_confirmed.begin(), is_confirmed.end(), 0), 0);
}

TEST(ConfirmedFacets, AreAllWhereNothingIsComparedOrAsked) {
  const TriangleMesh mesh = MakeBumpySphere(0.1F);
  PhotometricTerms terms =
      TermsOf(mesh, [](const Eigen::Vector3f& /*at*/) { return -0.5; });
  std::vector<uint8_t> is_confirmed = Confirmed(mesh, terms);
  EXPECT_EQ(std::count(is_confirmed.begin(), is_confirmed.end(), 1), 0);
  is_confirmed = Confirmed(mesh, terms, -1);
  EXPECT_EQ(std::count(is_confirmed.begin(), is_confirmed.end(), 0), 0);
  terms.facets.assign(mesh.facets.size(), {});
  is_confirmed = Confirmed(mesh, terms);
  EXPECT_EQ(std::count(is_confirmed.begin(), is_confirmed.end(), 0), 0);
}

}  // namespace confirmed_facets_test
}  // namespace colmap_ext
