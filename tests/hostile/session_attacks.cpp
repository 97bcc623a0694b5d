// Requests, banks and scenes that a session is given while it plays.
#include "protocol/wire/codec.h"
#include "tests/fuzz/mutator.h"
#include "tests/hostile/attack.h"
#include "tests/hostile/attacked_session.h"
#include "tests/hostile/banks.h"
#include "tests/hostile/playing.h"

#include <fstream>
#include <iterator>
#include <optional>

namespace ringdown::hostile {
namespace {

std::string text_of(const std::vector<std::byte>& bytes) {
  return {reinterpret_cast<const char*>(bytes.data()), bytes.size()};
}

// A session and its folder, which begin with the first input.
class SessionAttack : public Attack {
 public:
  void finish() override {
    if (session_) session_->expect_alive();
  }

 protected:
  [[nodiscard]] AttackedSession& session(Random& random) {
    if (!session_) session_.emplace(random);
    return *session_;
  }
  static std::string write(const char* name, const std::string& bytes) {
    std::ofstream(name, std::ios::binary) << bytes;
    return name;
  }

 private:
  Stage stage_;
  std::optional<AttackedSession> session_;
};

class RequestAttack : public SessionAttack {
 public:
  std::string make(Random& random) override { return text_of(wire::encode(hostile_message(random, names()))); }
  void feed(const std::string& input, Random& random) override {
    const auto messages = wire::decode_packet(std::as_bytes(std::span(input)));
    for (const wire::TimedMessage& timed : messages.value_or(std::vector<wire::TimedMessage>())) {
      session(random).take(timed.message);
    }
    session(random).play(1 + random.below(2), random);
  }
};

// A bank of extreme numbers becomes an object, on which everything that an object takes is tried.
class PlayedBankAttack : public SessionAttack {
 public:
  std::string make(Random& random) override { return hostile_bank(random); }
  void feed(const std::string& input, Random& random) override {
    AttackedSession& session = this->session(random);
    session.take({"/load", {std::string("a"), write("hostile.glb", input)}});
    session.play(1, random);
    const auto any = [&random] { return random.uniform(-1, 1); };
    const double blow = random.power(-6, 4);
    session.take({"/object/a/strike_vertex", {0, blow * any(), blow * any(), blow * any(), random.uniform(0, 0.01)}});
    session.play(1, random);
    for (int n = 0; n < 4; ++n) {
      session.take(hostile_message(random, {.objects = {"a"}, .files = names().files}));
    }
    session.take({"/object/a/excite", {1, 0.0, 0.0, 0.0, any() * random.power(-3, 6), any(), any()}});
    session.play(3, random);
  }
};

class PlayedSceneAttack : public SessionAttack {
 public:
  std::string make(Random& random) override { return mutator_.next(random.engine(), 16384); }
  void feed(const std::string& input, Random& random) override {
    AttackedSession& session = this->session(random);
    session.take({"/scene/load", {write("hostile.toml", input)}});
    session.play(4, random);
  }

 private:
  // The corpus, and as often the scene that sounds.
  static std::vector<std::string> scenes() {
    std::vector<std::string> all = fuzz::inputs_of({RINGDOWN_SOURCE_DIR "/tests/fuzz/corpus/scene"});
    std::ifstream file("scene.toml");
    all.insert(all.end(), all.size(), std::string{std::istreambuf_iterator<char>(file), {}});
    return all;
  }
  fuzz::Mutator mutator_{scenes()};
};

template <class Kind>
std::unique_ptr<Attack> begin(const std::string& /*name*/) {
  return std::make_unique<Kind>();
}

}  // namespace

std::vector<Kind> session_kinds() {
  std::vector<Kind> kinds;
  kinds.push_back({"requests", 30, 1000, begin<RequestAttack>});
  kinds.push_back({"played-banks", 8, 250, begin<PlayedBankAttack>});
  kinds.push_back({"played-scenes", 1, 100, begin<PlayedSceneAttack>});
  return kinds;
}

}  // namespace ringdown::hostile
