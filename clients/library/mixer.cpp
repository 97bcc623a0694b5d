#include "clients/library/handles.h"

#include "protocol/names.h"
#include "protocol/schema.h"
#include "server/session/head.h"

#include <cmath>
#include <memory>
#include <utility>

using namespace ringdown;
using library::check_index, library::check_within, library::first_null, library::guarded, library::missing,
    library::numbered;

static_assert(static_cast<int>(RINGDOWN_MAX_OBJECTS) == static_cast<int>(synth::kMaxObjects));
static_assert(static_cast<int>(RINGDOWN_MAX_INPUTS) == static_cast<int>(synth::kMaxInputs));
static_assert(static_cast<int>(RINGDOWN_MAX_PICKUPS) == static_cast<int>(synth::kMaxPickups));
static_assert(static_cast<int>(RINGDOWN_MAX_DAMPERS) == static_cast<int>(modal::kFirstSceneDamper));

namespace {

constexpr double kNoLimiter_db = 1;

ringdown_settings defaults() {
  const synth::MixerSettings mixer;
  return {.size = sizeof(ringdown_settings),
          .sample_rate_hz = 48000,
          .full_scale_pa = mixer.full_scale_pa,
          .limiter_db = -1,
          .floor_db = mixer.floor_db,
          .exact_contacts = mixer.exact_contacts,
          .ambisonic_order = 0,
          .threads = static_cast<int>(mixer.threads),
          .head = nullptr,
          .travel_time = mixer.travel_time};
}

Result<void> check_sample_rate(double sample_rate_hz) {
  return check_within("sample_rate_hz", sample_rate_hz, 8000, 384000);
}

Result<synth::MixerSettings> settings_of(const ringdown_settings& given) {
  if (auto good = check_sample_rate(given.sample_rate_hz); !good) return fail(good);
  if (auto good = check_within("full_scale_pa", given.full_scale_pa, 1e-6, 1e6); !good) return fail(good);
  if (auto good = check_within("floor_db", given.floor_db, 20, 300); !good) return fail(good);
  if (auto good = check_within("ambisonic_order", given.ambisonic_order, 0, 3); !good) return fail(good);
  if (auto good = check_within("threads", given.threads, 1, 64); !good) return fail(good);
  synth::MixerSettings settings;
  settings.full_scale_pa = given.full_scale_pa;
  settings.floor_db = given.floor_db;
  settings.exact_contacts = given.exact_contacts != 0;
  settings.threads = static_cast<std::size_t>(given.threads);
  settings.travel_time = given.travel_time != 0;
  if (given.ambisonic_order > 0) settings.ambisonic_order = static_cast<std::size_t>(given.ambisonic_order);
  if (given.limiter_db != kNoLimiter_db) {
    if (auto good = check_within("limiter_db", given.limiter_db, -60, 0, ", or 1 for no limiter"); !good)
      return fail(good);
    settings.limiter_db = given.limiter_db;
  }
  if (given.head) {
    auto head = session::read_head(given.head);
    if (!head) return fail(head);
    settings.head = *std::move(head);
  }
  return settings;
}

// Carries out a worker's request on an object, after its numbers were checked.
template <class Request, class Work>
ringdown_result change(ringdown_mixer* mixer, Request& request, ringdown_error* error, Work work) {
  return guarded(error, [&]() -> Result<void> {
    if (!mixer) return missing("mixer");
    if (auto good = library::check(request); !good) return good;
    return work(mixer->rack);
  });
}

// object0, object1, ...
std::string unused_name(const session::Rack& rack) {
  for (std::size_t n = 0;; ++n) {
    std::string name = formatted("object{}", n);
    if (!rack.find({.name = name, .number = {}})) return name;
  }
}

}  // namespace

void ringdown_settings_init(ringdown_settings* settings, size_t size) {
  if (!settings || size < sizeof settings->size) return;
  std::memset(settings, 0, size);
  const ringdown_settings ours = defaults();
  std::memcpy(settings, &ours, std::min(size, sizeof ours));
  settings->size = size;
}

ringdown_result ringdown_mixer_create(const ringdown_settings* settings, ringdown_mixer** mixer,
                                      ringdown_error* error) {
  return guarded(error, [&]() -> Result<void> {
    if (!mixer) return missing("mixer");
    const Result<ringdown_settings> given =
        settings ? library::taken(settings, settings->size, defaults()) : defaults();
    if (!given) return fail(given);
    const auto wanted = settings_of(*given);
    if (!wanted) return fail(wanted);
    static_cast<void>(protocol::addresses());  // makes the table of ranges now, not in the first event
    auto made = std::make_unique<ringdown_mixer>(given->sample_rate_hz);
    made->rack.mixer().configure(*wanted);
    *mixer = made.release();
    return {};
  });
}

