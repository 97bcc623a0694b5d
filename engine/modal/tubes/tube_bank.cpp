#include "engine/modal/tubes/tube_bank.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <numbers>
#include <optional>
#include <span>
#include <utility>

namespace ringdown::modal {
namespace {

using Complex = std::complex<double>;
using Field = std::vector<Complex>;

constexpr double kAlike = 0.9;               // cosine between the shapes of a bar's mode and of its tube's
constexpr double kMinOpening = 1e-3;         // a closed tube keeps so much, so that its states keep a sound
constexpr double kParallel = 1e-3;           // as in engine/tube/coupled.cpp: two eigenvectors count as one
constexpr double kDetune = 0.5 / 1731.2340;  // half a cent
constexpr double kMinFieldTerm = 1e-4;       // of a field, as in the radiation of bodies

Complex omega_of(const Bank& bank, std::size_t mode) {
  return {hz_to_rad_per_s(bank.frequency_hz[mode]), -bank.decay_per_s[mode]};
}

double shape_product(const Bank& bank, std::size_t a, std::size_t b) {
  double sum = 0;
  for (std::size_t p = 0; p < bank.point_count(); ++p) {
    for (std::size_t axis = 0; axis < 3; ++axis)
      sum += static_cast<double>(bank.shape(a, p)[axis]) * static_cast<double>(bank.shape(b, p)[axis]);
  }
  return sum;
}

// A mode of the bar and one of a tube before they are coupled.
struct Oscillators {
  Complex bar, tube, bond;  // two frequencies, and g [rad/s]
};

// Their two modes: frequencies, and eigenvectors with x^T x = 1.
struct Coupled {
  std::array<Complex, 2> omega;
  std::array<Complex, 4> mixing;
};

// The modes stand in the order of the frequencies that they are near to.
Coupled coupled(Oscillators of, const std::array<Complex, 2>& near) {
  for (int attempt = 0;; ++attempt) {
    const Complex middle = 0.5 * (of.bar + of.tube), half = 0.5 * (of.bar - of.tube);
    const Complex root = std::sqrt(half * half + of.bond * of.bond);
    Coupled two{{middle + root, middle - root}, {}};
    // Of each eigenvector, the component of which less is lost by rounding follows from the other one.
    std::array<std::array<Complex, 2>, 2> vectors;
    double least = 1;
    for (std::size_t n = 0; n < 2; ++n) {
      const Complex off_bar = two.omega[n] - of.bar, off_tube = two.omega[n] - of.tube;
      auto& [bar, tube] = vectors[n];
      if (std::abs(off_tube) >= std::abs(off_bar)) {
        bar = off_tube, tube = of.bond;
      } else {
        bar = of.bond, tube = off_bar;
      }
      if (!(std::norm(bar) + std::norm(tube) > 0)) bar = n == 0 ? 1 : 0, tube = n == 0 ? 0 : 1;
      const Complex square = bar * bar + tube * tube;
      least = std::min(least, std::abs(square) / (std::norm(bar) + std::norm(tube)));
      const Complex scale = 1.0 / std::sqrt(square);
      bar *= scale, tube *= scale;
    }
    if (least < kParallel && attempt < 3) {
      of.tube *= 1 + kDetune;
      continue;
    }
    const auto far = [&](std::size_t first, std::size_t second) {
      return std::abs(two.omega[first] - near[0]) + std::abs(two.omega[second] - near[1]);
    };
    if (far(1, 0) < far(0, 1)) {
      std::swap(vectors[0], vectors[1]);
      std::swap(two.omega[0], two.omega[1]);
    }
    for (std::size_t n = 0; n < 2; ++n) {
      const double sign = vectors[n][n].real() < 0 ? -1 : 1;
      two.mixing[n] = sign * vectors[n][0];
      two.mixing[2 + n] = sign * vectors[n][1];
    }
    return two;
  }
}

Complex unit(Complex value) { return std::abs(value) > 0 ? value / std::abs(value) : Complex(1); }

// The phase of each mode's motion over what its state says: that of the bar, because a blow on it gives real
// amplitudes. Both are turned by what makes the sound of the tube real, so that it goes on without a step in another
// tuning.
std::array<Complex, 2> phases_of(const std::array<Complex, 4>& mixing, double sign) {
  const Complex turn = std::conj(unit(mixing[2] * unit(mixing[0])));
  return {turn * unit(mixing[0]), turn * sign * unit(mixing[1])};
}

// A tube and the two modes of the bank that it has with a mode of the bar.
struct Found {
  TubePair pair;
  Oscillators oscillators;
};

// The two modes of the bank that move the bar alike, and of which one lies nearest to the tube's own.
Result<Found> find_pair(const Bank& bank, const ResonatorNote& note) {
  const Complex tube(hz_to_rad_per_s(note.frequency_hz), -note.decay_per_s);
  double least = std::numeric_limits<double>::max();
  std::optional<std::pair<std::size_t, std::size_t>> found;
  std::vector<double> square(bank.mode_count());
  for (std::size_t m = 0; m < bank.mode_count(); ++m) square[m] = shape_product(bank, m, m);
  for (std::size_t a = 0; a < bank.mode_count(); ++a) {
    for (std::size_t b = 0; b < a; ++b) {
      const double pull = std::abs((omega_of(bank, a) - tube) * (omega_of(bank, b) - tube));
      if (pull >= least) continue;
      if (!(std::abs(shape_product(bank, a, b)) > kAlike * std::sqrt(square[a] * square[b]))) continue;
      least = pull;
      found = std::pair(a, b);
    }
  }
  if (!found)
    return fail(ErrorKind::bad_input,
                "no two of its bank's modes show how its tube pulls; bake it with a tube nearer to a mode's pitch");
  auto [bar, second] = *found;
  if (square[second] > square[bar]) std::swap(bar, second);
  const Complex first = omega_of(bank, bar), other = omega_of(bank, second);
  const Oscillators apart{first + other - tube, tube, std::sqrt(-(first - tube) * (other - tube))};
  const Coupled two = coupled(apart, {first, other});
  Found result{.pair = {.bar = bar, .tube = second, .mixing = two.mixing, .phase = {}}, .oscillators = apart};
  const double sign = shape_product(bank, bar, second) < 0 ? -1 : 1;
  result.pair.phase = phases_of(two.mixing, sign);
  return result;
}

Result<std::vector<Found>> find_pairs(const Bank& bank) {
  if (bank.provenance.resonators.empty())
    return fail(ErrorKind::bad_input, "its bank has no tube; bake it with [[resonator]]");
  std::vector<Found> all;
  for (const ResonatorNote& note : bank.provenance.resonators) {
    auto found = find_pair(bank, note);
    if (!found) return fail(found);
    for (const Found& before : all) {
      for (const std::size_t mode : {before.pair.bar, before.pair.tube}) {
        if (mode == found->pair.bar || mode == found->pair.tube)
          return fail(ErrorKind::bad_input, "two of its tubes pull one mode; bake it with one of them");
      }
    }
    all.push_back(*std::move(found));
  }
  return all;
}

double phase_of(const Field& field) {
  Complex sum;
  for (const Complex& value : field) sum += value * value;
  return 0.5 * std::arg(sum);
}

Field sum_of(Complex a, const Field& first, Complex b, const Field& second) {
  Field sum(first.size());
  for (std::size_t i = 0; i < sum.size(); ++i) sum[i] = a * first[i] + b * second[i];
  return sum;
}

// The overlap of two fields; of one with itself, its square.
Complex product_of(const Field& a, const Field& b) {
  Complex sum;
  for (std::size_t i = 0; i < a.size(); ++i) sum += std::conj(a[i]) * b[i];
  return sum;
}

// The far fields of a bar's mode and of its tube's, apart from each other.
struct Apart {
  Field bar, tube;
};

// A bank has fields up to a phase. That of the tube's mode is the one at which least is left for the bar, whose low
// modes radiate far less than the tube.
Apart fields_apart(const Bank& bank, const TubePair& pair) {
  const FarField &first = bank.radiation->maps.modes[pair.bar], &second = bank.radiation->maps.modes[pair.tube];
  std::size_t size = 0;
  for (const FarField* field : {&first, &second}) {
    if (!field->terms.empty()) size = std::max<std::size_t>(size, field->terms.back().harmonic + std::size_t{1});
  }
  const auto dense = [size](const FarField& field, Complex phase) {
    Field values(size);
    for (const FarField::Term& term : field.terms) values[term.harmonic] = Complex(term.value) / phase;
    return values;
  };
  const auto& [x11, x12, x21, x22] = pair.mixing;
  const Field one = dense(first, unit(x11)), two = dense(second, 1);
  const Complex turn = -unit(product_of(two, one) * std::conj(x12) * x11);
  return {sum_of(x11, one, x12 * turn, two), sum_of(x21, one, x22 * turn, two)};
}

// Of a tube in another tuning. Friction at the wall takes part of its own decay, and grows as the root of the pitch;
// the rest is what the mouth radiates, and grows as its cube (docs/how/tubes.md).
Oscillators retuned(Oscillators of, const ResonatorNote& note, const Air& air, const TubeTuning& tuning) {
  const double ratio = std::exp2(tuning.detune_cents / 1200), omega = of.tube.real();
  const double area = std::numbers::pi / 4 * note.diameter_m * note.diameter_m;
  const double decay = -of.tube.imag(), per_turn = std::numbers::pi * air.sound_speed_m_s;
  const double radiated = std::min(decay, omega * omega * omega * area / (2 * per_turn * per_turn));
  of.tube = {ratio * omega, -((decay - radiated) * std::sqrt(ratio) + radiated * ratio * ratio * ratio)};
  of.bond *= ratio * std::max(tuning.opening, kMinOpening);
  return of;
}

class Retuner {
 public:
  Retuner(const Bank& bank, const TubeTuning& tuning) : before_(bank), bank_(bank), tuning_(tuning) {
    bank_.fracture.reset();
  }

