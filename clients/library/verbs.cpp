// The verbs as C functions. Written by ringdown_write_verbs (clients/verbs) from the rows of protocol/table.cpp.
// clang-format off
#include "clients/library/play.h"

using namespace ringdown;
using namespace ringdown::library;

ringdown_result ringdown_strike(ringdown_mixer* mixer, int64_t frame, uint32_t object, const double point_m[3],
                                const double impulse_ns[3], double contact_time_s, ringdown_error* error) {
  if (const char* name = first_null({{"point_m", point_m}, {"impulse_ns", impulse_ns}})) {
    return refuse(missing(name).value(), error);
  }
  const double numbers[] = {static_cast<double>(object), point_m[0], point_m[1], point_m[2], impulse_ns[0],
                            impulse_ns[1], impulse_ns[2], contact_time_s};
  return play<synth::verb::Strike>(mixer, frame, numbers, error);
}

ringdown_result ringdown_strike_vertex(ringdown_mixer* mixer, int64_t frame, uint32_t object, uint32_t vertex,
                                       const double impulse_ns[3], double contact_time_s, ringdown_error* error) {
  if (const char* name = first_null({{"impulse_ns", impulse_ns}})) {
    return refuse(missing(name).value(), error);
  }
  const double numbers[] = {static_cast<double>(object), static_cast<double>(vertex), impulse_ns[0], impulse_ns[1],
                            impulse_ns[2], contact_time_s};
  return play<synth::verb::StrikeVertex>(mixer, frame, numbers, error);
}

ringdown_result ringdown_gain(ringdown_mixer* mixer, int64_t frame, uint32_t object, double gain, double ramp_s,
                              ringdown_error* error) {
  const double numbers[] = {static_cast<double>(object), gain, ramp_s};
  return play<synth::verb::Gain>(mixer, frame, numbers, error);
}

ringdown_result ringdown_pan(ringdown_mixer* mixer, int64_t frame, uint32_t object, double pan,
                             ringdown_error* error) {
  const double numbers[] = {static_cast<double>(object), pan};
  return play<synth::verb::Pan>(mixer, frame, numbers, error);
}

ringdown_result ringdown_fan(ringdown_mixer* mixer, int64_t frame, uint32_t object, double rate_hz, double depth,
                             ringdown_error* error) {
  const double numbers[] = {static_cast<double>(object), rate_hz, depth};
  return play<synth::verb::Fan>(mixer, frame, numbers, error);
}

void ringdown_pickup_args_init(ringdown_pickup_args* args, size_t size) {
  ringdown_pickup_args ours{};
  ours.bus = 1;
  ours.motion = 1;
  ours.gain = 1;
  fill_in(args, size, ours);
}

ringdown_result ringdown_pickup(ringdown_mixer* mixer, int64_t frame, uint32_t object,
                                const ringdown_pickup_args* args, ringdown_error* error) {
  ringdown_pickup_args defaults{};
  ringdown_pickup_args_init(&defaults, sizeof defaults);
  const auto given = taken(args, defaults);
  if (!given) return refuse(given.error(), error);
  const double numbers[] = {static_cast<double>(object), given->point_m[0], given->point_m[1], given->point_m[2],
                            given->direction[0], given->direction[1], given->direction[2],
                            static_cast<double>(given->bus), static_cast<double>(given->motion), given->gain};
  return play<synth::verb::Pickup>(mixer, frame, numbers, error);
}

ringdown_result ringdown_ring(ringdown_mixer* mixer, int64_t frame, uint32_t object, uint32_t first,
                              uint32_t count, double amplitude, ringdown_error* error) {
  const double numbers[] = {static_cast<double>(object), static_cast<double>(first), static_cast<double>(count),
                            amplitude};
  return play<synth::verb::Ring>(mixer, frame, numbers, error);
}

ringdown_result ringdown_impart(ringdown_mixer* mixer, int64_t frame, uint32_t object, uint32_t mode,
                                double velocity, double phase_rad, ringdown_error* error) {
  const double numbers[] = {static_cast<double>(object), static_cast<double>(mode), velocity, phase_rad};
  return play<synth::verb::Impart>(mixer, frame, numbers, error);
}

