// Events: each becomes the request that a message to the daemon would be, is checked as such a message is, and is
// pushed as the mixer's event.
#include "clients/library/handles.h"

#include "server/session/request_events.h"

using namespace ringdown;
using library::first_null, library::guarded, library::missing, library::numbered, library::vector;

namespace {

constexpr double kMaxAhead_s = 3600;

Result<void> check_frame(const synth::Mixer& mixer, std::int64_t frame) {
  const double ahead_s =
      static_cast<double>(frame - mixer.counters().frames.load(std::memory_order_relaxed)) / mixer.sample_rate_hz();
  if (ahead_s <= kMaxAhead_s) return {};
  return fail(ErrorKind::bad_input, "frame lies more than an hour ahead");
}

// Plays a request, or says why there is none. Neither allocates nor locks, unless it fails. A gain or pan goes to the
// mixer alone: Rack::push would lock to write it into the object's description.
template <class Request>
ringdown_result play(ringdown_mixer* mixer, std::int64_t frame, const Result<Request>& made, ringdown_error* error) {
  return guarded(error, [&]() -> Result<void> {
    if (!mixer) return missing("mixer");
    if (!made) return fail(made.error());
    Request request = *made;
    if (auto good = library::check(request); !good) return good;
    if (auto good = check_frame(mixer->rack.mixer(), frame); !good) return good;
    mixer->events.clear();
    if (auto good = session::append_events(request, mixer->rack, frame, mixer->events); !good) return good;
    for (const synth::Event& event : mixer->events) {
      const bool described = synth::effect_of(event) == synth::Effect::sets;
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

Pose pose_of(const double* position_m, const double* rotation_wxyz) {
  return {vector(position_m), library::rotation(rotation_wxyz)};
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

ringdown_bow default_bow() {
  ringdown_bow bow{};
  bow.size = sizeof bow;
  bow.rosin = protocol::SetBow{}.verb.rosin;
  return bow;
}

ringdown_mallet default_mallet() {
  const protocol::HitMallet hit;
  ringdown_mallet mallet{};
  mallet.size = sizeof mallet;
  mallet.mass_kg = 0.02;
  mallet.head = hit.verb.head;
  mallet.bounce = hit.verb.bounce;
  return mallet;
}

ringdown_coupling default_coupling() {
  const protocol::SetCoupling set;
  ringdown_coupling coupling{};
  coupling.size = sizeof coupling;
  coupling.stiffness = set.verb.stiffness;
  coupling.friction = set.verb.friction;
  coupling.bounce = set.verb.bounce;
  return coupling;
}

// Fills `size` bytes of a caller's struct, which may be older or newer than ours, with defaults.
template <class Struct>
void fill_in(Struct* given, std::size_t size, const Struct& ours) {
  if (!given || size < sizeof given->size) return;
  std::memset(given, 0, size);
  std::memcpy(given, &ours, std::min(size, sizeof ours));
  given->size = size;
}

}  // namespace

ringdown_result ringdown_strike(ringdown_mixer* mixer, int64_t frame, uint32_t object, const double point_m[3],
                                const double impulse_ns[3], double contact_time_s, ringdown_error* error) {
  if (const char* name = first_null({{"point_m", point_m}, {"impulse_ns", impulse_ns}}))
    return play<protocol::Strike>(mixer, frame, missing(name), error);
  return play<protocol::Strike>(
      mixer, frame, protocol::Strike{numbered(object), {vector(point_m), vector(impulse_ns), contact_time_s}}, error);
}

ringdown_result ringdown_strike_at(ringdown_mixer* mixer, int64_t frame, uint32_t object, uint32_t point,
                                   const double impulse_ns[3], double contact_time_s, ringdown_error* error) {
  if (!impulse_ns) return play<protocol::StrikeVertex>(mixer, frame, missing("impulse_ns"), error);
  return play<protocol::StrikeVertex>(
      mixer, frame, protocol::StrikeVertex{numbered(object), {point, vector(impulse_ns), contact_time_s}}, error);
}

ringdown_result ringdown_click(ringdown_mixer* mixer, int64_t frame, uint32_t object, const double impulse_ns[3],
                               double contact_time_s, ringdown_error* error) {
  if (!impulse_ns) return play<protocol::Click>(mixer, frame, missing("impulse_ns"), error);
  return play<protocol::Click>(mixer, frame, protocol::Click{numbered(object), {vector(impulse_ns), contact_time_s}},
                               error);
}

void ringdown_contact_init(ringdown_contact* contact, size_t size) { fill_in(contact, size, default_contact()); }

ringdown_result ringdown_touch(ringdown_mixer* mixer, int64_t frame, uint32_t object, const ringdown_contact* contact,
                               ringdown_error* error) {
  if (!contact) return play<protocol::SetContact>(mixer, frame, missing("contact"), error);
  const auto given = library::taken(contact, contact->size, default_contact());
  if (!given) return play<protocol::SetContact>(mixer, frame, fail(given.error()), error);
  protocol::SetContact request{numbered(object), {vector(given->point_m), {}}};
  request.verb.contact = {.number = given->number,
                          .force_n = vector(given->force_n),
                          .slip_m_s = given->slip_m_s,
                          .roll_m_s = given->roll_m_s,
                          .texture = {given->roughness_m, given->correlation_m, given->spectral_slope}};
  return play<protocol::SetContact>(mixer, frame, request, error);
}

void ringdown_bow_init(ringdown_bow* bow, size_t size) { fill_in(bow, size, default_bow()); }

ringdown_result ringdown_draw_bow(ringdown_mixer* mixer, int64_t frame, uint32_t object, const ringdown_bow* bow,
                                  ringdown_error* error) {
  if (!bow) return play<protocol::SetBow>(mixer, frame, missing("bow"), error);
  const auto given = library::taken(bow, bow->size, default_bow());
  if (!given) return play<protocol::SetBow>(mixer, frame, fail(given.error()), error);
  protocol::SetBow request{numbered(object), {vector(given->point_m)}};
  request.verb.number = given->number;
  request.verb.direction = vector(given->direction);
  request.verb.speed_m_s = given->speed_m_s;
  request.verb.force_n = given->force_n;
  request.verb.width_m = given->width_m;
  request.verb.rosin = given->rosin;
  return play<protocol::SetBow>(mixer, frame, request, error);
}

void ringdown_mallet_init(ringdown_mallet* mallet, size_t size) { fill_in(mallet, size, default_mallet()); }

ringdown_result ringdown_hit(ringdown_mixer* mixer, int64_t frame, uint32_t object, const ringdown_mallet* mallet,
                             ringdown_error* error) {
  if (!mallet) return play<protocol::HitMallet>(mixer, frame, missing("mallet"), error);
  const auto given = library::taken(mallet, mallet->size, default_mallet());
  if (!given) return play<protocol::HitMallet>(mixer, frame, fail(given.error()), error);
  protocol::HitMallet request{numbered(object), {vector(given->point_m), vector(given->velocity_m_s)}};
  request.verb.mass_kg = given->mass_kg;
  request.verb.head = given->head;
  request.verb.bounce = given->bounce;
  return play<protocol::HitMallet>(mixer, frame, request, error);
}

void ringdown_coupling_init(ringdown_coupling* coupling, size_t size) { fill_in(coupling, size, default_coupling()); }

ringdown_result ringdown_couple(ringdown_mixer* mixer, int64_t frame, uint32_t object,
                                const ringdown_coupling* coupling, ringdown_error* error) {
  if (!coupling) return play<protocol::SetCoupling>(mixer, frame, missing("coupling"), error);
  const auto given = library::taken(coupling, coupling->size, default_coupling());
  if (!given) return play<protocol::SetCoupling>(mixer, frame, fail(given.error()), error);
  protocol::SetCoupling request{numbered(object), {vector(given->point_m)}, numbered(given->other)};
  request.verb.number = given->number;
  request.verb.other_point_m = vector(given->other_point_m);
  request.verb.direction = vector(given->direction);
  request.verb.weight_n = given->weight_n;
  request.verb.gap_m = given->gap_m;
  request.verb.stiffness = given->stiffness;
  request.verb.friction = given->friction;
  request.verb.bounce = given->bounce;
  request.verb.mass_kg = given->mass_kg;
  return play<protocol::SetCoupling>(mixer, frame, request, error);
}

ringdown_result ringdown_ring(ringdown_mixer* mixer, int64_t frame, uint32_t object, uint32_t first, uint32_t count,
                              double amplitude, ringdown_error* error) {
  return play<protocol::RingModes>(mixer, frame, protocol::RingModes{numbered(object), {first, count, amplitude}},
                                   error);
}

ringdown_result ringdown_gain(ringdown_mixer* mixer, int64_t frame, uint32_t object, double gain, double ramp_s,
                              ringdown_error* error) {
  return play<protocol::SetGain>(mixer, frame, protocol::SetGain{numbered(object), {gain, ramp_s}}, error);
}

ringdown_result ringdown_pan(ringdown_mixer* mixer, int64_t frame, uint32_t object, double pan, ringdown_error* error) {
  return play<protocol::SetPan>(mixer, frame, protocol::SetPan{numbered(object), {pan}}, error);
}

ringdown_result ringdown_clear(ringdown_mixer* mixer, int64_t frame, uint32_t object, double ramp_s,
                               ringdown_error* error) {
  return play<protocol::ClearObject>(mixer, frame, protocol::ClearObject{numbered(object), {ramp_s}}, error);
}

ringdown_result ringdown_pose(ringdown_mixer* mixer, int64_t frame, uint32_t object, const double position_m[3],
                              const double rotation_wxyz[4], ringdown_error* error) {
  if (const char* name = first_null({{"position_m", position_m}, {"rotation_wxyz", rotation_wxyz}}))
    return play<protocol::SetPose>(mixer, frame, missing(name), error);
  return play<protocol::SetPose>(mixer, frame,
                                 protocol::SetPose{numbered(object), {pose_of(position_m, rotation_wxyz)}}, error);
}

ringdown_result ringdown_listener(ringdown_mixer* mixer, int64_t frame, const double position_m[3],
                                  const double rotation_wxyz[4], ringdown_error* error) {
  if (const char* name = first_null({{"position_m", position_m}, {"rotation_wxyz", rotation_wxyz}}))
    return play<protocol::SetListener>(mixer, frame, missing(name), error);
  return play<protocol::SetListener>(mixer, frame, protocol::SetListener{{pose_of(position_m, rotation_wxyz)}}, error);
}

ringdown_result ringdown_listener_off(ringdown_mixer* mixer, int64_t frame, ringdown_error* error) {
  return play<protocol::ListenerOff>(mixer, frame, protocol::ListenerOff{}, error);
}

ringdown_result ringdown_listener_air(ringdown_mixer* mixer, int64_t frame, double temperature_c,
                                      double humidity_percent, ringdown_error* error) {
  return play<protocol::SetListenerAir>(mixer, frame, protocol::SetListenerAir{{temperature_c, humidity_percent}},
                                        error);
}
