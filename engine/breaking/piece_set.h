// The pieces of one pattern of a body, in the body's size and material. Immutable, so bodies may share it.
#pragma once

#include "engine/modal/fracture/breaking.h"
#include "engine/modal/material_scale.h"
#include "engine/modal/strike_map.h"

#include <cstddef>
#include <memory>
#include <vector>

namespace ringdown::breaking {

// Returns the modes of a bank in a scaled material, in the bank's order; an over-damped mode has the frequency 0. [any]
std::vector<modal::DampedMode> modes_of(const modal::Bank& bank, const modal::MaterialScale& material = {});

struct BodyPiece {
  // The piece's own bank at the gain of the body's, as baked: whoever plays it sets the body's material. Null: the
  // piece has no mode, and is never heard. A piece that breaks again has its own patterns in its bank.
  std::shared_ptr<const modal::StrikeMap> map;
  modal::MassProperties mass;            // in the body's frame, size and material
  std::vector<modal::DampedMode> modes;  // in the body's size and material; those that ring
  double delay_s = 0;                    // from the break until the crack reaches the piece
  std::size_t model = 0;                 // its number in the file of the body's bank
};

class PieceSet {
 public:
  // `body` must be able to break (Breakable::make()) and have the pattern. Cost: some 2 ms for each piece. [worker]
  PieceSet(const modal::StrikeMap& body, const modal::MaterialScale& material, std::size_t pattern);

  [[nodiscard]] std::size_t pattern() const { return pattern_; }
  [[nodiscard]] const std::vector<BodyPiece>& pieces() const { return pieces_; }
  [[nodiscard]] const modal::Breaking& breaking() const { return breaking_; }

  // Returns the piece whose surface is nearest to a point of the body [m]. [any]
  [[nodiscard]] std::size_t nearest(const Vec3& point_m) const;

 private:
  std::size_t pattern_;
  std::vector<std::vector<Vec3>> points_;  // of each piece's surface
  std::vector<BodyPiece> pieces_;
  modal::Breaking breaking_;
};

}  // namespace ringdown::breaking
