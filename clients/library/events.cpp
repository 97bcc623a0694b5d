// Events: each is made into the request that a message to the daemon would be, checked like that, and pushed as the
// mixer's event.
#include "clients/library/handles.h"

#include "protocol/schema.h"
#include "server/session/request_events.h"

using namespace ringdown;
using library::guarded, library::missing, library::numbered, library::vector;

namespace {

constexpr double kMaxAhead_s = 3600;

Result<void> check_frame(const synth::Mixer& mixer, std::int64_t frame) {
  const double ahead_s =
      static_cast<double>(frame - mixer.counters().frames.load(std::memory_order_relaxed)) / mixer.sample_rate_hz();
  if (ahead_s <= kMaxAhead_s) return {};
  return fail(ErrorKind::bad_input, "frame lies more than an hour ahead");
}

// Neither allocates nor locks, unless it fails. A gain or pan goes to the mixer alone: Rack::push would lock to write
// it into the object's description.
template <class Request>
ringdown_result play(ringdown_mixer* mixer, std::int64_t frame, const Request& request, ringdown_error* error) {
  return guarded(error, [&]() -> Result<void> {
    if (!mixer) return missing("mixer");
    if (auto good = protocol::check(request); !good) return good;
    if (auto good = check_frame(mixer->rack.mixer(), frame); !good) return good;
    mixer->events.clear();
    if (auto good = session::append_events(request, mixer->rack, frame, mixer->events); !good) return good;
    for (const synth::Event& event : mixer->events) {
      const bool described = event.type == synth::EventType::gain || event.type == synth::EventType::pan;
      const bool taken = described ? mixer->rack.mixer().push(synth::Producer::control, event)
                                   : mixer->rack.push(synth::Producer::control, event);
      if (taken) continue;
      ++mixer->dropped;
      return fail(ErrorKind::refused, "dropped, because " + std::to_string(synth::kQueueCapacity) +
                                          " events are waiting already; send fewer between two blocks");
    }
    return {};
  });
}

ringdown_result refuse(const char* what, ringdown_error* error) {
  return guarded(error, [&] { return missing(what); });
}

Pose pose_of(const double* position_m, const double* wxyz) {
  return {vector(position_m), {wxyz[0], wxyz[1], wxyz[2], wxyz[3]}};
}

ringdown_contact default_contact() {
  const synth::Texture texture;
  ringdown_contact contact{};
  contact.size = sizeof contact;
  contact.roughness_m = texture.roughness_m;
  contact.correlation_m = texture.correlation_m;
  contact.spectral_slope = texture.spectral_slope;
  return contact;
}

}  // namespace

ringdown_result ringdown_strike(ringdown_mixer* mixer, int64_t frame, uint32_t object, const double point_m[3],
                                const double impulse_ns[3], double contact_time_s, ringdown_error* error) {
  if (!point_m || !impulse_ns) return refuse("point_m or impulse_ns", error);
  return play(mixer, frame, protocol::Strike{numbered(object), vector(point_m), vector(impulse_ns), contact_time_s},
              error);
}

ringdown_result ringdown_strike_at(ringdown_mixer* mixer, int64_t frame, uint32_t object, uint32_t point,
                                   const double impulse_ns[3], double contact_time_s, ringdown_error* error) {
  if (!impulse_ns) return refuse("impulse_ns", error);
  return play(mixer, frame, protocol::StrikeVertex{numbered(object), point, vector(impulse_ns), contact_time_s}, error);
}

ringdown_result ringdown_click(ringdown_mixer* mixer, int64_t frame, uint32_t object, const double impulse_ns[3],
                               double contact_time_s, ringdown_error* error) {
  if (!impulse_ns) return refuse("impulse_ns", error);
  return play(mixer, frame, protocol::Click{numbered(object), vector(impulse_ns), contact_time_s}, error);
}

void ringdown_contact_init(ringdown_contact* contact, size_t size) {
  if (!contact || size < sizeof contact->size) return;
  std::memset(contact, 0, size);
  const ringdown_contact ours = default_contact();
  std::memcpy(contact, &ours, std::min(size, sizeof ours));
  contact->size = size;
}

ringdown_result ringdown_touch(ringdown_mixer* mixer, int64_t frame, uint32_t object, const ringdown_contact* contact,
                               ringdown_error* error) {
  if (!contact) return refuse("contact", error);
  const auto given = library::taken(contact, contact->size, default_contact());
  if (!given) return library::tell(library::code_of(given.error().kind), given.error().message, error);
  protocol::SetContact request{numbered(object), vector(given->point_m), {}};
  request.contact = {.number = given->number,
                     .force_n = vector(given->force_n),
                     .slip_m_s = given->slip_m_s,
                     .roll_m_s = given->roll_m_s,
                     .texture = {given->roughness_m, given->correlation_m, given->spectral_slope}};
  return play(mixer, frame, request, error);
}

ringdown_result ringdown_ring(ringdown_mixer* mixer, int64_t frame, uint32_t object, uint32_t first, uint32_t count,
                              double amplitude, ringdown_error* error) {
  return play(mixer, frame, protocol::RingModes{numbered(object), first, count, amplitude}, error);
}

ringdown_result ringdown_gain(ringdown_mixer* mixer, int64_t frame, uint32_t object, double gain, double ramp_s,
                              ringdown_error* error) {
  return play(mixer, frame, protocol::SetGain{numbered(object), gain, ramp_s}, error);
}

ringdown_result ringdown_pan(ringdown_mixer* mixer, int64_t frame, uint32_t object, double pan, ringdown_error* error) {
  return play(mixer, frame, protocol::SetPan{numbered(object), pan}, error);
}

ringdown_result ringdown_clear(ringdown_mixer* mixer, int64_t frame, uint32_t object, double ramp_s,
                               ringdown_error* error) {
  return play(mixer, frame, protocol::ClearObject{numbered(object), ramp_s}, error);
}

ringdown_result ringdown_pose(ringdown_mixer* mixer, int64_t frame, uint32_t object, const double position_m[3],
                              const double rotation_wxyz[4], ringdown_error* error) {
  if (!position_m || !rotation_wxyz) return refuse("position_m or rotation_wxyz", error);
  return play(mixer, frame, protocol::SetPose{numbered(object), pose_of(position_m, rotation_wxyz)}, error);
}

ringdown_result ringdown_listener(ringdown_mixer* mixer, int64_t frame, const double position_m[3],
                                  const double rotation_wxyz[4], ringdown_error* error) {
  if (!position_m || !rotation_wxyz) return refuse("position_m or rotation_wxyz", error);
  return play(mixer, frame, protocol::SetListener{pose_of(position_m, rotation_wxyz)}, error);
}

ringdown_result ringdown_listener_off(ringdown_mixer* mixer, int64_t frame, ringdown_error* error) {
  return play(mixer, frame, protocol::ListenerOff{}, error);
}

ringdown_result ringdown_listener_air(ringdown_mixer* mixer, int64_t frame, double temperature_c,
                                      double humidity_percent, ringdown_error* error) {
  return play(mixer, frame, protocol::SetListenerAir{temperature_c, humidity_percent}, error);
}
