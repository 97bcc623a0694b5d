// Finds what a body radiates at one wavenumber, from a skin and the next coarser one. [worker]
//
// The equation is solved on both. The coarser skin's is eliminated, which costs an eighth of what the finer one's
// would, and serves twice: its solution tells how far the two differ, and its elimination makes the iteration with the
// finer matrix short.
#pragma once

#include "engine/radiate/far_field.h"
#include "engine/radiate/skin.h"
#include "engine/radiate/wave_solver.h"

#include <Eigen/Core>
#include <Eigen/SparseCore>

#include <functional>
#include <optional>
#include <vector>

namespace ringdown::radiate {

// Two skins, and how a layer on the coarser one continues on the finer.
struct SkinPair {
  const Skin* fine = nullptr;
  const Skin* coarse = nullptr;
  Eigen::SparseMatrix<float, Eigen::RowMajor> continuation;  // V fine x V coarse
};
SkinPair pair_of(const Skin& fine, const Skin& coarse);

// Memory of one thread, used for one wavenumber after the other.
struct WaveMemory {
  ComplexMatrix fine, coarse;
};
// Bytes that a thread needs for a skin of so many nodes and the coarser one.
double wave_memory_bytes(int nodes);

struct WaveQuestion {
  double wavenumber_rad_m = 0;
  std::vector<int> modes;
  std::vector<Eigen::Vector3d> sources;  // places inside of the body
  Eigen::Vector3d origin;
  double radius_m = 0;
};

struct WaveAnswer {
  Eigen::MatrixXcd fine, coarse;  // coefficients of harmonics, (degree + 1)^2 x M
  double source_db = 0;           // error of the power of the worst source, on the finer skin
  bool eliminated = false;        // the iteration with the finer matrix did not converge
};

// Nothing when `go_on` returns false.
std::optional<WaveAnswer> answer(const WaveQuestion& question, const SkinPair& skins, WaveMemory& memory,
                                 const std::function<bool()>& go_on);

// On one skin alone, by elimination: coefficients of harmonics.
Eigen::MatrixXcd answer_on(const WaveQuestion& question, const Skin& skin, WaveMemory& memory);

}  // namespace ringdown::radiate
