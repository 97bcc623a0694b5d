// A material file for tests, and a way to change a word in it.
#pragma once

#include <gtest/gtest.h>

#include <string>

namespace ringdown::test {

inline const std::string kGood = R"(name = "clay"
description = "A test"
[youngs_modulus_pa]
value = 1e9
source = "a book"
[poisson_ratio]
value = 0.3
source = "a book"
[density_kg_m3]
value = 1000
source = "a book"
[alpha_per_s]
value = 1
source = "a guess"
[beta_s]
value = 1e-7
source = "a guess"
)";

inline std::string with(std::string text, const std::string& what, const std::string& instead) {
  const std::size_t at = text.find(what);
  EXPECT_NE(at, std::string::npos);
  return text.replace(at, what.size(), instead);
}

}  // namespace ringdown::test
