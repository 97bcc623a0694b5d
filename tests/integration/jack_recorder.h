// A JACK client that keeps every sample it gets: also in freewheel, where a program that writes to disk loses some.
#pragma once

#include "tests/integration/process.h"
#include "tests/support/signal.h"

#include <array>
#include <atomic>
#include <chrono>
#include <cstddef>
#include <cstdint>
#include <optional>
#include <string>
#include <vector>

struct _jack_client;
struct _jack_port;

namespace ringdown::test {

class JackRecorder {
 public:
  // What the recording begins with: the first block in which something is heard, however long that takes, or the next
  // one after record().
  enum class From { sound, call };

  // Client `name` with ports in_1 and in_2, at the server of that name; records up to `frames`.
  JackRecorder(const std::string& server, const std::string& name, std::size_t frames, From from = From::sound);
  ~JackRecorder();
  JackRecorder(const JackRecorder&) = delete;
  JackRecorder& operator=(const JackRecorder&) = delete;

  [[nodiscard]] bool works() const { return client_ != nullptr; }
  // Returns when the connection is in effect, which libjack's call does not wait for. A daemon begins to play to a new
  // connection a moment later, except in freewheel, where it looks in every block at what is connected.
  bool connect(const std::string& from, const std::string& to);
  void record() { called_ = true; }
  // Something was heard at this input in the last block.
  [[nodiscard]] bool hears(std::size_t port) const { return hears_[port]; }

  // Freewheel begins and ends a moment later, and ends with the recorder; freewheels_from() is the number of frames
  // recorded before it.
  void freewheel(bool on);
  // Returns when all clients have been in freewheel for some blocks.
  bool wait_for_freewheel();
  [[nodiscard]] std::optional<std::size_t> freewheels_from() const;

  // Sends a MIDI message of up to 16 bytes from midi_out, in the middle of a block; sent() is then the server's frame
  // at which it is. The port pretends to be a device's.
  void send(const std::vector<std::uint8_t>& message);
  [[nodiscard]] std::optional<std::uint32_t> sent() const;

  // Sends one sample of this value from audio_out, in the middle of a block; kicked() is then true.
  void kick(float value);
  [[nodiscard]] bool kicked() const { return kicked_; }

  // The server's frame of the first one recorded.
  [[nodiscard]] std::uint32_t first_frame() const { return first_frame_; }

  [[nodiscard]] std::size_t recorded() const { return recorded_; }
  bool wait_for(std::size_t frames, std::chrono::milliseconds limit = kPatience) const;
  // Waits until so many more blocks have passed, recorded or not.
  bool let_pass(std::size_t blocks) const;
  // What was recorded so far, of in_1 (0) or in_2 (1).
  [[nodiscard]] Samples samples(std::size_t port) const;

 private:
  int process(std::uint32_t frames);

  _jack_client* client_;
  From from_;
  std::array<_jack_port*, 2> ports_{};
  std::array<std::vector<float>, 2> tracks_;
  std::atomic<std::size_t> recorded_ = 0, blocks_ = 0;
  std::atomic<bool> freewheels_ = false, called_ = false;
  std::array<std::atomic<bool>, 2> hears_{};
  std::atomic<std::int64_t> freewheels_from_ = -1;
  std::atomic<std::uint32_t> first_frame_ = 0;
  _jack_port* midi_out_ = nullptr;
  _jack_port* audio_out_ = nullptr;
  std::atomic<float> kick_ = 0;
  std::atomic<bool> kicked_ = false;
  std::array<std::uint8_t, 16> message_{};
  std::size_t message_bytes_ = 0;
  std::atomic<bool> to_send_ = false;
  std::atomic<std::int64_t> sent_ = -1;
};

// Frames before the first that is not silent.
std::size_t silence_before(const Samples& samples);

}  // namespace ringdown::test