void ringdown_mixer_destroy(ringdown_mixer* mixer) { delete mixer; }

ringdown_result ringdown_set_sample_rate(ringdown_mixer* mixer, double sample_rate_hz, ringdown_error* error) {
  return guarded(error, [&]() -> Result<void> {
    if (!mixer) return missing("mixer");
    if (auto good = check_sample_rate(sample_rate_hz); !good) return good;
    mixer->rack.change_sample_rate(sample_rate_hz);
    return {};
  });
}

ringdown_result ringdown_add(ringdown_mixer* mixer, const char* name, const ringdown_bank* bank, uint32_t* object,
                             ringdown_error* error) {
  return guarded(error, [&]() -> Result<void> {
    if (!mixer) return missing("mixer");
    if (!bank) return missing("bank");
    if (!object) return missing("object");
    if (name && !is_object_name(name)) {
      return fail(ErrorKind::bad_input,
                  "name is " + protocol::quote(name) + "; it must be 1 to 64 of A-Z a-z 0-9 _ . - and not all digits");
    }
    const std::string called = name ? name : unused_name(mixer->rack);
    const auto number = mixer->rack.add(called, bank->path, bank->file);
    if (!number) return fail(number);
    *object = *number;
    return {};
  });
}

ringdown_result ringdown_remove(ringdown_mixer* mixer, uint32_t object, ringdown_error* error) {
  protocol::FreeObject request{numbered(object)};
  return change(mixer, request, error, [&](session::Rack& rack) { return rack.free(request.object); });
}

void ringdown_material_init(ringdown_material* material, size_t size_of_struct) {
  if (!material || size_of_struct < sizeof material->size_of_struct) return;
  std::memset(material, 0, size_of_struct);
  const ringdown_material ours{sizeof(ringdown_material), 1, 1, 1, 1, 1, 1, 1};
  std::memcpy(material, &ours, std::min(size_of_struct, sizeof ours));
  material->size_of_struct = size_of_struct;
}

ringdown_result ringdown_set_material(ringdown_mixer* mixer, uint32_t object, const ringdown_material* material,
                                      ringdown_error* error) {
  return guarded(error, [&]() -> Result<void> {
    if (!mixer) return missing("mixer");
    if (!material) return missing("material");
    const auto given = library::taken(material, material->size_of_struct,
                                      ringdown_material{sizeof(ringdown_material), 1, 1, 1, 1, 1, 1, 1});
    if (!given) return fail(given);
    protocol::SetMaterial request{numbered(object),
                                  {.alpha = given->alpha,
                                   .beta = given->beta,
                                   .density = given->density,
                                   .stiffness = given->stiffness,
                                   .size = given->size,
                                   .heat = given->heat,
                                   .air = given->air}};
    if (auto good = library::check(request); !good) return good;
    return mixer->rack.set_material(request.object, request.scale);
  });
}

ringdown_result ringdown_fill(ringdown_mixer* mixer, int64_t frame, uint32_t object, double level_m,
                              ringdown_error* error) {
  protocol::SetFill request{numbered(object), level_m};
  return change(mixer, request, error,
                [&](session::Rack& rack) { return rack.set_level(request.object, request.level_m, frame); });
}

ringdown_result ringdown_resonator(ringdown_mixer* mixer, int64_t frame, uint32_t object, double detune_cents,
                                   double opening, ringdown_error* error) {
  protocol::SetResonator request{numbered(object), {detune_cents, opening}};
  return change(mixer, request, error,
                [&](session::Rack& rack) { return rack.set_tubes(request.object, request.tuning, frame); });
}

ringdown_result ringdown_hold(ringdown_mixer* mixer, int64_t frame, uint32_t object, uint32_t number,
                              const double point_m[3], const double direction[3], double damping_ns_m,
                              ringdown_error* error) {
  if (const char* name = first_null({{"point_m", point_m}, {"direction", direction}}))
    return guarded(error, [&] { return missing(name); });
  if (auto good = check_index("number", number, RINGDOWN_MAX_DAMPERS); !good)
    return guarded(error, [&] { return good; });
  protocol::Hold request{
      numbered(object), {library::vector(point_m), library::vector(direction), damping_ns_m}, number};
  return change(mixer, request, error, [&](session::Rack& rack) -> Result<void> {
    const auto held = rack.find(request.object);
    if (!held) return fail(held);
    if (damping_ns_m > 0) {
      if (auto good = session::check_point(request.damper.point_m, **held); !good) return good;
    }
    return rack.set_dampers(request.object, {{request.number, request.damper}}, frame);
  });
}

