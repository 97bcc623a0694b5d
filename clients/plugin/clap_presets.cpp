#include "clients/plugin/clap_presets.h"

#include "clients/plugin/sources.h"
#include "engine/base/toml_table.h"

#include <cstring>
#include <memory>
#include <string>
#include <system_error>

namespace ringdown::plugin::clap {
namespace {

const ProviderDescriptor kAbout{CLAP_VERSION, "ringdown.presets", "Ringdown's presets", "Ringdown"};

std::filesystem::path& binary_path() {
  static std::filesystem::path path;
  return path;
}

struct Listing {
  Provider outer;  // what the host has: first, so that its address is the Listing's
  const Indexer* indexer;
};

const Listing& of(const Provider* provider) { return *reinterpret_cast<const Listing*>(provider); }

bool declare(const Provider* provider) {
  const Indexer* const to = of(provider).indexer;
  const Location factory{kFactoryContent, "Presets", kInPlugin, nullptr};
  if (!to->declare_location(to, &factory)) return false;
  std::error_code error;
  const std::string own = own_folder().string();
  if (!std::filesystem::is_directory(own, error)) return true;
  const FileType bank{"Bank", "The modes of an object", "glb"}, map{"Note map", "Objects by keys", "toml"};
  const Location user{kUserContent, "Own objects", kFile, own.c_str()};
  return to->declare_filetype(to, &bank) && to->declare_filetype(to, &map) && to->declare_location(to, &user);
}

void describe_common(const MetadataReceiver* to) {
  const PluginId plugin{"clap", kPluginId};
  to->add_plugin_id(to, &plugin);
  to->add_feature(to, "instrument");
}

// Adds what the preset's object file says; note maps and installations without that file say less.
void describe_object(const std::string& preset, const MetadataReceiver* to) {
  auto file = TomlTable::read(presets_near(binary_path()) / "objects" / (preset + ".toml"));
  if (!file) return;
  std::string description, material;
  file->text("description", description);
  file->text("material", material);
  if (!description.empty()) to->set_description(to, description.c_str());
  if (!material.empty()) to->add_feature(to, material.c_str());
}

bool list_presets(const MetadataReceiver* to) {
  for (const std::string_view name : kPresets) {
    const std::string preset(name);
    if (!to->begin_preset(to, preset.c_str(), preset.c_str())) return true;
    describe_common(to);
    to->add_creator(to, "Ringdown");
    to->add_feature(to, std::string(family_of(name)).c_str());
    describe_object(preset, to);
  }
  return true;
}

bool list_file(const std::filesystem::path& path, const MetadataReceiver* to) {
  std::error_code error;
  if (!std::filesystem::is_regular_file(path, error)) {
    to->on_error(to, error.value(), formatted("{}: this file cannot be read", path.string()).c_str());
    return false;
  }
  if (to->begin_preset(to, path.stem().c_str(), nullptr)) describe_common(to);
  return true;
}

bool get_metadata(const Provider*, std::uint32_t kind, const char* location, const MetadataReceiver* to) {
  if (kind == kInPlugin) return list_presets(to);
  return kind == kFile && location && list_file(location, to);
}

void destroy(const Provider* provider) { const std::unique_ptr<const Listing> gone(&of(provider)); }

const Provider* create(const PresetFactory*, const Indexer* indexer, const char* id) {
  if (!indexer || !id || std::strcmp(id, kAbout.id) != 0) return nullptr;
  const auto no_extension = [](const Provider*, const char*) -> const void* { return nullptr; };
  auto made =
      std::make_unique<Listing>(Listing{{&kAbout, nullptr, declare, destroy, get_metadata, no_extension}, indexer});
  return &made.release()->outer;
}

const PresetFactory kFactory{[](const PresetFactory*) { return std::uint32_t{1}; },
                             [](const PresetFactory*, std::uint32_t index) { return index == 0 ? &kAbout : nullptr; },
                             create};

}  // namespace

const PresetFactory* preset_factory(const std::filesystem::path& binary) {
  binary_path() = binary;
  return &kFactory;
}

}  // namespace ringdown::plugin::clap
