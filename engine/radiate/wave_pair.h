// Finds what a body radiates at a few wavenumbers close to each other, from a skin and the next coarser one. [worker]
//
// The equation is solved on both: the two solutions tell how far they differ. The coarser skin's matrix is eliminated
// at the middle of the wavenumbers, which costs an eighth of what the finer one's would, and makes all iterations
// short. Each class of a skin with mirror planes is solved by itself.
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

// How a layer on the coarser skin continues on the finer, and how a flow does, given as integrals over hat functions.
struct Continuation {
  Eigen::SparseMatrix<float, Eigen::RowMajor> layer, flow;  // V fine x V coarse
};
Continuation continuation_of(const Skin& fine, const Skin& coarse);

// Two skins' matrices in a band of wavenumbers.
struct BandPair {
  WaveBand fine, coarse;
  const Continuation& continuation;
};

// Memory of one thread, used for one wavenumber after the other.
struct WaveMemory {
  ClassMatrices fine, coarse, factors;
};
// Bytes for a skin and the coarser one: what each thread needs, and what the threads share in a band.
double wave_memory_bytes(const Skin& skin);
double band_memory_bytes(const Skin& skin);

struct WaveQuestion {
  double wavenumber_rad_m = 0;
  std::vector<int> modes;
  std::vector<Eigen::Vector3d> sources;  // places inside of the body
  Eigen::Vector3d origin;
  double radius_m = 0;
  Eigen::Matrix3d turn = Eigen::Matrix3d::Identity();  // from the directions that harmonics count to those of the skin
};

struct WaveAnswer {
  Eigen::MatrixXcd harmonics;      // coefficients, (degree + 1)^2 x M, extrapolated to ever finer skins
  Eigen::VectorXd rms, finer_rms;  // M, over all directions: extrapolated, and on the finer skin
  double source_db = 0;            // error of the power of the worst source, on the finer skin
  bool eliminated = false;         // the iteration with the finer matrix did not converge
};

// Answers the questions one by one. False when `go_on` returned false.
bool answer(const std::vector<WaveQuestion>& questions, const BandPair& bands, WaveMemory& memory,
            const std::function<bool()>& go_on,
            const std::function<void(const WaveQuestion&, const WaveAnswer&)>& keep);

// On one skin alone, by elimination: rms over all directions of each mode, good to 0.2 dB where directions are many.
Eigen::VectorXd rms_on(const WaveQuestion& question, const Skin& skin, WaveMemory& memory);

}  // namespace ringdown::radiate
