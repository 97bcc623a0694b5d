// Classifies the modes of a slender or flat body by their motion, from a bank's shapes. [any thread]
//
//   const BodyAxes axes = body_axes(bank, std::nullopt);
//   const auto bending = modes_of(bank, axes, ModeFamily::kVertical);   // in the strike direction, lowest first
//
// A bar that is tuned by undercutting changes the order of its modes: twist passes bending. So modes are counted within
// a family. In the body's axes, `along` its longest extent and `strike` across, the shape at the bank's points is split
// by least squares into motions of whole cross-sections, each a polynomial along the body:
//
//   vertical       the section moves along `strike`              bending, as a mallet excites it
//   lateral        it moves across both axes                     bending in the other plane
//   torsion        it turns about `along`
//   longitudinal   it moves along `along`
//   other          none of these holds half of the motion: the section itself changes
//   any            every mode; equal frequencies (within 3 cents, as a round body's pairs) count once
#pragma once

#include "engine/base/result.h"
#include "engine/modal/bank.h"

#include <optional>
#include <string>
#include <string_view>
#include <vector>

namespace ringdown::bake {

enum class ModeFamily { kVertical, kLateral, kTorsion, kLongitudinal, kOther, kAny };

std::string_view family_name(ModeFamily family);
Result<ModeFamily> parse_family(std::string_view name);  // all but kOther

struct BodyAxes {
  Vec3 centre;
  Vec3 along, strike, across;  // unit vectors, orthogonal
};

// `along` is the principal axis of the smallest moment of inertia. `strike` is the given direction without its part
// along, or the axis of the largest moment: across a flat body. bank.mass must be there, as in every bank that was
// baked.
BodyAxes body_axes(const modal::Bank& bank, std::optional<Vec3> strike);

// Numbers of the modes of one family, by rising frequency.
std::vector<std::size_t> modes_of(const modal::Bank& bank, const BodyAxes& axes, ModeFamily family);

}  // namespace ringdown::bake
