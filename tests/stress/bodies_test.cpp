// Sound bodies that are hard on the solver: each bakes within its stated error of an independent truth.
#include "tests/stress/claims.h"
#include "tests/stress/hard_meshes.h"
#include "tests/stress/ritz.h"

#include <gtest/gtest.h>

#include <functional>

namespace ringdown {
namespace {

using test::Body;

const Eigen::Vector3d kBlock(0.1, 0.08, 0.06);
const std::string kRitz = "Rayleigh-Ritz";

std::vector<double> block_truth(const modal::Material& material = test::kSteel) {
  return test::box_frequencies(kBlock, test::elastic(material), 40);
}

Body slivers(double degree, const std::string& name) {
  return {"slivers of " + name + " degree", "15 slivers across a block", test::box_with_slivers({5, 3, 4}, kBlock, degree), block_truth(),
          0.01, kRitz};
}

struct Case {
  const char* name;
  std::function<Body()> body;
};

void PrintTo(const Case& c, std::ostream* out) { *out << c.name; }

modal::Material with_poisson(double nu) {
  modal::Material m = test::kSteel;
  m.poisson_ratio = nu;
  return m;
}

Body poisson(double nu, double limit, fem::Element element = fem::Element::kTet10) {
  return {"nu = " + std::to_string(nu), "a block", test::box_mesh({5, 4, 3}, kBlock), block_truth(with_poisson(nu)),
          limit, kRitz, with_poisson(nu), element};
}

std::vector<Case> cases() {
  const auto box = [](auto cells) { return test::box_mesh(cells, kBlock); };
  std::vector<Case> all = {
      {"sound", [=] { return Body{"sound", "-", box(test::Cells{5, 3, 4}), block_truth(), 0.01, kRitz}; }},
      {"slivers10", [] { return slivers(10, "10"); }},
      {"slivers1", [] { return slivers(1, "1"); }},
      {"slivers01", [] { return slivers(0.1, "0.1"); }},
      {"slivers0001", [] { return slivers(0.001, "0.001"); }},
      {"slivers0000001", [] { return slivers(0.000001, "0.000001"); }},
      {"flat1000", [=] { return Body{"flat elements 1:1000", "layer", test::with_thin_layer(box(test::Cells{5, 4, 3}), 2, 3, 1e-3), block_truth(), 0.01, kRitz}; }},
      {"needles1000", [=] { return Body{"needles 1:1000", "column", test::with_thin_layer(test::with_thin_layer(box(test::Cells{5, 5, 3}), 0, 5, 1e-3), 1, 5, 1e-3), block_truth(), 0.02, kRitz}; }},
      {"plate500", [=] { return Body{"plate 500", "wall", test::box_mesh({20, 20, 1}, {0.5, 0.5, 0.001}), test::box_frequencies({0.5, 0.5, 0.001}, test::elastic(test::kSteel), {20, 20, 3}, 40, 40), 0.02, kRitz}; }},
      {"wire", [=] { return Body{"wire 1000", "wire", test::box_mesh({80, 1, 1}, {1, 0.001, 0.001}), test::box_frequencies({1, 0.001, 0.001}, test::elastic(test::kSteel), {30, 3, 3}, 40, 40), 0.02, kRitz}; }},
      {"shell", [=] { return Body{"shell", "wall", test::hollow_sphere(0.1, 0.1002, 2, 3), {2000,2000,2000,2000,2000,2000,5000,5000,5000,5000,10000,20000}, 0.02, "membrane", test::kSteel, fem::Element::kTet20, 3}; }},
  };
  for (const double nu : {-0.99, -0.5, 0.0, 0.3, 0.49, 0.499, 0.4999, 0.499999}) {
    all.push_back({"nu", [=] { return poisson(nu, 0.1); }});
    all.push_back({"nu", [=] { return poisson(nu, 0.1, fem::Element::kTet20); }});
  }
  return all;
}

class HardBody : public testing::TestWithParam<Case> {};
INSTANTIATE_TEST_SUITE_P(Stress, HardBody, testing::ValuesIn(cases()));
TEST_P(HardBody, BakesWithinItsStatedError) { test::expect_baked(GetParam().body()); }

}  // namespace
}  // namespace ringdown
