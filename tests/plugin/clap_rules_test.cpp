// The rules that CLAP's validators hold plug-ins to, asked of the built plug-in: clap-validator's list of 0.3, by its
// names in brackets, and what this plug-in's extensions promise. What the list asks of effects is left out.
#include "clients/plugin/clap_abi.h"
#include "tests/plugin/host.h"
#include "tests/support/temporary_folder.h"

#include <gtest/gtest.h>

#include "src/clap/entry.h"
#include "src/clap/ext/audio-ports.h"
#include "src/clap/ext/note-ports.h"
#include "src/clap/ext/params.h"
#include "src/clap/ext/state.h"
#include "src/clap/plugin-factory.h"

#include <algorithm>
#include <cmath>
#include <cstring>
#include <filesystem>
#include <fstream>
#include <map>
#include <random>
#include <set>
#include <span>
#include <string>
#include <string_view>
#include <vector>

namespace ringdown::test {
namespace {

namespace abi = ringdown::plugin::clap;

// Sizes of the published headers' structs on 64-bit machines.
static_assert(sizeof(abi::Voices) == 16 && sizeof(abi::NoteName) == 262 && sizeof(abi::ControlPage) == 552);
static_assert(sizeof(abi::MetadataReceiver) == 88 && sizeof(abi::Location) == 32 && sizeof(abi::Indexer) == 88);
static_assert(sizeof(abi::Provider) == 48 && sizeof(abi::Soundpack) == 64 && sizeof(abi::ProviderDescriptor) == 40);

constexpr const char* kPath = RINGDOWN_LIB_DIR "/clap/ringdown.clap";
constexpr const char* kId = "ringdown.instrument";
constexpr double kRate_hz = 48000;
constexpr clap_id kObject = 1, kRootKey = 3, kGain = 11, kRelease = 14;
constexpr double kMug = 31, kGlockenspiel = 25, kVibraphone = 46;

const clap_plugin_entry_t& entry() {
  static const clap_plugin_entry_t* const opened = [] {
    const Module module(kPath);
    const auto* found = static_cast<const clap_plugin_entry_t*>(module.symbol("clap_entry"));
    EXPECT_TRUE(found->init(kPath));
    return found;
  }();
  return *opened;
}

const clap_plugin_factory_t& factory() {
  return *static_cast<const clap_plugin_factory_t*>(entry().get_factory(CLAP_PLUGIN_FACTORY_ID));
}

struct Event {
  union {
    clap_event_header_t header;
    clap_event_note_t note;
    clap_event_param_value_t value;
    clap_event_param_mod_t modulation;
    clap_event_midi_t midi;
  };
};

Event note(std::uint16_t type, std::uint32_t time, int channel, int key, double velocity) {
  Event event{};
  event.note = {{sizeof event.note, time, CLAP_CORE_EVENT_SPACE_ID, type, 0},
                -1,
                0,
                static_cast<std::int16_t>(channel),
                static_cast<std::int16_t>(key),
                velocity};
  return event;
}

Event value_of(clap_id parameter, double value, std::uint32_t time = 0) {
  Event event{};
  event.value = {{sizeof event.value, time, CLAP_CORE_EVENT_SPACE_ID, CLAP_EVENT_PARAM_VALUE, 0},
                 parameter,
                 nullptr,
                 -1,
                 -1,
                 -1,
                 -1,
                 value};
  return event;
}

Event modulation_of(clap_id parameter, double amount) {
  Event event{};
  event.modulation = {{sizeof event.modulation, 0, CLAP_CORE_EVENT_SPACE_ID, CLAP_EVENT_PARAM_MOD, 0},
                      parameter,
                      nullptr,
                      -1,
                      -1,
                      -1,
                      -1,
                      amount};
  return event;
}

clap_input_events_t list_of(std::vector<Event>& events) {
  return {&events,
          [](const clap_input_events_t* list) {
            return static_cast<std::uint32_t>(static_cast<std::vector<Event>*>(list->ctx)->size());
          },
          [](const clap_input_events_t* list, std::uint32_t index) -> const clap_event_header_t* {
            return &(*static_cast<std::vector<Event>*>(list->ctx))[index].header;
          }};
}
const clap_output_events_t kIgnored{nullptr,
                                    [](const clap_output_events_t*, const clap_event_header_t*) { return true; }};

// A plug-in in a host that counts what it is asked.
class Instance {
 public:
  Instance() : plugin_(factory().create_plugin(&factory(), &host_, kId)) {
    EXPECT_TRUE(plugin_ && plugin_->init(plugin_));
    params = extension<clap_plugin_params_t>(CLAP_EXT_PARAMS);
    state = extension<clap_plugin_state_t>(CLAP_EXT_STATE);
  }
  Instance(const Instance&) = delete;
  Instance& operator=(const Instance&) = delete;
  ~Instance() {
    deactivate();
    plugin_->destroy(plugin_);
  }
  template <class Extension>
  [[nodiscard]] const Extension* extension(const char* id) const {
    return static_cast<const Extension*>(plugin_->get_extension(plugin_, id));
  }
  void activate(double rate_hz = kRate_hz) {
    deactivate();
    active_ = plugin_->activate(plugin_, rate_hz, 1, kMaxBlock) && plugin_->start_processing(plugin_);
    EXPECT_TRUE(active_);
  }
  void deactivate() {
    if (!active_) return;
    plugin_->stop_processing(plugin_);
    plugin_->deactivate(plugin_);
    active_ = false;
  }
  void reset() { plugin_->reset(plugin_); }
  clap_process_status process(std::vector<Event> events = {}, std::uint32_t frames = 256) {
    left.assign(frames, 7), right.assign(frames, 7);
    float* channels[2] = {left.data(), right.data()};
    clap_audio_buffer_t output{channels, nullptr, 2, 0, ~std::uint64_t{0}};
    const clap_input_events_t in = list_of(events);
    const clap_process_t block{-1, frames, nullptr, nullptr, &output, 0, 1, &in, &kIgnored};
    const clap_process_status status = plugin_->process(plugin_, &block);
    constant_mask = output.constant_mask;
    return status;
  }
  void flush(std::vector<Event> events) {
    const clap_input_events_t in = list_of(events);
    params->flush(plugin_, &in, &kIgnored);
  }
  double value(clap_id parameter) {
    double found = NAN;
    EXPECT_TRUE(params->get_value(plugin_, parameter, &found));
    return found;
  }
  std::string text(clap_id parameter, double of) {
    char found[256] = "";
    EXPECT_TRUE(params->value_to_text(plugin_, parameter, of, found, sizeof found));
    return found;
  }
  // Saves and loads in pieces of at most `piece` bytes.
  std::string save(std::size_t piece = 1 << 20) {
    Piecewise to{"", piece};
    const clap_ostream_t stream{&to, [](const clap_ostream_t* self, const void* bytes, std::uint64_t size) {
                                  auto& all = *static_cast<Piecewise*>(self->ctx);
                                  const std::size_t count = std::min<std::size_t>(size, all.piece);
                                  all.bytes.append(static_cast<const char*>(bytes), count);
                                  return static_cast<std::int64_t>(count);
                                }};
    EXPECT_TRUE(state->save(plugin_, &stream));
    return to.bytes;
  }
  bool load(const std::string& bytes, std::size_t piece = 1 << 20) {
    Piecewise from{bytes, piece};
    const clap_istream_t stream{&from, [](const clap_istream_t* self, void* target, std::uint64_t size) {
                                  auto& all = *static_cast<Piecewise*>(self->ctx);
                                  const std::size_t count = std::min<std::size_t>({size, all.piece, all.bytes.size()});
                                  std::memcpy(target, all.bytes.data(), count);
                                  all.bytes.erase(0, count);
                                  return static_cast<std::int64_t>(count);
                                }};
    return state->load(plugin_, &stream);
  }
  // Renders blocks until the plug-in lets the host sleep; returns how many.
  int blocks_until_sleep(int max = 4000) {
    for (int block = 1; block <= max; ++block) {
      if (process() == CLAP_PROCESS_SLEEP) return block;
    }
    return max + 1;
  }
  [[nodiscard]] double power() const {
    double sum = 0;
    for (const float sample : left) sum += static_cast<double>(sample) * static_cast<double>(sample);
    return sum;
  }
  [[nodiscard]] const clap_plugin_t* raw() const { return plugin_; }
  void run_main_thread() { plugin_->on_main_thread(plugin_); }

