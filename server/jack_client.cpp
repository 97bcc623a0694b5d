#include "server/jack_client.h"

#include "server/log.h"

#include <jack/jack.h>
#include <jack/metadata.h>
#include <jack/midiport.h>
#include <jack/thread.h>
#include <jack/uuid.h>
#include <algorithm>
#include <bit>
#include <cerrno>
#include <string>
#include <utility>

namespace ringdown::server {
namespace {

constexpr std::size_t kLeft = 0, kRight = 1, kFirstBus = 2;

// Silences libjack's own messages, which would repeat what our log says.
void quiet(const char*) {}

// JACK metadata: what patchbays show of a port in addition to its name. Not an error if the server does not keep it.
struct PortDescription {
  std::string pretty_name;
  std::string group;  // ports of one group stand together
  int order = 0;      // among our ports, from 0
};

void describe(jack_client_t* client, jack_port_t* port, const PortDescription& description) {
  constexpr const char* kText = "text/plain";
  constexpr const char* kInteger = "http://www.w3.org/2001/XMLSchema#integer";
  const jack_uuid_t id = jack_port_uuid(port);
  if (jack_uuid_empty(id)) return;
  jack_set_property(client, id, JACK_METADATA_PRETTY_NAME, description.pretty_name.c_str(), kText);
  jack_set_property(client, id, JACK_METADATA_PORT_GROUP, description.group.c_str(), kText);
  jack_set_property(client, id, JACK_METADATA_ORDER, std::to_string(description.order).c_str(), kInteger);
}

// Called before a port is unregistered or the client is closed: servers keep the metadata of ports that are gone.
void forget_description(jack_client_t* client, jack_port_t* port) {
  const jack_uuid_t id = jack_port_uuid(port);
  if (!jack_uuid_empty(id)) jack_remove_properties(client, id);
}

JackClient* self(void* client) { return static_cast<JackClient*>(client); }

// JACK made these for the process callback: they read memory that is shared with the server.
TRUST_REALTIME_BEGIN
void* buffer_of(jack_port_t* port, std::uint32_t frames) REALTIME { return jack_port_get_buffer(port, frames); }

std::uint32_t block_start(const jack_client_t* client) REALTIME { return jack_last_frame_time(client); }

std::uint32_t count_notes(void* buffer) REALTIME { return jack_midi_get_event_count(buffer); }

bool take_note(jack_midi_event_t& event, void* buffer, std::uint32_t number) REALTIME {
  return jack_midi_event_get(&event, buffer, number) == 0;
}
TRUST_REALTIME_END

}  // namespace

std::unique_ptr<JackClient> JackClient::open(const std::string& name, std::shared_ptr<LoadMeter> meter,
                                             std::shared_ptr<session::MidiPlayer> midi,
                                             std::function<void()> on_change) {
  jack_set_error_function(quiet);
  jack_set_info_function(quiet);
  jack_client_t* handle = jack_client_open(name.c_str(), JackNoStartServer, nullptr);
  if (!handle) return nullptr;
  std::unique_ptr<JackClient> client(new JackClient(handle, std::move(meter), std::move(midi), std::move(on_change)));
  client->set_callbacks();
  if (!client->add_port(kLeft, "out_left") || !client->add_port(kRight, "out_right")) return nullptr;
  client->midi_port_ = jack_port_register(handle, "midi_in", JACK_DEFAULT_MIDI_TYPE, JackPortIsInput, 0);
  return client;
}

JackClient::JackClient(jack_client_t* client, std::shared_ptr<LoadMeter> meter,
                       std::shared_ptr<session::MidiPlayer> midi, std::function<void()> on_change)
    : client_(client), meter_(std::move(meter)), midi_(std::move(midi)), on_change_(std::move(on_change)) {}

JackClient::~JackClient() {
  stop();
  const auto forget = [this](jack_port_t* port) {
    if (port && !lost_) forget_description(client_, port);
  };
  for (jack_port_t* port : ports_) forget(port);
  for (jack_port_t* port : inputs_) forget(port);
  jack_client_close(client_);
}

void JackClient::set_callbacks() {
  jack_set_process_callback(
      client_,
      [](jack_nframes_t frames, void* us) {
        JackClient& client = *self(us);
        ++client.calls_;
        client.freewheels_ ? client.process_offline(frames) : client.process(frames);
        ++client.calls_;
        return 0;
      },
      this);
  jack_set_xrun_callback(
      client_, [](void* us) { return self(us)->meter_->note_xrun(), 0; }, this);
  jack_set_freewheel_callback(
      client_, [](int starting, void* us) { self(us)->freewheels_ = starting != 0; }, this);
  jack_set_port_connect_callback(
      client_, [](jack_port_id_t, jack_port_id_t, int, void* us) { self(us)->on_change_(); }, this);
  jack_set_port_registration_callback(
      client_, [](jack_port_id_t, int, void* us) { self(us)->on_change_(); }, this);
  jack_set_latency_callback(
      client_,
      [](jack_latency_callback_mode_t mode, void* us) {
        if (mode == JackCaptureLatency) self(us)->tell_latency();
      },
      this);
  jack_on_shutdown(
      client_,
      [](void* us) {
        self(us)->lost_ = true;
        self(us)->on_change_();
      },
      this);
}

bool JackClient::add_port(std::size_t channel, const std::string& name) {
  constexpr auto kFlags = JackPortIsOutput | JackPortIsTerminal;
  jack_port_t* const port = jack_port_register(client_, name.c_str(), JACK_DEFAULT_AUDIO_TYPE, kFlags, 0);
  if (!port) return false;
  const bool ambisonic = channel >= synth::kFirstAmbisonic;
  const std::string acn = std::to_string(channel - synth::kFirstAmbisonic);
  describe(client_, port,
           {.pretty_name = channel == kLeft    ? "Mix left"
                           : channel == kRight ? "Mix right"
                           : ambisonic         ? "AmbiX " + acn + " (ACN, SN3D)"
                                               : name,
            .group = channel < kFirstBus ? "Mix"
                     : ambisonic         ? "Ambisonics"
                                         : "Objects",
            .order = static_cast<int>(channel)});
  ports_[channel] = port;
  return true;
}

// Reports latencies to JACK. The limiter delays the mix, but not the buses.
void JackClient::tell_latency() {
  const auto late = static_cast<jack_nframes_t>(program_ ? program_->mixer.latency_frames() : 0);
  for (std::size_t channel = 0; channel < ports_.size(); ++channel) {
    jack_latency_range_t range{.min = channel < kFirstBus ? late : 0, .max = channel < kFirstBus ? late : 0};
    if (jack_port_t* const port = ports_[channel]) jack_port_set_latency_range(port, JackCaptureLatency, &range);
  }
}

void JackClient::remove_port(std::size_t channel) {
  jack_port_t* const port = ports_[channel].exchange(nullptr);
  if (!port) return;
  gate_.wait();
  forget_description(client_, port);
  jack_port_unregister(client_, port);
}

void JackClient::show_buses(const std::map<std::size_t, std::string>& names) {
  for (const auto& [bus, name] : buses_) {
    const auto now = names.find(bus);
    if (now == names.end() || now->second != name) remove_port(kFirstBus + bus);
  }
  for (const auto& [bus, name] : names) {
    const auto before = buses_.find(bus);
    if (before != buses_.end() && before->second == name) continue;
    if (!add_port(kFirstBus + bus, name)) log_warning("JACK has no port for " + name + ": it is heard in the mix only");
  }
  buses_ = names;
}

bool JackClient::add_input(std::size_t input) {
  const std::string number = std::to_string(input + 1);
  jack_port_t* const port =
      jack_port_register(client_, ("in_" + number).c_str(), JACK_DEFAULT_AUDIO_TYPE, JackPortIsInput, 0);
  if (!port) return false;
  describe(
      client_, port,
      {.pretty_name = "Excite " + number, .group = "Inputs", .order = static_cast<int>(synth::kMaxChannels + input)});
  inputs_[input] = port;
  return true;
}

void JackClient::show_inputs(std::uint32_t inputs) {
  if (std::exchange(shown_inputs_, inputs) == inputs) return;
  for (std::size_t input = 0; input < inputs_.size(); ++input) {
    if ((inputs >> input & 1) == 0 || inputs_[input] || add_input(input)) continue;
    log_warning(formatted("JACK has no port for input {}", input + 1));
  }
}

// jackd takes one byte less than libjack says.
std::size_t max_jack_name_length() { return static_cast<std::size_t>(jack_client_name_size()) - 2; }

std::string JackClient::name() const { return jack_get_client_name(client_); }
double JackClient::sample_rate_hz() const { return jack_get_sample_rate(client_); }
std::size_t JackClient::block_frames() const { return jack_get_buffer_size(client_); }

int JackClient::priority() const {
  return jack_is_realtime(client_) != 0 ? std::max(jack_client_real_time_priority(client_), 0) : 0;
}

Result<void> JackClient::start(const Driver::Program& program) {
  program_ = &program;
  if (const auto order = program.mixer.settings().ambisonic_order) {
    for (std::size_t acn = 0; acn < synth::ambisonic_channels(*order); ++acn) {
      if (add_port(synth::kFirstAmbisonic + acn, formatted("ambisonic_{}", acn))) continue;
      return fail(ErrorKind::no_sound_server, "the JACK server has no free port for ambisonic channel {}", acn);
    }
  }
  gate_.open();
  if (jack_activate(client_) == 0) return {};
  gate_.shut();
  return fail(ErrorKind::no_sound_server, "the JACK server refused to start the client; see its own messages");
}

// JACK counts frames in 32 bits since its server started; the mixer counts in 64 bits since it was made. `offset_` is
// their difference modulo 2^32, renewed in every callback because an xrun moves JACK's count but not ours. JACK's count
// also continues while no callback runs; ours is then held back, or the scene would run ahead of the sound.
synth::Frame JackClient::now() const {
  const synth::Frame rendered = program_->mixer.counters().frames.load(std::memory_order_acquire);
  const std::int64_t offset = offset_.load(std::memory_order_relaxed);
  if (offset == kUnknown || freewheels_) return rendered;
  const auto low = static_cast<std::uint32_t>(jack_frame_time(client_)) - static_cast<std::uint32_t>(offset);
  const auto ahead = static_cast<std::int32_t>(low - static_cast<std::uint32_t>(rendered));
  return rendered + std::min(ahead, static_cast<std::int32_t>(block_frames()));
}

void JackClient::process(std::uint32_t frames) REALTIME {
  if (gate_.enter()) {
    render(frames, true);
  } else {
    write_silence(frames);
    next_start_ = kUnknown;
  }
  gate_.leave();
}

void JackClient::process_offline(std::uint32_t frames) {
  if (gate_.enter()) {
    program_->prepare_offline(program_->mixer.counters().frames.load(std::memory_order_relaxed) + frames);
    note_listeners();  // the driver's thread would notice a new connection many blocks too late
    render(frames, false);
  } else {
    write_silence(frames);
  }
  gate_.leave();
}

void JackClient::render(std::uint32_t frames, bool deadline) REALTIME {
  synth::Mixer& mixer = program_->mixer;
  const synth::Frame rendered = mixer.counters().frames.load(std::memory_order_relaxed);
  meter_->begin(frames, mixer.sample_rate_hz());
  const std::uint32_t start = block_start(client_);
  if (deadline && next_start_ != kUnknown) {
    const auto skipped = static_cast<std::int32_t>(start - static_cast<std::uint32_t>(next_start_));
    if (skipped > 0) meter_->note_skipped(skipped / mixer.sample_rate_hz());
  }
  next_start_ = deadline ? static_cast<std::int64_t>(start + frames) : kUnknown;
  offset_.store(start - static_cast<std::uint32_t>(rendered), std::memory_order_relaxed);
  play_notes(frames, rendered);
  synth::Outputs outputs;
  for (synth::ChannelSet rest = listened_.load(); rest != 0; rest &= rest - 1) {
    const auto channel = static_cast<std::size_t>(std::countr_zero(rest));
    jack_port_t* const port = ports_[channel];
    if (!port) continue;
    auto* const samples = static_cast<float*>(buffer_of(port, frames));
    if (channel < kFirstBus) {
      outputs.listen_to_mix(channel, samples);
    } else if (channel >= synth::kFirstAmbisonic) {
      outputs.listen_to_ambisonics(channel - synth::kFirstAmbisonic, samples);
    } else {
      outputs.listen_to_bus(channel - kFirstBus, samples);
    }
  }
  mixer.keep_deadlines(deadline);
  mixer.render(outputs, read_inputs(frames), frames);
  meter_->end(deadline);
}

synth::Inputs JackClient::read_inputs(std::uint32_t frames) REALTIME {
  synth::Inputs inputs{};
  const std::uint32_t fed = fed_;
  for (std::size_t input = 0; input < inputs.size(); ++input) {
    jack_port_t* const port = fed >> input & 1 ? inputs_[input].load() : nullptr;
    if (port) inputs[input] = static_cast<const float*>(buffer_of(port, frames));
  }
  return inputs;
}

void JackClient::play_notes(std::uint32_t frames, synth::Frame first) REALTIME {
  const session::NoteTable* const notes = notes_;
  if (!midi_port_ || !notes) return;
  void* const buffer = buffer_of(midi_port_, frames);
  const std::uint32_t count = count_notes(buffer);
  for (std::uint32_t i = 0; i < count; ++i) {
    jack_midi_event_t event;
    if (!take_note(event, buffer, i)) continue;
    midi_->play({event.buffer, event.size}, first + event.time, *notes, program_->mixer, program_->notes_played);
  }
}

void JackClient::set_notes(std::shared_ptr<const session::NoteTable> notes) {
  if (notes == table_) return;
  notes_ = notes.get();
  gate_.wait();
  table_ = std::move(notes);
}

void JackClient::write_silence(std::uint32_t frames) REALTIME {
  for (synth::ChannelSet rest = listened_.load(); rest != 0; rest &= rest - 1) {
    jack_port_t* const port = ports_[static_cast<std::size_t>(std::countr_zero(rest))];
    if (port) std::fill_n(static_cast<float*>(buffer_of(port, frames)), frames, 0.0f);
  }
}

std::set<JackConnection> JackClient::connections() const {
  std::set<JackConnection> found;
  const auto look_at = [&found](const jack_port_t* port) {
    const char** others = port ? jack_port_get_connections(port) : nullptr;
    for (std::size_t i = 0; others && others[i]; ++i) found.insert({jack_port_short_name(port), others[i]});
    jack_free(others);
  };
  for (const auto& port : ports_) look_at(port);
  for (const auto& port : inputs_) look_at(port);
  look_at(midi_port_);
  return found;
}

bool JackClient::connect(const JackConnection& connection) {
  const std::string ours = name() + ":" + connection.ours;
  const jack_port_t* port = jack_port_by_name(client_, ours.c_str());
  if (!port || !jack_port_by_name(client_, connection.theirs.c_str())) return false;
  const bool out = (jack_port_flags(port) & JackPortIsOutput) != 0;
  const int failed = jack_connect(client_, out ? ours.c_str() : connection.theirs.c_str(),
                                  out ? connection.theirs.c_str() : ours.c_str());
  return failed == 0 || failed == EEXIST;
}

std::vector<std::string> JackClient::others(Others kind) const {
  const bool is_audio = kind == Others::speakers, is_program = kind == Others::midi_sources;
  const unsigned long flags = (is_audio ? JackPortIsInput : JackPortIsOutput) | (is_program ? 0 : JackPortIsPhysical);
  const char** ports =
      jack_get_ports(client_, nullptr, is_audio ? JACK_DEFAULT_AUDIO_TYPE : JACK_DEFAULT_MIDI_TYPE, flags);
  std::vector<std::string> names;
  for (std::size_t i = 0; ports && ports[i]; ++i) names.emplace_back(ports[i]);
  jack_free(static_cast<void*>(ports));
  return names;
}

void JackClient::note_listeners() {
  synth::ChannelSet listened = 0;
  for (std::size_t channel = 0; channel < ports_.size(); ++channel) {
    const jack_port_t* port = ports_[channel];
    if (port && jack_port_connected(port) > 0) listened |= synth::only(channel);
  }
  listened_ = listened;
  std::uint32_t fed = 0;
  for (std::size_t input = 0; input < inputs_.size(); ++input) {
    const jack_port_t* port = inputs_[input];
    if (port && jack_port_connected(port) > 0) fed |= 1u << input;
  }
  fed_ = fed;
}

}  // namespace ringdown::server
