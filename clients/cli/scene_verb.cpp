// ringdown scene export: a scene as a glTF file that other programs read.
#include "clients/cli/verb.h"
#include "engine/base/folders.h"
#include "engine/base/output_file.h"
#include "engine/modal/bank_file.h"
#include "engine/scene/gltf/writer.h"
#include "engine/scene/scene_file.h"
#include "packaging/manual/command_line.h"

#include <cstdio>
#include <filesystem>
#include <memory>
#include <string>
#include <utility>
#include <vector>

namespace ringdown::cli {
namespace {

struct SceneArguments {
  std::string scene;
  std::filesystem::path output;
};

ExitCode export_scene(const SceneArguments& arguments) {
  const auto path = preset_or_file(arguments.scene, PresetKind::scene);
  if (!path) return complain(path.error());
  const auto scene = scene::read_scene(*path, preset_folder().value_or(std::filesystem::path()));
  if (!scene) return complain(scene.error());
  std::vector<modal::Bank> banks;
  for (const scene::ObjectDescription& object : scene->objects) {
    auto bank = modal::read_bank(object.bank);
    if (!bank) return complain(bank.error());
    banks.push_back(*std::move(bank));
  }
  const auto bytes = scene::to_glb(*scene, banks);
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
  to_gltf->callback([arguments, &outcome] { outcome = export_scene(*arguments); });
}

}  // namespace ringdown::cli
