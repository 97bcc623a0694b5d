// Our client at one JACK server, for as long as that server lives. JackDriver makes a new one for each server.
//
// jackd2 and PipeWire differ in when they announce a block size, so the callback takes whatever count it is given.
#pragma once

#include "engine/base/realtime.h"
#include "engine/base/result.h"
#include "engine/synth/events/event.h"
#include "engine/synth/mixer.h"
#include "server/driver.h"
#include "server/gate.h"
#include "server/load_meter.h"
#include "server/session/midi_player.h"

#include <array>
#include <atomic>
#include <compare>
#include <cstddef>
#include <cstdint>
#include <functional>
#include <map>
#include <memory>
#include <set>
#include <string>
#include <vector>

struct _jack_client;
struct _jack_port;

namespace ringdown::server {

// A connection: our port by its short name, and the other port by its full name.
struct JackConnection {
  std::string ours, theirs;
  friend auto operator<=>(const JackConnection&, const JackConnection&) = default;
};

// Returns the maximum length of a client's name, in bytes. [any]
std::size_t max_jack_name_length();

class JackClient {
 public:
  // Returns null if no server answers or the server is full. JACK's threads call `on_change` when the server has gone,
  // when a connection was made, and when a port has appeared; `on_change` must return at once. [one thread, always the
  // same, calls this and every function below that names no other thread]
  static std::unique_ptr<JackClient> open(const std::string& name, std::shared_ptr<LoadMeter> meter,
                                          std::shared_ptr<session::MidiPlayer> midi, std::function<void()> on_change);

  // Closes the client at JACK, which may hang if the server died. [any]
  ~JackClient();
  JackClient(const JackClient&) = delete;
  JackClient& operator=(const JackClient&) = delete;

  [[nodiscard]] std::string name() const;                        // name assigned by the server
  [[nodiscard]] bool lost() const { return lost_; }              // the server has gone [any]
  [[nodiscard]] bool freewheels() const { return freewheels_; }  // [any]
  // Returns the number of beginnings and ends of callbacks so far: odd while JACK is inside one. [any]
  [[nodiscard]] std::uint64_t calls() const { return calls_; }
  [[nodiscard]] double sample_rate_hz() const;     // the server's [any but audio]
  [[nodiscard]] std::size_t block_frames() const;  // the server's [any but audio]

  // Starts to render `program`, which must exist until the client is stopped or destroyed.
  Result<void> start(const Driver::Program& program);

  // stop() and go_on() stop and continue rendering; in between, the ports are silent. When stop() returns, no callback
  // is in the mixer.
  void stop() { gate_.shut(); }
  void go_on() { gate_.open(); }

  // Returns the mixer's frame that is being computed. [any but audio]
  [[nodiscard]] synth::Frame now() const;

  // Returns the real-time priority of the client's audio thread; 0 for none. [any but audio]
  [[nodiscard]] int priority() const;

  // Registers ports for these buses and removes the others. A port whose bus keeps its name stays untouched.
  void show_buses(const std::map<std::size_t, std::string>& names);

  // Registers an input port for each bit that is set; bit 0 is in_1. Ports that exist stay.
  void show_inputs(std::uint32_t inputs);

  // Sets the objects that notes strike from the next block on.
  void set_notes(std::shared_ptr<const session::NoteTable> notes);

  // Returns the connections of our ports.
  [[nodiscard]] std::set<JackConnection> connections() const;
  // Asks the server for a connection. False if one of the ports does not exist, or is of a program that has not begun.
  bool connect(const JackConnection& connection);

  // Returns the names of the server's physical playback ports, of its physical MIDI sources, or of all MIDI sources.
  enum class Others { speakers, midi_devices, midi_sources };
  [[nodiscard]] std::vector<std::string> others(Others kind) const;

  // Asks JACK which of our ports are connected; the others are not rendered. Call after on_change(), and in freewheel.
  void note_listeners();

 private:
  JackClient(_jack_client* client, std::shared_ptr<LoadMeter> meter, std::shared_ptr<session::MidiPlayer> midi,
             std::function<void()> on_change);
  void set_callbacks();
  [[nodiscard]] bool add_port(std::size_t channel, const std::string& name);
  [[nodiscard]] bool add_input(std::size_t input);
  void remove_port(std::size_t channel);
  void tell_latency();
  void process(std::uint32_t frames) REALTIME;
  void process_offline(std::uint32_t frames);  // used in freewheel; steps the scene in the callback
  void render(std::uint32_t frames, bool deadline) REALTIME;
  [[nodiscard]] synth::Inputs read_inputs(std::uint32_t frames) REALTIME;
  void play_notes(std::uint32_t frames, synth::Frame first) REALTIME;
  void write_silence(std::uint32_t frames) REALTIME;

  static constexpr std::int64_t kUnknown = -1;

  _jack_client* client_;
  std::shared_ptr<LoadMeter> meter_;
  std::shared_ptr<session::MidiPlayer> midi_;
  std::function<void()> on_change_;
  const Driver::Program* program_ = nullptr;
  Gate gate_;
  _jack_port* midi_port_ = nullptr;
  std::shared_ptr<const session::NoteTable> table_;                    // keeps the table of notes_ alive
  std::atomic<const session::NoteTable*> notes_ = nullptr;             // the table in use
  std::array<std::atomic<_jack_port*>, synth::kMaxChannels> ports_{};  // indexed by the mixer's channel
  std::map<std::size_t, std::string> buses_;                           // buses of the last show_buses()
  std::array<std::atomic<_jack_port*>, synth::kMaxInputs> inputs_{};   // in_1 first; null: none
  std::uint32_t shown_inputs_ = 0;                                     // inputs of the last show_inputs()
  std::atomic<std::uint32_t> fed_ = 0;                                 // connected inputs
  std::atomic<synth::ChannelSet> listened_ = 0;                        // connected output channels
  std::atomic<std::int64_t> offset_ = kUnknown;                        // difference of both frame counts (now())
  std::int64_t next_start_ = kUnknown;  // audio thread: where JACK's next block begins, by its count of 32 bits
  std::atomic<bool> lost_ = false, freewheels_ = false;
  std::atomic<std::uint64_t> calls_ = 0;
};

}  // namespace ringdown::server