  const clap_plugin_params_t* params = nullptr;
  const clap_plugin_state_t* state = nullptr;
  std::vector<float> left, right;
  std::uint64_t constant_mask = 0;
  std::map<std::string, int> asked;  // what the plug-in asked of the host, and how often

 private:
  struct Piecewise {
    std::string bytes;
    std::size_t piece;
  };
  static Instance& of(const clap_host_t* host) { return *static_cast<Instance*>(host->host_data); }
  static const void* host_extension(const clap_host_t*, const char* id) {
    static const clap_host_params_t params{
        [](const clap_host_t* host, clap_param_rescan_flags) { ++of(host).asked["rescan"]; },
        [](const clap_host_t*, clap_id, clap_param_clear_flags) {}, [](const clap_host_t*) {}};
    static const abi::HostNoteNames names{[](const clap_host_t* host) { ++of(host).asked["note names"]; }};
    static const abi::HostTail tail{[](const clap_host_t* host) { ++of(host).asked["tail"]; }};
    static const abi::HostPresetLoad presets{
        [](const clap_host_t* host, std::uint32_t, const char*, const char*, std::int32_t, const char*) {
          ++of(host).asked["preset error"];
        },
        [](const clap_host_t* host, std::uint32_t, const char*, const char*) { ++of(host).asked["preset loaded"]; }};
    const std::string_view wanted = id;
    if (wanted == CLAP_EXT_PARAMS) return &params;
    if (wanted == abi::NoteNames::kId) return &names;
    if (wanted == abi::Tail::kId) return &tail;
    if (wanted == abi::PresetLoad::kIds[0]) return &presets;
    return nullptr;
  }

