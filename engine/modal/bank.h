// A bank: everything the real-time half knows of one shape and material.
//
// Plain data, checked once when it is read (bank_file.h) and immutable after; many objects may share one. It holds
// M modes and P sample points on the surface:
//
//   frequency_hz   M      damped, in (0, inf)                    [Hz]
//   decay_per_s    M      amplitude decay, in [0, inf)           [1/s]
//   losses         M      its parts: material, air, support      [1/s]; empty when unknown
//   positions      P x 3  object frame                           [m]
//   shapes         M x P x 3, mode-major: shape(m, p) is the mass-normalised displacement of point p in mode m
//                                                                [kg^-1/2]; between points it is interpolated linearly
//   triangles      T x 3  point numbers, counter-clockwise from outside; may be empty
//   frequency_error  M    estimated relative errors of the frequencies, at least 0; empty when unknown
//   radiation        what modes radiate into the air; absent when nobody computed it
//   shape_error      M    estimated errors of amplitudes where strikes are interpolated between points: rms over the
//                         surface over the rms of the mode; empty when unknown
//
// Modes stand in order of decreasing perceptual importance, not of pitch. Rigid-body modes are not in it.
#pragma once

#include "engine/base/range.h"
#include "engine/base/vec3.h"
#include "engine/modal/damping.h"
#include "engine/modal/losses.h"
#include "engine/modal/nonlinear.h"
#include "engine/modal/orthotropy.h"
#include "engine/modal/radiation_map.h"

#include <algorithm>
#include <array>
#include <cstddef>
#include <cstdint>
#include <optional>
#include <string>
#include <vector>

namespace ringdown::modal {

using Vec3f = std::array<float, 3>;

// An elastic solid: isotropic, and where it is known, what it is along its grain and across.
struct Material {
  std::string name;
  double youngs_modulus_pa = 0;
  double poisson_ratio = 0;
  double density_kg_m3 = 0;
  RayleighDamping damping;
  std::vector<LossFactor> loss_factors = {};  // where they are known, ascending; `damping` is then their fit
  std::optional<Orthotropy> orthotropy = {};  // of a bank: its modes are those of this solid, not of an isotropic one
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
  RadiationMaps maps;               // of M modes
  Air air;                          // in which they were found, and the air's part of the losses
  std::vector<double> error_db;     // M estimated errors of the power, at least 0; empty when unknown
  std::vector<std::string> reason;  // M: why the error is larger than wanted, or empty; no list when there is none
};

inline constexpr double kPeakBlow_ns = 0.05;
inline constexpr Range kStatedPitch_hz{1, 1e5};

// How the bank was made; all of it optional, none of it needed to play. Kept in extras.ringdown of the file.
struct Provenance {
  std::string generator;      // program and version
  std::string body;           // where its elements come from: "surface filled by gmsh", ...
  double wall_elements = 0;   // across its thinnest wall, where that is less than one (--force-coarse); 0: enough
  std::string element;        // "tet20 consistent", ...
  std::int64_t unknowns = 0;  // degrees of freedom of the eigenproblem
  std::int64_t rigid_modes = 0;
  std::int64_t counted_modes = 0;  // rigid ones and all below the band's top, by inertia; 0: not counted
  double band_low_hz = 0, band_high_hz = 0;
  double largest_residual = 0;     // max over modes of |K phi - lambda M phi| / |lambda M phi|
  std::int64_t dropped_modes = 0;  // of the band, as inaudible or unimportant (engine/bake/audibility.h)
  double floor_db = 0;             // how far below the loudest mode one was dropped as inaudible; 0: none was for that
  double loss_db = 0;              // energy they held over that of all, for the worst strike; with dropped_modes > 0
  std::vector<std::string> parts;  // materials of its parts, beside its own
  double peak_pa = 0;  // pressure at 1 m at which a blow of kPeakBlow_ns peaks; of recorded banks only, else 0
};

struct Bank {
  std::string name;
  std::vector<double> frequency_hz;
  std::vector<double> decay_per_s;
  std::vector<ModeLoss> losses;
  std::optional<BankRadiation> radiation;
  std::optional<NonlinearTerms> nonlinear;
  std::vector<double> frequency_error, shape_error;
  std::vector<Vec3f> positions;
  std::vector<Vec3f> shapes;
  std::vector<std::array<std::uint32_t, 3>> triangles;
  std::optional<Material> material;
  std::optional<MassProperties> mass;
  bool held = false;               // supports hold it: it is no free body
  double gain = 1;                 // linear, on all that it sounds: how loud its maker wants it beside others
  std::optional<double> pitch_hz;  // that its maker states, in kStatedPitch_hz; without, see pitch.h
  Provenance provenance;

  [[nodiscard]] std::size_t mode_count() const { return frequency_hz.size(); }
  [[nodiscard]] std::size_t point_count() const { return positions.size(); }
  [[nodiscard]] const Vec3f& shape(std::size_t mode, std::size_t point) const RINGDOWN_REALTIME {
    return shapes.data()[mode * positions.size() + point];
  }
};

struct ErrorSpread {
  double median = 0, largest = 0;
};

// The median and the largest of bank.frequency_error or bank.shape_error; nothing when the list is empty.
inline std::optional<ErrorSpread> error_spread(std::vector<double> errors) {
  if (errors.empty()) return std::nullopt;
  std::sort(errors.begin(), errors.end());
  return ErrorSpread{.median = errors[errors.size() / 2], .largest = errors.back()};
}

}  // namespace ringdown::modal
