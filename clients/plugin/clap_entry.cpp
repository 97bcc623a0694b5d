// The CLAP plug-in's entry: a layer in front of DPF's entry that adds what DPF 1.6 lacks.
//
// - Events pass through clap_events.h, so that note expressions and modulation act.
// - Parameters have units, names and groups; their texts are those of parameter_text.h.
// - process() lets the host sleep while nothing sounds, the worker has nothing to do and no window is open.
// - A state is read and written in pieces of any size; DPF takes a short piece for the end of a text, and writes the
//   beginning again after a short one.
// - Notes may come as CLAP's own, which note expressions need, or as MPE.
// - Extensions: tail, latency, voice info, note names, remote controls, state context, loading of presets.
//
// DPF's entry is compiled under the name dpf_clap_entry. Our plug-in is a copy of DPF's struct with a few functions
// replaced; the others find their instance in the struct as before.
#include "clients/plugin/clap_abi.h"
#include "clients/plugin/clap_events.h"
#include "clients/plugin/clap_presets.h"
#include "clients/plugin/instrument.h"
#include "clients/plugin/parameter_text.h"
#include "engine/base/version.h"

#include "src/clap/entry.h"
#include "src/clap/ext/audio-ports.h"
#include "src/clap/ext/gui.h"
#include "src/clap/ext/note-ports.h"
#include "src/clap/ext/params.h"
#include "src/clap/ext/state.h"
#include "src/clap/plugin-factory.h"

#include <algorithm>
#include <array>
#include <atomic>
#include <cmath>
#include <cstring>
#include <limits>
#include <memory>
#include <string>
#include <string_view>
#include <system_error>

extern "C" const clap_plugin_entry_t dpf_clap_entry;

namespace {

using namespace ringdown::plugin;
namespace clap = ringdown::plugin::clap;

constexpr std::size_t kMaxState = std::size_t{256} << 20;  // bytes
constexpr double kTailStep = 0.1;                          // relative change of the tail that the host is told of

struct Plugin {
  clap_plugin_t outer;  // what the host has: first, so that its address is the Plugin's
  const clap_plugin_t* dpf;
  const clap_host_t* host;
  Instrument* instrument;
  clap::Events events;
  double sample_rate_hz = 0;
  std::atomic<bool> has_window = false;
  double told_tail_s = 0;              // [audio] the tail that the host was last told of
  std::uint64_t asked_generation = 0;  // [audio] the keys' map for which the main thread was called
  std::uint64_t told_generation = 0;   // [main] the keys' map whose names the host knows
  std::vector<std::pair<std::size_t, std::string>> key_names;  // [main]

