// Finds the radiation of a body at a few wavenumbers close to each other, from a skin and the next coarser one.
// [worker]
//
// The equation is solved on both skins; the difference of the solutions gives the error. The coarser skin's matrix is
// eliminated at the middle of the wavenumbers, which costs an eighth of eliminating the finer one, and makes all
// iterations short. Each class of a skin with mirror planes is solved separately.
#pragma once

#include "engine/radiate/far_field.h"
#include "engine/radiate/skin.h"
#include "engine/radiate/wave_band.h"
#include "engine/radiate/wave_solver.h"

#include <Eigen/Core>
#include <Eigen/SparseCore>

#include <functional>
#include <vector>

namespace ringdown::radiate {

// Maps a layer on the coarser skin to the finer one, and a flow, which is given as integrals over hat functions.
struct Continuation {
  Eigen::SparseMatrix<float, Eigen::RowMajor> layer, flow;  // V fine x V coarse
};
Continuation continuation_of(const Skin& fine, const Skin& coarse);

// The matrices of two skins in a band of wavenumbers.
struct BandPair {
  WaveBand fine, coarse;
  const Continuation& continuation;
};

// The memory of one thread, reused for one wavenumber after the other.
struct WaveMemory {
  ClassMatrices fine, coarse, factors;
};
// Bytes for a skin and the coarser one: the memory of each thread, and the memory that threads share in a band.
double wave_memory_bytes(const Skin& skin);
double band_memory_bytes(const Skin& skin);

struct WaveQuestion {
  double wavenumber_rad_m = 0;
  std::vector<int> modes;
  std::vector<Eigen::Vector3d> sources;  // places inside the body
  Eigen::Vector3d origin;
  double radius_m = 0;
  Eigen::Matrix3d turn = Eigen::Matrix3d::Identity();  // from directions of the harmonics to those of the skin
};

struct WaveAnswer {
  Eigen::MatrixXcd harmonics;      // coefficients, (degree + 1)^2 x M, extrapolated to ever finer skins
  Eigen::VectorXd rms, finer_rms;  // M, rms over all directions: extrapolated, and on the finer skin
  double source_db = 0;            // power error of the worst source, on the finer skin
  bool eliminated = false;         // true: the iteration with the finer matrix did not converge
};

// Answers the questions one by one and hands each answer to `keep`. Returns false when `go_on` returned false.
bool answer(const std::vector<WaveQuestion>& questions, const BandPair& bands, WaveMemory& memory,
            const std::function<bool()>& go_on,
            const std::function<void(const WaveQuestion&, const WaveAnswer&)>& keep);

// The rms over all directions of each mode, on one skin alone, by elimination. Good to 0.2 dB if directions are many.
Eigen::VectorXd rms_on(const WaveQuestion& question, const Skin& skin, WaveMemory& memory);

}  // namespace ringdown::radiate
