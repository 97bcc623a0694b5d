#include "tests/soak/ear.h"

#include <jack/jack.h>

#include <cerrno>
#include <cmath>

namespace ringdown::test {

struct Ear::Jack {
  jack_client_t* client = nullptr;
  jack_port_t* ports[2] = {};
  Heard* heard = nullptr;
  std::atomic<bool> lost{false};

  void listen(jack_nframes_t frames) {
    std::uint64_t bad = 0, loud = 0;
    for (jack_port_t* port : ports) {
      const auto* samples = static_cast<const float*>(jack_port_get_buffer(port, frames));
      for (jack_nframes_t n = 0; n < frames; ++n) {
        bad += !std::isfinite(samples[n]);
        loud += std::abs(samples[n]) > 1e-6f;
      }
    }
    heard->samples += 2 * frames;
    heard->not_finite += bad;
    heard->loud += loud;
  }
};

Ear::Ear(const std::string& server, Heard& heard) : jack_(std::make_unique<Jack>()) {
  jack_->heard = &heard;
  const auto options = static_cast<jack_options_t>(JackNoStartServer | JackServerName);
  jack_->client = jack_client_open("ringdown-ear", options, nullptr, server.c_str());
  if (!jack_->client) return;
  for (int side = 0; side < 2; ++side) {
    jack_->ports[side] =
        jack_port_register(jack_->client, side ? "right" : "left", JACK_DEFAULT_AUDIO_TYPE, JackPortIsInput, 0);
  }
  jack_set_process_callback(
      jack_->client,
      [](jack_nframes_t frames, void* jack) {
        static_cast<Jack*>(jack)->listen(frames);
        return 0;
      },
      jack_.get());
  jack_on_shutdown(
      jack_->client, [](void* jack) { static_cast<Jack*>(jack)->lost = true; }, jack_.get());
  jack_activate(jack_->client);
}

Ear::~Ear() {
  // Closing a client whose server died can hang; what is left of it is small.
  if (jack_->lost) {
    static_cast<void>(jack_.release());
  } else if (jack_->client) {
    jack_deactivate(jack_->client);
    jack_client_close(jack_->client);
  }
}

bool Ear::connect() {
  if (!jack_->client || jack_->lost) return false;
  const int left = jack_connect(jack_->client, "ringdown:out_left", "ringdown-ear:left");
  const int right = jack_connect(jack_->client, "ringdown:out_right", "ringdown-ear:right");
  return (left == 0 || left == EEXIST) && (right == 0 || right == EEXIST);
}

}  // namespace ringdown::test