  TubePair retune(const Found& found, std::size_t tube) {
    ResonatorNote& note = bank_.provenance.resonators[tube];
    const Air air = before_.radiation ? before_.radiation->air : Air{};
    const Oscillators changed = retuned(found.oscillators, note, air, tuning_);
    const Coupled two = coupled(changed, {omega_of(before_, found.pair.bar), omega_of(before_, found.pair.tube)});
    TubePair pair = found.pair;
    pair.mixing = two.mixing;
    const double sign = before_.radiation ? set_fields(found, changed, two) : -1;
    pair.phase = phases_of(two.mixing, sign);
    set_shapes(found.pair, pair, sign);
    for (std::size_t n = 0; n < 2; ++n) set_mode(n, found.pair, two);
    note.length_m = (note.length_m + note.end_correction_m) * found.oscillators.tube.real() / changed.tube.real() -
                    note.end_correction_m;
    note.frequency_hz = rad_per_s_to_hz(changed.tube.real());
    note.decay_per_s = -changed.tube.imag();
    return pair;
  }

  Bank take() { return std::move(bank_); }

 private:
  // Frequency, decay and its parts: the bar's own go with its share of the energy, and the tube takes the rest.
  void set_mode(std::size_t n, const TubePair& before, const Coupled& two) {
    const std::size_t mode = n == 0 ? before.bar : before.tube;
    const auto share = [n](const std::array<Complex, 4>& mixing) {
      return std::norm(mixing[n]) / (std::norm(mixing[n]) + std::norm(mixing[2 + n]));
    };
    bank_.frequency_hz[mode] = rad_per_s_to_hz(two.omega[n].real());
    bank_.decay_per_s[mode] = -two.omega[n].imag();
    const double more = share(two.mixing) / share(before.mixing);
    if (!bank_.heat.empty()) bank_.heat[mode] = multiplied(before_.heat[mode], more, 1);
    if (bank_.losses.empty()) return;
    ModeLoss loss = before_.losses[mode];
    loss.material_per_s *= more, loss.support_per_s *= more, loss.heat_per_s *= more, loss.air_per_s = 0;
    const double own = loss.total_per_s(), all = bank_.decay_per_s[mode];
    if (own > all) loss.material_per_s *= all / own, loss.support_per_s *= all / own, loss.heat_per_s *= all / own;
    loss.air_per_s = std::max(all - own, 0.0);
    bank_.losses[mode] = loss;
  }

