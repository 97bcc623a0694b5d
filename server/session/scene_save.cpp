#include "server/session/scene_save.h"

#include "engine/base/atomic_file.h"
#include "engine/base/folders.h"
#include "engine/modal/bank_file.h"
#include "engine/scene/scene_file.h"
#include "engine/scene/scene_text.h"
#include "server/session/file_roots.h"
#include "server/session/session.h"

#include <algorithm>

namespace ringdown::session {
namespace {

namespace fs = std::filesystem;

// Returns the bank's path in the form for a scene file in `folder`.
fs::path bank_path(const fs::path& bank, const fs::path& folder, const fs::path& presets) {
  std::error_code error;
  const fs::path whole = fs::canonical(bank, error);
  if (error) return bank;
  const auto below = [&whole](const fs::path& top) {
    const fs::path rest = whole.lexically_relative(top);
    return rest.empty() || *rest.begin() == ".." ? fs::path() : rest;
  };
  if (const fs::path rest = below(folder); !rest.empty()) return rest;
  const fs::path preset = presets.empty() ? fs::path() : below(fs::canonical(presets, error));
  return preset.empty() || fs::exists(folder / preset, error) ? whole : preset;
}

}  // namespace

scene::SceneDescription scene_of(const Session& session) {
  scene::SceneDescription scene = session.scene().description().value_or(scene::SceneDescription());
  for (const ObjectSnapshot& object : session.rack().objects()) {
    if (session.breakage().is_piece(object->number) || session.scene().pieces().contains(object->number)) continue;
    auto described = std::ranges::find(scene.objects, object->name, &scene::ObjectDescription::name);
    if (described == scene.objects.end()) described = scene.objects.insert(described, {.name = object->name});
    described->bank = object->bank;
    described->group = object->group;
    described->gain = object->gain;
    described->pan = object->pan;
    const ObjectState as_written = untuned(*object);
    described->material = as_written.material;
    described->level_m = level_m(as_written);
    described->tubes = tube_tuning(as_written);
    described->fan = {object->fan_hz, object->fan_depth};
  }
  return scene;
}

Result<void> save_scene(const Session& session, const fs::path& path) {
  scene::SceneDescription scene = scene_of(session);
  if (scene.objects.empty() && !session.scene().playing()) {
    return fail(ErrorKind::refused, "there is nothing to save: neither a scene nor an object");
  }
  const fs::path presets = preset_folder().value_or(fs::path());
  for (scene::ObjectDescription& object : scene.objects) {
    modal::BankPath bank = modal::split_bank_path(object.bank);
    bank.file = bank_path(bank.file, path.parent_path(), presets);
    object.bank = modal::bank_path(bank);
  }
  std::string text(kSceneKind.mark);
  text.append("; `ringdownd --scene` and `ringdown render --scene` play it.\n").append(to_toml(scene));
  if (const auto loads = scene::parse_scene(text, path, presets); !loads) return fail(loads);
  return write_file_atomically(path, text);
}

}  // namespace ringdown::session
