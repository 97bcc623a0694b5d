#include "clients/plugin/instrument.h"

#include "engine/base/base64.h"
#include "engine/base/formatted.h"

#include <algorithm>
#include <array>
#include <chrono>
#include <cmath>
#include <cstdio>
#include <fstream>
#include <iterator>
#include <optional>
#include <utility>

namespace ringdown::plugin {
namespace {

constexpr std::chrono::milliseconds kRound{4};
constexpr std::chrono::microseconds kWait{200};
constexpr int kMaxWaits = 5000;  // a second: no block takes so long
constexpr std::uint64_t kRoundsPerCollection = 32;
constexpr double kGainRamp_s = 0.01;
constexpr double kMiddleKey = 63.5;
constexpr double kSilence_s = 0.1;  // of silence, after which the instrument is idle
constexpr double kFade_s = 0.016;   // more than the mixer takes to fade what it clears at once
constexpr std::size_t kFadeBlock = 128;
thread_local Instrument* newest_made = nullptr;

void report(const std::string& sentence) { std::fprintf(stderr, "Ringdown: %s\n", sentence.c_str()); }

std::unique_ptr<ringdown_mixer, MixerDestroy> make_mixer(double sample_rate_hz) {
  ringdown_settings settings;
  ringdown_settings_init(&settings, sizeof settings);
  settings.sample_rate_hz = sample_rate_hz;
  settings.limiter_db = 1;  // none: hosts mix in floating point, and a limiter would delay the sound
  ringdown_mixer* mixer = nullptr;
  ringdown_error error{};
  if (ringdown_mixer_create(&settings, &mixer, &error) != RINGDOWN_OK) report(error.sentence);
  return std::unique_ptr<ringdown_mixer, MixerDestroy>(mixer);
}

// The bytes that a session holds for this source; nothing: it holds none.
std::optional<std::string> embedded_bytes(const std::string& embedded, const Source& source) {
  const std::size_t blank = embedded.rfind(' ');
  if (blank == std::string::npos || embedded.compare(0, blank, source.name) != 0) return std::nullopt;
  auto bytes = from_base64(std::string_view(embedded).substr(blank + 1));
  if (!bytes || bytes->empty()) {
    report("the bank that the session holds is damaged; trying " + source.path.string());
    return std::nullopt;
  }
  return bytes;
}

// The exact strike points that texts mean, of those that lie on the object of the source, whose bank this is.
std::array<std::optional<StrikePoint>, kPoints> points_on(const Source& source, const ringdown_bank* bank,
                                                          const std::array<std::string, kPoints>& texts) {
  std::array<std::optional<StrikePoint>, kPoints> points;
  for (std::size_t i = 0; i < kPoints; ++i) {
    auto point = strike_point_of(texts[i]);
    const bool is_here = point && bank && !is_note_map(source) && point->source == source.name;
    if (is_here && is_near(bank, point->point_m)) points[i] = std::move(point);
  }
  return points;
}

bool same(const ringdown_material& a, const ringdown_material& b) {
  return a.stiffness == b.stiffness && a.density == b.density && a.size == b.size && a.alpha == b.alpha &&
         a.beta == b.beta && a.heat == b.heat && a.air == b.air;
}

}  // namespace

Instrument::Instrument(double sample_rate_hz, std::filesystem::path binary)
    : binary_(std::move(binary)), sample_rate_hz_(sample_rate_hz) {
  newest_made = this;
}

Instrument* Instrument::newest() { return newest_made; }

void Instrument::load_preset(std::size_t preset) {
  for (std::size_t i = 0; i < kParameters; ++i) {
    if (is_of_preset(i)) parameters_.set(i, kParameterInfo[i].standard);
  }
  parameters_.set(Parameter::object, static_cast<double>(kFirstPreset + preset));
  for (const Which which : {Which::first, Which::second}) set_point("", which);
  const std::lock_guard lock(mutex_);
  if (running_) catch_up();
}

std::vector<std::pair<std::size_t, std::string>> Instrument::key_names() const {
  const std::lock_guard lock(mutex_);
  std::vector<std::pair<std::size_t, std::string>> names;
  if (!map_ || !map_->is_note_map) return names;
  for (std::size_t key = 0; key < kKeys; ++key) {
    if (map_->keys[key].sounds) names.emplace_back(key, map_->objects[map_->keys[key].object].name);
  }
  return names;
}

bool Instrument::is_idle() const REALTIME {
  const auto choice = static_cast<std::size_t>(parameters_[Parameter::object]);
  return settled_ == choice && static_cast<double>(silent_frames_) > kSilence_s * sample_rate_hz_;
}

void Instrument::set_file(const std::string& path) {
  const std::lock_guard lock(mutex_);
  file_ = path;
  is_other_ = true;
  if (running_) catch_up();
}

std::string Instrument::file() const {
  const std::lock_guard lock(mutex_);
  return file_;
}

void Instrument::set_embedded(const std::string& text) {
  const std::lock_guard lock(mutex_);
  if (text == embedded_) return;
  embedded_ = text;
  source_ = {};  // it may be other bytes under the same name
  is_other_ = true;
  if (running_) catch_up();
}

std::string Instrument::embedded() const {
  const std::lock_guard lock(mutex_);
  if (!parameters_.on(Parameter::embed)) return "";
  const auto choice = static_cast<std::size_t>(parameters_[Parameter::object]);
  const Source source = find_source(choice, file_, binary_);
  if (is_note_map(source)) return "";
  if (embedded_bytes(embedded_, source)) return embedded_;
  std::ifstream bank(source.path, std::ios::binary);
  const std::string bytes{std::istreambuf_iterator<char>(bank), {}};
  return bytes.empty() ? "" : source.name + " " + to_base64(bytes);
}

void Instrument::set_point(const std::string& text, Which which) {
  const std::lock_guard lock(mutex_);
  points_[static_cast<std::size_t>(which)] = text;
  if (!map_) return;
  auto map = std::make_unique<KeyMap>(*map_);
  map->points = points_on(source_, bank_.get(), points_);
  publish(std::move(map));
}

std::string Instrument::point(Which which) const {
  const std::lock_guard lock(mutex_);
  return points_[static_cast<std::size_t>(which)];
}

// A new mixer, so that nothing of a former run sounds on, and objects of a former bank are gone.
void Instrument::start() {
  stop();
  const std::lock_guard lock(mutex_);
  published_ = nullptr;
  map_ = nullptr;
  plan_ = nullptr;
  retired_.clear();
  tunings_.clear();
  source_ = {};
  is_other_ = true;
  keyboard_.reset();
  full_at_ = -1;
  gain_ = {};
  silent_frames_ = 0;
  parameters_.end_modulation();
  spread_generation_ = 0;
  mixer_ = make_mixer(sample_rate_hz_);
  if (!mixer_) return;
  catch_up();
  if (map_) spread(*map_);
  silence();  // so that objects stand in their places when the first note comes
  running_ = true;
  worker_ = std::thread([this] { work(); });
}

void Instrument::stop() {
  running_ = false;
  if (worker_.joinable()) worker_.join();
}

void Instrument::work() {
  while (running_) {
    std::this_thread::sleep_for(kRound);
    const std::lock_guard lock(mutex_);
    catch_up();
  }
}

void Instrument::catch_up() {
  const auto choice = static_cast<std::size_t>(parameters_[Parameter::object]);
  if (is_other_ || choice != choice_) {
    is_other_ = false;
    choice_ = choice;
    Source wanted = find_source(choice, file_, binary_);
    if (wanted != source_) load(wanted);
    source_ = std::move(wanted);
  }
  const KeyMap* const played = plan_ ? &plan_->map : map_.get();
  const auto scale = static_cast<std::size_t>(parameters_[Parameter::scale]);
  keyboard_.tuning().set_base(tunings_of_keys_.read(scale, played ? played->tuning : std::nullopt));
  if (plan_ && ringdown_now(mixer_.get()) != full_at_) {
    full_at_ = install(*plan_) ? -1 : ringdown_now(mixer_.get());
    if (full_at_ < 0) plan_ = nullptr;
  }
  double tail_s = 0;
  for (std::size_t i = 0; map_ && i < map_->objects.size(); ++i) {
    tune(*map_, map_->objects[i], tunings_[i]);
    tail_s = std::max(tail_s, tunings_[i].material.size * map_->body_of(map_->objects[i]).ring_s);
  }
  tail_s_ = tail_s / parameters_[Parameter::loss];
  settled_ = plan_ ? kUnsettled : choice;
  std::erase_if(retired_, [&](const auto& map) { return map.get() != in_use_.load(); });
  if (++rounds_ % kRoundsPerCollection == 0) ringdown_collect(mixer_.get());
}

void Instrument::load(const Source& source) {
  const auto embedded = embedded_bytes(embedded_, source);
  auto plan = plan_keys(source, embedded ? std::string_view(*embedded) : std::string_view());
  if (!plan) return report(plan.error().message);
  if (!plan->notice.empty() && !parameters_.on(Parameter::tuning)) report(plan->notice);
  plan->map.generation = ++generations_;
  plan_ = std::make_unique<KeyPlan>(*std::move(plan));
}

// Gives each object its bank and its material. Returns false if the mixer has no room until the audio thread has taken
// what waits in its queues; the remaining objects are installed in another round.
bool Instrument::install(KeyPlan& plan) {
  silence_keys();
  const std::size_t count = plan.map.objects.size();
  std::vector<Tuning> tunings(count);
  ringdown_collect(mixer_.get());
  for (std::size_t i = 0; i < count; ++i) {
    KeyMap::Object& object = plan.map.objects[i];
    const std::string name = formatted("key{}", i);
    ringdown_error error{};
    if (ringdown_add(mixer_.get(), name.c_str(), plan.banks[object.body].get(), &object.number, &error) !=
        RINGDOWN_OK) {
      return false;
    }
    if (object.level_m && ringdown_fill(mixer_.get(), 0, object.number, *object.level_m, &error) != RINGDOWN_OK)
      return false;
    if (!tune(plan.map, object, tunings[i])) return false;
  }
  tunings_ = std::move(tunings);
  bank_ = plan.banks[0];
  plan.map.points = points_on(source_, bank_.get(), points_);
  publish(std::make_unique<const KeyMap>(std::move(plan.map)));
  return true;
}

// While objects get other banks, libringdown might refuse a blow from the old map and allocate a sentence for the
// error. So the keys strike nothing until the new map is ready, and nobody reads the old one.
void Instrument::silence_keys() {
  if (!map_) return;
  const KeyMap* const old = map_.get();
  auto silent = std::make_unique<KeyMap>(*map_);
  for (KeyMap::Key& key : silent->keys) key.sounds = false;
  publish(std::move(silent));
  for (int waits = 0; in_use_.load() == old && waits < kMaxWaits; ++waits) std::this_thread::sleep_for(kWait);
}

void Instrument::publish(std::unique_ptr<const KeyMap> map) {
  published_ = map.get();
  voices_ = std::max<std::size_t>(1, map->objects.size());
  generation_ = map->generation;
  if (map_) retired_.push_back(std::move(map_));
  map_ = std::move(map);
}

bool Instrument::tune(const KeyMap& map, const KeyMap::Object& object, Tuning& tuning) {
  ringdown_material material;
  ringdown_material_init(&material, sizeof material);
  material.stiffness = parameters_[Parameter::stiffness];
  material.density = parameters_[Parameter::density];
  material.alpha = material.beta = material.heat = material.air = parameters_[Parameter::loss];
  material.size = size_of(map, object, parameters_, keyboard_.bend_semitones(object.key));
  if (tuning.is_new || !same(material, tuning.material)) {
    std::atomic<double>& placed = sizes_[static_cast<std::size_t>(&object - map.objects.data())];
    placed = std::min(tuning.is_new ? 1 : tuning.material.size, material.size);
    if (ringdown_set_material(mixer_.get(), object.number, &material, nullptr) != RINGDOWN_OK) return false;
    placed = material.size;
    tuning.material = material;
    tuning.is_new = false;
  }
  const double pressure = keyboard_.pressure(object.key);
  const double damping_ns_m = parameters_[Parameter::hand] * pressure * pressure;
  if (damping_ns_m == tuning.damping_ns_m) return true;
  const Vec3 place = material.size * map.body_of(object).stations[0].position_m;
  const double point_m[3] = {place.x, place.y, place.z}, direction[3] = {0, 0, 0};
  if (ringdown_hold(mixer_.get(), 0, object.number, 0, point_m, direction, damping_ns_m, nullptr) != RINGDOWN_OK) {
    return false;
  }
  tuning.damping_ns_m = damping_ns_m;
  return true;
}

// The worker never frees the map in in_use_. The map may have been replaced between our reading and our writing, so we
// read again.
const KeyMap* Instrument::take_map() REALTIME {
  const KeyMap* map = published_.load();
  for (;;) {
    in_use_.store(map);
    const KeyMap* const now = published_.load();
    if (now == map) return map;
    map = now;
  }
}

// libringdown's functions for the audio thread are not marked in C.
TRUST_REALTIME_BEGIN

void Instrument::render(std::span<const MidiMessage> messages, float* left, float* right, std::size_t frames) REALTIME {
  const KeyMap* const map = take_map();
  if (map) {
    spread(*map);
    keyboard_.begin_block();
    const std::int64_t now = ringdown_now(mixer_.get());
    for (const MidiMessage& message : messages) {
      keyboard_.play(message.bytes, {mixer_.get(), now + message.frame, *map, parameters_, sizes_});
    }
  }
  ringdown_render(mixer_.get(), left, right, frames);
  if (!mixer_) std::fill_n(left, frames, 0.0F), std::fill_n(right, frames, 0.0F);
  gain_.apply(std::pow(10, parameters_[Parameter::gain] / 20), kGainRamp_s * sample_rate_hz_, {left, frames},
              {right, frames});
  float peak = 0;
  for (std::size_t i = 0; i < frames; ++i) peak = std::max({peak, std::abs(left[i]), std::abs(right[i])});
  parameters_.set(Parameter::level, 20 * std::log10(std::max(static_cast<double>(peak), 1e-6)));
  silent_frames_ = peak == 0 && messages.empty() ? silent_frames_ + frames : 0;
  in_use_.store(nullptr);
}

// The mixer fades what it clears, so the fade is rendered here, and nobody hears it.
void Instrument::silence() REALTIME {
  const KeyMap* const map = take_map();
  if (map) {
    constexpr std::array<std::uint8_t, 1> kReset = {session::midi::kSystemReset};
    keyboard_.begin_block();
    keyboard_.play(kReset, {mixer_.get(), ringdown_now(mixer_.get()), *map, parameters_, sizes_});
  }
  std::array<float, kFadeBlock> unheard{};
  for (std::size_t i = 0; mixer_ && static_cast<double>(i) * kFadeBlock < kFade_s * sample_rate_hz_; ++i) {
    ringdown_render(mixer_.get(), unheard.data(), unheard.data(), kFadeBlock);
  }
  in_use_.store(nullptr);
}

// Places the objects between left and right, in the order of their keys.
void Instrument::spread(const KeyMap& map) REALTIME {
  const double pan = parameters_[Parameter::pan] / 100, width = parameters_[Parameter::width] / 100;
  if (map.generation == spread_generation_ && pan == spread_pan_ && width == spread_width_) return;
  spread_generation_ = map.generation;
  spread_pan_ = pan;
  spread_width_ = width;
  for (std::size_t i = 0; i < map.objects.size(); ++i) {
    const KeyMap::Object& object = map.objects[i];
    const double place = pan + width * (static_cast<double>(object.key) - kMiddleKey) / kMiddleKey;
    ringdown_pan(mixer_.get(), 0, object.number, std::clamp(place, -1.0, 1.0), nullptr);
  }
}

TRUST_REALTIME_END

void Instrument::GainRamp::apply(double gain, double ramp_frames, std::span<float> on_left,
                                 std::span<float> on_right) REALTIME {
  if (wanted != gain) {
    const bool first = wanted == 0;
    wanted = gain;
    left = first ? 0 : static_cast<std::size_t>(ramp_frames);
    step = first ? 0 : (wanted - present) / static_cast<double>(left);
    if (first) present = wanted;
  }
  for (std::size_t i = 0; i < on_left.size(); ++i) {
    if (left > 0) present = --left == 0 ? wanted : present + step;
    on_left[i] = static_cast<float>(static_cast<double>(on_left[i]) * present);
    on_right[i] = static_cast<float>(static_cast<double>(on_right[i]) * present);
  }
}

}  // namespace ringdown::plugin
