// ringdown scene export: a scene as a glTF file that other programs read.
#include "clients/cli/long_work.h"
#include "clients/cli/verb.h"
#include "engine/base/atomic_file.h"
#include "engine/base/folders.h"
#include "engine/base/output_file.h"
#include "engine/gltf/gltf_file.h"
#include "engine/modal/bank_file.h"
#include "engine/scene/gltf/picture_writer.h"
#include "engine/scene/gltf/scene.h"
#include "engine/scene/gltf/writer.h"
#include "engine/scene/foley/recording.h"
#include "engine/scene/scene_file.h"
#include "packaging/manual/command_line.h"

#include <cstdio>
#include <filesystem>
#include <memory>
#include <optional>
#include <span>
#include <string>
#include <utility>
#include <vector>

namespace ringdown::cli {
namespace {

struct SceneArguments {
  std::string scene;
  std::filesystem::path output;
  std::optional<double> animate_fps, seconds;
  bool plain = false;
};

Result<scene::SceneDescription> read(const std::filesystem::path& path) {
  if (!scene::is_gltf(path)) return scene::read_scene(path, preset_folder().value_or(std::filesystem::path()));
  const auto text = read_whole_file(path, modal::kMaxBankFileBytes);
  if (!text) return fail(text);
  auto read = scene::parse_gltf_scene(std::as_bytes(std::span(*text)), path, modal::files_beside(path));
  if (!read) return fail(read);
  for (const std::string& note : read->notes) complain(note, ExitCode::ok);
  return std::move(read->scene);
}

// Simulates the scene, which then has its poses as keyframes.
Result<void> animate(scene::SceneDescription& scene, const SceneArguments& arguments,
                     const std::vector<modal::Bank>& banks, const std::stop_token& stop) {
  if (arguments.seconds) scene.duration_s = *arguments.seconds;
  std::vector<scene::SoundingObject> objects;
  for (std::size_t k = 0; k < banks.size(); ++k)
    objects.push_back(
        {scene.objects[k].name, static_cast<synth::ObjectNumber>(k), std::make_shared<const modal::Bank>(banks[k])});
  auto recording =
      scene::record(scene, objects, *arguments.animate_fps, [&stop](double) { return !stop.stop_requested(); });
  if (!recording) return fail(recording);
  for (const std::string& notice : recording->notices) complain(notice, ExitCode::ok);
  scene = std::move(recording->scene);
  return {};
}

ExitCode export_scene(const SceneArguments& arguments, const std::stop_token& stop) {
  if (!arguments.animate_fps && (arguments.plain || arguments.seconds))
    return complain("--plain and --seconds are about keyframes; add --animate and the frames in a second",
                    ExitCode::usage);
  const auto path = preset_or_file(arguments.scene, PresetKind::scene);
  if (!path) return complain(path.error());
  auto scene = read(*path);
  if (!scene) return complain(scene.error());
  std::vector<modal::Bank> banks;
  for (const scene::ObjectDescription& object : scene->objects) {
    auto bank = modal::read_bank(object.bank);
    if (!bank) return complain(bank.error());
    banks.push_back(*std::move(bank));
  }
  if (arguments.animate_fps) {
    if (const auto animated = animate(*scene, arguments, banks, stop); !animated) return complain(animated.error());
  }
  const auto bytes = arguments.plain ? scene::to_picture_glb(*scene, banks) : scene::to_glb(*scene, banks);
  if (!bytes) return complain(bytes.error());
  if (const auto written = write_output(arguments.output, *bytes); !written) return complain(written.error());
  std::printf("%s: %zu bodies, %zu objects\n", arguments.output.c_str(), scene->bodies.size(), scene->objects.size());
  return ExitCode::ok;
}

}  // namespace

void add_scene_verb(manual::App& app, ExitCode& outcome) {
  auto arguments = std::make_shared<SceneArguments>();
  manual::App* verb = app.add_subcommand("scene", "Works on scenes.");
  verb->require_subcommand(1);
  manual::App* to_gltf =
      verb->add_subcommand("export", "Writes a scene with its banks as a .glb file, for other programs.");
  to_gltf->add_option("scene", arguments->scene, "The scene: a .toml file, or the name of a preset.")
      ->type_name("FILE")
      ->required();
  to_gltf->add_option("-o,--output", arguments->output, "The .glb file to write.")->type_name("FILE")->required();
  to_gltf
      ->add_option("--animate", arguments->animate_fps,
                   "Simulate the scene, and write where its bodies are as keyframes, so many in a second.")
      ->check(manual::between(1.0, 1000.0));
  to_gltf->add_option("--seconds", arguments->seconds, "Length of the simulation; default: the scene's duration.")
      ->check(manual::between(0.01, 3600.0));
  to_gltf->add_flag("--plain", arguments->plain,
                    "With --animate: no banks and no physics, but meshes, materials by name, keyframes and the camera, "
                    "as programs for pictures export them.");
  to_gltf->callback([arguments, &outcome] {
    outcome = run_cancellable([&](const std::stop_token& stop) { return export_scene(*arguments, stop); });
  });
}

}  // namespace ringdown::cli
