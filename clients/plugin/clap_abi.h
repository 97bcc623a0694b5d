// The extensions of CLAP that DPF 1.6 has no headers for, as https://github.com/free-audio/clap publishes them. Names
// and order of members are ours and CLAP's in turn; what hosts rely on is the layout and the identifiers.
#pragma once

#include "src/clap/plugin.h"
#include "src/clap/stream.h"
#include "src/clap/string-sizes.h"

#include <array>
#include <cstddef>
#include <cstdint>

namespace ringdown::plugin::clap {

struct Tail {
  static constexpr const char* kId = "clap.tail";
  std::uint32_t (*get)(const clap_plugin_t*);  // [frames]; INT32_MAX and more: without end [main, audio]
};
struct HostTail {
  void (*changed)(const clap_host_t*);  // [audio]
};

struct Latency {
  static constexpr const char* kId = "clap.latency";
  std::uint32_t (*get)(const clap_plugin_t*);  // [frames] [main]
};

struct Voices {
  std::uint32_t count, capacity;
  std::uint64_t flags;
};
struct VoiceInfo {
  static constexpr const char* kId = "clap.voice-info";
  bool (*get)(const clap_plugin_t*, Voices*);  // [main]
};
struct HostVoiceInfo {
  void (*changed)(const clap_host_t*);  // [main]
};

struct NoteName {
  char name[CLAP_NAME_SIZE];
  std::int16_t port, key, channel;  // -1: all
};
struct NoteNames {
  static constexpr const char* kId = "clap.note-name";
  std::uint32_t (*count)(const clap_plugin_t*);  // [main]
  bool (*get)(const clap_plugin_t*, std::uint32_t index, NoteName*);
};
struct HostNoteNames {
  void (*changed)(const clap_host_t*);  // [main]
};

inline constexpr std::size_t kControlsOfPage = 8;
struct ControlPage {
  char section[CLAP_NAME_SIZE];
  clap_id id;
  char name[CLAP_NAME_SIZE];
  clap_id parameters[kControlsOfPage];  // CLAP_INVALID_ID: none
  bool is_for_preset;
};
struct RemoteControls {
  static constexpr std::array kIds = {"clap.remote-controls/2", "clap.remote-controls.draft/2"};
  std::uint32_t (*count)(const clap_plugin_t*);  // [main]
  bool (*get)(const clap_plugin_t*, std::uint32_t index, ControlPage*);
};

struct StateContext {
  static constexpr const char* kId = "clap.state-context/2";
  bool (*save)(const clap_plugin_t*, const clap_ostream_t*, std::uint32_t context);  // [main]
  bool (*load)(const clap_plugin_t*, const clap_istream_t*, std::uint32_t context);
};

enum LocationKind : std::uint32_t { kFile = 0, kInPlugin = 1 };
struct PresetLoad {
  static constexpr std::array kIds = {"clap.preset-load/2", "clap.preset-load.draft/2"};
  bool (*from_location)(const clap_plugin_t*, std::uint32_t kind, const char* location, const char* key);  // [main]
};
struct HostPresetLoad {
  void (*on_error)(const clap_host_t*, std::uint32_t kind, const char* location, const char* key, std::int32_t os_error,
                   const char* sentence);
  void (*loaded)(const clap_host_t*, std::uint32_t kind, const char* location, const char* key);
};

// Preset discovery

using Timestamp = std::uint64_t;  // seconds since 1970; 0: unknown

struct PluginId {
  const char *abi, *id;
};
enum ContentFlags : std::uint32_t { kFactoryContent = 1, kUserContent = 2 };

struct MetadataReceiver {
  void* data;
  void (*on_error)(const MetadataReceiver*, std::int32_t os_error, const char* sentence);
  bool (*begin_preset)(const MetadataReceiver*, const char* name, const char* key);
  void (*add_plugin_id)(const MetadataReceiver*, const PluginId*);
  void (*set_soundpack_id)(const MetadataReceiver*, const char*);
  void (*set_flags)(const MetadataReceiver*, std::uint32_t);
  void (*add_creator)(const MetadataReceiver*, const char*);
  void (*set_description)(const MetadataReceiver*, const char*);
  void (*set_timestamps)(const MetadataReceiver*, Timestamp created, Timestamp changed);
  void (*add_feature)(const MetadataReceiver*, const char*);
  void (*add_extra_info)(const MetadataReceiver*, const char* key, const char* value);
};

struct FileType {
  const char *name, *description, *ending;
};
struct Location {
  std::uint32_t flags;
  const char* name;
  std::uint32_t kind;
  const char* path;  // null for kInPlugin
};
struct Soundpack {
  std::uint32_t flags;
  const char *id, *name, *description, *url, *vendor, *image_path;
  Timestamp released;
};

struct Indexer {
  clap_version_t version;
  const char *name, *vendor, *url, *version_text;
  void* data;
  bool (*declare_filetype)(const Indexer*, const FileType*);
  bool (*declare_location)(const Indexer*, const Location*);
  bool (*declare_soundpack)(const Indexer*, const Soundpack*);
  const void* (*get_extension)(const Indexer*, const char* id);
};

struct ProviderDescriptor {
  clap_version_t version;
  const char *id, *name, *vendor;
};
struct Provider {
  const ProviderDescriptor* about;
  void* data;
  bool (*init)(const Provider*);
  void (*destroy)(const Provider*);
  bool (*get_metadata)(const Provider*, std::uint32_t kind, const char* location, const MetadataReceiver*);
  const void* (*get_extension)(const Provider*, const char* id);
};

struct PresetFactory {
  static constexpr std::array kIds = {"clap.preset-discovery-factory/2", "clap.preset-discovery-factory/draft-2"};
  std::uint32_t (*count)(const PresetFactory*);
  const ProviderDescriptor* (*get_descriptor)(const PresetFactory*, std::uint32_t index);
  const Provider* (*create)(const PresetFactory*, const Indexer*, const char* id);
};

}  // namespace ringdown::plugin::clap
