#include "engine/modal/radiation_map.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstring>
#include <numbers>
#include <string>

namespace ringdown::modal {

int degree_of(const FarField& field) REALTIME {
  if (field.terms.empty()) return -1;
  const int harmonic = field.terms[field.terms.size() - 1].harmonic;
  int degree = static_cast<int>(std::sqrt(static_cast<double>(harmonic)));
  while (degree * degree > harmonic) --degree;
  while (harmonic_count(degree) <= harmonic) ++degree;
  return degree;
}

namespace {

// The factors of the recurrences below. They need square roots, so they are computed once, when the program starts.
struct Legendre {
  static constexpr int kDegrees = kMaxHarmonicDegree + 1;
  std::array<double, kDegrees> diagonal{};                      // from Q_(m-1)^(m-1) to Q_m^m
  std::array<std::array<double, kDegrees>, kDegrees> a{}, b{};  // by m, then by l
  Legendre() {
    for (int m = 0; m < kDegrees; ++m) {
      if (m > 0) diagonal[static_cast<std::size_t>(m)] = std::sqrt((2 * m + 1.0) / (2 * m));
      for (int l = m + 1; l < kDegrees; ++l) {
        const double l2 = static_cast<double>(l) * l, m2 = static_cast<double>(m) * m;
        const double below = (l - 1.0) * (l - 1.0);
        a[static_cast<std::size_t>(m)][static_cast<std::size_t>(l)] = std::sqrt((4 * l2 - 1) / (l2 - m2));
        b[static_cast<std::size_t>(m)][static_cast<std::size_t>(l)] = std::sqrt((below - m2) / (4 * below - 1));
      }
    }
  }
};
const Legendre kLegendre;

}  // namespace

// With x = sin(theta) cos(phi), y = sin(theta) sin(phi), z = cos(theta), the functions are products of
// Re or Im (x + iy)^m and of Q_l^m(z), the normalised Legendre functions over sin(theta)^m. These obey
//
//   Q_m^m = sqrt((2m + 1) / (2m)) Q_(m-1)^(m-1),      Q_0^0 = 1 / sqrt(4 pi)
//   Q_l^m = a (z Q_(l-1)^m - b Q_(l-2)^m),            a = sqrt((4 l^2 - 1) / (l^2 - m^2)),
//                                                     b = sqrt(((l - 1)^2 - m^2) / (4 (l - 1)^2 - 1))
//
// which is stable upward in l. (Holmes & Featherstone, A unified approach to the Clenshaw summation, J. Geodesy 2002.)
void real_harmonics(const Vec3& direction, int degree, std::span<float> values) REALTIME {
  const double scale = 1 / length(direction);
  const double x = direction.x * scale, y = direction.y * scale, z = direction.z * scale;
  float* const out = values.data();
  double diagonal = 0.5 / std::sqrt(std::numbers::pi);
  double re = 1, im = 0;  // (x + iy)^m
  for (int m = 0; m <= degree; ++m) {
    if (m > 0) {
      diagonal *= kLegendre.diagonal[m];
      const double next = re * x - im * y;
      im = re * y + im * x;
      re = next;
    }
    const double factor = m == 0 ? 1 : std::numbers::sqrt2;
    const double *const a = kLegendre.a[m].data(), *const b = kLegendre.b[m].data();
    double before = 0, now = diagonal;
    for (int l = m; l <= degree; ++l) {
      if (l > m) {
        const double next = a[l] * (z * now - (l > m + 1 ? b[l] * before : 0));
        before = now;
        now = next;
      }
      out[l * l + l + m] = static_cast<float>(factor * now * re);
      if (m > 0) out[l * l + l - m] = static_cast<float>(factor * now * im);
    }
  }
}

std::complex<float> far_field(const FarField& field, std::span<const float> harmonics) REALTIME {
  float re = 0, im = 0;
  const FarField::Term* const terms = field.terms.data();
  for (std::size_t t = 0; t < field.terms.size(); ++t) {
    const float at = harmonics[terms[t].harmonic];
    re += at * terms[t].value.real();
    im += at * terms[t].value.imag();
  }
  return {re, im};
}

double rms(const FarField& field) REALTIME {
  double sum = 0;
  const FarField::Term* const terms = field.terms.data();
  for (std::size_t t = 0; t < field.terms.size(); ++t) {
    const double re = terms[t].value.real(), im = terms[t].value.imag();
    sum += re * re + im * im;
  }
  return std::sqrt(sum / (4 * std::numbers::pi));
}

bool covers(const FarField& field, double wavenumber_rad_m) REALTIME {
  constexpr double kSlack = 1e-3;  // share of k; levels are floats
  const double own = field.wavenumber_rad_m;
  const std::size_t count = field.levels.size();
  const double low = count == 0 ? own : std::min<double>(own, field.levels[0].wavenumber_rad_m);
  const double high = count == 0 ? own : std::max<double>(own, field.levels[count - 1].wavenumber_rad_m);
  return wavenumber_rad_m >= low * (1 - kSlack) && wavenumber_rad_m <= high * (1 + kSlack);
}

namespace {

// Returns log rms at a wavenumber between the levels, linear in the logarithm of the wavenumber.
double log_level(const FarField& field, double wavenumber) REALTIME {
  const FarField::Level* const levels = field.levels.data();
  const std::size_t count = field.levels.size();
  if (wavenumber <= levels[0].wavenumber_rad_m) return std::log(levels[0].rms);
  for (std::size_t i = 1; i < count; ++i) {
    const double low = levels[i - 1].wavenumber_rad_m, high = levels[i].wavenumber_rad_m;
    if (wavenumber > high) continue;
    const double t = std::log(wavenumber / low) / std::log(high / low);
    return (1 - t) * std::log(levels[i - 1].rms) + t * std::log(levels[i].rms);
  }
  return std::log(levels[count - 1].rms);
}

}  // namespace

double level_ratio(const FarField& field, double wavenumber_rad_m) REALTIME {
  if (field.levels.empty()) return 1;
  return std::exp(log_level(field, wavenumber_rad_m) - log_level(field, field.wavenumber_rad_m));
}

double radiated_power(double rms, double omega_rad_s, const Air& air) REALTIME {
  return 2 * std::numbers::pi * air.density_kg_m3 * omega_rad_s * omega_rad_s * rms * rms / air.sound_speed_m_s;
}

double radiation_decay_per_s(double rms, double omega_rad_s, const Air& air) REALTIME {
  return radiated_power(rms, omega_rad_s, air);
}

std::vector<FarField::Term> terms_of(std::span<const std::complex<double>> coefficients, double smallest) {
  double largest = 0;
  for (const auto& value : coefficients) largest = std::max(largest, std::abs(value));
  std::vector<FarField::Term> terms;
  for (std::size_t i = 0; i < coefficients.size(); ++i) {
    if (std::abs(coefficients[i]) <= smallest * largest) continue;
    terms.push_back({static_cast<std::uint16_t>(i), std::complex<float>(coefficients[i])});
  }
  return terms;
}

namespace {

constexpr std::uint32_t kVersion = 1;
constexpr std::size_t kMaxLevels = 64, kMaxModes = std::size_t{1} << 20;
constexpr float kLevelStep_db = 0.01F;
constexpr int kMaxUnits = 8191;  // largest absolute value that fits into two bytes

void put(std::vector<std::byte>& out, std::uint32_t value, int bytes) {
  for (int b = 0; b < bytes; ++b) out.push_back(static_cast<std::byte>(value >> (8 * b) & 0xFF));
}

void put_float(std::vector<std::byte>& out, double value) {
  const auto number = static_cast<float>(value);
  std::uint32_t bits = 0;
  std::memcpy(&bits, &number, sizeof bits);
  put(out, bits, 4);
}

// Writes seven bits in each byte, the lowest first; the eighth bit tells that another byte follows.
void put_short(std::vector<std::byte>& out, std::uint32_t value) {
  for (; value >= 128; value >>= 7) put(out, (value & 127) | 128, 1);
  put(out, value, 1);
}

// Maps 0, -1, 1, -2 ... to 0, 1, 2, 3 ..., so that small values of either sign take one byte.
std::uint32_t fold(int value) {
  return value < 0 ? 2 * static_cast<std::uint32_t>(-value) - 1 : 2 * static_cast<std::uint32_t>(value);
}
int unfold(std::uint32_t value) {
  const int half = static_cast<int>(value / 2);
  return value % 2 == 1 ? -half - 1 : half;
}

struct Rounded {
  int harmonic = 0, re = 0, im = 0;
};

// Rounds a mode's terms to whole multiples of `unit`. Terms that round to 0 are left out.
std::vector<Rounded> round_terms(const FarField& field, double unit) {
  std::vector<Rounded> rounded;
  for (const FarField::Term& term : field.terms) {
    const auto units = [&](float value) { return static_cast<int>(std::lround(value / unit)); };
    const Rounded r{term.harmonic, units(term.value.real()), units(term.value.imag())};
    if (r.re != 0 || r.im != 0) rounded.push_back(r);
  }
  return rounded;
}

// The error of rounding, rms over directions relative to the mode's own rms.
double rounding_error(const FarField& field, double unit) {
  double lost = 0, all = 0;
  for (const FarField::Term& term : field.terms) {
    const std::complex<double> value(term.value);
    const std::complex<double> kept(unit * std::round(value.real() / unit), unit * std::round(value.imag() / unit));
    lost += std::norm(value - kept);
    all += std::norm(value);
  }
  return all > 0 ? std::sqrt(lost / all) : 0;
}

// Returns the coarsest unit that keeps the error, or the finest that two bytes allow.
double unit_for(const FarField& field, double error) {
  float largest = 0;
  for (const FarField::Term& term : field.terms) {
    largest = std::max({largest, std::abs(term.value.real()), std::abs(term.value.imag())});
  }
  const double finest = largest / kMaxUnits;
  double unit = finest;
  while (unit > 0 && unit * std::numbers::sqrt2 < 2 * largest) {
    if (rounding_error(field, unit * std::numbers::sqrt2) > error) break;
    unit *= std::numbers::sqrt2;
  }
  return unit;
}

void pack_mode(const FarField& field, double error, PackedMaps& out) {
  const double unit = field.unit > 0 ? field.unit : static_cast<float>(unit_for(field, error));
  const std::vector<Rounded> terms = unit > 0 ? round_terms(field, unit) : std::vector<Rounded>{};
  const double own = rms(field);
  const std::size_t levels = own > 0 ? std::min(field.levels.size(), kMaxLevels) : 0;
  put_float(out.bytes, field.wavenumber_rad_m);
  put_float(out.bytes, unit);
  put(out.bytes, static_cast<std::uint32_t>(terms.size()), 2);
  put(out.bytes, static_cast<std::uint32_t>(levels), 1);
  for (std::size_t i = 0; i < levels; ++i) {
    const double db = 20 * std::log10(std::max(field.levels[i].rms / own, 1e-15));
    const auto steps = static_cast<std::int32_t>(std::lround(std::clamp(db, -320.0, 320.0) / kLevelStep_db));
    put_float(out.bytes, field.levels[i].wavenumber_rad_m);
    put(out.bytes, static_cast<std::uint32_t>(steps), 2);
  }
  int before = -1;
  for (const Rounded& term : terms) {
    put_short(out.bytes, static_cast<std::uint32_t>(term.harmonic - before));
    put_short(out.bytes, fold(term.re));
    put_short(out.bytes, fold(term.im));
    before = term.harmonic;
  }
  if (unit > 0) out.largest_error = std::max(out.largest_error, rounding_error(field, unit));
}

// Reads little-endian numbers until the bytes end; `sound` is false from then on.
struct Reader {
  std::span<const std::byte> rest;
  bool sound = true;

