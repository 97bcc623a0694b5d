// A block is rendered chunk by chunk:
//
//   commands that are due             -> Stage
//   how far until something happens   -> Timeline, and inputs
//   events of the chunk               -> the objects and groups they happen to
//   what is to be left out            -> Shedding
//   every source                      -> Renderer: sums of samples and moments
//   what has died away                -> Stage
//   sums                              -> MixOutput: the block's buffers
#include "engine/synth/mixer.h"

#include <cassert>
#include <cmath>
#include <limits>
#include <map>
#include <utility>

namespace ringdown::synth {
namespace {

Inputs from_frame(std::size_t frame, Inputs inputs) REALTIME {
  for (const float*& samples : inputs) {
    if (samples) samples += frame;
  }
  return inputs;
}

}  // namespace

Mixer::Mixer(double sample_rate_hz, const MixerSettings& settings) : sample_rate_hz_(sample_rate_hz) {
  configure(settings);
}

Mixer::~Mixer() {
  for (; const Command* command = timeline_.due_command(std::numeric_limits<Frame>::max()); timeline_.pop_command()) {
    delete command->voice;
  }
  voices_.collect();
}

void Mixer::configure(const MixerSettings& settings) {
  if (settings.threads != renderer_.threads()) renderer_.set_threads(settings.threads);
  if (settings.limiter_db != settings_.limiter_db) output_.limit(settings.limiter_db, sample_rate_hz());
  output_.wear(settings.head ? settings.head(sample_rate_hz()) : nullptr);
  const std::optional<std::size_t> order = settings.head ? kMaxAmbisonicOrder : settings.ambisonic_order;
  voices_.set_ambisonic_channels(order ? synth::ambisonic_channels(*order) : 0);
  renderer_.have_field(order.has_value());
  shedding_.configure(settings.budget, settings.clock, renderer_.threads());
  stage_.set_travel_time(settings.travel_time);
  floor_ = std::pow(10.0, -settings.floor_db / 20);
  settings_ = settings;
}

void Mixer::make_object(ObjectNumber object) {
  timeline_.events().make_room();
  renderer_.make_room();
  stage_.make_object(object);
}

bool Mixer::install(ObjectNumber object, std::unique_ptr<Voice> voice, Install how, Frame at) {
  assert(object < kMaxObjects && voice);
  if (!voices_.has_room()) return false;
  make_object(object);
  if (auto group = voices_.group_for(voice->shared_table())) {
    const Command found{.kind = Command::Kind::found_group, .group = group.get()};
    if (timeline_.push(found)) voices_.keep_group(voice->shared_table(), std::move(group));
  }
  const auto kind = how == Install::replace ? Command::Kind::replace : Command::Kind::retune;
  if (!timeline_.push(Command{.kind = kind, .object = object, .at = at, .voice = voice.get()})) return false;
  static_cast<void>(voice.release());
  voices_.count_installed(object);
  return true;
}

bool Mixer::remove(ObjectNumber object) {
  assert(object < kMaxObjects);
  make_object(object);
  return timeline_.push(Command{.kind = Command::Kind::remove, .object = object});
}

bool Mixer::assign(ObjectNumber object, std::optional<std::size_t> bus) {
  assert(object < kMaxObjects && (!bus || *bus < kMaxBuses));
  const std::size_t channel = bus ? kFirstBus + *bus : kNoBus;
  make_object(object);
  return timeline_.push(
      Command{.kind = Command::Kind::assign, .object = object, .channel = static_cast<std::uint32_t>(channel)});
}

bool Mixer::silence(ObjectNumber object, bool silent) {
  assert(object < kMaxObjects);
  const auto ramp = static_cast<Frame>(kSilenceRamp_s * sample_rate_hz());
  make_object(object);
  return timeline_.push(
      Command{.kind = silent ? Command::Kind::silence : Command::Kind::unsilence, .object = object, .ramp = ramp});
}

bool Mixer::connect_input(std::size_t input, ObjectNumber object, Vec3 point_m, Vec3 impulse_ns) {
  assert(input < kMaxInputs && object < kMaxObjects);
  make_object(object);
  return timeline_.connect(
      {.kind = Command::Kind::connect, .object = object, .input = static_cast<std::uint32_t>(input)},
      {.point_m = point_m, .impulse_ns = impulse_ns, .contact_time_s = 0});
}

bool Mixer::disconnect_input(std::size_t input) {
  assert(input < kMaxInputs);
  return timeline_.push(Command{.kind = Command::Kind::disconnect, .input = static_cast<std::uint32_t>(input)});
}

void Mixer::render(const Outputs& outputs, const Inputs& inputs, std::size_t frames) REALTIME {
  const DenormalGuard guard;
  MixerCounters& counters = meters_.counters;
  const double rate_hz = sample_rate_hz();
  shedding_.begin_block(frames, rate_hz, deadlines_);
  count(counters.late,
        timeline_.events().accept(now_, [&](const Event& placing) REALTIME { stage_.place(placing, now_, rate_hz); }));
  output_.begin_block(outputs, frames);
  renderer_.main().counts = {};
  for (std::size_t done = 0; done < frames;) {
    Chunk chunk{.begin = now_,
                .sample_rate_hz = rate_hz,
                .floor = floor_,
                .wanted = output_.to_render(),
                .inputs = from_frame(done, inputs),
                .shedding = &shedding_,
                .counters = &counters};
    execute_commands(now_);
    const std::size_t rest = stage_.listen_to_inputs(chunk, frames - done);
    chunk.frames = timeline_.chunk_frames(now_, rest, stage_.idle(), stage_.has_listened());
    render_chunk(chunk);
    output_.write(renderer_.main().sums, done, chunk.frames);
    done += chunk.frames;
    now_ = chunk.end();
    meters_.measure(stage_, now_, rate_hz);
  }
  const ChunkCounts& counts = renderer_.main().counts;  // of the last chunk in which anything sounded
  const float peak = output_.end_block(now_ - static_cast<Frame>(frames), frames, rate_hz);
  count(counters.not_finite, std::isinf(peak) ? 1 : 0);
  meters_.note_peak(std::isinf(peak) ? 0 : peak);
  counters.ringing_voices.store(counts.voices, std::memory_order_relaxed);
  counters.ringing_modes.store(counts.modes, std::memory_order_relaxed);
  counters.muted_modes.store(counts.muted_modes, std::memory_order_relaxed);
  counters.coupled_voices.store(counts.coupled_voices, std::memory_order_relaxed);
  counters.psi_over_truth.store(1 + counts.psi_error, std::memory_order_relaxed);
  counters.frames.store(now_, std::memory_order_release);
}

void Mixer::execute_commands(Frame until) REALTIME {
  for (; const Command* command = timeline_.due_command(until); timeline_.pop_command()) {
    const bool connects = command->kind == Command::Kind::connect;
    stage_.execute(*command, connects ? timeline_.take_impulse() : verb::Strike{}, now_);
  }
}

void Mixer::render_chunk(Chunk& chunk) REALTIME {
  shedding_.begin_chunk(chunk.frames);
  renderer_.open(chunk.frames);
  if (stage_.idle() && !timeline_.events().next_before(chunk.end())) return;
  Workspace& workspace = renderer_.main();
  workspace.counts = {};
  chunk.listening = stage_.begin_listening(chunk);
  chunk.look_pressure = look_pressure_.now();
  chunk.moments = renderer_.prefers_moments(chunk.frames);
  stage_.route_events(chunk, settings_.exact_contacts, shedding_, workspace);
  const std::span<Source* const> sources = stage_.sources();
  shedding_.plan(sources, chunk, renderer_.workspaces());
  renderer_.render(sources, chunk);
  if (chunk.listening) look_pressure_.update(workspace.counts.look_terms, workspace.counts.modes, chunk);
  stage_.finish_chunk(chunk, shedding_, workspace);
  stage_.render_clicks(chunk, workspace);
  renderer_.close();
  shedding_.end_chunk(workspace.counts, chunk, stage_.events_waited());
  if (shedding_.shed()) count(meters_.counters.shed);
}

void Mixer::change_sample_rate(double sample_rate_hz) {
  const double ratio = sample_rate_hz / this->sample_rate_hz();
  execute_commands(std::numeric_limits<Frame>::max());
  const auto place = [&](const Event& placing) { stage_.place(placing, now_, sample_rate_hz); };
  count(meters_.counters.late, timeline_.events().rescale(now_, ratio, place));
  struct Tables {
    std::shared_ptr<ModeTable> old, renewed;
  };
  std::map<const ModeTable*, Tables> tables;  // voices that shared a table share the new one
  stage_.part_all(now_);
  stage_.rescale(now_, ratio, [&](Voice* before) {
    const std::unique_ptr<Voice> voice(before);
    Tables& table = tables[&voice->table()];
    if (!table.old) table = {voice->shared_table(), voice->table().at_rate(sample_rate_hz)};
    return voice->with_table(table.renewed).release();
  });
  voices_.renew([&](const ModeTable* table) {
    const auto found = tables.find(table);
    return found == tables.end() ? nullptr : found->second.renewed;
  });
  sample_rate_hz_.store(sample_rate_hz, std::memory_order_relaxed);
  output_.limit(settings_.limiter_db, sample_rate_hz);
  output_.wear(settings_.head ? settings_.head(sample_rate_hz) : nullptr);
}

}  // namespace ringdown::synth
