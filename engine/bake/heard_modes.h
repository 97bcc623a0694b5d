// The modes of a body that lie in a band, on their way into a bank. [any thread]
#pragma once

#include "engine/bake/body_modes.h"
#include "engine/modal/bank.h"
#include "engine/modal/losses.h"
#include "engine/modal/radiation_map.h"

#include <Eigen/Core>

#include <functional>
#include <string>
#include <vector>

namespace ringdown::bake {

struct HeardMode {
  Eigen::Index number = 0;  // in BodyModes
  double lambda = 0;        // [rad^2/s^2]
  modal::DampedMode mode;
  modal::ModeLoss loss;
  modal::ModeHeat heat{};
  double importance = 0;
  double frequency_error = 0;
  bool turned = false;    // the bank has the shape with the other sign than sign_of()
  modal::FarField field;  // of the mode with the sign that its shape has in the bank; where it was computed
  double radiation_error_db = 0;
  std::string radiation_doubt;
};

struct Band {
  double low_hz = 0, high_hz = 0;
};

struct LeftOut {
  int below_band = 0, above_band = 0, over_damped = 0;
};

// Returns the decay rates [1/s] of mode `number` of BodyModes, whose eigenvalue is lambda [rad^2/s^2]; the air takes
// `air_per_s` of them.
using LossOf = std::function<modal::ModeLoss(Eigen::Index number, double lambda, double air_per_s)>;

// The modes whose damped frequency lies in the band, by ascending lambda.
std::vector<HeardMode> modes_in_band(const BodyModes& modes, const BodyUnits& units, const LossOf& loss_of,
                                     const Band& band, LeftOut& left_out);

// Lets the air take `air_per_s` of what the mode loses. False when that leaves it no pitch.
bool add_air_loss(HeardMode& mode, const LossOf& loss_of, double air_per_s);

// Puts the most important modes first (importance.h). `bank` holds these modes in this order, and says what they
// radiate; `weights` are those of the surface's nodes (mesh::area_weights).
void order_by_importance(std::vector<HeardMode>& heard, const modal::Bank& bank, const BodyModes& modes,
                         const BodyUnits& units, const std::vector<double>& weights);

// The sign, 1 or -1, that a bank gives a shape: its first component whose size is the largest to rounding is positive.
double sign_of(const Eigen::Ref<const Eigen::VectorXd>& shape);

// The shapes of modes at the surface's nodes, free of units, with the sign that a bank gives them: 3S x M.
Eigen::MatrixXd shapes_of(const std::vector<HeardMode>& heard, const BodyModes& modes);

// Appends the modes to the bank, with `shapes` (3P x M) in kg^-1/2, one column for each. With `air`, what they radiate
// in it is added, too.
void add_modes(modal::Bank& bank, const std::vector<HeardMode>& heard, const Eigen::MatrixXd& shapes,
               const modal::Air* air = nullptr);

}  // namespace ringdown::bake
