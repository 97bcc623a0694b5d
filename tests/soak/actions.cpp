#include "tests/soak/actions.h"

#include "engine/modal/bank_file.h"
#include "tests/support/synthetic_bank.h"

#include <chrono>
#include <cmath>
#include <fstream>
#include <limits>

namespace ringdown::test {
namespace {

using wire::Message;

constexpr const char* kScene = R"(
[[object]]
name = "ball"
bank = "bank0.glb"

[[static]]
shape = "plane"
normal = [0, 0, 1]

[[body]]
name = "ball"
object = "ball"
shape = "sphere"
radius_m = 0.05
position_m = [0, 0, 0.5]
)";

double unix_now_s() {
  return std::chrono::duration<double>(std::chrono::system_clock::now().time_since_epoch()).count();
}

}  // namespace

Actions::Actions(const std::filesystem::path& folder, std::uint32_t seed) : folder_(folder), random_(seed) {
  for (std::size_t n = 0; n < kBanks; ++n) {
    modal::Bank bank = random_bank(seed + static_cast<std::uint32_t>(n), 20 << n, 40);
    bank.mass = modal::MassProperties{.mass_kg = 1, .inertia_kg_m2 = {1e-3, 1e-3, 1e-3}};
    const auto written = modal::write_bank(bank, folder_ / ("bank" + std::to_string(n) + ".glb"));
    if (!written) std::fprintf(stderr, "%s\n", written.error().message.c_str());
  }
  std::ofstream(folder_ / "scene.toml") << kScene;
}

void Actions::act(Daemon& daemon) {
  ++count_;
  const double chance = uniform(0, 1);
  if (chance < 0.65) return strike(daemon);
  if (chance < 0.75) return touch(daemon);
  if (chance < 0.80) return bundle(daemon);
  if (chance < 0.96) return change(daemon);
  if (chance < 0.98) return scene(daemon);
  nonsense(daemon);
}

void Actions::free_everything(Daemon& daemon) {
  daemon.send({"/clear", {}});
  daemon.send({"/scene/clear", {}});
  for (std::size_t n = 0; n < kObjects; ++n) daemon.send({"/object/o" + std::to_string(n) + "/free", {}});
  daemon.send({"/object/ball/free", {}});
}

void Actions::strike(Daemon& daemon) {
  const double size = std::pow(10.0, uniform(-6, -2));
  daemon.send({"/object/" + object() + "/strike",
               {uniform(-0.1, 0.1), uniform(-0.1, 0.1), uniform(-0.1, 0.1), uniform(-size, size), uniform(-size, size),
                uniform(-size, size), uniform(0, 0.002)}});
}

void Actions::bundle(Daemon& daemon) {
  std::vector<Message> messages;
  for (std::size_t n = 0; n <= below(20); ++n) {
    messages.push_back({"/object/" + object() + "/strike_vertex",
                        {static_cast<std::int32_t>(below(50)), 0.0, 0.0, uniform(-1e-3, 1e-3)}});
  }
  messages.push_back(hold());
  daemon.send_bundle(unix_now_s() + uniform(-0.1, 1), messages);
}

Message Actions::hold() {
  const double damping = below(3) == 0 ? 0 : std::pow(10.0, uniform(-2, 4));
  return {"/object/" + object() + "/hold",
          {uniform(-0.1, 0.1), uniform(-0.1, 0.1), uniform(-0.1, 0.1), damping, 0.0, 0.0, uniform(-1, 1),
           static_cast<std::int32_t>(below(16))}};
}

void Actions::touch(Daemon& daemon) {
  switch (below(3)) {
    case 0:
      return daemon.send(hold());
    case 1:
      return daemon.send({"/object/" + object() + "/click", {0.0, 0.0, uniform(-1e-3, 1e-3), uniform(0, 0.002)}});
    default:
      return daemon.send({"/object/" + object() + "/contact",
                          {uniform(-0.1, 0.1), uniform(-0.1, 0.1), uniform(-0.1, 0.1), 0.0, 0.0, uniform(-0.1, 0.1),
                           uniform(0, 1), uniform(0, 1), static_cast<std::int32_t>(below(6))}});
  }
}

void Actions::change(Daemon& daemon) {
  const std::string name = object();
  switch (below(7)) {
    case 0:
      return daemon.send({"/object/" + name + "/gain", {uniform(0, 1), uniform(0, 0.5)}});
    case 1:
      return daemon.send({"/object/" + name + "/pan", {uniform(-1, 1)}});
    case 2:
      return daemon.send(
          {"/object/" + name + "/material", {uniform(0.5, 4), uniform(0.5, 4), uniform(0.5, 2), uniform(0.5, 2)}});
    case 3:
      return daemon.send({"/object/" + name + "/clear", {}});
    case 4:
      return daemon.send({"/object/" + name + "/free", {}});
    default:
      return daemon.send({"/load", {name, (folder_ / ("bank" + std::to_string(below(kBanks)) + ".glb")).string()}});
  }
}

void Actions::scene(Daemon& daemon) {
  switch (below(6)) {
    case 0:
      return daemon.send({"/scene/load", {(folder_ / "scene.toml").string()}});
    case 1:
      return daemon.send({"/scene/pause", {static_cast<std::int32_t>(below(2))}});
    case 2:
      return daemon.send({"/scene/clear", {}});
    default:
      return daemon.send({"/scene/spawn/sphere", {"ball", uniform(-0.3, 0.3), uniform(-0.3, 0.3), uniform(0.1, 1)}});
  }
}

void Actions::nonsense(Daemon& daemon) {
  switch (below(5)) {
    case 0:
      return daemon.send({"/object/" + object() + "/strike", {std::nan(""), 0.0, 0.0, 0.0, 0.0, 1.0}});
    case 1:
      return daemon.send({"/object/nobody/strike", {0.0, 0.0, 0.0, 0.0, 0.0, 1.0}});
    case 2:
      return daemon.send({"/load", {"o1", (folder_ / "missing.glb").string()}});
    case 3:
      return daemon.send({"/object/" + object() + "/gain", {std::numeric_limits<double>::infinity()}});
    default:
      return daemon.send({"/no/such/address", {"text", 3}});
  }
}

}  // namespace ringdown::test