ringdown_result ringdown_mute(ringdown_mixer* mixer, uint32_t object, int on, ringdown_error* error) {
  protocol::SetMute request{numbered(object), on != 0};
  return change(mixer, request, error, [&](session::Rack& rack) {
    return rack.set_heard(request.object, &session::ObjectState::mute, request.on);
  });
}

ringdown_result ringdown_solo(ringdown_mixer* mixer, uint32_t object, int on, ringdown_error* error) {
  protocol::SetSolo request{numbered(object), on != 0};
  return change(mixer, request, error, [&](session::Rack& rack) {
    return rack.set_heard(request.object, &session::ObjectState::solo, request.on);
  });
}

ringdown_result ringdown_excite(ringdown_mixer* mixer, uint32_t input, uint32_t object, const double point_m[3],
                                const double force_n[3], ringdown_error* error) {
  if (const char* name = first_null({{"point_m", point_m}, {"force_n", force_n}}))
    return guarded(error, [&] { return missing(name); });
  if (auto good = check_index("input", input, RINGDOWN_MAX_INPUTS); !good) return guarded(error, [&] { return good; });
  protocol::Excite request{numbered(object), input + 1, library::vector(point_m), library::vector(force_n)};
  return change(mixer, request, error, [&](session::Rack& rack) {
    return rack.excite(input, request.object, request.point_m, request.force_n);
  });
}

void ringdown_collect(ringdown_mixer* mixer) {
  static_cast<void>(guarded(nullptr, [&]() -> Result<void> {
    if (!mixer) return missing("mixer");
    mixer->rack.collect();
    return {};
  }));
}

void ringdown_render(ringdown_mixer* mixer, float* left, float* right, size_t frames) {
  if (!mixer) return;
  synth::Outputs outputs;
  if (left) outputs.listen_to_mix(0, left);
  if (right) outputs.listen_to_mix(1, right);
  mixer->rack.mixer().render(outputs, frames);
}

void ringdown_render_all(ringdown_mixer* mixer, const ringdown_block* block) {
  if (!mixer || !block || block->size < offsetof(ringdown_block, inputs) + sizeof block->inputs) return;
  synth::Outputs outputs;
  for (std::size_t side = 0; side < 2; ++side) {
    if (block->mix[side]) outputs.listen_to_mix(side, block->mix[side]);
  }
  const auto order = mixer->rack.mixer().settings().ambisonic_order;
  const std::size_t channels = order ? synth::ambisonic_channels(*order) : 0;
  for (std::size_t acn = 0; acn < channels; ++acn) {
    if (block->ambisonics[acn]) outputs.listen_to_ambisonics(acn, block->ambisonics[acn]);
  }
  if (block->size >= offsetof(ringdown_block, pickups) + sizeof block->pickups) {
    for (std::size_t pickup = 0; pickup < synth::kMaxPickups; ++pickup) {
      if (block->pickups[pickup]) outputs.listen_to_pickup(pickup, block->pickups[pickup]);
    }
  }
  synth::Inputs inputs;
  std::copy_n(block->inputs, inputs.size(), inputs.begin());
  mixer->rack.mixer().render(outputs, inputs, block->frames);
}

int64_t ringdown_now(const ringdown_mixer* mixer) {
  return mixer ? mixer->rack.mixer().counters().frames.load(std::memory_order_acquire) : 0;
}

size_t ringdown_latency(const ringdown_mixer* mixer) { return mixer ? mixer->rack.mixer().latency_frames() : 0; }

ringdown_result ringdown_get_status(const ringdown_mixer* mixer, ringdown_status* status) {
  return guarded(nullptr, [&]() -> Result<void> {
    if (!mixer) return missing("mixer");
    const synth::MixerCounters& counters = mixer->rack.mixer().counters();
    ringdown_status ours{};
    ours.strikes = counters.strikes;
    ours.late = counters.late;
    ours.dropped = mixer->dropped;
    ours.refused = counters.refused;
    ours.not_finite = counters.not_finite;
    ours.objects = static_cast<std::uint32_t>(mixer->rack.names()->size());
    ours.sounding = counters.ringing_voices;
    ours.ringing_modes = counters.ringing_modes;
    ours.peak = counters.peak;
    return library::give(status, ours);
  });
}
