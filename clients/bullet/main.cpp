// ringdown-bullet: an external simulator. It plays a scene file in Bullet, and sends the events of its contacts to a
// daemon.
#include "clients/bullet/bullet_world.h"
#include "clients/cli/daemon_link.h"
#include "engine/base/folders.h"
#include "engine/base/output_file.h"
#include "engine/modal/bank_file.h"
#include "engine/scene/scene_file.h"
#include "packaging/manual/command_line.h"
#include "protocol/defaults.h"
#include "protocol/schema.h"
#include "protocol/wire/score.h"
#include "server/event_sender.h"

#include <atomic>
#include <chrono>
#include <csignal>
#include <cstdio>
#include <optional>
#include <thread>
#include <utility>

namespace {

using namespace ringdown;
using protocol::complain;
using protocol::ExitCode;
using std::chrono::duration;

std::atomic<bool> interrupted = false;

struct Options {
  std::filesystem::path scene;
  std::string to = formatted("osc.udp://127.0.0.1:{}", protocol::kDefaultPort);
  std::optional<std::filesystem::path> events;
  std::optional<double> seconds;
  double lead_s = 0.05;
  bool no_load = false;
};

double unix_now_s() { return duration<double>(std::chrono::system_clock::now().time_since_epoch()).count(); }

Result<bullet::BulletWorld> make_world(const scene::SceneDescription& scene) {
  std::vector<std::shared_ptr<const modal::Bank>> banks;
  for (const scene::ObjectDescription& object : scene.objects) {
    Result<modal::Bank> bank = modal::read_bank(object.bank);
    if (!bank) return fail(bank);
    banks.push_back(std::make_shared<const modal::Bank>(std::move(*bank)));
  }
  return bullet::BulletWorld::create(scene, banks);
}

// The messages that prepare a daemon for the scene: its objects, and how they are set.
std::vector<wire::Message> setup_messages(const scene::SceneDescription& scene) {
  std::vector<wire::Message> messages;
  for (const scene::ObjectDescription& object : scene.objects) {
    const protocol::ObjectRef ref{.name = object.name};
    messages.push_back(
        protocol::format(protocol::LoadObject{object.name, std::filesystem::absolute(object.bank).string()}));
    messages.push_back(protocol::format(protocol::SetMaterial{ref, object.material}));
    if (!object.group.empty()) messages.push_back(protocol::format(protocol::SetGroup{ref, object.group}));
    messages.push_back(protocol::format(protocol::SetGain{ref, {object.gain, 0}}));
    messages.push_back(protocol::format(protocol::SetPan{ref, {object.pan}}));
  }
  return messages;
}

// Plays the scene in real time. Each event is sent ahead of its time, in a bundle whose time tag says when it is due,
// so that delays in the network and in this program are inaudible.
ExitCode play(const Options& options, const scene::SceneDescription& scene, bullet::BulletWorld& world,
              double seconds) {
  auto link = cli::DaemonLink::open(options.to);
  if (!link) return complain(link.error().message, ExitCode::usage);
  for (const wire::Message& message : options.no_load ? std::vector<wire::Message>() : setup_messages(scene)) {
    const auto reply = link->ask(message, std::chrono::seconds(5));
    if (!reply) return complain(reply.error().message, ExitCode::no_answer);
    if (const auto* no = reply->get_if<protocol::Fail>()) return complain(no->sentence, ExitCode::failure);
  }
  auto sender = server::EventSender::open(options.to);
  if (!sender) return complain(sender.error().message, ExitCode::usage);

  const double lead_s = options.lead_s + 2 * scene.step_s;
  double start_s = unix_now_s() + lead_s;  // computer time at which scene time 0 sounds
  std::size_t lost = 0;
  while (world.time_s() < seconds && !interrupted) {
    const bullet::BulletWorld::StepEvents step = world.step();
    const auto name = [&](synth::ObjectNumber object) { return scene.objects[object].name; };
    const auto time = [&](synth::Frame frame) { return start_s + static_cast<double>(frame) / bullet::kFrameRate_hz; };
    lost += sender->send(step.events, name, time) + sender->send(step.dampings, name, time);
    const double ahead_s = start_s + world.time_s() - lead_s - unix_now_s();
    if (ahead_s > 0) std::this_thread::sleep_for(duration<double>(ahead_s));
    // On a computer that is too slow the scene slows down; no strikes are sent in a burst to catch up.
    if (ahead_s < -0.5 * options.lead_s) start_s -= ahead_s;
  }
  if (lost > 0) return complain({ErrorKind::input_output, formatted("{} events could not be sent", lost)});
  return interrupted ? ExitCode::cancelled : ExitCode::ok;
}

// Plays the scene as fast as possible, and writes its events as a score.
ExitCode write_events(const std::filesystem::path& path, const scene::SceneDescription& scene,
                      bullet::BulletWorld& world, double seconds) {
  std::vector<wire::ScoreEvent> score;
  for (const wire::Message& message : setup_messages(scene)) score.push_back({0, message});
  while (world.time_s() < seconds) {
    if (interrupted) return complain({ErrorKind::cancelled, "cancelled; nothing was written"});
    const bullet::BulletWorld::StepEvents step = world.step();
    const auto ref = [&](synth::ObjectNumber object) {
      return protocol::ObjectRef{.name = scene.objects[object].name};
    };
    const auto add = [&](synth::Frame frame, const protocol::Request& request) {
      score.push_back({static_cast<double>(frame) / bullet::kFrameRate_hz, protocol::format(request)});
    };
    for (const synth::Event& event : step.events) add(event.frame, protocol::request_for(event, ref(event.object)));
    for (const scene::RestDamping& damping : step.dampings) {
      for (const protocol::Hold& damper : protocol::dampers_for(damping.dampers, ref(damping.object)))
        add(damping.frame, damper);
    }
  }
  score.push_back({world.time_s(), {"/c_set", {0, 0.f}}});  // the usual end of a score
  const auto written = write_output(path, wire::encode_score(score));
  return written ? ExitCode::ok : complain(written);
}

ExitCode run(const Options& options) {
  const auto scene = scene::read_scene(options.scene, preset_folder().value_or(std::filesystem::path()));
  if (!scene) return complain(scene);
  auto world = make_world(*scene);
  if (!world) return complain({world.error().kind, options.scene.string() + ": " + world.error().message});
  for (const int signal : {SIGINT, SIGTERM}) std::signal(signal, [](int) { interrupted = true; });
  const double seconds = options.seconds.value_or(scene->duration_s);
  return options.events ? write_events(*options.events, *scene, *world, seconds)
                        : play(options, *scene, *world, seconds);
}

}  // namespace

int main(int argc, char** argv) {
  Options options;
  manual::App app("Simulates a scene in the physics engine Bullet, and sends its contacts to a daemon.",
                  "ringdown-bullet");
  app.add_option("scene", options.scene, "Scene file (docs/use/scenes.md)")->type_name("FILE")->required();
  app.add_option("--to", options.to, "The daemon")->type_name("URL")->capture_default_str();
  app.add_option("--events", options.events, "Send nothing: write an OSC score, for `ringdown render --events`")
      ->type_name("FILE");
  app.add_option("--seconds", options.seconds, "Duration in seconds; default: the scene's")
      ->type_name("SECONDS")
      ->check(manual::between(0.0, wire::kMaxScore / 2));
  app.add_option("--lead", options.lead_s, "Minimum time in seconds by which an event is sent ahead")
      ->type_name("SECONDS")
      ->check(manual::between(0.0, 10.0))
      ->capture_default_str();
  app.add_flag("--no-load", options.no_load, "Do not load the scene's objects, because the daemon has them already");
  if (const auto ended = manual::parse(app, argc, argv)) return static_cast<int>(*ended);
  return protocol::exit_status([&] { return run(options); });
}