  static Plugin& of(const clap_plugin_t* plugin) {
    return *reinterpret_cast<Plugin*>(const_cast<clap_plugin_t*>(plugin));
  }
  // Returns the host's functions for an extension; null if it has none.
  template <class Extension>
  [[nodiscard]] const Extension* of_host(const char* id) const {
    return static_cast<const Extension*>(host->get_extension(host, id));
  }
};

template <class Extension>
const Extension* of_dpf(const clap_plugin_t* plugin, const char* id) {
  return static_cast<const Extension*>(Plugin::of(plugin).dpf->get_extension(Plugin::of(plugin).dpf, id));
}

void copy_text(std::string_view text, char* target, std::size_t size) {
  const std::size_t count = std::min(text.size(), size - 1);
  std::memcpy(target, text.data(), count);
  target[count] = 0;
}

// The plug-in's own functions

bool activate(const clap_plugin_t* plugin, double sample_rate_hz, std::uint32_t min_frames, std::uint32_t max_frames) {
  Plugin& ours = Plugin::of(plugin);
  ours.sample_rate_hz = sample_rate_hz;
  ours.asked_generation = 0;
  return ours.dpf->activate(ours.dpf, sample_rate_hz, min_frames, max_frames);
}

void reset(const clap_plugin_t* plugin) { Plugin::of(plugin).instrument->silence(); }

// Tells the host of changes that it may not have noticed. [audio]
void report_changes(Plugin& ours) {
  if (const double tail_s = ours.instrument->tail_s();
      std::abs(tail_s - ours.told_tail_s) > kTailStep * ours.told_tail_s) {
    ours.told_tail_s = tail_s;
    if (const auto* tail = ours.of_host<clap::HostTail>(clap::Tail::kId)) tail->changed(ours.host);
  }
  if (const std::uint64_t generation = ours.instrument->generation(); generation != ours.asked_generation) {
    ours.asked_generation = generation;
    ours.host->request_callback(ours.host);
  }
}

clap_process_status process(const clap_plugin_t* plugin, const clap_process_t* block) {
  Plugin& ours = Plugin::of(plugin);
  ours.events.take(block->in_events, ours.instrument->parameters());
  clap_process_t filtered = *block;
  filtered.in_events = ours.events.list();
  sayings_of_block() = &ours.events.sayings();
  const clap_process_status status = ours.dpf->process(ours.dpf, &filtered);
  sayings_of_block() = nullptr;
  if (status == CLAP_PROCESS_ERROR) return CLAP_PROCESS_ERROR;
  report_changes(ours);
  const bool sleeps = ours.events.empty() && ours.instrument->is_idle() && !ours.has_window;
  for (std::uint32_t i = 0; i < block->audio_outputs_count; ++i) block->audio_outputs[i].constant_mask = sleeps ? 3 : 0;
  return sleeps ? CLAP_PROCESS_SLEEP : CLAP_PROCESS_CONTINUE;
}

void on_main_thread(const clap_plugin_t* plugin) {
  Plugin& ours = Plugin::of(plugin);
  if (const std::uint64_t generation = ours.instrument->generation(); generation != ours.told_generation) {
    ours.told_generation = generation;
    ours.key_names = ours.instrument->key_names();
    if (const auto* names = ours.of_host<clap::HostNoteNames>(clap::NoteNames::kId)) names->changed(ours.host);
    if (const auto* voices = ours.of_host<clap::HostVoiceInfo>(clap::VoiceInfo::kId)) voices->changed(ours.host);
  }
  ours.dpf->on_main_thread(ours.dpf);
}

// Parameters

bool get_parameter_info(const clap_plugin_t*, std::uint32_t index, clap_param_info_t* about) {
  if (index >= kParameters) return false;
  const ParameterInfo& info = kParameterInfo[index];
  *about = {};
  about->id = index;
  about->flags = info.scale == Scale::output ? CLAP_PARAM_IS_READONLY : CLAP_PARAM_IS_AUTOMATABLE;
  if (info.scale == Scale::whole || info.scale == Scale::choice || info.scale == Scale::toggle) {
    about->flags |= CLAP_PARAM_IS_STEPPED;
  }
  if (is_modulatable(info)) about->flags |= CLAP_PARAM_IS_MODULATABLE;
  copy_text(info.name, about->name, sizeof about->name);
  copy_text(kGroupInfo[static_cast<std::size_t>(info.group)].name, about->module, sizeof about->module);
  about->min_value = static_cast<double>(info.min);
  about->max_value = static_cast<double>(info.max);
  about->default_value = static_cast<double>(info.standard);
  return true;
}

bool get_value(const clap_plugin_t* plugin, clap_id id, double* value) {
  if (id >= kParameters) return false;
  *value = static_cast<double>(Plugin::of(plugin).instrument->parameters().get(id));
  return true;
}

bool value_to_text(const clap_plugin_t*, clap_id id, double value, char* text, std::uint32_t size) {
  if (id >= kParameters || size == 0) return false;
  copy_text(text_of(id, value), text, size);
  return true;
}

bool text_to_value(const clap_plugin_t*, clap_id id, const char* text, double* value) {
  const auto found = text ? value_of(id, text) : std::nullopt;
  if (found) *value = *found;
  return found.has_value();
}

void flush(const clap_plugin_t* plugin, const clap_input_events_t* in, const clap_output_events_t* out) {
  Plugin& ours = Plugin::of(plugin);
  ours.events.take(in, ours.instrument->parameters());
  of_dpf<clap_plugin_params_t>(plugin, CLAP_EXT_PARAMS)->flush(ours.dpf, ours.events.list(), out);
  if (!ours.events.empty()) ours.host->request_process(ours.host);  // another object is installed between blocks only
}

const clap_plugin_params_t kParams{[](const clap_plugin_t*) { return std::uint32_t{kParameters}; },
                                   get_parameter_info,
                                   get_value,
                                   value_to_text,
                                   text_to_value,
                                   flush};

// State

bool save(const clap_plugin_t* plugin, const clap_ostream_t* stream) {
  std::string state;
  const clap_ostream_t whole{&state, [](const clap_ostream_t* self, const void* bytes, std::uint64_t size) {
                               static_cast<std::string*>(self->ctx)->append(static_cast<const char*>(bytes), size);
                               return static_cast<std::int64_t>(size);
                             }};
  if (!of_dpf<clap_plugin_state_t>(plugin, CLAP_EXT_STATE)->save(plugin, &whole)) return false;
  for (std::string_view left = state; !left.empty();) {
    const std::int64_t count = stream->write(stream, left.data(), left.size());
    if (count <= 0) return false;
    left.remove_prefix(std::min(left.size(), static_cast<std::size_t>(count)));
  }
  return true;
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

const clap_plugin_state_t kState{save, load};

// A project, a preset and a duplicate hold the same: everything.
const clap::StateContext kStateContext{
    [](const clap_plugin_t* plugin, const clap_ostream_t* stream, std::uint32_t) { return save(plugin, stream); },
    [](const clap_plugin_t* plugin, const clap_istream_t* stream, std::uint32_t) { return load(plugin, stream); }};

// The name of a failure, or nothing.
std::string load_preset(Plugin& ours, std::uint32_t kind, const char* location, const char* key) {
  if (kind == clap::kInPlugin && key) {
    const auto* const found = std::find(kPresets.begin(), kPresets.end(), std::string_view(key));
    if (found == kPresets.end()) return ringdown::formatted("there is no preset '{}'", key);
    ours.instrument->load_preset(static_cast<std::size_t>(found - kPresets.begin()));
    return "";
  }
  if (kind != clap::kFile || !location) return "presets are named by a key, or by a file";
  std::error_code error;
  if (!std::filesystem::is_regular_file(location, error)) {
    return ringdown::formatted("{}: this file cannot be read", location);
  }
  ours.instrument->set_file(location);
  ours.instrument->parameters().set(Parameter::object, 0);
  return "";
}

bool load_from(const clap_plugin_t* plugin, std::uint32_t kind, const char* location, const char* key) {
  Plugin& ours = Plugin::of(plugin);
  const std::string failure = load_preset(ours, kind, location, key);
  const auto* host = ours.of_host<clap::HostPresetLoad>(clap::PresetLoad::kIds[0]);
  if (!host) host = ours.of_host<clap::HostPresetLoad>(clap::PresetLoad::kIds[1]);
  if (!failure.empty()) {
    if (host) host->on_error(ours.host, kind, location, key, 0, failure.c_str());
    return false;
  }
  if (const auto* params = ours.of_host<clap_host_params_t>(CLAP_EXT_PARAMS)) {
    params->rescan(ours.host, CLAP_PARAM_RESCAN_VALUES | CLAP_PARAM_RESCAN_TEXT);
  }
  ours.host->request_process(ours.host);
  if (host) host->loaded(ours.host, kind, location, key);
  return true;
}

const clap::PresetLoad kPresetLoad{load_from};

// The window

// An edit in a window reaches the plug-in in process(), so a sleeping plug-in is woken.
bool create_window(const clap_plugin_t* plugin, const char* api, bool floats) {
  Plugin& ours = Plugin::of(plugin);
  if (!of_dpf<clap_plugin_gui_t>(plugin, CLAP_EXT_GUI)->create(ours.dpf, api, floats)) return false;
  ours.has_window = true;
  ours.host->request_process(ours.host);
  return true;
}

void destroy_window(const clap_plugin_t* plugin) {
  Plugin& ours = Plugin::of(plugin);
  ours.has_window = false;
  of_dpf<clap_plugin_gui_t>(plugin, CLAP_EXT_GUI)->destroy(ours.dpf);
}

// Returns DPF's functions with ours among them; null if it was built without a window.
const clap_plugin_gui_t* window_of(const clap_plugin_t* plugin) {
  const auto* const dpf = of_dpf<clap_plugin_gui_t>(plugin, CLAP_EXT_GUI);
  if (!dpf) return nullptr;
  static const clap_plugin_gui_t ours = [dpf] {
    clap_plugin_gui_t changed = *dpf;
    changed.create = create_window;
    changed.destroy = destroy_window;
    return changed;
  }();
  return &ours;
}

// The plug-in about itself

bool get_audio_port(const clap_plugin_t* plugin, std::uint32_t index, bool is_input, clap_audio_port_info_t* about) {
  if (is_input || index > 0) return false;
  if (!of_dpf<clap_plugin_audio_ports_t>(plugin, CLAP_EXT_AUDIO_PORTS)->get(plugin, index, is_input, about))
    return false;
  about->port_type = CLAP_PORT_STEREO;
  return true;
}

const clap_plugin_audio_ports_t kAudioPorts{
    [](const clap_plugin_t*, bool is_input) { return std::uint32_t{is_input ? 0U : 1U}; }, get_audio_port};

bool get_note_port(const clap_plugin_t* plugin, std::uint32_t index, bool is_input, clap_note_port_info_t* about) {
  if (!is_input || index > 0) return false;
  if (!of_dpf<clap_plugin_note_ports_t>(plugin, CLAP_EXT_NOTE_PORTS)->get(plugin, index, is_input, about)) return false;
  about->supported_dialects |= CLAP_NOTE_DIALECT_CLAP | CLAP_NOTE_DIALECT_MIDI_MPE;
  return true;
}

const clap_plugin_note_ports_t kNotePorts{
    [](const clap_plugin_t*, bool is_input) { return std::uint32_t{is_input ? 1U : 0U}; }, get_note_port};

const clap::Tail kTail{[](const clap_plugin_t* plugin) {
  const Plugin& ours = Plugin::of(plugin);
  constexpr double kMax = std::numeric_limits<std::int32_t>::max();
  return static_cast<std::uint32_t>(std::min(kMax, std::ceil(ours.instrument->tail_s() * ours.sample_rate_hz)));
}};

const clap::Latency kLatency{[](const clap_plugin_t*) { return std::uint32_t{0}; }};

const clap::VoiceInfo kVoiceInfo{[](const clap_plugin_t* plugin, clap::Voices* voices) {
  *voices = {static_cast<std::uint32_t>(Plugin::of(plugin).instrument->voices()), std::uint32_t{kKeys}, 0};
  return true;
}};

const clap::NoteNames kNoteNames{[](const clap_plugin_t* plugin) {
                                   Plugin& ours = Plugin::of(plugin);
                                   ours.key_names = ours.instrument->key_names();
                                   return static_cast<std::uint32_t>(ours.key_names.size());
                                 },
                                 [](const clap_plugin_t* plugin, std::uint32_t index, clap::NoteName* name) {
                                   const Plugin& ours = Plugin::of(plugin);
                                   if (index >= ours.key_names.size()) return false;
                                   copy_text(ours.key_names[index].second, name->name, sizeof name->name);
                                   name->port = name->channel = -1;
                                   name->key = static_cast<std::int16_t>(ours.key_names[index].first);
                                   return true;
                                 }};

struct Page {
  const char *section, *name;
  std::array<Parameter, clap::kControlsOfPage> parameters;
};
constexpr std::array<Page, 2> kPages = {
    {{"Play",
      "Play",
      {Parameter::mallet, Parameter::strike_point, Parameter::contact_time, Parameter::release, Parameter::hand,
       Parameter::loss, Parameter::gain, Parameter::width}},
     {"Object",
      "Object",
      {Parameter::object, Parameter::tuning, Parameter::root_key, Parameter::size, Parameter::stiffness,
       Parameter::density, Parameter::loss, Parameter::even_loudness}}}};

const clap::RemoteControls kRemoteControls{
    [](const clap_plugin_t*) { return static_cast<std::uint32_t>(kPages.size()); },
    [](const clap_plugin_t*, std::uint32_t index, clap::ControlPage* page) {
      if (index >= kPages.size()) return false;
      *page = {};
      copy_text(kPages[index].section, page->section, sizeof page->section);
      copy_text(kPages[index].name, page->name, sizeof page->name);
      page->id = index;
      std::transform(kPages[index].parameters.begin(), kPages[index].parameters.end(), page->parameters,
                     [](Parameter parameter) { return static_cast<clap_id>(parameter); });
      return true;
    }};

struct NamedExtension {
  std::string_view id;
  const void* functions;
};
const std::array kExtensions = std::to_array<NamedExtension>({
    {CLAP_EXT_PARAMS, &kParams},
    {CLAP_EXT_STATE, &kState},
    {CLAP_EXT_AUDIO_PORTS, &kAudioPorts},
    {CLAP_EXT_NOTE_PORTS, &kNotePorts},
    {clap::StateContext::kId, &kStateContext},
    {clap::PresetLoad::kIds[0], &kPresetLoad},
    {clap::PresetLoad::kIds[1], &kPresetLoad},
    {clap::Tail::kId, &kTail},
    {clap::Latency::kId, &kLatency},
    {clap::VoiceInfo::kId, &kVoiceInfo},
    {clap::NoteNames::kId, &kNoteNames},
    {clap::RemoteControls::kIds[0], &kRemoteControls},
    {clap::RemoteControls::kIds[1], &kRemoteControls},
});

const void* get_extension(const clap_plugin_t* plugin, const char* id) {
  if (std::strcmp(id, CLAP_EXT_GUI) == 0) return window_of(plugin);
  for (const NamedExtension& extension : kExtensions) {
    if (extension.id == id) return extension.functions;
  }
  return Plugin::of(plugin).dpf->get_extension(Plugin::of(plugin).dpf, id);
}

void destroy(const clap_plugin_t* plugin) {
  const std::unique_ptr<Plugin> ours(&Plugin::of(plugin));
  ours->dpf->destroy(ours->dpf);
}

// The library

const clap_plugin_factory_t* dpf_factory() {
  return static_cast<const clap_plugin_factory_t*>(dpf_clap_entry.get_factory(CLAP_PLUGIN_FACTORY_ID));
}

const clap_plugin_descriptor_t& about() {
  static const clap_plugin_descriptor_t described = [] {
    clap_plugin_descriptor_t changed = *dpf_factory()->get_plugin_descriptor(dpf_factory(), 0);
    changed.version = ringdown::kVersion;
    return changed;
  }();
  return described;
}

const clap_plugin_t* create(const clap_plugin_factory_t*, const clap_host_t* host, const char* id) {
  if (!host || !id || std::strcmp(id, clap::kPluginId) != 0) return nullptr;
  const clap_plugin_t* const made = dpf_factory()->create_plugin(dpf_factory(), host, id);
  if (!made) return nullptr;
  auto ours = std::make_unique<Plugin>();
  ours->outer = *made;
  ours->outer.desc = &about();
  ours->outer.activate = activate;
  ours->outer.reset = reset;
  ours->outer.process = process;
  ours->outer.get_extension = get_extension;
  ours->outer.on_main_thread = on_main_thread;
  ours->outer.destroy = destroy;
  ours->dpf = made;
  ours->host = host;
  ours->instrument = Instrument::newest();
  return &ours.release()->outer;
}

const clap_plugin_factory_t kFactory{
    [](const clap_plugin_factory_t*) { return std::uint32_t{1}; },
    [](const clap_plugin_factory_t*, std::uint32_t index) { return index == 0 ? &about() : nullptr; }, create};

std::filesystem::path& own_path() {
  static std::filesystem::path path;
  return path;
}

bool open(const char* path) {
  own_path() = path ? path : "";
  return dpf_clap_entry.init(path);
}

const void* get_factory(const char* id) {
  if (std::strcmp(id, CLAP_PLUGIN_FACTORY_ID) == 0) return &kFactory;
  for (const char* const known : clap::PresetFactory::kIds) {
    if (std::strcmp(id, known) == 0) return clap::preset_factory(own_path());
  }
  return nullptr;
}

}  // namespace

extern "C" CLAP_EXPORT const clap_plugin_entry_t clap_entry = {CLAP_VERSION, open, [] { dpf_clap_entry.deinit(); },
                                                               get_factory};
