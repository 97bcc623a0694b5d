#include "engine/bake/material_library.h"
#include "engine/bake/object_file.h"
#include "engine/scene/scene_file.h"
#include "engine/scene/world.h"
#include "server/options.h"
#include "server/session/note_map.h"
#include "server/session/state.h"
#include "server/settings.h"
#include "tests/fuzz/targets.h"

#include <CLI/CLI.hpp>

#include <sys/mman.h>
#include <unistd.h>

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
void play(const scene::SceneDescription& description) {
  if (description.bodies.size() + description.statics.size() > 16) return;
  auto world = scene::World::create(description, {}, 48000);
  if (!world) return expect(!world.error().message.empty(), "a refusal has a sentence");
  for (int step = 0; step < 20; ++step) {
    for (const synth::Event& strike : world->step().events) {
      expect(is_finite(strike.impulse_ns) && is_finite(strike.point_m), "a strike of a scene is finite");
    }
  }
  for (const scene::BodyState& body : world->bodies()) expect(is_finite(body.position_m), "a body is somewhere");
}

void read_settings_text(std::string_view text) {
  const MemoryFile file(text);
  server::DaemonOptions options;
  CLI::App app("", "ringdownd");
  server::add_options(app, options);
  static_cast<void>(server::read_settings(app, file.path()));
}

}  // namespace

void text(Bytes file) {
  if (file.empty()) return;
  const auto kind = static_cast<char>(file.front());
  const std::string_view text(reinterpret_cast<const char*>(file.data()) + 1, file.size() - 1);
  if (kind == 's') {
    const auto scene = scene::parse_scene(text, "scene.toml", "/nowhere");
    if (scene) play(*scene);
  } else if (kind == 'm') {
    static_cast<void>(bake::read_material(MemoryFile(text).path()));
  } else if (kind == 'o') {
    static_cast<void>(bake::read_object(MemoryFile(text).path()));
  } else if (kind == 'n') {
    static_cast<void>(session::read_note_map(MemoryFile(text).path()));
  } else if (kind == 't') {
    const auto state = session::parse_state(text, "state.toml");
    if (state)
      expect(session::parse_state(session::to_toml(*state), "again").has_value(), "a state survives being written");
  } else {
    read_settings_text(text);
  }
}

}  // namespace ringdown::fuzz
