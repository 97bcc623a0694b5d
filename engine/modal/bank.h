// A bank: everything the real-time half knows of one shape and material.
//
// Plain data, checked once when it is read (bank_file.h) and immutable after; many objects may share one. It holds
// M modes and P sample points on the surface:
//
//   frequency_hz   M      damped, in (0, inf)                    [Hz]
//   decay_per_s    M      amplitude decay, in [0, inf)           [1/s]
//   losses         M      decay split into material, heat, air, support [1/s]; empty when unknown
//   heat           M      relaxations of the heat that flows in the body; empty when unknown or when none counts
//   positions      P x 3  object frame                           [m]
//   shapes         M x P x 3, mode-major: shape(m, p) is the mass-normalised displacement of point p in mode m
//                                                                [kg^-1/2]; between points it is interpolated linearly
//   triangles      T x 3  point numbers, counter-clockwise from outside; may be empty
//   frequency_error  M    estimated relative errors of the frequencies, at least 0; empty when unknown
//   radiation        far fields of the modes in air; absent when they were not computed
//   shape_error      M    estimated errors of amplitudes where strikes are interpolated between points: rms over the
//                         surface over the rms of the mode; empty when unknown
//
// Modes are ordered by decreasing perceptual importance, not by pitch. A bank has no rigid-body modes.
#pragma once

#include "engine/base/range.h"
#include "engine/base/vec3.h"
#include "engine/modal/damping.h"
#include "engine/modal/fracture/strength.h"
#include "engine/modal/losses.h"
#include "engine/modal/nonlinear.h"
#include "engine/modal/orthotropy.h"
#include "engine/modal/radiation_map.h"
#include "engine/modal/tubes/cavity.h"

#include <algorithm>
#include <array>
#include <cstddef>
#include <cstdint>
#include <memory>
#include <optional>
#include <string>
#include <vector>

