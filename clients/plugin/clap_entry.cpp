// The CLAP plug-in's entry: a layer in front of DPF's entry that adds what DPF 1.6 lacks.
//
// - Note expressions become MIDI: pressure is the key's aftertouch, brightness controller 74, tuning a bend of the key.
// - Events that DPF would misread do not reach it: modulation, gestures, transport, unknown parameters, releases of
//   all keys at once.
// - A state may be read in pieces of any size; DPF takes a short piece for the end of a text.
// - Notes may come as CLAP's own, which note expressions need, or as MPE.
//
// DPF's entry is compiled under the name dpf_clap_entry. Our plug-in is a copy of DPF's struct with a few functions
// replaced; the others find their instance in the struct as before.
#include "clients/plugin/keyboard.h"
#include "clients/plugin/parameters.h"

#include "src/clap/entry.h"
#include "src/clap/ext/note-ports.h"
#include "src/clap/ext/params.h"
#include "src/clap/ext/state.h"
#include "src/clap/plugin-factory.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstring>
#include <memory>
#include <string>
#include <string_view>

extern "C" const clap_plugin_entry_t dpf_clap_entry;

namespace {

using namespace ringdown::plugin;

constexpr std::size_t kMaxEvents = 2048, kMaxMidi = 512;   // of a block; further ones are dropped, by DPF too
constexpr std::size_t kMaxState = std::size_t{256} << 20;  // bytes

std::uint8_t seven_bits(double share) {
  return static_cast<std::uint8_t>(std::lround(std::clamp(std::isfinite(share) ? share : 0.0, 0.0, 1.0) * 127));
}

// The events of one block for DPF: those of the host, and MIDI made from note expressions.
class Events {
 public:
  void take(const clap_input_events_t* given) {
    used_ = midi_used_ = 0;
    const std::uint32_t count = given ? given->size(given) : 0;
    for (std::uint32_t i = 0; i < count; ++i) take(*given->get(given, i));
  }
  [[nodiscard]] const clap_input_events_t* list() const { return &list_; }

 private:
  void take(const clap_event_header_t& event) {
    if (event.space_id != CLAP_CORE_EVENT_SPACE_ID) return;
    switch (event.type) {
      case CLAP_EVENT_NOTE_ON:
      case CLAP_EVENT_MIDI:
        return add(event);
      case CLAP_EVENT_NOTE_OFF:
      case CLAP_EVENT_NOTE_CHOKE:
        return release(reinterpret_cast<const clap_event_note_t&>(event));
      case CLAP_EVENT_PARAM_VALUE:
        if (reinterpret_cast<const clap_event_param_value_t&>(event).param_id < kParameters) add(event);
        return;
      case CLAP_EVENT_NOTE_EXPRESSION:
        return express(reinterpret_cast<const clap_event_note_expression_t&>(event));
      default:
        return;
    }
  }
  void add(const clap_event_header_t& event) {
    if (used_ < kMaxEvents) events_[used_++] = &event;
  }
  void add_midi(std::uint32_t time, std::uint8_t status, int first, int second) {
    if (midi_used_ == kMaxMidi) return;
    clap_event_midi_t& midi = midi_[midi_used_++];
    midi = {{sizeof midi, time, CLAP_CORE_EVENT_SPACE_ID, CLAP_EVENT_MIDI, 0},
            0,
            {status, static_cast<std::uint8_t>(first), static_cast<std::uint8_t>(second)}};
    add(midi.header);
  }
  // Adds a message on a channel, or on all channels if it is negative, as CLAP has it.
  void add_midi_on(int channel, std::uint32_t time, int kind, int first, int second) {
    for (int one = 0; one < 16; ++one) {
      if (channel < 0 || channel == one) add_midi(time, static_cast<std::uint8_t>(kind | one), first, second);
    }
  }
  // A release without a key is one of all keys.
  void release(const clap_event_note_t& event) {
    const bool one_key = event.key >= 0 && event.key < static_cast<int>(kKeys);
    if (one_key) return add_midi_on(event.channel, event.header.time, 0x80, event.key, 0);
    add_midi_on(event.channel, event.header.time, 0xb0, 123, 0);
  }
  // An expression without a key is one of all keys that its channel plays.
  void express(const clap_event_note_expression_t& event) {
    const int channel = event.channel;
    const bool one_key = event.key >= 0 && event.key < static_cast<int>(kKeys);
    const std::uint32_t time = event.header.time;
    if (event.expression_id == CLAP_NOTE_EXPRESSION_PRESSURE) {
      if (one_key) return add_midi_on(channel, time, 0xa0, event.key, seven_bits(event.value));
      return add_midi_on(channel, time, 0xd0, seven_bits(event.value), 0);
    }
    if (event.expression_id == CLAP_NOTE_EXPRESSION_BRIGHTNESS) {
      return add_midi_on(channel, time, 0xb0, 74, seven_bits(event.value));
    }
    if (event.expression_id != CLAP_NOTE_EXPRESSION_TUNING || !one_key || !std::isfinite(event.value)) return;
    const int code = tuning_code(event.value);
    add_midi(time, kTuneKeyHigh, event.key, code >> 7);
    add_midi(time, kTuneKeyLow, event.key, code & 0x7f);
  }

