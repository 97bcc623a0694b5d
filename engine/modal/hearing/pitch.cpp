// A partial's audibility is its level above the threshold of hearing and above the masking by other partials. Its
// weight for pitch is larger the nearer it lies to 700 Hz: the spectral-pitch weights of Terhardt, Stoll & Seewann
// [J. Acoust. Soc. Am. 71, 679, 1982]. Partials less than a semitone apart count as one, at the stronger one's
// frequency.
//
// Each audible partial is a candidate. Its harmonics support the candidate, the k-th by 1/k of the harmonic's weight;
// makers tune bars 1 : 4 : 10 or 1 : 3 for this effect. All other partials within an octave above or below compete. A
// candidate's clarity is its share of the weight within that range; its score is its weight with its harmonics' times
// its clarity. A candidate must lie below 5 kHz, ring long enough to be a tone, and hold 1 % of the energy (or 0.01 %,
// if it holds half of the energy with its harmonics). The candidate of the highest score is the pitch if
//
//   its clarity is a half or more, and with its harmonics it holds at least as much energy as its competitors,
//   it is no more than half masked, and no other candidate except its harmonics comes near its score.
//
// Bells are recognised first: three partials at 2 : 3 : 4 that hold half of the energy give a strike note an octave
// below the first of the three [Terhardt & Seewann, Acustica 54, 129, 1984].
#include "engine/modal/hearing/pitch.h"

#include "engine/base/note.h"
#include "engine/modal/hearing/contact_pulse.h"
#include "engine/modal/hearing/loudness.h"
#include "engine/modal/hearing/masking.h"

#include <algorithm>
#include <cmath>
#include <numeric>
#include <optional>
#include <utility>
#include <vector>

