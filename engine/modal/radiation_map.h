// The far field of a mode in air: a complex function of direction, compact enough for a bank.
//
// The time factor is exp(-i omega t). A mode moves the surface with velocity v phi.n, where phi is its mass-normalised
// shape [kg^-1/2] and v the modal velocity [kg^1/2 m/s]; a strike's modal impulse changes v at once. At distance r from
// the origin of the maps, towards the unit vector d, the complex pressure is
//
//   p = i rho omega v F(d) exp(ikr) / r,       |p| = rho omega |v| |F(d)| / r    [Pa]
//
// with the far field F [m^2 kg^-1/2]. For a body small beside the wavelength, F is the volume velocity per unit of
// modal velocity, over -4 pi. F is valid for every size of the body: at s times the size, k is 1/s of its value and F
// is s^(1/2) times as large, because a mass-normalised shape goes as s^(-3/2) and an area as s^2.
//
// F is stored as a sum over real spherical harmonics, orthonormal on the sphere, in the body's frame:
//
//   F(d) = sum of terms value * Y_harmonic(d),    harmonic = l^2 + l + m,  m = -l ... l
//
// Terms too small to matter are left out, so a mode of a symmetric body has few. [any thread]
#pragma once

#include "engine/base/realtime.h"
#include "engine/base/result.h"
#include "engine/base/vec3.h"

#include <complex>
#include <cstddef>
#include <cstdint>
#include <span>
#include <string_view>
#include <vector>

namespace ringdown::modal {

struct Air {
  double density_kg_m3 = 1.2041;  // dry, 20 degrees, 1013 hPa
  double sound_speed_m_s = 343.2;
};

// The far field of one mode.
struct FarField {
  struct Term {
    std::uint16_t harmonic = 0;  // l^2 + l + m
    std::complex<float> value;   // [m^2 kg^-1/2]
  };
  // The rms of F over all directions if the same shape vibrated at another frequency.
  struct Level {
    float wavenumber_rad_m = 0;
    float rms = 0;  // [m^2 kg^-1/2]
  };

  double wavenumber_rad_m = 0;  // the mode's own wavenumber omega / c, for which the terms were computed
  std::vector<Term> terms;      // in ascending order of harmonics; empty: radiates nothing
  std::vector<Level> levels;    // in ascending order of wavenumbers; empty: known at its own wavenumber only
  float unit = 0;               // in unpacked maps all parts of values are whole multiples of this; 0: no unit
};

// The far fields of a bank's modes, in the order of the modes.
struct RadiationMaps {
  Vec3 origin_m;  // the origin of r, in the object's frame
  std::vector<FarField> modes;
};

// The highest degree l that a map may have; packed maps with more are refused.
inline constexpr int kMaxHarmonicDegree = 63;
inline constexpr int harmonic_count(int degree) { return (degree + 1) * (degree + 1); }

// The highest degree among the terms; -1 when there are none.
int degree_of(const FarField& field) REALTIME;

// Writes Y_0 ... Y of the given degree towards a direction, which need not have length 1 but must not be 0.
// `values` has room for harmonic_count(degree). About 3 ns each. [audio]
void real_harmonics(const Vec3& direction, int degree, std::span<float> values) REALTIME;

// Returns F at the mode's own wavenumber, towards the direction for which `harmonics` were computed, to at least
// degree_of(field). Takes one multiplication for each term. [audio]
std::complex<float> far_field(const FarField& field, std::span<const float> harmonics) REALTIME;

// The rms of F over all directions, at the mode's own wavenumber. [audio]
double rms(const FarField& field) REALTIME;

// Returns the ratio of F at another wavenumber to F at the mode's own, rms over directions. A change of material or air
// needs it: k changes by sqrt(stiffness ratio / density ratio) and the ratio of c, while the shape stays. (The changed
// normalisation of the shape is not included.) Between levels, log rms is interpolated linearly over log k. Outside the
// range of levels the nearest level is used, independent of k; without levels the ratio is 1. Ask covers() where that
// matters. [any]
double level_ratio(const FarField& field, double wavenumber_rad_m) REALTIME;
bool covers(const FarField& field, double wavenumber_rad_m) REALTIME;

// The mean radiated power at a modal velocity of amplitude 1 kg^1/2 m/s [W], from the rms of F: 2 pi rho omega^2 rms^2
// / c.
double radiated_power(double rms, double omega_rad_s, const Air& air) REALTIME;

// The rate at which a mode's amplitude decays because of radiation [1/s]. The energy at amplitude 1 is 1/2, and
// amplitude falls half as fast as energy, so the rate is the same number as radiated_power().
double radiation_decay_per_s(double rms, double omega_rad_s, const Air& air) REALTIME;

// Returns the terms of a far field from the coefficients of all harmonics, without those below `smallest` times the
// largest.
std::vector<FarField::Term> terms_of(std::span<const std::complex<double>> coefficients, double smallest = 0);

// Maps as bytes. Numbers are little-endian. A term is the step from the previous harmonic and two whole multiples of
// the mode's unit, of one or two bytes each. The rounding error is at most `error` rms, relative to each mode's rms
// over directions; if the result would exceed `max_bytes`, the smallest errors that fit are used. Maps that were packed
// before keep their units, so packing them again loses nothing.
struct PackedMaps {
  std::vector<std::byte> bytes;
  double largest_error = 0;  // largest error of any mode, rms over directions relative to the mode's own
};
inline constexpr double kPackingError = 0.01;
inline constexpr std::size_t kMaxPackedBytesPerMode = 750;  // 150 kB for 200 modes
PackedMaps pack(const RadiationMaps& maps, std::size_t max_bytes);
inline PackedMaps pack(const RadiationMaps& maps) {
  return pack(maps, kMaxPackedBytesPerMode * maps.modes.size() + 32);
}

// Reads what pack() wrote, or refuses it: every count, degree and number is checked. `name` stands in the message.
Result<RadiationMaps> unpack(std::span<const std::byte> bytes, std::string_view name);

}  // namespace ringdown::modal