  // The bar's part of the tube's mode changes; what other modes of the bar add to it stays.
  void set_shapes(const TubePair& before, const TubePair& after, double sign) {
    const double unit_size = std::abs(before.mixing[0]);
    const double sign_before = shape_product(before_, before.bar, before.tube) < 0 ? -1 : 1;
    const double bar = std::abs(after.mixing[0]) / unit_size;
    const double kept = sign * sign_before;
    const double tube = sign * (std::abs(after.mixing[1]) - std::abs(before.mixing[1])) / unit_size;
    const std::size_t points = bank_.point_count();
    for (std::size_t p = 0; p < points; ++p) {
      for (std::size_t axis = 0; axis < 3; ++axis) {
        const double first = static_cast<double>(before_.shape(before.bar, p)[axis]);
        const double second = static_cast<double>(before_.shape(before.tube, p)[axis]);
        bank_.shapes[before.bar * points + p][axis] = static_cast<float>(bar * first);
        bank_.shapes[before.tube * points + p][axis] = static_cast<float>(kept * second + tube * first);
      }
    }
  }

  // Returns the sign of the shape of the tube's mode beside that of the bar's. The mixer hears each mode at its own
  // phase, so the sign of the field goes into the shape: the tube is silent when the bar is struck.
  double set_fields(const Found& found, const Oscillators& changed, const Coupled& two) {
    Apart apart = fields_apart(before_, found.pair);
    const double louder =
        std::max(tuning_.opening, kMinOpening) * std::sqrt(changed.tube.real() / found.oscillators.tube.real());
    for (Complex& value : apart.tube) value *= louder;
    const auto& [x11, x12, x21, x22] = two.mixing;
    const Field first = sum_of(unit(x11) * x11, apart.bar, unit(x11) * x21, apart.tube);
    Field second = sum_of(unit(x12) * x12, apart.bar, unit(x12) * x22, apart.tube);
    const double sign = product_of(first, second).real() < 0 ? -1 : 1;
    const Complex turn = std::polar(sign, -phase_of(second));
    for (Complex& value : second) value *= turn;
    put(found.pair.bar, first, two.omega[0]);
    put(found.pair.tube, second, two.omega[1]);
    return sign;
  }