namespace ringdown::modal {
namespace {

constexpr double kLowest_hz = 20, kHighest_hz = 20000;  // limits of hearing
constexpr double kListened_s = 1;
constexpr double kShortestContact_s = 0.0005, kLongestContact_s = 0.002;  // contact times, hard to soft mallets
constexpr int kContacts = 32;
constexpr double kListeningLevel_db = 70;  // SPL of the whole sound: moderate
constexpr double kOnePartial_cents = 100;  // closer partials fuse
constexpr double kInTune_cents = 50;       // largest mistuning of a harmonic
constexpr double kBellOctave_cents = 75;   // largest mistuning of a bell's 4; 4.17 in [Fletcher & Rossing, table 21.1]
constexpr int kHarmonics = 10;             // highest harmonic that supports a pitch
constexpr double kMinClarity = 0.5, kMinAudibility = 0.5;
constexpr double kTie = 0.9;                             // share of the best score from which a rival counts as a tie
constexpr double kMinShare = 0.01;                       // least share of the energy of a lone partial: -20 dB
constexpr double kMinOfGroup = 1e-4, kGroupShare = 0.5;  // least share of a partial whose group holds half of all
constexpr double kShortestTone_s =
    0.01;  // a time constant; shorter ones click [Doughty & Garner, J. Exp. Psych. 37, 1947]
constexpr double kEndOfPitch_hz = 5000;  // [Attneave & Olson, Am. J. Psych. 84, 1971]

struct Partial {
  double frequency_hz = 0, decay_per_s = 0;
  double energy = 0;      // in the first second, in any unit; later weighted by the ear, as a share of all
  double loudest = 0;     // energy of the mode that gives the partial its frequency
  double audibility = 0;  // level above the masking, as 0 (inaudible) to 1
  double weight = 0;      // spectral-pitch weight, 0 to 1
};

struct Candidate {
  double frequency_hz = 0;
  double score = 0, clarity = 0, audibility = 0;
  double share = 0, group = 0, rivals = 0;  // shares of the energy
};

double cents_between(double a_hz, double b_hz) { return 1200 * std::log2(a_hz / b_hz); }

// The share of the surface that each sample point represents, and the normal there.
struct Surface {
  std::vector<double> weight;
  std::vector<Vec3> normal;
};

Vec3 vector_of(const Vec3f& v) { return {v[0], v[1], v[2]}; }

Surface surface_of(const Bank& bank) {
  Surface surface{std::vector<double>(bank.point_count()), std::vector<Vec3>(bank.point_count())};
  double sum = 0;
  for (const auto& [a, b, c] : bank.triangles) {
    const Vec3 corner = vector_of(bank.positions[a]);
    const Vec3 area = cross(vector_of(bank.positions[b]) - corner, vector_of(bank.positions[c]) - corner);
    for (const std::uint32_t point : {a, b, c}) {
      surface.weight[point] += length(area);
      surface.normal[point] = surface.normal[point] + area;
      sum += length(area);
    }
  }
  if (!(sum > 0)) return {};
  for (double& weight : surface.weight) weight /= sum;
  for (Vec3& normal : surface.normal) {
    if (const double size = length(normal); size > 0) normal = (1 / size) * normal;
  }
  return surface;
}

// The mean square of the modal velocity after a blow of 1 N s. Without triangles, blows come from all directions.
double mean_square(const Bank& bank, const Surface& surface, std::size_t mode) {
  double sum = 0;
  for (std::size_t p = 0; p < bank.point_count(); ++p) {
    const Vec3 shape = vector_of(bank.shape(mode, p));
    sum += surface.weight.empty() ? dot(shape, shape) / (3 * static_cast<double>(bank.point_count()))
                                  : surface.weight[p] * std::pow(dot(shape, surface.normal[p]), 2);
  }
  return sum;
}

// The mean square of a contact's spectrum over short and long contacts.
double mean_pulse(double frequency_hz) {
  double sum = 0;
  for (int i = 0; i < kContacts; ++i) {
    const double way = (i + 0.5) / kContacts;
    sum += std::pow(
        pulse_spectrum(frequency_hz, kShortestContact_s * std::pow(kLongestContact_s / kShortestContact_s, way)), 2);
  }
  return sum / kContacts;
}

// The audible range's partials, ascending.
std::vector<Partial> partials_of(const Bank& bank) {
  const Loudness loudness(bank);
  const Surface surface = surface_of(bank);
  std::vector<Partial> modes;
  for (std::size_t m = 0; m < bank.mode_count(); ++m) {
    const double frequency_hz = bank.frequency_hz[m], decay = bank.decay_per_s[m];
    if (frequency_hz < kLowest_hz || frequency_hz > kHighest_hz) continue;
    const double pressure_pa = loudness.pressure_pa(bank, m, {}, frequency_hz);
    const double lasts_s = decay > 0 ? -std::expm1(-2 * decay * kListened_s) / (2 * decay) : kListened_s;
    const double energy =
        mean_square(bank, surface, m) * mean_pulse(frequency_hz) * pressure_pa * pressure_pa * lasts_s;
    if (energy > 0)
      modes.push_back({.frequency_hz = frequency_hz, .decay_per_s = decay, .energy = energy, .loudest = energy});
  }
  std::ranges::sort(modes, {}, &Partial::frequency_hz);
  std::vector<Partial> partials;
  for (const Partial& mode : modes) {
    if (partials.empty() || cents_between(mode.frequency_hz, partials.back().frequency_hz) >= kOnePartial_cents) {
      partials.push_back(mode);
      continue;
    }
    Partial& partial = partials.back();
    const double energy = partial.energy + mode.energy;
    if (mode.loudest > partial.loudest) partial = mode;
    partial.energy = energy;
  }
  return partials;
}

// The threshold of hearing in quiet [dB SPL; Terhardt 1979].
double threshold_db(double frequency_hz) {
  const double khz = frequency_hz / 1000;
  return 3.64 * std::pow(khz, -0.8) - 6.5 * std::exp(-0.6 * std::pow(khz - 3.3, 2)) + 1e-3 * std::pow(khz, 4);
}

// The A-weighting's factor on energies, up to a constant [IEC 61672-1, annex E].
double a_weight(double frequency_hz) {
  const double f2 = frequency_hz * frequency_hz;
  const double gain =
      f2 * f2 /
      ((f2 + 20.6 * 20.6) * std::sqrt((f2 + 107.7 * 107.7) * (f2 + 737.9 * 737.9)) * (f2 + 12194.0 * 12194.0));
  return gain * gain;
}

// Sets the weights, and energies as shares of the whole sound.
void hear(std::vector<Partial>& partials) {
  const auto sum = [&] {
    return std::accumulate(partials.begin(), partials.end(), 0.0,
                           [](double s, const Partial& p) { return s + p.energy; });
  };
  const double all = sum();
  std::vector<double> level_db;
  for (const Partial& partial : partials)
    level_db.push_back(kListeningLevel_db + 10 * std::log10(partial.energy / all));
  for (std::size_t i = 0; i < partials.size(); ++i) {
    const double f = partials[i].frequency_hz;
    double masking = 0;  // pressure, re the threshold's reference
    for (std::size_t k = 0; k < partials.size(); ++k) {
      if (k == i) continue;
      const double distance = bark(f) - bark(partials[k].frequency_hz);
      const double slope = distance < 0 ? 27 : 24 + 230 / partials[k].frequency_hz - 0.2 * level_db[k];
      masking += std::pow(10, (level_db[k] - slope * std::abs(distance)) / 20);
    }
    const double above_db = level_db[i] - 10 * std::log10(masking * masking + std::pow(10, threshold_db(f) / 10));
    const double off = f / 700 - 700 / f;
    partials[i].audibility = above_db > 0 ? 1 - std::exp(-above_db / 15) : 0;
    partials[i].weight = partials[i].audibility / std::sqrt(1 + 0.07 * off * off);
  }
  for (Partial& partial : partials) partial.energy *= a_weight(partial.frequency_hz);
  const double weighted = sum();
  for (Partial& partial : partials) partial.energy /= weighted;
}

// Returns k of the nearest harmonic and the partial's distance from it in cents; nothing beyond kHarmonics or out of
// tune.
std::optional<std::pair<int, double>> harmonic_of(double frequency_hz, double fundamental_hz) {
  const int k = static_cast<int>(std::lround(std::min(frequency_hz / fundamental_hz, kHarmonics + 1.0)));
  if (k < 1 || k > kHarmonics) return std::nullopt;
  const double off = std::abs(cents_between(frequency_hz, k * fundamental_hz));
  return off < kInTune_cents ? std::optional(std::pair(k, off)) : std::nullopt;
}

Candidate judge(const std::vector<Partial>& partials, const Partial& own) {
  Candidate candidate{.frequency_hz = own.frequency_hz, .audibility = own.audibility, .share = own.energy};
  double support = 0, rivals = 0;
  for (const Partial& partial : partials) {
    if (!(partial.weight > 0)) continue;
    if (const auto harmonic = harmonic_of(partial.frequency_hz, own.frequency_hz)) {
      const auto [k, off] = *harmonic;
      support += partial.weight / k * (1 - off / kInTune_cents);
      candidate.group += partial.energy;
    } else if (std::abs(cents_between(partial.frequency_hz, own.frequency_hz)) < 1200 + kInTune_cents) {
      rivals += partial.weight;
      candidate.rivals += partial.energy;
    }
  }
  candidate.clarity = own.weight / (own.weight + rivals);
  candidate.score = support * candidate.clarity;
  return candidate;
}

bool is_tone(const Partial& partial) {
  return partial.decay_per_s * kShortestTone_s <= 1 && partial.frequency_hz <= kEndOfPitch_hz;
}

bool is_loud(const Candidate& candidate) {
  return candidate.share >= kMinShare || (candidate.share >= kMinOfGroup && candidate.group >= kGroupShare);
}

// The energy of the strongest partial within the tolerance of this frequency; 0 if all are weak.
double strong_near(const std::vector<Partial>& partials, double frequency_hz, double tolerance_cents) {
  double strongest = 0;
  for (const Partial& partial : partials) {
    if (std::abs(cents_between(partial.frequency_hz, frequency_hz)) < tolerance_cents && partial.energy >= kMinShare)
      strongest = std::max(strongest, partial.energy);
  }
  return strongest;
}

// The strike note of a bell, with the energy of the three partials that give it.
std::optional<Candidate> strike_note(const std::vector<Partial>& partials) {
  for (const Partial& nominal : partials) {
    const double third = strong_near(partials, 1.5 * nominal.frequency_hz, kInTune_cents);
    const double fourth = strong_near(partials, 2 * nominal.frequency_hz, kBellOctave_cents);
    const double group = nominal.energy + third + fourth;
    if (nominal.energy < kMinShare || third == 0 || fourth == 0 || group < kGroupShare) continue;
    return Candidate{.frequency_hz = nominal.frequency_hz / 2, .group = group};
  }
  return std::nullopt;
}

// The candidate of the highest score that may be the pitch, and the next one that is not its harmonic.
struct Choice {
  Candidate best, next;
  Candidate any;  // the best candidate overall, if none may be the pitch
};

Choice choose(const std::vector<Partial>& partials) {
  Choice choice;
  std::vector<Candidate> candidates;
  for (const Partial& partial : partials) {
    if (!(partial.weight > 0)) continue;
    const Candidate candidate = judge(partials, partial);
    if (candidate.score > choice.any.score) choice.any = candidate;
    if (!is_tone(partial) || !is_loud(candidate)) continue;
    if (candidate.score > choice.best.score) choice.best = candidate;
    candidates.push_back(candidate);
  }
  for (const Candidate& candidate : candidates) {
    const bool is_rival = !harmonic_of(candidate.frequency_hz, choice.best.frequency_hz);
    if (is_rival && candidate.score > choice.next.score) choice.next = candidate;
  }
  return choice;
}

// Returns the reason why the best candidate is not a pitch; "" if it is one.
std::string objection(const Choice& choice) {
  const Candidate& best = choice.best;
  if (best.score == 0) return "nothing below 5 kHz rings for long enough";
  if (best.clarity < kMinClarity || best.group < best.rivals) return "several partials compete within an octave";
  if (best.audibility < kMinAudibility) return "its partials mask each other";
  if (choice.next.score > kTie * best.score) return "two partials are equally strong";
  return "";
}

Pitch found(double hz, double strength) { return {.hz = hz, .strength = strength, .tone_hz = hz, .reason = {}}; }

}  // namespace

Pitch estimated_pitch(const Bank& bank) {
  std::vector<Partial> partials = partials_of(bank);
  if (partials.empty()) {
    return {.hz = {}, .tone_hz = bank.mode_count() > 0 ? bank.frequency_hz[0] : 440, .reason = "no mode is audible"};
  }
  hear(partials);
  if (const auto bell = strike_note(partials)) return found(bell->frequency_hz, bell->group);
  const Choice choice = choose(partials);
  const std::string reason = objection(choice);
  if (reason.empty()) return found(choice.best.frequency_hz, choice.best.clarity);
  const Candidate& nearest = choice.best.score > 0 ? choice.best : choice.any;
  const double tone_hz = nearest.score > 0 ? nearest.frequency_hz : partials.front().frequency_hz;
  return {.hz = {}, .strength = nearest.clarity, .tone_hz = tone_hz, .reason = reason};
}

Pitch pitch_of(const Bank& bank) {
  if (!bank.pitch_hz) return estimated_pitch(bank);
  return {.hz = bank.pitch_hz, .stated = true, .strength = 1, .tone_hz = *bank.pitch_hz, .reason = {}};
}

std::optional<double> scaled_pitch(std::optional<double> pitch_hz, const MaterialScale& scale) {
  if (!pitch_hz) return std::nullopt;
  const double scaled_hz = *pitch_hz * std::sqrt(lambda_factor(scale));
  return kStatedPitch_hz.holds(scaled_hz) ? std::optional(scaled_hz) : std::nullopt;
}

std::string describe(const Pitch& pitch) {
  if (!pitch.hz) return formatted("none: {}; {:.2f} Hz comes closest to one", pitch.reason, pitch.tone_hz);
  return formatted("{:.2f} Hz ({}), {}", *pitch.hz, note_name(*pitch.hz),
                   pitch.stated ? "as its maker states" : "as estimated from its modes");
}

}  // namespace ringdown::modal
