// Everything the daemon answers, one struct each, in scsynth's manner. schema.h turns them into messages and back.
//
// On the wire replies use the OSC types i, f and s only: Pure Data's parser knows no others. [any thread]
#pragma once

#include "engine/base/one_of.h"
#include "engine/base/vec3.h"
#include "engine/modal/material_scale.h"
#include "protocol/wire/message.h"

#include <cstdint>
#include <optional>
#include <string>

namespace ringdown::protocol {

struct Done {  // /done
  std::string address;
  std::optional<std::int32_t> number;
};
struct Fail {  // /fail
  std::string address;
  std::string sentence;
};
struct StatusReply {  // /status.reply
  std::int32_t objects = 0;
  std::int32_t sounding_objects = 0;
  std::int32_t sounding_modes = 0;
  std::int32_t bodies = 0;
  double sample_rate_hz = 0;
  std::int32_t block_frames = 0;
  double load_mean = 0;
  double load_peak = 0;
  std::int32_t xruns = 0;
  std::int32_t dropped_events = 0;
  std::int32_t late_events = 0;
  std::int32_t merged_events = 0;
  double load_p99 = 0;
  std::int32_t misses = 0;
  std::int32_t own_xruns = 0;
  std::int32_t hidden_modes = 0;
  std::int32_t shed = 0;
  double slowed_s = 0;
  double skipped_s = 0;
  bool recording = false;
  double captured_s = 0;
  double full_scale_pa = 0;  // the sound pressure at 1 m that is a sample of 1
  std::int32_t limited = 0;
  std::int32_t coupled_objects = 0;
  double psi = 1;
  std::optional<std::string> capture;  // the file; absent: nothing is being captured
};
struct VersionReply {  // /version.reply
  std::string program;
  std::string version;
  std::int32_t protocol = 0;
};
struct Synced {  // /synced
  std::int32_t id = 0;
};

struct ObjectReply {  // /object.reply
  std::int32_t number = 0;
  std::string name;
  std::int32_t version = 0;     // of its bank: grows when it gets a new one
  std::int32_t bank_bytes = 0;  // the size of the bank's file
  std::string bank_content;     // names what is in it: 32 hexadecimal digits; files that share them are the same
  std::string bank;             // its path
  std::int32_t modes = 0;       // of the bank
  std::int32_t first_mode = 0, selected_modes = 0;
  modal::MaterialScale scale;
  double gain = 1, pan = 0;
  bool mute = false, solo = false;
  double level_m = 0;  // of the liquid in it; 0 where its bank knows no levels
  std::optional<std::string> group;
};
struct BankReply {  // /bank.reply
  std::string name;
  std::int32_t version = 0;  // as in ObjectReply
  std::int32_t offset = 0;
  std::int32_t total = 0;  // bytes of the file
  wire::Blob bytes;
};
struct PiecesReply {  // /pieces.reply
  std::string name;
  std::int32_t pattern = 0, patterns = 0;
  bool broken = false;
  std::int32_t pieces = 0;  // number of /pieces.piece that follow the patterns
  bool armed = false;       // with this pattern
  double strength_pa = 0;   // as /strength set it; 0: no blow breaks it
};
struct PatternReply {  // /pieces.pattern
  std::int32_t number = 0;
  Vec3 at_m;
  std::int32_t pieces = 0;
  double crack_energy_j = 0;
};
struct PieceReply {  // /pieces.piece
  std::int32_t number = 0;
  std::string name;
  std::int32_t object = -1;  // -1: it has no mode that rings
  double mass_kg = 0;
  Vec3 center_m, inertia_kg_m2;
  double x = 0, y = 0, z = 0, w = 1;  // principal axes -> object frame
  Vec3 velocity_m_s, spin_rad_s;
};
struct BrokenReply {  // /broken
  std::string name;
  std::int32_t pattern = 0;
  std::int32_t pieces = 0;  // number of /pieces.piece that follow
};
struct SceneReply {  // /scene.reply
  std::int32_t version = 0;
  std::int32_t bodies = 0, statics = 0;  // numbers of /scene.body and /scene.static that follow
  double duration_s = 0;
  Vec3 camera_m, target_m;
  double field_of_view_degrees = 0;  // vertical; 0: the scene names no camera
  std::optional<std::string> file;   // absent: there is no scene
};
struct SceneBody {  // /scene.body
  std::int32_t version = 0;
  std::int32_t id = 0;
  std::string name, object;  // "-": silent
  std::string shape;         // "box", "sphere", "convex", "trimesh"
  Vec3 size_m;               // of the shape's bounding box
  bool fixed = false;
};
struct SceneStatic {  // /scene.static
  std::int32_t version = 0;
  std::int32_t number = 0;
  std::string name;
  std::string shape;                  // "plane", "box"
  Vec3 size_m;                        // edges of a box; 0 0 0 for a plane
  Vec3 position_m;                    // the box's centre; a plane's point nearest to the origin
  double x = 0, y = 0, z = 0, w = 1;  // a plane's normal is the turned z axis
};
struct BrowseReply {       // /browse.reply
  std::int32_t files = 0;  // number of /browse.file that follow
};
struct BrowseFile {  // /browse.file
  std::int32_t number = 0;
  std::string kind;  // "scene", "bank"
  std::string path;  // as /scene/load and /load take it
};

// Notices, which are sent to subscribers in bundles.
struct NotifyObject {  // /notify.object
  std::int32_t number = 0;
  std::string name;
  bool loaded = true;
};
struct NotifyGroup {  // /notify.group
  std::int32_t number = 0;
  std::string name;
  std::optional<std::string> group;
};
struct NotifyContact {  // /notify.contact
  std::string object;
  Vec3 point_m, impulse_ns;  // object frame
  double contact_time_s = 0;
};
struct NotifyPeak {  // /notify.peak
  double peak = 0;
};
struct NotifyObjectPeak {  // /notify.object_peak
  std::string object;
  double peak = 0;
};
struct NotifyLoad {  // /notify.load
  double mean = 0, peak = 0;
  std::int32_t xruns = 0, sounding_objects = 0, sounding_modes = 0;
};
struct NotifyBody {  // /notify.body
  std::int32_t id = 0;
  std::string name, object;  // "-": silent
  Vec3 position_m;
  double x = 0, y = 0, z = 0, w = 1;  // unit quaternion: object frame -> scene frame
};

struct NotifyScene {         // /notify.scene
  std::int32_t version = 0;  // grows when the scene, or a body's shape or object, changes
  double time_s = 0;         // at which its bodies are where they are said to be
  bool paused = false;
};
struct NotifySound {       // /notify.sound
  std::int32_t frame = 0;  // of the first sample, modulo kFrameModulus
  double sample_rate_hz = 0;
  wire::Blob samples;  // float32, left right left right ... (message.h)
};
struct NotifyModes {  // /notify.modes
  std::string object;
  std::int32_t first = 0;  // the lowest of them; modes count by ascending frequency
  wire::Blob amplitudes;   // float32
};

inline constexpr std::int32_t kFrameModulus = 1 << 30;

using Replies =
    Types<Done, Fail, StatusReply, VersionReply, Synced, ObjectReply, BankReply, PiecesReply, PatternReply, PieceReply,
          BrokenReply, SceneReply, SceneBody, SceneStatic, BrowseReply, BrowseFile, NotifyObject, NotifyGroup,
          NotifyContact, NotifyPeak, NotifyObjectPeak, NotifyLoad, NotifyBody, NotifyScene, NotifySound, NotifyModes>;
using Reply = OneOf<Replies>;

}  // namespace ringdown::protocol

extern template class ringdown::detail::OneOfStorage<ringdown::protocol::Replies>;
