// What a line of the stress suite claims. Each function bakes, checks by GoogleTest's EXPECTs, and enters the line.
#pragma once

#include "engine/bake/bake.h"
#include "tests/stress/table.h"

#include <string>
#include <vector>

namespace ringdown::test {

inline const modal::Material kSteel{"steel", 200e9, 0.3, 7850, {}};

fem::Elastic elastic(const modal::Material& material);

// A body that bakes within `limit` of the truth: frequencies [Hz] ascending, more of them than are compared.
struct Body {
  std::string name, hard;
  mesh::TetMesh mesh;
  std::vector<double> truth_hz;
  double limit = 0;
  std::string oracle;
  modal::Material material = kSteel;
  fem::Element element = fem::Element::kTet20;
  std::size_t min_modes = 10;
  int rigid = 6;
  double shortfall = 1;  // the worst error is at most so many times what the bank itself states
};

// The band ends in a gap above the least modes, so that the number of modes in it is known: so many are found, each
// within the limit and, times the shortfall, within what the bank states.
void expect_baked(const Body& body);

// Checks a body whose truth is the bank of another mesh, baked up to `top_hz`, with frequencies times `factor`.
void expect_like(Body body, const mesh::TetMesh& sound, double top_hz, double factor = 1);

// Bakes; an empty list, and a failed test, when that fails.
std::vector<double> baked_frequencies(const mesh::TetMesh& mesh, const modal::Material& material,
                                      const bake::BakeOptions& options);

// Refused by check_mesh() or by bake(), with a sentence that has these words.
void expect_refused(const std::string& name, const std::string& hard, const mesh::TetMesh& mesh,
                    const modal::Material& material, const std::vector<std::string>& words);

}  // namespace ringdown::test