  std::uint32_t number(std::size_t bytes) {
    if (rest.size() < bytes) sound = false;
    if (!sound) return 0;
    std::uint32_t value = 0;
    for (std::size_t b = 0; b < bytes; ++b) value |= static_cast<std::uint32_t>(rest[b]) << (8 * b);
    rest = rest.subspan(bytes);
    return value;
  }
  std::uint32_t short_number() {
    constexpr int kMaxBits = 14;
    std::uint32_t value = 0;
    for (int bit = 0; bit < kMaxBits; bit += 7) {
      const std::uint32_t byte = number(1);
      value |= (byte & 127) << bit;
      if (byte < 128) return value;
    }
    sound = false;
    return 0;
  }
  float real() {
    const std::uint32_t bits = number(4);
    float value = 0;
    std::memcpy(&value, &bits, sizeof value);
    if (!std::isfinite(value)) sound = false;
    return value;
  }
};

bool read_mode(Reader& in, FarField& field) {
  const float wavenumber = in.real(), unit = in.real();
  const std::uint32_t terms = in.number(2), levels = in.number(1);
  if (!in.sound || !(wavenumber > 0) || unit < 0 || levels > kMaxLevels || terms > in.rest.size() / 3) return false;
  field.wavenumber_rad_m = wavenumber;
  field.unit = unit;
  std::vector<float> ratios;
  for (std::uint32_t i = 0; i < levels; ++i) {
    const float at = in.real();
    const auto steps = static_cast<std::int16_t>(in.number(2));
    if (!(at > 0) || (i > 0 && at <= field.levels.back().wavenumber_rad_m)) return false;
    field.levels.push_back({.wavenumber_rad_m = at});
    ratios.push_back(std::pow(10.0F, static_cast<float>(steps) * kLevelStep_db / 20));
  }
  int harmonic = -1;
  for (std::uint32_t i = 0; i < terms; ++i) {
    const std::uint32_t step = in.short_number();
    const int re = unfold(in.short_number()), im = unfold(in.short_number());
    harmonic += static_cast<int>(step);
    if (!in.sound || step == 0 || harmonic >= harmonic_count(kMaxHarmonicDegree)) return false;
    field.terms.push_back({static_cast<std::uint16_t>(harmonic), {unit * re, unit * im}});
  }
  const double own = rms(field);
  if (levels > 0 && !(own > 0)) return false;
  for (std::size_t i = 0; i < ratios.size(); ++i) field.levels[i].rms = static_cast<float>(own * ratios[i]);
  return in.sound;
}

}  // namespace

PackedMaps pack(const RadiationMaps& maps, std::size_t max_bytes) {
  constexpr double kCoarser = 1.25, kMaxError = 0.5;
  PackedMaps packed;
  for (double error = kPackingError;; error *= kCoarser) {
    packed = {};
    put(packed.bytes, kVersion, 4);
    put(packed.bytes, static_cast<std::uint32_t>(maps.modes.size()), 4);
    for (const double at : {maps.origin_m.x, maps.origin_m.y, maps.origin_m.z}) put_float(packed.bytes, at);
    for (const FarField& field : maps.modes) pack_mode(field, error, packed);
    if (packed.bytes.size() <= max_bytes || error > kMaxError) return packed;
  }
}

Result<RadiationMaps> unpack(std::span<const std::byte> bytes, std::string_view name) {
  const auto broken = [&](const std::string& what) {
    return fail(ErrorKind::bad_input, "{}: the radiation maps {}", name, what);
  };
  Reader in{bytes};
  const std::uint32_t version = in.number(4), modes = in.number(4);
  if (in.sound && version != kVersion) return broken(formatted("have version {}, not 1", version));
  RadiationMaps maps;
  maps.origin_m = {in.real(), in.real(), in.real()};
  constexpr std::size_t kMinBytes = 11;  // for each mode
  if (!in.sound || modes > kMaxModes || modes > in.rest.size() / kMinBytes) return broken("are cut off");
  maps.modes.resize(modes);
  for (std::size_t m = 0; m < modes; ++m) {
    if (!read_mode(in, maps.modes[m])) return broken(formatted("are damaged at mode {}", m));
  }
  if (!in.rest.empty()) return broken("go on after the last mode");
  return maps;
}

}  // namespace ringdown::modal