namespace ringdown::modal {

using Vec3f = std::array<float, 3>;

// An elastic solid: its isotropic constants and, where they are known, those along and across its grain.
struct Material {
  std::string name;
  double youngs_modulus_pa = 0;
  double poisson_ratio = 0;
  double density_kg_m3 = 0;
  RayleighDamping damping;
  std::vector<LossFactor> loss_factors = {};  // by ascending frequency; empty: unknown, else `damping` is their fit
  std::optional<Thermal> thermal = {};        // absent: how it warms is not known
  std::optional<Orthotropy> orthotropy = {};  // if a bank has it, its modes are those of this solid, not the isotropic
  std::optional<Brittleness> brittleness = {};  // absent: ductile, or read from a bank, where Fracture has it
  [[nodiscard]] MaterialDamping damping_law() const { return {damping, loss_factors}; }
};

struct MassProperties {
  double mass_kg = 0;
  Vec3 center_of_mass_m;
  Vec3 inertia_kg_m2;                                // principal moments about the centre of mass
  std::array<double, 4> orientation = {0, 0, 0, 1};  // unit quaternion x y z w: principal axes -> object frame
};

// The radiation of a bank's modes, with its errors.
struct BankRadiation {
  RadiationMaps maps;               // one map for each of M modes
  Air air;                          // the air for which maps and the air's part of the losses were computed
  std::vector<double> error_db;     // M estimated errors of the power, at least 0; empty when unknown
  std::vector<std::string> reason;  // M: why the error is larger than wanted, or ""; empty list: no error is
};

inline constexpr double kPeakBlow_ns = 0.05;
inline constexpr Range kStatedPitch_hz{1, 1e5};

// A liquid with which the modes of a bank were computed.
struct LiquidNote {
  std::string liquid;  // its name
  double density_kg_m3 = 0, sound_speed_m_s = 0, viscosity_pa_s = 0;
  double level_m = 0;    // height of its free surface along `up`
  double volume_m3 = 0;  // of the liquid, or what the body displaces
  Vec3 up{0, 0, 1};
  bool around = false;  // true: the body stands in it; false: it is in the body
};

// A tube under the body, whose air the modes of a bank include. In the object's frame.
struct ResonatorNote {
  double diameter_m = 0, length_m = 0;
  Vec3 mouth_m, axis{0, 0, -1};  // the middle of its mouth; into the tube
  bool stopped = true;           // at its far end; false: open there
  double frequency_hz = 0;       // of its lowest mode beside a body at rest
  double decay_per_s = 0;        // of that mode
  double end_correction_m = 0;   // of its mouth beside the body
};

// Records how the bank was made. All fields are optional, and playing needs none of them. Kept in extras.ringdown of
// the file.
struct Provenance {
  std::string generator;      // program and version
  std::string body;           // the origin of the elements: "surface filled by gmsh", ...
  double wall_elements = 0;   // elements across the thinnest wall, if less than one (--force-coarse); 0: enough
  std::string element;        // "tet20 consistent", ...
  std::int64_t unknowns = 0;  // degrees of freedom of the eigenproblem
  std::int64_t rigid_modes = 0;
  std::int64_t counted_modes = 0;  // number of modes below the band's top with rigid ones, by inertia; 0: not counted
  double band_low_hz = 0, band_high_hz = 0;
  double largest_residual = 0;      // max over modes of |K phi - lambda M phi| / |lambda M phi|
  std::int64_t dropped_modes = 0;   // modes in the band dropped as inaudible or unimportant (engine/bake/audibility.h)
  double floor_db = 0;              // level below the loudest mode from which modes were dropped as inaudible; 0: none
  double loss_db = 0;               // energy of the dropped modes over that of all modes, for the worst strike
  std::vector<std::string> parts;   // materials of the body's parts, beside its own
  std::vector<LiquidNote> liquids;  // in the body and around it
  std::vector<ResonatorNote> resonators;  // under it
  double peak_pa = 0;  // peak pressure at 1 m after a blow of kPeakBlow_ns; 0 unless the bank was recorded
};

struct Fracture;      // fracture/fracture.h
struct LiquidLevels;  // levels/liquid_levels.h

struct Bank {
  std::string name;
  std::vector<double> frequency_hz;
  std::vector<double> decay_per_s;
  std::vector<ModeLoss> losses;
  std::vector<ModeHeat> heat;
  std::optional<BankRadiation> radiation;
  std::optional<NonlinearTerms> nonlinear;
  std::vector<double> frequency_error, shape_error;
  std::vector<Vec3f> positions;
  std::vector<Vec3f> shapes;
  std::vector<std::array<std::uint32_t, 3>> triangles;
  std::optional<Material> material;
  std::optional<MassProperties> mass;
  bool held = false;               // true: supports hold the body; false: the body is free
  double gain = 1;                 // linear gain on the whole sound, by which its maker balances it against other banks
  std::optional<double> pitch_hz;  // pitch stated by the maker, in kStatedPitch_hz; absent: see hearing/pitch.h
  std::shared_ptr<const Fracture> fracture;    // how the body breaks; null: it does not
  std::shared_ptr<const LiquidLevels> levels;  // of the liquid in it; null: it knows its own level only
  std::optional<Cavity> cavity;                // the air in it; absent: it has no modes of its own
  Provenance provenance;

  [[nodiscard]] std::size_t mode_count() const { return frequency_hz.size(); }
  [[nodiscard]] std::size_t point_count() const { return positions.size(); }
  [[nodiscard]] const Vec3f& shape(std::size_t mode, std::size_t point) const REALTIME {
    return shapes[mode * positions.size() + point];
  }
};

struct ErrorSpread {
  double median = 0, largest = 0;
};

// Returns the median and the largest of bank.frequency_error or bank.shape_error; nothing when the list is empty.
inline std::optional<ErrorSpread> error_spread(std::vector<double> errors) {
  if (errors.empty()) return std::nullopt;
  std::sort(errors.begin(), errors.end());
  return ErrorSpread{.median = errors[errors.size() / 2], .largest = errors.back()};
}

}  // namespace ringdown::modal
