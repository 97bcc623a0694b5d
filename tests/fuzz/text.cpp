#include "engine/bake/object_file.h"
#include "engine/materials/material_library.h"
#include "engine/microtuning/scala.h"
#include "engine/scene/scene_file.h"
#include "engine/scene/world.h"
#include "packaging/manual/command_line.h"
#include "server/options.h"
#include "server/session/note_map.h"
#include "server/session/state.h"
#include "server/settings.h"
#include "tests/fuzz/targets.h"

#include <sys/mman.h>
#include <unistd.h>

#include <algorithm>
#include <cmath>
#include <sstream>

namespace ringdown::fuzz {
namespace {

// A file that exists in memory only.
class MemoryFile {
 public:
  explicit MemoryFile(std::string_view text) : descriptor_(::memfd_create("text", MFD_CLOEXEC)) {
    expect(::write(descriptor_, text.data(), text.size()) == static_cast<ssize_t>(text.size()), "memory for a file");
  }
  ~MemoryFile() { ::close(descriptor_); }
  MemoryFile(const MemoryFile&) = delete;
  MemoryFile& operator=(const MemoryFile&) = delete;
  [[nodiscard]] std::filesystem::path path() const { return "/proc/self/fd/" + std::to_string(descriptor_); }

 private:
  int descriptor_;
};

// Bodies without objects need no bank: those scenes are set in motion, and must stay finite.
void play(const ringdown::scene::SceneDescription& description) {
  if (description.bodies.size() + description.statics.size() > 16) return;
  auto world = ringdown::scene::World::create(description, {}, 48000);
  if (!world) return expect(!world.error().message.empty(), "a refusal has a sentence");
  for (int step = 0; step < 20; ++step) {
    for (const synth::Event& event : world->step().events) {
      const auto* strike = event.verb.get_if<synth::verb::Strike>();
      expect(!strike || (is_finite(strike->impulse_ns) && is_finite(strike->point_m)), "a strike of a scene is finite");
    }
  }
  for (const ringdown::scene::BodyState& body : world->bodies())
    expect(is_finite(body.position_m), "a body is somewhere");
}

std::string_view text_of(Bytes file) { return {reinterpret_cast<const char*>(file.data()), file.size()}; }

// An accepted number is finite, wherever it came from.
void check_numbers(const server::DaemonOptions& options) {
  for (const double number : {options.sample_rate_hz, options.merge_s, options.seconds.value_or(0),
                              options.mixer.budget, options.mixer.floor_db, options.mixer.limiter_db.value_or(0)}) {
    expect(std::isfinite(number), "a number of an option is finite");
  }
  for (const server::DaemonOptions::Input& input : options.inputs) {
    expect(is_finite(input.point_m.value_or(Vec3{})) && is_finite(input.force_n.value_or(Vec3{})),
           "an input's vectors are finite");
  }
}

}  // namespace

void scene(Bytes file) {
  const auto scene = ringdown::scene::parse_scene(text_of(file), "scene.toml", "/nowhere");
  if (scene) play(*scene);
}

void material(Bytes file) { static_cast<void>(bake::read_material(MemoryFile(text_of(file)).path())); }

void object(Bytes file) { static_cast<void>(bake::read_object(MemoryFile(text_of(file)).path())); }

void notes(Bytes file) { static_cast<void>(session::read_note_map(MemoryFile(text_of(file)).path())); }

void scala(Bytes file) {
  const MemoryFile kept(text_of(file));
  for (const bool is_scale : {true, false}) {
    const auto tuning =
        is_scale ? microtuning::read_tuning(kept.path(), "") : microtuning::read_tuning("", kept.path());
    if (!tuning) continue;
    expect(std::ranges::all_of(tuning->semitones, [](double pitch) { return std::isfinite(pitch); }),
           "keys have finite pitches");
  }
}

void state(Bytes file) {
  const auto state = session::parse_state(text_of(file), "state.toml");
  if (!state) return;
  expect(session::parse_state(session::to_toml(*state), "again").has_value(), "a state survives being written");
}

void settings(Bytes file) {
  if (text_of(file).find("masking") != std::string_view::npos) return;  // it prints
  const MemoryFile kept(text_of(file));
  server::DaemonOptions options;
  manual::App app("", "ringdownd");
  server::add_options(app, options);
  if (server::read_settings(app, kept.path())) check_numbers(options);
}

void options(Bytes words) {
  if (text_of(words).find("--masking") != std::string_view::npos) return;  // it prints
  server::DaemonOptions options;
  manual::App app("", "ringdownd");
  server::add_options(app, options);
  std::vector<std::string> arguments;
  std::istringstream lines{std::string(text_of(words))};
  for (std::string line; std::getline(lines, line);) arguments.push_back(line);
  if (app.take(arguments).empty()) check_numbers(options);
}

}  // namespace ringdown::fuzz