  void put(std::size_t mode, const Field& values, Complex omega) {
    FarField& field = bank_.radiation->maps.modes[mode];
    const double before = rms(field);
    field.wavenumber_rad_m = omega.real() / bank_.radiation->air.sound_speed_m_s;
    field.unit = 0;
    field.terms = terms_of(values, kMinFieldTerm);
    const double ratio = before > 0 ? rms(field) / before : 0;
    for (FarField::Level& level : field.levels) level.rms = static_cast<float>(level.rms * ratio);
  }

  const Bank& before_;
  Bank bank_;
  const TubeTuning tuning_;
};

// The share of a field that one of its parts has.
double share_of(const Field& part, const Field& whole) {
  const double all = product_of(whole, whole).real();
  return all > 0 ? std::clamp(product_of(whole, part).real() / all, 0.0, 1.0) : 0;
}

}  // namespace

Result<TubeModes> as_tuned(const Bank& bank) {
  const auto found = find_pairs(bank);
  if (!found) return fail(found);
  TubeModes modes;
  for (const Found& one : *found) modes.pairs.push_back(one.pair);
  return modes;
}

Result<TubeBank> at_tuning(const Bank& bank, const TubeTuning& tuning) {
  const auto found = find_pairs(bank);
  if (!found) return fail(found);
  Retuner retuner(bank, tuning);
  TubeModes modes{.tuning = tuning, .pairs = {}};
  for (std::size_t t = 0; t < found->size(); ++t) modes.pairs.push_back(retuner.retune((*found)[t], t));
  return TubeBank{retuner.take(), std::move(modes)};
}

ModeTransfer transfer(const TubeModes& from, const TubeModes& to, std::size_t modes) {
  ModeTransfer change;
  change.velocity.resize(modes * modes);
  change.turn.resize(modes * modes);
  for (std::size_t m = 0; m < modes; ++m) change.velocity[m * modes + m] = 1;
  for (std::size_t t = 0; t < to.pairs.size(); ++t) {
    const TubePair &old = from.pairs[t], &now = to.pairs[t];
    const std::array<std::size_t, 2> at = {now.bar, now.tube};
    for (std::size_t i = 0; i < 2; ++i) {
      for (std::size_t j = 0; j < 2; ++j) {
        const Complex along = now.mixing[i] * old.mixing[j] + now.mixing[2 + i] * old.mixing[2 + j];
        // States turn as exp(+i omega t), the tube's equations as exp(-i omega t).
        const Complex part = std::conj(along * old.phase[j] / now.phase[i]);
        change.velocity[at[i] * modes + at[j]] = part.real();
        change.turn[at[i] * modes + at[j]] = part.imag();
      }
    }
  }
  change.displacement = change.velocity;
  return change;
}

std::vector<double> tube_shares(const Bank& bank) {
  std::vector<double> shares;
  if (!bank.radiation || bank.provenance.resonators.empty()) return shares;
  const auto found = find_pairs(bank);
  if (!found) return shares;
  shares.resize(bank.mode_count());
  for (const Found& one : *found) {
    const auto& [x11, x12, x21, x22] = one.pair.mixing;
    const Apart apart = fields_apart(bank, one.pair);
    shares[one.pair.bar] = share_of(sum_of(0, apart.bar, x21, apart.tube), sum_of(x11, apart.bar, x21, apart.tube));
    shares[one.pair.tube] = share_of(sum_of(0, apart.bar, x22, apart.tube), sum_of(x12, apart.bar, x22, apart.tube));
  }
  return shares;
}

}  // namespace ringdown::modal
