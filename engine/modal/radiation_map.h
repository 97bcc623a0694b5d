// The far field of a mode in air: a complex function of direction, compact enough for a bank.
//
// Time goes as exp(-i omega t). A mode moves the surface with velocity v phi.n, where phi is its mass-normalised shape
// [kg^-1/2] and v the modal velocity [kg^1/2 m/s], which is what a strike's modal impulse gives at once. At distance r
// from the origin of the maps, towards the unit vector d, the complex pressure is
//
//   p = i rho omega v F(d) exp(ikr) / r,       |p| = rho omega |v| |F(d)| / r    [Pa]
//
// with the far field F [m^2 kg^-1/2]. For a body small beside the wavelength, F is the volume velocity per unit of
// modal velocity, over -4 pi. F holds for every size of the body: at s times the size k is 1/s of its value and F is
// s^(1/2) times as large, because a mass-normalised shape goes as s^(-3/2) and an area as s^2.
//
// F stands as a sum over real spherical harmonics, orthonormal on the sphere, in the body's frame:
//
//   F(d) = sum of terms value * Y_harmonic(d),    harmonic = l^2 + l + m,  m = -l ... l
//
// Terms too small to matter are left out, so that a mode of a symmetric body takes few. [any thread]
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

  double wavenumber_rad_m = 0;  // omega / c, at which the terms hold
  std::vector<Term> terms;      // in ascending order of harmonics; empty: radiates nothing
  std::vector<Level> levels;    // in ascending order of wavenumbers; empty: known at its own wavenumber only
  float unit = 0;               // of which every part of a value is a whole multiple, as in unpacked maps; 0: of none
};

// The far fields of a bank's modes, in the order of the modes.
struct RadiationMaps {
  Vec3 origin_m;  // in the object's frame: where r is measured from
  std::vector<FarField> modes;
};

// The highest degree l that a map may have; packed maps with more are refused.
inline constexpr int kMaxHarmonicDegree = 63;
inline constexpr int harmonic_count(int degree) { return (degree + 1) * (degree + 1); }

// The highest degree among the terms; -1 when there are none.
int degree_of(const FarField& field) RINGDOWN_REALTIME;

// Writes Y_0 ... Y of the given degree towards a direction, which need not have length 1 but must not be 0.
// `values` has room for harmonic_count(degree). About 3 ns each. [audio]
void real_harmonics(const Vec3& direction, int degree, std::span<float> values) RINGDOWN_REALTIME;

// F towards the direction that `harmonics` were computed for, to at least degree_of(field). At the mode's own
// wavenumber. One multiplication for each term. [audio]
std::complex<float> far_field(const FarField& field, std::span<const float> harmonics) RINGDOWN_REALTIME;

// The rms of F over all directions, at the mode's own wavenumber. [audio]
double rms(const FarField& field) RINGDOWN_REALTIME;

// By what F at another wavenumber is larger than at the mode's own, rms over directions: for a change of material or of
// the air, which moves k by sqrt(stiffness ratio / density ratio) and c's ratio while the shape stays. (The changed
// normalisation of the shape is not in it.) Between levels the logarithm is interpolated against that of k. Outside of
// their range, or without levels, the nearest one counts, times k^0: ask covers() where that matters. [any]
double level_ratio(const FarField& field, double wavenumber_rad_m) RINGDOWN_REALTIME;
bool covers(const FarField& field, double wavenumber_rad_m) RINGDOWN_REALTIME;

// The mean radiated power at a modal velocity of amplitude 1 kg^1/2 m/s [W], from the rms of F: 2 pi rho omega^2 rms^2
// / c.
double radiated_power(double rms, double omega_rad_s, const Air& air) RINGDOWN_REALTIME;

// The rate at which a mode's amplitude decays because it radiates [1/s]. The energy at amplitude 1 is 1/2, and
// amplitude falls half as fast as energy, so that this is the number that radiated_power() gives.
double radiation_decay_per_s(double rms, double omega_rad_s, const Air& air) RINGDOWN_REALTIME;

// The terms of a far field whose coefficients of all harmonics are given, without those below `smallest` times the
// largest.
std::vector<FarField::Term> terms_of(std::span<const std::complex<double>> coefficients, double smallest = 0);

// Maps as bytes: numbers little-endian, a term as the step from the one before and two whole numbers of units that
// each mode has for itself, each of one byte or two. What is lost is at most `error` rms, relative to each mode's rms
// over directions; larger errors are taken, as small as possible, when it would not fit into `max_bytes`. Maps that
// have been packed once keep their units, so that a second time loses nothing.
struct PackedMaps {
  std::vector<std::byte> bytes;
  double largest_error = 0;  // of any mode, rms over directions relative to the mode's own
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