  clap_host_t host_{CLAP_VERSION,
                    this,
                    "test",
                    "Ringdown",
                    "",
                    "1",
                    host_extension,
                    [](const clap_host_t* host) { ++of(host).asked["restart"]; },
                    [](const clap_host_t* host) { ++of(host).asked["process"]; },
                    [](const clap_host_t* host) { ++of(host).asked["callback"]; }};
  const clap_plugin_t* plugin_;
  bool active_ = false;
};

std::vector<clap_param_info_t> parameters(const Instance& instance) {
  std::vector<clap_param_info_t> all(instance.params->count(instance.raw()));
  for (std::uint32_t i = 0; i < all.size(); ++i) EXPECT_TRUE(instance.params->get_info(instance.raw(), i, &all[i]));
  return all;
}

// ---- The library
// ------------------------------------------------------------------------------------------------------

// [query-factory-nonexistent, create-id-with-trailing-garbage]
TEST(ClapRules, OnlyWhatExistsIsMade) {
  EXPECT_EQ(entry().get_factory("ringdown.nothing"), nullptr);
  ASSERT_EQ(factory().get_plugin_count(&factory()), 1U);
  EXPECT_EQ(factory().get_plugin_descriptor(&factory(), 1), nullptr);
  const clap_host_t host{CLAP_VERSION,
                         nullptr,
                         "t",
                         "t",
                         "",
                         "1",
                         [](const clap_host_t*, const char*) -> const void* { return nullptr; },
                         [](const clap_host_t*) {},
                         [](const clap_host_t*) {},
                         [](const clap_host_t*) {}};
  EXPECT_EQ(factory().create_plugin(&factory(), &host, "ringdown.instrumentx1"), nullptr);
  const clap_plugin_t* const unused = factory().create_plugin(&factory(), &host, kId);
  ASSERT_NE(unused, nullptr);
  unused->destroy(unused);  // without init()
}

// [descriptor-consistency, features-categories, features-duplicates]
TEST(ClapRules, TheDescriptorIsCompleteAndTheSameEverywhere) {
  const Instance instance;
  const clap_plugin_descriptor_t& listed = *factory().get_plugin_descriptor(&factory(), 0);
  const clap_plugin_descriptor_t& own = *instance.raw()->desc;
  for (const auto member :
       {&clap_plugin_descriptor_t::id, &clap_plugin_descriptor_t::name, &clap_plugin_descriptor_t::vendor,
        &clap_plugin_descriptor_t::version, &clap_plugin_descriptor_t::description}) {
    ASSERT_NE(listed.*member, nullptr);
    EXPECT_STRNE(listed.*member, "");
    EXPECT_STREQ(listed.*member, own.*member);
  }
  std::set<std::string> features;
  for (const char** feature = own.features; *feature; ++feature) EXPECT_TRUE(features.insert(*feature).second);
  EXPECT_TRUE(features.contains("instrument"));
}

// ---- Parameters
// -------------------------------------------------------------------------------------------------------

TEST(ClapRules, ParametersAreOrderedNamedAndGrouped) {
  const Instance instance;
  std::set<std::string> names, groups;
  std::set<clap_id> ids;
  for (const clap_param_info_t& one : parameters(instance)) {
    EXPECT_EQ(one.id, ids.size()) << "sessions store these numbers";
    EXPECT_TRUE(ids.insert(one.id).second && names.insert(one.name).second) << one.name;
    groups.insert(one.module);
    EXPECT_LT(one.min_value, one.max_value);
    EXPECT_TRUE(one.default_value >= one.min_value && one.default_value <= one.max_value) << one.name;
    const bool is_stepped = (one.flags & CLAP_PARAM_IS_STEPPED) != 0;
    EXPECT_TRUE(!is_stepped || std::round(one.max_value) == one.max_value) << one.name;
    EXPECT_NE((one.flags & CLAP_PARAM_IS_READONLY) != 0, (one.flags & CLAP_PARAM_IS_AUTOMATABLE) != 0) << one.name;
    EXPECT_FALSE(is_stepped && (one.flags & CLAP_PARAM_IS_MODULATABLE) != 0) << one.name;
  }
  EXPECT_EQ(groups, (std::set<std::string>{"Object", "Body", "Strike", "Playing", "Output", "Session"}));
  clap_param_info_t none;
  double value = 0;
  EXPECT_FALSE(instance.params->get_info(instance.raw(), static_cast<std::uint32_t>(ids.size()), &none));
  EXPECT_FALSE(instance.params->get_value(instance.raw(), 9999, &value));
}

// [param-conversions]
TEST(ClapRules, TextsOfParametersMeanTheirValues) {
  Instance instance;
  for (const clap_param_info_t& one : parameters(instance)) {
    const double span = one.max_value - one.min_value;
    const bool is_stepped = (one.flags & CLAP_PARAM_IS_STEPPED) != 0;
    for (int i = 0; i <= 20; ++i) {
      const double at = one.min_value + span * i / 20;
      const std::string text = instance.text(one.id, is_stepped ? std::round(at) : at);
      double meant = NAN, again = NAN;
      ASSERT_TRUE(instance.params->text_to_value(instance.raw(), one.id, text.c_str(), &meant)) << one.name << text;
      const std::string second = instance.text(one.id, meant);
      EXPECT_EQ(text, second) << one.name;
      ASSERT_TRUE(instance.params->text_to_value(instance.raw(), one.id, second.c_str(), &again));
      EXPECT_EQ(meant, again);
      const double wanted = is_stepped ? meant : at;
      EXPECT_NEAR(meant, wanted, 0.005 * std::abs(wanted) + 1e-9) << one.name << text;
    }
    double value = 3;
    EXPECT_FALSE(instance.params->text_to_value(instance.raw(), one.id, "no such text", &value)) << one.name;
    EXPECT_EQ(value, 3);
  }
}

TEST(ClapRules, ValuesAreSpokenWithUnitsAndNames) {
  Instance instance;
  const auto spoken = [&](clap_id parameter, double value) { return instance.text(parameter, value); };
  EXPECT_EQ(spoken(kRootKey, 60), "C4");
  EXPECT_EQ(spoken(kRootKey, 70), "A#4");
  EXPECT_EQ(spoken(kObject, kMug), "mug");
  EXPECT_EQ(spoken(kObject, 0), "file");
  EXPECT_EQ(spoken(2, 1), "own pitch");
  EXPECT_EQ(spoken(4, 0.25), "0.250 x");
  EXPECT_EQ(spoken(8, 100), "100 %");
  EXPECT_EQ(spoken(9, 0.2), "0.200 ms");
  EXPECT_EQ(spoken(10, 1), "on");
  EXPECT_EQ(spoken(17, 0), "off");
  EXPECT_EQ(spoken(kGain, -6.0206), "-6.02 dB");
  EXPECT_EQ(spoken(kRelease, 30), "rings on");
  EXPECT_EQ(spoken(16, 48), "48 semitones");
  const auto meant = [&](clap_id parameter, const char* text) {
    double value = NAN;
    EXPECT_TRUE(instance.params->text_to_value(instance.raw(), parameter, text, &value)) << text;
    return value;
  };
  EXPECT_EQ(meant(kRootKey, "Bb4"), 70);
  EXPECT_EQ(meant(kRootKey, "61"), 61);
  EXPECT_EQ(meant(kObject, " MUG "), kMug);
  EXPECT_EQ(meant(9, "1.5"), 1.5);
  EXPECT_EQ(meant(9, "1.5 ms"), 1.5);
  EXPECT_EQ(meant(kGain, "+6 db"), 6);
  EXPECT_EQ(meant(kGain, "900"), 24) << "the nearest value in range";
}

// [param-set-wrong-namespace]
TEST(ClapRules, EventsOfOtherSpacesChangeNothing) {
  Instance instance;
  Event foreign = value_of(kGain, -20);
  foreign.header.space_id = 0xb33f;
  instance.flush({foreign});
  instance.activate();
  instance.process({foreign});
  EXPECT_EQ(instance.value(kGain), 0);
}

// [param-fuzz-basic, param-fuzz-bounds, param-fuzz-sample-accurate, param-fuzz-modulation]
TEST(ClapRules, AnyValuesAndModulationsGiveFiniteSound) {
  Instance instance;
  const auto all = parameters(instance);
  std::mt19937 random(1);
  instance.activate();
  for (int block = 0; block < 40; ++block) {
    std::vector<Event> events;
    for (const clap_param_info_t& one : all) {
      if ((one.flags & CLAP_PARAM_IS_READONLY) != 0 || (one.id == kObject && block % 20 != 0)) continue;
      const double share = block % 2 == 0 ? static_cast<double>(random() % 2) : (random() % 1000) / 999.0;
      const double value = one.min_value + share * (one.max_value - one.min_value);
      events.push_back(value_of(one.id, one.id == kObject ? 9.0 + random() % 46 : value, random() % 256));
      if (block % 3 == 0) events.push_back(modulation_of(one.id, (share - 0.5) * (one.max_value - one.min_value)));
    }
    for (Event& event : events) event.header.time = std::min(event.header.time, 255U);
    std::sort(events.begin(), events.end(),
              [](const Event& a, const Event& b) { return a.header.time < b.header.time; });
    events.push_back(note(CLAP_EVENT_NOTE_ON, 255, 0, static_cast<int>(random() % 128), 0.8));
    ASSERT_NE(instance.process(events), CLAP_PROCESS_ERROR);
    for (std::size_t i = 0; i < instance.left.size(); ++i) {
      ASSERT_TRUE(std::isfinite(instance.left[i]) && std::isfinite(instance.right[i])) << block;
      ASSERT_TRUE(std::fpclassify(instance.left[i]) != FP_SUBNORMAL) << block;
    }
  }
}

TEST(ClapRules, ModulationIsHeardAndLeavesTheValue) {
  Instance instance;
  instance.flush({value_of(kObject, kGlockenspiel)});
  std::vector<double> powers;
  for (const double amount : {0.0, -20.0}) {
    instance.activate();
    instance.process({modulation_of(kGain, amount), note(CLAP_EVENT_NOTE_ON, 0, 0, 84, 0.8)}, 4096);
    powers.push_back(instance.power());
    EXPECT_EQ(instance.value(kGain), 0);
  }
  EXPECT_NEAR(10 * std::log10(powers[1] / powers[0]), -20, 0.1);
}

// ---- Sound
// ------------------------------------------------------------------------------------------------------------

// [process-note-out-of-place-basic, process-note-inconsistent, process-varying-sample-rates,
// process-varying-block-sizes, process-random-block-sizes]
TEST(ClapRules, AnyNotesRatesAndBlocksGiveFiniteSound) {
  Instance instance;
  instance.flush({value_of(kObject, kGlockenspiel)});
  std::mt19937 random(2);
  for (const double rate_hz : {1000.0, 22050.0, 44100.0, 88200.0, 192000.0}) {
    instance.activate(rate_hz);
    for (int block = 0; block < 12; ++block) {
      const std::uint32_t frames = block % 2 == 0 ? 1 + random() % kMaxBlock / 4 : 1U << (random() % 10);
      std::vector<Event> events;
      for (int i = 0; i < 20; ++i) {
        const auto type = static_cast<std::uint16_t>(random() % 3);  // on, off, choke
        events.push_back(note(type, frames * static_cast<std::uint32_t>(i) / 20, static_cast<int>(random() % 17) - 1,
                              static_cast<int>(random() % 129) - 1, (random() % 100) / 99.0));
      }
      ASSERT_NE(instance.process(events, frames), CLAP_PROCESS_ERROR);
      for (const float sample : instance.left) ASSERT_TRUE(std::isfinite(sample)) << rate_hz;
    }
  }
}

TEST(ClapRules, ANoteOfVelocityZeroIsNoRelease) {
  Instance instance;
  instance.flush({value_of(kObject, kGlockenspiel), value_of(kRelease, 0.02)});
  instance.activate();
  instance.process({note(CLAP_EVENT_NOTE_ON, 0, 0, 69, 1)}, 2048);
  instance.process({note(CLAP_EVENT_NOTE_ON, 0, 0, 69, 0)}, 2048);
  instance.process({}, 2048);
  EXPECT_GT(instance.power(), 1e-6);
}

// [process-reset-determinism]
TEST(ClapRules, AResetSilencesAndTheNextNoteIsAsAfterActivation) {
  Instance instance;
  instance.flush({value_of(kObject, kGlockenspiel)});
  instance.activate();
  const std::vector<Event> one = {note(CLAP_EVENT_NOTE_ON, 0, 0, 80, 0.7)};
  instance.process(one, 2048);
  const std::vector<float> expected = instance.left;
  instance.process({note(CLAP_EVENT_NOTE_ON, 0, 0, 60, 1)}, 2048);
  instance.reset();
  instance.process();
  EXPECT_EQ(instance.power(), 0);
  instance.process(one, 2048);
  double difference = 0;
  for (std::size_t i = 0; i < expected.size(); ++i) {
    difference += std::pow(static_cast<double>(instance.left[i]) - static_cast<double>(expected[i]), 2);
  }
  EXPECT_LT(difference, 1e-10 * instance.power());
}

// [process-sleep-process-status, process-sleep-constant-mask]
TEST(ClapRules, TheHostMaySleepWhileNothingSounds) {
  Instance instance;
  instance.flush({value_of(kObject, kGlockenspiel), value_of(kRelease, 0.05)});
  instance.activate();
  EXPECT_LT(instance.blocks_until_sleep(), 60);
  EXPECT_EQ(instance.constant_mask, 3U);
  EXPECT_EQ(instance.power(), 0);
  EXPECT_EQ(instance.process({note(CLAP_EVENT_NOTE_ON, 0, 0, 90, 0.8)}), CLAP_PROCESS_CONTINUE);
  EXPECT_GT(instance.power(), 1e-9) << "a sleeper wakes with its first event";
  EXPECT_EQ(instance.constant_mask, 0U);
  EXPECT_EQ(instance.process(), CLAP_PROCESS_CONTINUE);
  instance.process({note(CLAP_EVENT_NOTE_OFF, 0, 0, 90, 0)});
  EXPECT_LT(instance.blocks_until_sleep(), 100);
  instance.flush({value_of(kObject, kMug)});
  EXPECT_GE(instance.asked["process"], 1) << "another object is installed while blocks are rendered";
}

TEST(ClapRules, WhatRingsOnSleepsOnceItIsInaudible) {
  Instance instance;
  instance.flush({value_of(kObject, kMug)});
  instance.activate();
  const auto* const tail = instance.extension<abi::Tail>(abi::Tail::kId);
  instance.process({note(CLAP_EVENT_NOTE_ON, 0, 0, 100, 0.5)});
  const double blocks = tail->get(instance.raw()) / 256.0;
  EXPECT_GT(blocks, 100);
  EXPECT_LT(instance.blocks_until_sleep(30'000), 30'000);
}

// ---- State
// ------------------------------------------------------------------------------------------------------------

// [state-reproducibility-basic, -flush, -null-cookies, state-buffered-streams]
TEST(ClapRules, StatesAreEqualHoweverTheyAreMadeAndRead) {
  Instance by_flush, by_process, third;
  std::mt19937 random(3);
  std::vector<Event> events;
  for (const clap_param_info_t& one : parameters(by_flush)) {
    if ((one.flags & CLAP_PARAM_IS_READONLY) != 0) continue;
    const double value = one.min_value + (random() % 1000) / 999.0 * (one.max_value - one.min_value);
    events.push_back(
        value_of(one.id, one.id == kObject ? kMug : (one.flags & CLAP_PARAM_IS_STEPPED ? std::round(value) : value)));
  }
  by_flush.flush(events);
  by_process.activate();
  by_process.process(events);
  const std::string state = by_flush.save();
  EXPECT_EQ(state, by_process.save());
  EXPECT_EQ(state, by_flush.save(7));
  ASSERT_TRUE(third.load(state, 5));
  EXPECT_EQ(state, third.save());
  EXPECT_GE(third.asked["rescan"], 1);
  for (const Event& event : events) {
    EXPECT_NEAR(third.value(event.value.param_id), event.value.value, 1e-4) << event.value.param_id;
  }
  const auto* const context = by_flush.extension<abi::StateContext>(abi::StateContext::kId);
  ASSERT_NE(context, nullptr);
  for (const std::uint32_t kind : {1U, 2U, 3U}) {
    std::string saved;
    const clap_ostream_t stream{&saved, [](const clap_ostream_t* self, const void* bytes, std::uint64_t size) {
                                  static_cast<std::string*>(self->ctx)->append(static_cast<const char*>(bytes), size);
                                  return static_cast<std::int64_t>(size);
                                }};
    EXPECT_TRUE(context->save(by_flush.raw(), &stream, kind));
    EXPECT_EQ(saved, state);
  }
}

// ---- What the plug-in says about itself
// -------------------------------------------------------------------------------

TEST(ClapRules, PortsAreOneForNotesAndOneInStereo) {
  const Instance instance;
  const auto* const audio = instance.extension<clap_plugin_audio_ports_t>(CLAP_EXT_AUDIO_PORTS);
  const auto* const notes = instance.extension<clap_plugin_note_ports_t>(CLAP_EXT_NOTE_PORTS);
  EXPECT_EQ(audio->count(instance.raw(), true), 0U);
  ASSERT_EQ(audio->count(instance.raw(), false), 1U);
  clap_audio_port_info_t port{};
  ASSERT_TRUE(audio->get(instance.raw(), 0, false, &port));
  EXPECT_EQ(port.channel_count, 2U);
  EXPECT_STREQ(port.port_type, CLAP_PORT_STEREO);
  EXPECT_EQ(port.flags, static_cast<std::uint32_t>(CLAP_AUDIO_PORT_IS_MAIN));
  EXPECT_FALSE(audio->get(instance.raw(), 1, false, &port));
  EXPECT_EQ(notes->count(instance.raw(), false), 0U);
  clap_note_port_info_t note_port{};
  ASSERT_TRUE(notes->get(instance.raw(), 0, true, &note_port));
  EXPECT_NE(note_port.supported_dialects & note_port.preferred_dialect, 0U);
  EXPECT_FALSE(notes->get(instance.raw(), 1, true, &note_port));
}

TEST(ClapRules, KeysOfANoteMapAreNamedAndHostsAreToldOfAnotherMap) {
  Instance instance;
  const auto* const names = instance.extension<abi::NoteNames>(abi::NoteNames::kId);
  const auto* const voices = instance.extension<abi::VoiceInfo>(abi::VoiceInfo::kId);
  const auto* const latency = instance.extension<abi::Latency>(abi::Latency::kId);
  ASSERT_TRUE(names && voices && latency);
  instance.flush({value_of(kObject, kMug)});
  instance.activate();
  instance.process();
  EXPECT_EQ(latency->get(instance.raw()), 0U);
  EXPECT_EQ(names->count(instance.raw()), 0U) << "one object has no names for its keys";
  abi::Voices count{};
  ASSERT_TRUE(voices->get(instance.raw(), &count));
  EXPECT_EQ(count.count, 128U);
  instance.flush({value_of(kObject, kVibraphone)});
  instance.activate();
  const int before = instance.asked["callback"];
  instance.process();
  EXPECT_GT(instance.asked["callback"], before);
  instance.run_main_thread();
  EXPECT_GE(instance.asked["note names"], 1);
  EXPECT_GE(instance.asked["tail"], 1);
  ASSERT_EQ(names->count(instance.raw()), 37U);
  abi::NoteName name{};
  ASSERT_TRUE(names->get(instance.raw(), 0, &name));
  EXPECT_STREQ(name.name, "F3");
  EXPECT_EQ(name.key, 53);
  EXPECT_FALSE(names->get(instance.raw(), 37, &name));
  ASSERT_TRUE(voices->get(instance.raw(), &count));
  EXPECT_EQ(count.count, 37U);
  EXPECT_EQ(count.capacity, 128U);
}

TEST(ClapRules, RemoteControlsNameParameters) {
  const Instance instance;
  for (const char* const id : abi::RemoteControls::kIds) {
    const auto* const pages = instance.extension<abi::RemoteControls>(id);
    ASSERT_NE(pages, nullptr) << id;
    std::set<clap_id> ids;
    for (std::uint32_t i = 0; i < pages->count(instance.raw()); ++i) {
      abi::ControlPage page{};
      ASSERT_TRUE(pages->get(instance.raw(), i, &page));
      EXPECT_TRUE(ids.insert(page.id).second);
      EXPECT_STRNE(page.name, "");
      for (const clap_id parameter : page.parameters) EXPECT_LT(parameter, instance.params->count(instance.raw()));
    }
  }
}

// ---- Presets
// ----------------------------------------------------------------------------------------------------------

struct Listed {
  std::string name, key, description;
  std::set<std::string> features;
  bool is_ours = false;
};
struct Crawl {
  std::vector<Listed> presets;
  std::vector<std::pair<std::uint32_t, std::string>> locations;
  std::vector<std::string> endings, errors;
};

// Asks the provider for everything that it declares, as a host's browser does. [preset-discovery-crawl]
Crawl crawl() {
  Crawl found;
  const auto* const presets = static_cast<const abi::PresetFactory*>(entry().get_factory(abi::PresetFactory::kIds[0]));
  EXPECT_EQ(presets, entry().get_factory(abi::PresetFactory::kIds[1]));
  EXPECT_EQ(presets->count(presets), 1U);
  EXPECT_EQ(presets->get_descriptor(presets, 1), nullptr);
  const abi::Indexer indexer{
      CLAP_VERSION,
      "test",
      "",
      "",
      "1",
      &found,
      [](const abi::Indexer* self, const abi::FileType* type) {
        static_cast<Crawl*>(self->data)->endings.emplace_back(type->ending);
        return true;
      },
      [](const abi::Indexer* self, const abi::Location* location) {
        static_cast<Crawl*>(self->data)->locations.emplace_back(location->kind, location->path ? location->path : "");
        return true;
      },
      [](const abi::Indexer*, const abi::Soundpack*) { return true; },
      [](const abi::Indexer*, const char*) -> const void* { return nullptr; }};
  EXPECT_EQ(presets->create(presets, &indexer, "ringdown.others"), nullptr);
  const abi::Provider* const provider = presets->create(presets, &indexer, presets->get_descriptor(presets, 0)->id);
  EXPECT_STREQ(provider->about->id,
               presets->get_descriptor(presets, 0)->id);  // [preset-discovery-descriptor-consistency]
  EXPECT_TRUE(provider->init(provider));
  static const auto last = [](const abi::MetadataReceiver* self) -> Listed& {
    return static_cast<Crawl*>(self->data)->presets.back();
  };
  const abi::MetadataReceiver receiver{
      &found,
      [](const abi::MetadataReceiver* self, std::int32_t, const char* sentence) {
        static_cast<Crawl*>(self->data)->errors.emplace_back(sentence);
      },
      [](const abi::MetadataReceiver* self, const char* name, const char* key) {
        static_cast<Crawl*>(self->data)->presets.push_back({name, key ? key : "", "", {}, false});
        return true;
      },
      [](const abi::MetadataReceiver* self, const abi::PluginId* plugin) {
        last(self).is_ours = std::string_view(plugin->abi) == "clap" && std::string_view(plugin->id) == kId;
      },
      [](const abi::MetadataReceiver*, const char*) {},
      [](const abi::MetadataReceiver*, std::uint32_t) {},
      [](const abi::MetadataReceiver*, const char*) {},
      [](const abi::MetadataReceiver* self, const char* text) { last(self).description = text; },
      [](const abi::MetadataReceiver*, abi::Timestamp, abi::Timestamp) {},
      [](const abi::MetadataReceiver* self, const char* feature) { last(self).features.insert(feature); },
      [](const abi::MetadataReceiver*, const char*, const char*) {}};
  for (const auto& [kind, path] : found.locations) {
    if (kind == abi::kInPlugin) {
      EXPECT_TRUE(provider->get_metadata(provider, kind, nullptr, &receiver));
      continue;
    }
    for (const auto& file : std::filesystem::directory_iterator(path)) {
      EXPECT_TRUE(provider->get_metadata(provider, kind, file.path().c_str(), &receiver));
    }
  }
  EXPECT_FALSE(provider->get_metadata(provider, abi::kFile, "/nowhere/x.glb", &receiver));
  EXPECT_EQ(found.errors.size(), 1U);
  provider->destroy(provider);
  return found;
}

// [preset-discovery-load]
TEST(ClapRules, PresetsAreFoundWithTheirTagsAndLoad) {
  const TemporaryFolder home;
  std::filesystem::create_directories(home / "ringdown/plugin");
  std::filesystem::copy_file(RINGDOWN_SOURCE_DIR "/presets/banks/mug.glb", home / "ringdown/plugin/1.glb");
  const char* const before = std::getenv("XDG_DATA_HOME");
  const std::string kept = before ? before : "";
  setenv("XDG_DATA_HOME", home.path().c_str(), 1);
  const Crawl found = crawl();
  before ? setenv("XDG_DATA_HOME", kept.c_str(), 1) : unsetenv("XDG_DATA_HOME");
  EXPECT_EQ(found.endings, (std::vector<std::string>{"glb", "toml"}));
  ASSERT_GT(found.presets.size(), 46U);
  Instance instance;
  const auto* const load = instance.extension<abi::PresetLoad>(abi::PresetLoad::kIds[0]);
  ASSERT_NE(load, nullptr);
  instance.flush({value_of(kGain, -20)});
  std::size_t families = 0;
  for (const Listed& preset : found.presets) {
    EXPECT_TRUE(preset.is_ours && preset.features.contains("instrument")) << preset.name;
    families += preset.features.size() > 1;
    if (preset.key.empty()) continue;
    ASSERT_TRUE(load->from_location(instance.raw(), abi::kInPlugin, nullptr, preset.key.c_str())) << preset.key;
    EXPECT_EQ(instance.text(kObject, instance.value(kObject)), preset.key);
    EXPECT_EQ(instance.value(kGain), 0) << "a preset has the defaults of the other parameters";
  }
  EXPECT_GE(families, 46U);
  const auto mug = std::find_if(found.presets.begin(), found.presets.end(),
                                [](const Listed& preset) { return preset.key == "mug"; });
  EXPECT_TRUE(mug->features.contains("Glass and porcelain") && mug->features.contains("porcelain"));
  EXPECT_EQ(mug->description, "A mug of stoneware with its handle");
  const std::string own = home / "ringdown/plugin/1.glb";
  ASSERT_TRUE(load->from_location(instance.raw(), abi::kFile, own.c_str(), nullptr));
  EXPECT_EQ(instance.value(kObject), 0);
  instance.activate();
  instance.process({note(CLAP_EVENT_NOTE_ON, 0, 0, 100, 1)}, 1024);
  EXPECT_GT(instance.power(), 1e-6);
  EXPECT_FALSE(load->from_location(instance.raw(), abi::kInPlugin, nullptr, "no-such-preset"));
  EXPECT_FALSE(load->from_location(instance.raw(), abi::kFile, "/nowhere/x.glb", nullptr));
  EXPECT_EQ(instance.asked["preset error"], 2);
  EXPECT_EQ(instance.asked["preset loaded"], static_cast<int>(found.presets.size()));
}

}  // namespace
}  // namespace ringdown::test
