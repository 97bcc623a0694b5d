#include "clients/plugin/key_map.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <map>
#include <numbers>
#include <string>
#include <utility>

namespace ringdown::plugin {
namespace {

constexpr std::size_t kLeadingModes = 8;  // decide where an object moves most, as without a note map in the daemon
constexpr double kBlow_m_s = 0.1;         // speed that a blow gives the object as a whole
constexpr double kMinSize = 0.01, kMaxSize = 100;  // what libringdown takes
constexpr double kLowest_hz = 20, kHighest_hz = 20000;
constexpr double kPitchContact_s = 2e-4,
                 kEnoughEnergy = 0.01;  // of the mode with most: that of the pitch may have less
constexpr double kConcertA_hz = 440, kConcertA = 69;

// The bank's arrays, by mode and point.
struct Shapes {
  std::size_t modes, points;
  const float *shapes, *positions_m;

  [[nodiscard]] Vec3 shape(std::size_t mode, std::size_t point) const {
    return vector(shapes + 3 * (mode * points + point));
  }
  [[nodiscard]] Vec3 position_m(std::size_t point) const { return vector(positions_m + 3 * point); }
  static Vec3 vector(const float* xyz) {
    return {static_cast<double>(xyz[0]), static_cast<double>(xyz[1]), static_cast<double>(xyz[2])};
  }
};

Shapes shapes_of(const ringdown_bank* bank) {
  ringdown_bank_info info{};
  info.size = sizeof info;
  ringdown_bank_describe(bank, &info);
  return {info.modes, info.points, ringdown_bank_shapes(bank), ringdown_bank_points_m(bank)};
}

double motion_at(const Shapes& bank, std::size_t point) {
  double sum = 0;
  for (std::size_t mode = 0; mode < std::min(bank.modes, kLeadingModes); ++mode) {
    sum += dot(bank.shape(mode, point), bank.shape(mode, point));
  }
  return sum;
}

std::size_t nearest_point(const Shapes& bank, const Vec3& position_m) {
  std::size_t nearest = 0;
  double min = std::numeric_limits<double>::infinity();
  for (std::size_t point = 0; point < bank.points; ++point) {
    const Vec3 offset = bank.position_m(point) - position_m;
    if (const double distance = dot(offset, offset); distance < min) {
      nearest = point;
      min = distance;
    }
  }
  return nearest;
}

// Walks from the place where the leading modes move most to the sample point nearest to the middle. Where the main mode
// is at rest, the direction is that of the nearest place where it moves.
void lay_stations(const Shapes& bank, const Vec3& middle_m, Body& body) {
  std::size_t best = 0;
  double max = -1;
  for (std::size_t point = 0; point < bank.points; ++point) {
    if (const double motion = motion_at(bank, point); motion > max) {
      best = point;
      max = motion;
    }
  }
  const Vec3 start_m = bank.position_m(best);
  const double strong = length(bank.shape(0, best));
  Vec3 direction{0, 0, 1};
  for (std::size_t i = 0; i < kStations; ++i) {
    const double way = static_cast<double>(i) / (kStations - 1);
    const std::size_t point = i == 0 ? best : nearest_point(bank, start_m + way * (middle_m - start_m));
    const Vec3 motion = bank.shape(0, point);
    if (length(motion) > 1e-3 * strong) direction = (1 / length(motion)) * motion;
    body.stations[i] = {static_cast<std::uint32_t>(point), bank.position_m(point), direction};
  }
}

// Returns the pressure of each mode at 1 m after an ideal impulse of 1 N s at a sample point [Pa]; 0 for inaudible
// modes.
std::vector<double> audible_pa(const ringdown_bank* bank, const Shapes& shapes, std::size_t point,
                               const Vec3& direction) {
  std::vector<double> amplitudes(shapes.modes);
  if (ringdown_bank_levels_pa(bank, amplitudes.data()) != RINGDOWN_OK) return amplitudes;
  const double* const frequencies_hz = ringdown_bank_frequencies_hz(bank);
  for (std::size_t mode = 0; mode < shapes.modes; ++mode) {
    const bool is_heard = frequencies_hz[mode] >= kLowest_hz && frequencies_hz[mode] <= kHighest_hz;
    amplitudes[mode] *= is_heard ? std::abs(dot(shapes.shape(mode, point), direction)) : 0;
  }
  return amplitudes;
}

std::vector<double> audible_pa(const ringdown_bank* bank, const Shapes& shapes, const Body& body) {
  return audible_pa(bank, shapes, body.stations[0].point, body.stations[0].direction);
}

// Returns the share of a mode that is left if the blow is not an ideal impulse, but a half sine.
double heard_of_blow(double frequency_hz, double contact_time_s) {
  const double turns = 2 * frequency_hz * contact_time_s;
  if (std::abs(turns - 1) < 1e-6) return std::numbers::pi / 4;
  return std::abs(std::cos(std::numbers::pi * turns / 2) / (1 - turns * turns));
}

// Returns the pitch that earlier versions found: the lowest of the modes that radiate nearly as much energy as any
// after a blow of wood. Sessions that they saved at concert pitch have sizes based on it, so players are told if it
// differs.
double pitch_before_hz(const ringdown_bank* bank, const std::vector<double>& amplitudes_pa) {
  const double* const frequencies_hz = ringdown_bank_frequencies_hz(bank);
  const double* const decays_per_s = ringdown_bank_decays_per_s(bank);
  std::vector<double> energies(amplitudes_pa.size());
  for (std::size_t mode = 0; mode < energies.size(); ++mode) {
    energies[mode] =
        std::pow(amplitudes_pa[mode] * heard_of_blow(frequencies_hz[mode], kPitchContact_s), 2) / decays_per_s[mode];
  }
  const double enough = kEnoughEnergy * *std::max_element(energies.begin(), energies.end());
  double lowest = frequencies_hz[0];
  for (std::size_t mode = 0; mode < energies.size(); ++mode) {
    if (energies[mode] >= enough && energies[mode] > 0) lowest = std::min(lowest, frequencies_hz[mode]);
  }
  return lowest;
}

Result<std::shared_ptr<ringdown_bank>> opened(const std::filesystem::path& path, std::string_view bytes) {
  ringdown_bank* bank = nullptr;
  ringdown_error error{};
  const ringdown_result result = bytes.empty()
                                     ? ringdown_bank_open(path.c_str(), &bank, &error)
                                     : ringdown_bank_parse(bytes.data(), bytes.size(), path.c_str(), &bank, &error);
  if (result != RINGDOWN_OK) return fail(ErrorKind::bad_input, error.sentence);
  return std::shared_ptr<ringdown_bank>(bank, BankRelease{});
}

Result<void> add_body(const std::filesystem::path& path, std::string_view bytes, KeyPlan& plan) {
  auto bank = opened(path, bytes);
  if (!bank) return fail(bank);
  const auto body = measure(bank->get());
  if (!body) return fail(ErrorKind::bad_input, path.string() + ": " + body.error().message);
  plan.map.bodies.push_back(*body);
  plan.banks.push_back(*std::move(bank));
  return {};
}

// Returns a sentence if earlier versions took another pitch for the bank, by more than any ear would call in tune.
std::string notice_of(const Body& body, const ringdown_bank* bank, const Source& source) {
  constexpr double kTolerance_octaves = 0.5 / 12;
  const Shapes shapes = shapes_of(bank);
  const double before_hz = pitch_before_hz(bank, audible_pa(bank, shapes, body));
  if (std::abs(std::log2(body.pitch_hz / before_hz)) < kTolerance_octaves) return "";
  return formatted(
      "{}: at concert pitch its keys are tuned by {:.1f} Hz; earlier versions took {:.1f} Hz, so a session saved by "
      "them sounds {:.1f} semitones {}",
      source.path.string(), body.pitch_hz, before_hz, 12 * std::abs(std::log2(body.pitch_hz / before_hz)),
      body.pitch_hz < before_hz ? "higher" : "lower");
}

double distance_m(const Shapes& shapes, const Vec3& point_m) {
  return length(shapes.position_m(nearest_point(shapes, point_m)) - point_m);
}

Result<void> check_point(const session::NoteMap::Entry& entry, const ringdown_bank* bank) {
  if (!entry.point_m || is_near(bank, *entry.point_m)) return {};
  return fail(ErrorKind::bad_input, "note {}: point_m lies {:f} m from {}, in whose frame and metres it should be",
              entry.note, distance_m(shapes_of(bank), *entry.point_m), entry.object);
}

// The geometric mean, over the keys with an impulse of their own, of what would bring each to the even level.
double evening_of(const KeyMap& map) {
  double logarithms = 0, count = 0;
  for (const KeyMap::Key& key : map.keys) {
    if (!key.sounds || !key.impulse_ns || length(*key.impulse_ns) == 0) continue;
    logarithms += std::log(map.body_of(map.objects[key.object]).even_impulse_ns / length(*key.impulse_ns));
    ++count;
  }
  return count > 0 ? std::exp(logarithms / count) : 1;
}

// Refuses a level that the bank does not know.
Result<void> check_level(const session::NoteMap::Entry& entry, const ringdown_bank* bank) {
  ringdown_bank_info info{};
  info.size = sizeof info;
  if (!entry.level_m || ringdown_bank_describe(bank, &info) != RINGDOWN_OK) return {};
  const auto [low, high] = info.level_m;
  if (low < high && *entry.level_m >= low && *entry.level_m <= high) return {};
  return fail(ErrorKind::bad_input,
              "note {}: the bank of object \"{}\" knows no level of {:.4g} m, but from {:.4g} to {:.4g}", entry.note,
              entry.object, *entry.level_m, low, high);
}

std::optional<KeyMap::Key::Bow> bow_of(const session::NoteMap::Entry& entry) {
  if (!entry.is_bowed()) return std::nullopt;
  const auto unit = [](const Vec3& way) { return (1 / length(way)) * way; };
  return KeyMap::Key::Bow{entry.bow_direction ? std::optional(unit(*entry.bow_direction)) : std::nullopt,
                          entry.bow_speed_m_s.value_or(session::kDefaultBow_m_s),
                          entry.bow_force_n.value_or(session::kDefaultBow_n)};
}

// The objects that the map names, each with its bank. Objects may share one.
Result<KeyPlan> plan_note_map(const std::filesystem::path& path) {
  const auto file = session::read_note_map(path);
  if (!file) return fail(file);
  KeyPlan plan;
  plan.map.is_note_map = true;
  plan.map.release_s = file->release_s;
  plan.map.damp_s = file->damp_s;
  plan.map.tuning = file->tuning;
  std::map<std::string, std::uint32_t> known;
  std::map<std::string, std::size_t> bodies;  // by the bank's file
  for (const session::NoteMap::Entry& entry : file->notes) {
    const auto [object, is_new] = known.try_emplace(entry.object, static_cast<std::uint32_t>(known.size()));
    if (is_new) {
      const std::string file_name = entry.bank_file();
      const auto [body, is_first] = bodies.try_emplace(file_name, plan.banks.size());
      if (is_first) {
        if (const auto good = add_body(path.parent_path() / file->banks / file_name, {}, plan); !good)
          return fail(good);
      }
      plan.map.objects.push_back(
          {.body = body->second, .key = entry.note, .name = entry.object, .level_m = entry.level_m});
    }
    const ringdown_bank* const bank = plan.banks[plan.map.objects[object->second].body].get();
    for (const auto& good : {check_point(entry, bank), check_level(entry, bank)}) {
      if (!good) return fail(ErrorKind::bad_input, path.string() + ": " + good.error().message);
    }
    plan.map.keys[entry.note] = {true,         object->second, entry.point_m, entry.impulse_ns, entry.contact_time_s,
                                 bow_of(entry)};
    std::size_t& lowest = plan.map.objects[object->second].key;
    lowest = std::min(lowest, entry.note);
  }
  plan.map.evening = evening_of(plan.map);
  return plan;
}

// Returns the mode that a bow at the first station sounds: that of the pitch; if it hardly moves there, the one that
// moves most.
BowedMode bowed_mode(const ringdown_bank* bank, const Shapes& shapes, const Body& body) {
  constexpr double kHardly = 0.01;
  const double* const frequencies_hz = ringdown_bank_frequencies_hz(bank);
  BowedMode most, tuned;
  double nearest = std::numeric_limits<double>::infinity();
  for (std::size_t mode = 0; mode < shapes.modes; ++mode) {
    const double per_kg = std::pow(dot(shapes.shape(mode, body.stations[0].point), body.stations[0].direction), 2);
    const BowedMode bowed{per_kg, 2 * std::numbers::pi * frequencies_hz[mode]};
    if (per_kg > most.per_kg) most = bowed;
    const double away = std::abs(std::log2(frequencies_hz[mode] / body.pitch_hz));
    if (away < nearest) tuned = bowed;
    nearest = std::min(nearest, away);
  }
  return tuned.per_kg > kHardly * most.per_kg ? tuned : most;
}

}  // namespace

Result<Body> measure(const ringdown_bank* bank) {
  ringdown_bank_info info{};
  info.size = sizeof info;
  if (ringdown_bank_describe(bank, &info) != RINGDOWN_OK || info.modes == 0 || info.points == 0) {
    return fail(ErrorKind::bad_input, "the bank has no modes that could be struck");
  }
  const Shapes shapes{info.modes, info.points, ringdown_bank_shapes(bank), ringdown_bank_points_m(bank)};
  Body body;
  const double* const middle = info.center_of_mass_m;
  lay_stations(shapes, {middle[0], middle[1], middle[2]}, body);
  if (info.mass_kg > 0) body.mass_kg = info.mass_kg;
  const std::vector<double> amplitudes_pa = audible_pa(bank, shapes, body);
  ringdown_pitch kind = RINGDOWN_PITCH_NONE;
  if (ringdown_bank_pitch(bank, &body.pitch_hz, &kind) != RINGDOWN_OK) {
    return fail(ErrorKind::bad_input, "the bank's pitch cannot be found");
  }
  double power = 0;
  for (const double amplitude : amplitudes_pa) power += amplitude * amplitude / 2;
  const double* const decays_per_s = ringdown_bank_decays_per_s(bank);
  const double slowest_per_s = *std::min_element(decays_per_s, decays_per_s + info.modes);
  body.ring_s = kInaudible_db / 20 * std::numbers::ln10 / slowest_per_s;
  body.bowed = bowed_mode(bank, shapes, body);
  body.even_impulse_ns = power > 0 ? kEvenLevel_pa / std::sqrt(power) : kBlow_m_s * body.mass_kg;
  return body;
}

// libringdown refuses blows outside of the object, and the audio thread must not make any.
bool is_near(const ringdown_bank* bank, const Vec3& point_m) {
  const Shapes shapes = shapes_of(bank);
  double size_m = 0;
  for (std::size_t point = 0; point < shapes.points; ++point) {
    size_m = std::max(size_m, length(shapes.position_m(point) - shapes.position_m(0)));
  }
  return distance_m(shapes, point_m) <= size_m / 2;
}

std::vector<double> struck_pa(const ringdown_bank* bank, const Vec3& point_m, const Vec3& direction,
                              double contact_time_s) {
  const Shapes shapes = shapes_of(bank);
  std::vector<double> amplitudes = audible_pa(bank, shapes, nearest_point(shapes, point_m), direction);
  const double* const frequencies_hz = ringdown_bank_frequencies_hz(bank);
  for (std::size_t mode = 0; mode < shapes.modes; ++mode) {
    amplitudes[mode] *= heard_of_blow(frequencies_hz[mode], contact_time_s);
  }
  return amplitudes;
}

Result<KeyPlan> plan_keys(const Source& source, std::string_view embedded) {
  if (is_note_map(source)) return plan_note_map(source.path);
  KeyPlan plan;
  if (const auto good = add_body(source.path, embedded, plan); !good) return fail(good);
  plan.notice = notice_of(plan.map.bodies[0], plan.banks[0].get(), source);
  for (std::uint32_t key = 0; key < kKeys; ++key) {
    plan.map.keys[key].sounds = true;
    plan.map.keys[key].object = key;
    plan.map.objects.push_back({.body = 0, .key = key});
  }
  return plan;
}

double size_of(const KeyMap& map, const KeyMap::Object& object, const ParameterValues& parameters,
               double bend_semitones) REALTIME {
  double size = parameters[Parameter::size] * std::exp2(-bend_semitones / 12);
  const double key = static_cast<double>(object.key);
  if (map.is_note_map) {
    // as large as its bank
  } else if (parameters.on(Parameter::tuning)) {
    size *= std::exp2((parameters[Parameter::root_key] - key) / 12);
  } else {
    const double wanted_hz = kConcertA_hz * std::exp2((key - kConcertA) / 12);
    const double material = std::sqrt(parameters[Parameter::stiffness] / parameters[Parameter::density]);
    size *= map.body_of(object).pitch_hz * material / wanted_hz;
  }
  return std::clamp(size, kMinSize, kMaxSize);
}

// A body that is s times as large has s^3 times the mass. Its modes move 1/s^(3/2) times as much per impulse and
// radiate 1/sqrt(s) times the pressure per modal velocity, so an impulse s^2 times as large is equally loud.
double full_impulse_ns(const Body& body, const ParameterValues& parameters, double size) REALTIME {
  if (parameters.on(Parameter::even_loudness)) return body.even_impulse_ns * size * size;
  return kBlow_m_s * body.mass_kg * parameters[Parameter::density] * size * size * size;
}

}  // namespace ringdown::plugin
