#include "tests/integration/jack_recorder.h"

#include "tests/integration/daemon_fixture.h"

#include <jack/jack.h>
#include <jack/midiport.h>

#include <algorithm>
#include <cerrno>

namespace ringdown::test {

JackRecorder::JackRecorder(const std::string& server, const std::string& name, std::size_t frames, From from)
    : from_(from) {
  for (auto& track : tracks_) track.resize(frames);
  const auto options = static_cast<jack_options_t>(JackNoStartServer | JackServerName);
  client_ = jack_client_open(name.c_str(), options, nullptr, server.c_str());
  if (!client_) return;
  for (std::size_t i = 0; i < ports_.size(); ++i) {
    ports_[i] = jack_port_register(client_, i == 0 ? "in_1" : "in_2", JACK_DEFAULT_AUDIO_TYPE, JackPortIsInput, 0);
  }
  midi_out_ = jack_port_register(client_, "midi_out", JACK_DEFAULT_MIDI_TYPE, JackPortIsOutput | JackPortIsPhysical, 0);
  audio_out_ = jack_port_register(client_, "audio_out", JACK_DEFAULT_AUDIO_TYPE, JackPortIsOutput, 0);
  jack_set_process_callback(
      client_, [](jack_nframes_t count, void* self) { return static_cast<JackRecorder*>(self)->process(count); }, this);
  jack_set_freewheel_callback(
      client_, [](int on, void* self) { static_cast<JackRecorder*>(self)->freewheels_ = on != 0; }, this);
  jack_activate(client_);
}

JackRecorder::~JackRecorder() {
  if (!client_) return;
  if (freewheels_) freewheel(false);
  jack_client_close(client_);
}

bool JackRecorder::connect(const std::string& from, const std::string& to) {
  const int error = jack_connect(client_, from.c_str(), to.c_str());
  return (error == 0 || error == EEXIST) && let_pass(4);
}

void JackRecorder::freewheel(bool on) { jack_set_freewheel(client_, on ? 1 : 0); }

bool JackRecorder::wait_for_freewheel() {
  freewheel(true);
  return becomes_true([this] { return freewheels_.load(); }) && let_pass(4);
}

int JackRecorder::process(std::uint32_t frames) {
  ++blocks_;
  const std::uint32_t now = jack_last_frame_time(client_);
  void* const midi = jack_port_get_buffer(midi_out_, frames);
  jack_midi_clear_buffer(midi);
  if (to_send_.exchange(false)) {
    jack_midi_event_write(midi, frames / 2, message_.data(), message_bytes_);
    sent_ = now + frames / 2;
  }
  auto* const audio = static_cast<float*>(jack_port_get_buffer(audio_out_, frames));
  std::fill_n(audio, frames, 0.0f);
  if (kick_ != 0) {
    audio[frames / 2] = kick_.exchange(0);
    kicked_ = true;
  }
  const std::size_t at = recorded_;
  std::array<const float*, 2> heard{};
  for (std::size_t i = 0; i < ports_.size(); ++i) {
    heard[i] = static_cast<const float*>(jack_port_get_buffer(ports_[i], frames));
    hears_[i] = std::any_of(heard[i], heard[i] + frames, [](float sample) { return sample != 0; });
  }
  if (at == 0 && !(from_ == From::call ? called_.load() : hears_[0] || hears_[1])) return 0;
  if (at == 0) first_frame_ = now;
  if (freewheels_ && freewheels_from_ < 0) freewheels_from_ = static_cast<std::int64_t>(at);
  const std::size_t count = std::min<std::size_t>(frames, tracks_[0].size() - at);
  for (std::size_t i = 0; i < ports_.size(); ++i) std::copy_n(heard[i], count, tracks_[i].data() + at);
  recorded_ = at + count;
  return 0;
}

void JackRecorder::send(const std::vector<std::uint8_t>& message) {
  message_bytes_ = std::min(message.size(), message_.size());
  std::copy_n(message.begin(), message_bytes_, message_.begin());
  to_send_ = true;
}

void JackRecorder::kick(float value) {
  kicked_ = false;
  kick_ = value;
}

std::optional<std::uint32_t> JackRecorder::sent() const {
  return sent_ < 0 ? std::nullopt : std::optional(static_cast<std::uint32_t>(sent_));
}

std::optional<std::size_t> JackRecorder::freewheels_from() const {
  return freewheels_from_ < 0 ? std::nullopt : std::optional(static_cast<std::size_t>(freewheels_from_));
}

bool JackRecorder::wait_for(std::size_t frames, std::chrono::milliseconds limit) const {
  return becomes_true([&] { return recorded_ >= frames; }, limit);
}

bool JackRecorder::let_pass(std::size_t blocks) const {
  return becomes_true([this, end = blocks_ + blocks] { return blocks_ >= end; });
}

std::size_t silence_before(const Samples& samples) {
  const auto heard = std::ranges::find_if(samples, [](double sample) { return sample != 0; });
  return static_cast<std::size_t>(heard - samples.begin());
}

Samples JackRecorder::samples(std::size_t port) const { return to_doubles(std::span(tracks_[port]).first(recorded_)); }

}  // namespace ringdown::test