  std::array<const clap_event_header_t*, kMaxEvents> events_{};
  std::array<clap_event_midi_t, kMaxMidi> midi_{};
  std::size_t used_ = 0, midi_used_ = 0;
  clap_input_events_t list_{this,
                            [](const clap_input_events_t* list) {
                              return static_cast<std::uint32_t>(static_cast<const Events*>(list->ctx)->used_);
                            },
                            [](const clap_input_events_t* list, std::uint32_t index) -> const clap_event_header_t* {
                              return static_cast<const Events*>(list->ctx)->events_[index];
                            }};
};

struct Plugin {
  clap_plugin_t outer;  // what the host has: first, so that its address is the Plugin's
  const clap_plugin_t* dpf;
  Events events;

  static Plugin& of(const clap_plugin_t* plugin) {
    return *reinterpret_cast<Plugin*>(const_cast<clap_plugin_t*>(plugin));
  }
};

template <class Extension>
const Extension* of_dpf(const clap_plugin_t* plugin, const char* id) {
  return static_cast<const Extension*>(Plugin::of(plugin).dpf->get_extension(Plugin::of(plugin).dpf, id));
}

clap_process_status process(const clap_plugin_t* plugin, const clap_process_t* block) {
  Plugin& ours = Plugin::of(plugin);
  ours.events.take(block->in_events);
  clap_process_t filtered = *block;
  filtered.in_events = ours.events.list();
  return ours.dpf->process(ours.dpf, &filtered);
}

void flush(const clap_plugin_t* plugin, const clap_input_events_t* in, const clap_output_events_t* out) {
  Plugin& ours = Plugin::of(plugin);
  ours.events.take(in);
  of_dpf<clap_plugin_params_t>(plugin, CLAP_EXT_PARAMS)->flush(ours.dpf, ours.events.list(), out);
}

bool save(const clap_plugin_t* plugin, const clap_ostream_t* stream) {
  return of_dpf<clap_plugin_state_t>(plugin, CLAP_EXT_STATE)->save(plugin, stream);
}

// DPF ends a state with 0xfe.
bool load(const clap_plugin_t* plugin, const clap_istream_t* stream) {
  std::string state;
  std::array<char, 65536> piece;
  for (std::int64_t count = 1; count > 0;) {
    count = stream->read(stream, piece.data(), piece.size());
    if (count < 0 || state.size() > kMaxState) return false;
    state.append(piece.data(), static_cast<std::size_t>(count));
  }
  if (state.find('\xfe') == std::string::npos) return false;
  std::string_view rest = state;
  const clap_istream_t whole{&rest, [](const clap_istream_t* self, void* bytes, std::uint64_t size) {
                               auto& left = *static_cast<std::string_view*>(self->ctx);
                               const std::size_t count = std::min<std::size_t>(size, left.size());
                               std::memcpy(bytes, left.data(), count);
                               left.remove_prefix(count);
                               return static_cast<std::int64_t>(count);
                             }};
  return of_dpf<clap_plugin_state_t>(plugin, CLAP_EXT_STATE)->load(plugin, &whole);
}

bool get_note_port(const clap_plugin_t* plugin, std::uint32_t index, bool is_input, clap_note_port_info_t* info) {
  if (!of_dpf<clap_plugin_note_ports_t>(plugin, CLAP_EXT_NOTE_PORTS)->get(plugin, index, is_input, info)) return false;
  info->supported_dialects |= CLAP_NOTE_DIALECT_CLAP | CLAP_NOTE_DIALECT_MIDI_MPE;
  return true;
}

const void* get_extension(const clap_plugin_t* plugin, const char* id) {
  if (std::strcmp(id, CLAP_EXT_STATE) == 0) {
    static const clap_plugin_state_t state{save, load};
    return &state;
  }
  if (std::strcmp(id, CLAP_EXT_PARAMS) == 0) {
    static const clap_plugin_params_t params = [plugin] {
      clap_plugin_params_t changed = *of_dpf<clap_plugin_params_t>(plugin, CLAP_EXT_PARAMS);
      changed.flush = flush;
      return changed;
    }();
    return &params;
  }
  if (std::strcmp(id, CLAP_EXT_NOTE_PORTS) == 0) {
    static const clap_plugin_note_ports_t ports = [plugin] {
      clap_plugin_note_ports_t changed = *of_dpf<clap_plugin_note_ports_t>(plugin, CLAP_EXT_NOTE_PORTS);
      changed.get = get_note_port;
      return changed;
    }();
    return &ports;
  }
  return Plugin::of(plugin).dpf->get_extension(Plugin::of(plugin).dpf, id);
}

void destroy(const clap_plugin_t* plugin) {
  const std::unique_ptr<Plugin> ours(&Plugin::of(plugin));
  ours->dpf->destroy(ours->dpf);
}

const clap_plugin_factory_t* dpf_factory() {
  return static_cast<const clap_plugin_factory_t*>(dpf_clap_entry.get_factory(CLAP_PLUGIN_FACTORY_ID));
}

const clap_plugin_t* create(const clap_plugin_factory_t*, const clap_host_t* host, const char* id) {
  const clap_plugin_descriptor_t* const about = dpf_factory()->get_plugin_descriptor(dpf_factory(), 0);
  if (!host || !id || std::strcmp(id, about->id) != 0) return nullptr;
  const clap_plugin_t* const made = dpf_factory()->create_plugin(dpf_factory(), host, id);
  if (!made) return nullptr;
  auto ours = std::make_unique<Plugin>();
  ours->outer = *made;
  ours->outer.process = process;
  ours->outer.get_extension = get_extension;
  ours->outer.destroy = destroy;
  ours->dpf = made;
  return &ours.release()->outer;
}

const clap_plugin_factory_t kFactory{
    [](const clap_plugin_factory_t*) { return dpf_factory()->get_plugin_count(dpf_factory()); },
    [](const clap_plugin_factory_t*, std::uint32_t index) {
      return index == 0 ? dpf_factory()->get_plugin_descriptor(dpf_factory(), 0) : nullptr;
    },
    create};

const void* get_factory(const char* id) { return std::strcmp(id, CLAP_PLUGIN_FACTORY_ID) == 0 ? &kFactory : nullptr; }

}  // namespace

extern "C" CLAP_EXPORT const clap_plugin_entry_t clap_entry = {
    CLAP_VERSION, [](const char* path) { return dpf_clap_entry.init(path); }, [] { dpf_clap_entry.deinit(); },
    get_factory};
