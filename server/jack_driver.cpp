// The only file that knows JACK.
//
// jackd2 and PipeWire differ in when they announce a block size, so the callback takes whatever count it is given.
#include "server/driver.h"
#include "server/load_meter.h"

#include <jack/jack.h>

#include <array>

namespace ringdown::server {
namespace {

class JackDriver final : public Driver {
 public:
  JackDriver(jack_client_t* client, std::array<jack_port_t*, 2> ports, bool connect)
      : client_(client), ports_(ports), connect_(connect), sample_rate_hz_(jack_get_sample_rate(client)) {}

  ~JackDriver() override {
    if (lost_) return;  // closing a client whose server died can hang; it calls us no more
    jack_deactivate(client_);
    jack_client_close(client_);
  }

  [[nodiscard]] double sample_rate_hz() const override { return sample_rate_hz_; }
  [[nodiscard]] std::size_t block_frames() const override { return jack_get_buffer_size(client_); }

  Result<void> start(synth::Mixer& mixer, std::function<void()> on_lost) override {
    mixer_ = &mixer;
    on_lost_ = std::move(on_lost);
    jack_set_process_callback(
        client_,
        [](jack_nframes_t frames, void* self) {
          static_cast<JackDriver*>(self)->process(frames);
          return 0;
        },
        this);
    jack_set_xrun_callback(
        client_,
        [](void* self) {
          ++static_cast<JackDriver*>(self)->xruns_;
          return 0;
        },
        this);
    jack_on_shutdown(
        client_,
        [](void* self) {
          static_cast<JackDriver*>(self)->lost_ = true;
          static_cast<JackDriver*>(self)->on_lost_();
        },
        this);
    if (jack_activate(client_) != 0) return fail("the JACK server refused to start the client; see its own messages");
    if (connect_) connect_to_speakers();
    return {};
  }

  // JACK counts 32 bits of frames since its server started; the mixer counts 64 since it was made. `offset_` is their
  // difference modulo 2^32, renewed in every callback because an xrun moves JACK's count but not ours.
  [[nodiscard]] protocol::Frame now() const override {
    const protocol::Frame rendered = mixer_->counters().frames.load(std::memory_order_acquire);
    const auto low = static_cast<std::uint32_t>(jack_frame_time(client_)) - offset_.load(std::memory_order_relaxed);
    return rendered + static_cast<std::int32_t>(low - static_cast<std::uint32_t>(rendered));
  }

  [[nodiscard]] Load load() const override { return meter_.read(); }
  [[nodiscard]] std::int32_t xruns() const override { return xruns_; }

 private:
  void process(jack_nframes_t frames) {
    const auto begin = LoadMeter::Clock::now();
    const auto rendered = static_cast<std::uint32_t>(mixer_->counters().frames.load(std::memory_order_relaxed));
    offset_.store(static_cast<std::uint32_t>(jack_last_frame_time(client_)) - rendered, std::memory_order_relaxed);
    auto* left = static_cast<float*>(jack_port_get_buffer(ports_[0], frames));
    auto* right = static_cast<float*>(jack_port_get_buffer(ports_[1], frames));
    mixer_->render({left, frames}, {right, frames});
    meter_.note(begin, frames, sample_rate_hz_);
  }

  void connect_to_speakers() {
    const char** speakers =
        jack_get_ports(client_, nullptr, JACK_DEFAULT_AUDIO_TYPE, JackPortIsInput | JackPortIsPhysical);
    for (std::size_t i = 0; speakers && speakers[i] && i < ports_.size(); ++i) {
      jack_connect(client_, jack_port_name(ports_[i]), speakers[i]);
    }
    jack_free(speakers);
  }

  jack_client_t* client_;
  std::array<jack_port_t*, 2> ports_;
  bool connect_;
  double sample_rate_hz_;
  synth::Mixer* mixer_ = nullptr;
  std::function<void()> on_lost_;
  LoadMeter meter_;
  std::atomic<std::uint32_t> offset_ = 0;
  std::atomic<std::int32_t> xruns_ = 0;
  std::atomic<bool> lost_ = false;
};

}  // namespace

Result<std::unique_ptr<Driver>> open_jack(const JackOptions& options) {
  const auto quiet = [](const char*) {};  // libjack's own reports; ours is the sentence below
  jack_set_error_function(quiet);
  jack_set_info_function(quiet);
  jack_client_t* client = jack_client_open(options.client_name.c_str(), JackNoStartServer, nullptr);
  if (!client) {
    return fail("no JACK server answers; start one (jackd or PipeWire), or run with --driver null or --driver wav");
  }
  std::array<jack_port_t*, 2> ports{};
  const std::array names = {"out_left", "out_right"};
  for (std::size_t i = 0; i < ports.size(); ++i) {
    ports[i] = jack_port_register(client, names[i], JACK_DEFAULT_AUDIO_TYPE, JackPortIsOutput | JackPortIsTerminal, 0);
    if (!ports[i]) {
      jack_client_close(client);
      return fail("the JACK server has no port left for us; restart it with a larger --port-max");
    }
  }
  return std::make_unique<JackDriver>(client, ports, options.connect);
}

}  // namespace ringdown::server
