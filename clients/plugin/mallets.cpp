#include "clients/plugin/mallets.h"

#include <algorithm>
#include <cmath>

// libringdown's events allocate, lock and wait for nothing, but a C header cannot say so to the compiler.
TRUST_REALTIME_BEGIN

namespace ringdown::plugin {
namespace {

// The limits of blows, mallets and bows are those of libringdown, or below them.
constexpr double kMaxContact_s = 0.1, kMaxImpulse_ns = 1e4;
constexpr double kMaxMallet_kg = 100, kMaxMallet_m_s = 100, kSoftestHead = 1, kHardestHead = 1e14;
constexpr double kMaxBow_n = 1e5;

constexpr double kDeadBounce = 0.05;
constexpr double kPress = 0.5;    // of a bow at full pressure: its force over w m v
constexpr double kBow_m_s = 0.2;  // at 0.4, as note maps have it, presets take up to a second to sound

// Returns the exact point that a velocity strikes, if there is one.
const StrikePoint* exact_point(const KeyMap& map, double percent, std::uint8_t velocity) REALTIME {
  const auto& [first, second] = map.points;
  if (velocity >= kSecondFrom && second && second->is_at(percent)) return &*second;
  return first && first->is_at(percent) ? &*first : nullptr;
}

}  // namespace

Target target_of(const KeyMap::Key& key, std::uint8_t velocity, const KeyMap& map, const ParameterValues& parameters,
                 const PlacedSizes& sizes, double bend_semitones) REALTIME {
  const KeyMap::Object& object = map.objects[key.object];
  const Body& body = map.body_of(object);
  Target target;
  target.object = object.number;
  target.index = key.object;
  target.placed_size = sizes[key.object];
  target.size = size_of(map, object, parameters, bend_semitones);
  const double percent = parameters[Parameter::strike_point];
  const Body::Station& station = body.stations[std::min(static_cast<std::size_t>(std::lround(percent)), kStations - 1)];
  const StrikePoint* const exact = exact_point(map, percent, velocity);
  const Vec3 direction = exact ? exact->direction : station.direction;
  if (!key.point_m && !exact) target.vertex = station.point;
  target.point_m = exact ? exact->point_m : key.point_m.value_or(station.position_m);
  const double evening = parameters.on(Parameter::even_loudness) ? map.evening : 1;
  const Vec3 full_ns =
      key.impulse_ns ? evening * *key.impulse_ns : full_impulse_ns(body, parameters, target.size) * direction;
  target.full_ns = std::min(1.0, kMaxImpulse_ns / std::max(length(full_ns), kMaxImpulse_ns)) * full_ns;
  target.contact_time_s = key.contact_time_s ? *key.contact_time_s : 1e-3 * parameters[Parameter::contact_time];
  target.mass_kg = body.mass_kg * parameters[Parameter::density] * std::pow(target.size, 3);
  return target;
}

void strike(ringdown_mixer* mixer, std::int64_t frame, const Target& target, const Blow& blow) REALTIME {
  const Vec3 impulse = blow.share * target.full_ns;
  const double impulse_ns[3] = {impulse.x, impulse.y, impulse.z};
  const double contact_time_s =
      std::min(target.contact_time_s * std::pow(blow.share, -0.2) * blow.softness, kMaxContact_s);
  if (target.vertex) {
    ringdown_strike_vertex(mixer, frame, target.object, *target.vertex, impulse_ns, contact_time_s, nullptr);
  } else {
    double point_m[3];
    write(target.placed_size * target.point_m, point_m);
    ringdown_strike(mixer, frame, target.object, point_m, impulse_ns, contact_time_s, nullptr);
  }
}

// The time of contact is proportional to head^(-2/5), by Hertz's law.
void throw_mallet(ringdown_mixer* mixer, std::int64_t frame, const Target& target, const Blow& blow,
                  const MalletInfo& mallet) REALTIME {
  const double full_ns = length(target.full_ns);
  if (!(full_ns > 0)) return;
  ringdown_mallet_args args;
  ringdown_mallet_args_init(&args, sizeof args);
  args.bounce = blow.is_dead ? kDeadBounce : mallet.bounce;
  args.mass_kg = std::min(std::max(mallet.mass_kg, full_ns / ((1 + mallet.bounce) * kFastest_m_s)), kMaxMallet_kg);
  args.head = std::clamp(mallet.head * std::pow(blow.softness, -2.5), kSoftestHead, kHardestHead);
  const double speed_m_s =
      std::min(blow.share * full_ns / (1 + args.bounce) * (1 / args.mass_kg + 1 / target.mass_kg), kMaxMallet_m_s);
  const Vec3 velocity = speed_m_s / full_ns * target.full_ns;
  write(target.placed_size * target.point_m, args.point_m);
  write(velocity, args.velocity_m_s);
  ringdown_mallet(mixer, frame, target.object, &args, nullptr);
}

// The greatest force at which the hair still slips once in each period is about w m v / (static - sliding friction),
// for a mode of frequency w and mass m at the bow. In the object's size, m grows as size^3, and w as 1 / size.
Bows::Stroke stroke_of(const KeyMap::Key& key, const Target& target, const KeyMap& map,
                       const ParameterValues& parameters) REALTIME {
  const KeyMap::Object& object = map.objects[key.object];
  const Body& body = map.body_of(object);
  Bows::Stroke stroke;
  stroke.object = target.object;
  stroke.index = target.index;
  stroke.map = map.generation;
  stroke.point_m = target.point_m;
  const double full_ns = length(target.full_ns);
  const Vec3 way = full_ns > 0 ? (1 / full_ns) * target.full_ns : body.stations[0].direction;
  stroke.direction = key.bow && key.bow->direction ? *key.bow->direction : way;
  if (key.bow) {
    stroke.speed_m_s = key.bow->speed_m_s;
    stroke.force_n = key.bow->force_n;
    return stroke;
  }
  const double per_kg = body.bowed.per_kg * body.mass_kg / target.mass_kg;
  const double stiffness = std::sqrt(parameters[Parameter::stiffness] / parameters[Parameter::density]);
  const double omega_rad_s = body.bowed.omega_rad_s * stiffness / target.size;
  stroke.speed_m_s = kBow_m_s;
  stroke.force_n = per_kg > 0 ? std::min(kPress * omega_rad_s * stroke.speed_m_s / per_kg, kMaxBow_n) : 0;
  return stroke;
}

}  // namespace ringdown::plugin

TRUST_REALTIME_END