ringdown_result ringdown_clear(ringdown_mixer* mixer, int64_t frame, uint32_t object, double ramp_s,
                               ringdown_error* error) {
  const double numbers[] = {static_cast<double>(object), ramp_s};
  return play<synth::verb::Clear>(mixer, frame, numbers, error);
}

ringdown_result ringdown_choke(ringdown_mixer* mixer, int64_t frame, uint32_t object, double within_s,
                               ringdown_error* error) {
  const double numbers[] = {static_cast<double>(object), within_s};
  return play<synth::verb::Choke>(mixer, frame, numbers, error);
}

ringdown_result ringdown_slap(ringdown_mixer* mixer, int64_t frame, uint32_t object, double impulse_ns,
                              double contact_time_s, ringdown_error* error) {
  const double numbers[] = {static_cast<double>(object), impulse_ns, contact_time_s};
  return play<synth::verb::Slap>(mixer, frame, numbers, error);
}

ringdown_result ringdown_blow(ringdown_mixer* mixer, int64_t frame, uint32_t object, double pressure_pa,
                              ringdown_error* error) {
  const double numbers[] = {static_cast<double>(object), pressure_pa};
  return play<synth::verb::Blow>(mixer, frame, numbers, error);
}

void ringdown_contact_args_init(ringdown_contact_args* args, size_t size) {
  ringdown_contact_args ours{};
  ours.roll_m_s = 0;
  ours.number = 0;
  ours.roughness_m = 2e-6;
  ours.correlation_m = 5e-5;
  ours.slope = -2.4;
  fill_in(args, size, ours);
}

ringdown_result ringdown_contact(ringdown_mixer* mixer, int64_t frame, uint32_t object,
                                 const ringdown_contact_args* args, ringdown_error* error) {
  ringdown_contact_args defaults{};
  ringdown_contact_args_init(&defaults, sizeof defaults);
  const auto given = taken(args, defaults);
  if (!given) return refuse(given.error(), error);
  const double numbers[] = {static_cast<double>(object), given->point_m[0], given->point_m[1], given->point_m[2],
                            given->force_n[0], given->force_n[1], given->force_n[2], given->slip_m_s,
                            given->roll_m_s, static_cast<double>(given->number), given->roughness_m,
                            given->correlation_m, given->slope};
  return play<synth::verb::Contact>(mixer, frame, numbers, error);
}

void ringdown_bow_args_init(ringdown_bow_args* args, size_t size) {
  ringdown_bow_args ours{};
  ours.width_m = 0;
  ours.rosin = 0.8;
  ours.number = 0;
  fill_in(args, size, ours);
}

ringdown_result ringdown_bow(ringdown_mixer* mixer, int64_t frame, uint32_t object, const ringdown_bow_args* args,
                             ringdown_error* error) {
  ringdown_bow_args defaults{};
  ringdown_bow_args_init(&defaults, sizeof defaults);
  const auto given = taken(args, defaults);
  if (!given) return refuse(given.error(), error);
  const double numbers[] = {static_cast<double>(object), given->point_m[0], given->point_m[1], given->point_m[2],
                            given->direction[0], given->direction[1], given->direction[2], given->speed_m_s,
                            given->force_n, given->width_m, given->rosin, static_cast<double>(given->number)};
  return play<synth::verb::Bow>(mixer, frame, numbers, error);
}

void ringdown_mallet_args_init(ringdown_mallet_args* args, size_t size) {
  ringdown_mallet_args ours{};
  ours.mass_kg = 0.02;
  ours.head = 10000000;
  ours.bounce = 0.9;
  fill_in(args, size, ours);
}

