// Checks whether another method agrees with the modes found (EigenRequest::verify). [worker]
//
// The other method finds the modes nearest to two shifts of the band, with factorizations that were made for other
// purposes. Near each shift every frequency must agree, and so must the spaces that the shapes of close modes span:
// inside a family of equal frequencies the basis is arbitrary, its span is not. As many modes must lie below the shift
// as the factorization counted. The shapes must solve the equation with K and M as given, because both methods share
// the factorization.
#pragma once

#include "engine/solve/block_lanczos.h"
#include "engine/solve/eigensolver.h"

#include <string_view>
#include <vector>

namespace ringdown::solve {

inline constexpr double kSameFrequency = 1e-8;  // relative
inline constexpr double kSameFamily = 1e-4;     // modes whose frequencies are closer, relative, are compared as a space
inline constexpr double kSameSpace = 1e-5;      // sine of the largest principal angle, in the M inner product
inline constexpr double kSmallResidual = 1e-5;  // |K phi - lambda M phi| / |lambda M phi|

// The modes nearest to a shift, as one method found them: at least one shape for every eigenvalue within `radius`.
struct NearModes {
  std::string_view method;  // name in messages: "Spectra"
  Count shift;
  double radius = 0;       // [lambda]
  Eigen::VectorXd lambda;  // the nearest first, the last one at `radius`
  Eigen::MatrixXd shapes;  // 3N x m, M-orthonormal, in the order of the mesh
};

// Finds the `wanted` modes nearest to `shift`, at which the pencil is factored, by Spectra or by block Lanczos. Fails
// when they do not converge. Throws Cancelled.
Result<NearModes> find_near(Method by, const Pencil& pencil, const Count& shift, int wanted,
                            const EigenRequest& request, const KeepGoing& keep_going = {});

// The range in which modes are compared: above the rigid motions and below the top.
struct Band {
  double low = 0, high = 0;  // [lambda]
};

// Fails with one sentence about the first thing on which `modes` and `near` disagree. Families of modes that reach
// beyond the band, or beyond the radius of `near`, are left out. Updates `agreement`.
Result<void> compare(const fem::System& system, const Eigenmodes& modes, const NearModes& near, const Band& band,
                     const EigenRequest& request, Agreement& agreement);

class SecondOpinion {
 public:
  // `by` is the method that gives the opinion: kSpectra or kBlockLanczos. `request` and `progress` must live longer.
  SecondOpinion(Method by, const Band& band, const EigenRequest& request, const Progress& progress)
      : by_(by), band_(band), request_(request), progress_(progress) {}

  // Finds the modes nearest to the pencil's shift. Fails when they do not converge.
  Result<void> ask(const Pencil& pencil, const Count& shift);

  // Compares the modes that ask() found with `modes`. Also fails when no mode could be compared.
  Result<Agreement> check(const fem::System& system, const Eigenmodes& modes) const;

 private:
  const Method by_;
  const Band band_;
  const EigenRequest& request_;
  const Progress& progress_;
  std::vector<NearModes> found_;
  double seconds_ = 0;
};

}  // namespace ringdown::solve
