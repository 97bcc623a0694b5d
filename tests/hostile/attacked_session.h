// A session that plays while it is attacked, offline: the same inputs bring about the same samples. Every sample at
// every output is looked at: the mix, a port for each object, and the ambisonic channels. There is no limiter.
#pragma once

#include "server/session/session.h"
#include "tests/hostile/messages.h"
#include "tests/synth/every_output.h"

#include <memory>

namespace ringdown::hostile {

class AttackedSession {
 public:
  // A Stage is there (playing.h). Some settings are drawn: ambisonics, a head, exact contacts, travel times.
  explicit AttackedSession(Random& random);

  // Does what the daemon would do with a message; refusals are as good as successes.
  void take(const wire::Message& message);
  // Goes on for some blocks, the scene and what plays by itself too.
  void play(std::size_t blocks, Random& random);
  // After all that, an object that is not to blame can be loaded, struck and heard.
  void expect_alive();

 private:
  void carry_out(const wire::Message& message);
  void render(std::size_t frames, const synth::Inputs& inputs);
  [[nodiscard]] synth::Frame now() { return session_->rack().mixer().counters().frames; }

  std::unique_ptr<session::Session> session_ = std::make_unique<session::Session>(48000);
  synth::test::EveryOutput outputs_;
  std::size_t turns_ = 0;
};

}  // namespace ringdown::hostile