ringdown_result ringdown_mallet(ringdown_mixer* mixer, int64_t frame, uint32_t object,
                                const ringdown_mallet_args* args, ringdown_error* error) {
  ringdown_mallet_args defaults{};
  ringdown_mallet_args_init(&defaults, sizeof defaults);
  const auto given = taken(args, defaults);
  if (!given) return refuse(given.error(), error);
  const double numbers[] = {static_cast<double>(object), given->point_m[0], given->point_m[1], given->point_m[2],
                            given->velocity_m_s[0], given->velocity_m_s[1], given->velocity_m_s[2], given->mass_kg,
                            given->head, given->bounce};
  return play<synth::verb::Mallet>(mixer, frame, numbers, error);
}

void ringdown_couple_args_init(ringdown_couple_args* args, size_t size) {
  ringdown_couple_args ours{};
  ours.weight_n = 0;
  ours.gap_m = 0;
  ours.stiffness = 100000000;
  ours.friction = 0.3;
  ours.bounce = 0.6;
  ours.mass_kg = 0;
  ours.number = 0;
  fill_in(args, size, ours);
}

ringdown_result ringdown_couple(ringdown_mixer* mixer, int64_t frame, uint32_t object,
                                const ringdown_couple_args* args, ringdown_error* error) {
  ringdown_couple_args defaults{};
  ringdown_couple_args_init(&defaults, sizeof defaults);
  const auto given = taken(args, defaults);
  if (!given) return refuse(given.error(), error);
  const double numbers[] = {static_cast<double>(object), given->point_m[0], given->point_m[1], given->point_m[2],
                            static_cast<double>(given->other), given->other_point_m[0], given->other_point_m[1],
                            given->other_point_m[2], given->direction[0], given->direction[1], given->direction[2],
                            given->weight_n, given->gap_m, given->stiffness, given->friction, given->bounce,
                            given->mass_kg, static_cast<double>(given->number)};
  return play<synth::verb::Couple>(mixer, frame, numbers, error);
}

ringdown_result ringdown_click(ringdown_mixer* mixer, int64_t frame, uint32_t object, const double impulse_ns[3],
                               double contact_time_s, ringdown_error* error) {
  if (const char* name = first_null({{"impulse_ns", impulse_ns}})) {
    return refuse(missing(name).value(), error);
  }
  const double numbers[] = {static_cast<double>(object), impulse_ns[0], impulse_ns[1], impulse_ns[2], contact_time_s};
  return play<synth::verb::Click>(mixer, frame, numbers, error);
}

ringdown_result ringdown_pose(ringdown_mixer* mixer, int64_t frame, uint32_t object, const double position_m[3],
                              const double rotation_wxyz[4], ringdown_error* error) {
  if (const char* name = first_null({{"position_m", position_m}, {"rotation_wxyz", rotation_wxyz}})) {
    return refuse(missing(name).value(), error);
  }
  const double numbers[] = {static_cast<double>(object), position_m[0], position_m[1], position_m[2],
                            rotation_wxyz[0], rotation_wxyz[1], rotation_wxyz[2], rotation_wxyz[3]};
  return play<synth::verb::Pose>(mixer, frame, numbers, error);
}

ringdown_result ringdown_listener(ringdown_mixer* mixer, int64_t frame, const double position_m[3],
                                  const double rotation_wxyz[4], ringdown_error* error) {
  if (const char* name = first_null({{"position_m", position_m}, {"rotation_wxyz", rotation_wxyz}})) {
    return refuse(missing(name).value(), error);
  }
  const double numbers[] = {position_m[0], position_m[1], position_m[2], rotation_wxyz[0], rotation_wxyz[1],
                            rotation_wxyz[2], rotation_wxyz[3]};
  return play<synth::verb::Listener>(mixer, frame, numbers, error);
}

ringdown_result ringdown_listener_off(ringdown_mixer* mixer, int64_t frame, ringdown_error* error) {
  const std::span<const double> numbers;
  return play<synth::verb::ListenerOff>(mixer, frame, numbers, error);
}

ringdown_result ringdown_listener_air(ringdown_mixer* mixer, int64_t frame, double temperature_c,
                                      double humidity_percent, ringdown_error* error) {
  const double numbers[] = {temperature_c, humidity_percent};
  return play<synth::verb::ListenerAir>(mixer, frame, numbers, error);
}
