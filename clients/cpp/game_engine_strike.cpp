// How a game makes its collisions sound, with plain sockets and no library. Copy what you need.
//
//   game_engine_strike [OBJECT [PORT]]
//
// A ball bounces on an object; each bounce is one OSC message /object/OBJECT/strike with point and impulse in the
// object's own frame, in SI units. docs/reference/protocol.md lists all messages of the daemon.
#include <arpa/inet.h>
#include <bit>
#include <chrono>
#include <cstdint>
#include <cstdio>
#include <cstdlib>
#include <string>
#include <sys/socket.h>
#include <thread>
#include <unistd.h>

namespace {

struct Vector {
  float x, y, z;
};

// An OSC message: address, type tags and arguments, each padded to a multiple of 4 bytes.
class OscMessage {
 public:
  explicit OscMessage(std::string address) : head_(std::move(address)) { pad(head_); }

  OscMessage& add(float value) {
    const auto bits = std::bit_cast<std::uint32_t>(value);
    for (int shift = 24; shift >= 0; shift -= 8) arguments_.push_back(static_cast<char>(bits >> shift));
    types_.push_back('f');
    return *this;
  }
  OscMessage& add(Vector v) { return add(v.x).add(v.y).add(v.z); }

  [[nodiscard]] std::string bytes() const {
    std::string types = types_;
    pad(types);
    return head_ + types + arguments_;
  }

 private:
  static void pad(std::string& text) { text.resize((text.size() / 4 + 1) * 4, '\0'); }

  std::string head_, types_ = ",", arguments_;
};

class Ringdown {
 public:
  explicit Ringdown(std::uint16_t port) : socket_(::socket(AF_INET, SOCK_DGRAM, 0)) {
    daemon_.sin_family = AF_INET;
    daemon_.sin_port = htons(port);
    daemon_.sin_addr.s_addr = htonl(INADDR_LOOPBACK);
  }
  ~Ringdown() { ::close(socket_); }
  Ringdown(const Ringdown&) = delete;
  Ringdown& operator=(const Ringdown&) = delete;

  // Strikes an object; call it from the physics engine's contact callback. Never waits; without a daemon nothing
  // happens.
  void strike(const std::string& object, Vector point_m, Vector impulse_ns) {
    const std::string bytes = OscMessage("/object/" + object + "/strike").add(point_m).add(impulse_ns).bytes();
    ::sendto(socket_, bytes.data(), bytes.size(), MSG_DONTWAIT, reinterpret_cast<const sockaddr*>(&daemon_),
             sizeof daemon_);
  }

 private:
  int socket_;
  sockaddr_in daemon_{};
};

}  // namespace

int main(int argc, char** argv) {
  const std::string object = argc > 1 ? argv[1] : "bell";
  Ringdown ringdown(static_cast<std::uint16_t>(argc > 2 ? std::atoi(argv[2]) : 7770));

  // A 20 g ball falls from 20 cm; each bounce reverses its velocity and keeps 60 % of its speed.
  constexpr float kMassKg = 0.02f, kRestitution = 0.6f, kGravity = 9.81f;
  for (float speed = 1.98f; speed > 0.2f; speed *= kRestitution) {
    ringdown.strike(object, {0, 0, 0.05f}, {0, 0, -kMassKg * speed * (1 + kRestitution)});
    const float flight_s = 2 * kRestitution * speed / kGravity;
    std::this_thread::sleep_for(std::chrono::duration<float>(flight_s));
  }
  return 0;
}
