// Everything a client can ask of Ringdown, one struct each. schema.h turns messages into these and back.
//
// Values are SI and already checked: finite, inside the range the schema states. Points and impulses are in the
// object's own frame. A member's initialiser is the default of an optional argument. [any thread]
#pragma once

#include "engine/base/rotation.h"
#include "engine/base/vec3.h"
#include "engine/modal/damper.h"
#include "engine/modal/material_scale.h"
#include "engine/modal/mode_range.h"
#include "engine/synth/event.h"
#include "protocol/defaults.h"
#include "protocol/one_of.h"
#include "protocol/wire/message.h"

#include <cstdint>
#include <optional>
#include <string>
#include <vector>

namespace ringdown::protocol {

// An object as a client names it: by name, or by the number that /load replied.
struct ObjectRef {
  std::string name;                     // empty when given by number
  std::optional<std::uint32_t> number;  // empty when given by name
  friend bool operator==(const ObjectRef&, const ObjectRef&) = default;
};

struct Strike {  // /object/{object}/strike
  ObjectRef object;
  Vec3 point_m, impulse_ns;
  double contact_time_s = kDefaultContactTimeS;
};
struct StrikeVertex {  // /object/{object}/strike_vertex
  ObjectRef object;
  std::uint32_t vertex = 0;
  Vec3 impulse_ns;
  double contact_time_s = kDefaultContactTimeS;
};
// Many strikes in one message, for simulators: records as in bulk.h.
struct StrikeMany {  // /strikes
  wire::Blob records;
};
struct SetGain {  // /object/{object}/gain
  ObjectRef object;
  double gain = 1;
  double ramp_s = 0;
};
struct SetPan {  // /object/{object}/pan
  ObjectRef object;
  double pan = 0;
};
struct SetMaterial {  // /object/{object}/material
  ObjectRef object;
  modal::MaterialScale scale;
};
// Lays a damper on the object, or takes it away.
struct SetDamper {  // /object/{object}/hold
  ObjectRef object;
  modal::Damper damper;
  std::uint32_t number = 0;  // which of the object's dampers, below modal::kMaxDampers
};
struct SetGroup {  // /object/{object}/group
  ObjectRef object;
  std::optional<std::string> group;  // nothing: in none
};
// While any object is soloed, only soloed ones are heard; a muted one never is.
struct SetMute {  // /object/{object}/mute
  ObjectRef object;
  bool on = true;
};
struct SetSolo {  // /object/{object}/solo
  ObjectRef object;
  bool on = true;
};
struct ClearObject {  // /object/{object}/clear
  ObjectRef object;
  double ramp_s = 0;
};
// Sets modes of the object going, each at the same amplitude. Modes count from the lowest frequency, from 0.
struct RingModes {  // /object/{object}/ring
  ObjectRef object;
  std::uint32_t first = 0;
  std::uint32_t count = 1;
  double amplitude = kDefaultRingAmplitude;
};
// Chooses the modes that the object has from now on.
struct SelectModes {  // /object/{object}/modes
  ObjectRef object;
  modal::ModeRange range;
};
// Whether the subscriber is sent the amplitudes of the object's modes.
struct WatchObject {  // /object/{object}/watch
  ObjectRef object;
  bool on = true;
};
struct DescribeObject {  // /object/{object}/describe
  ObjectRef object;
};
// A piece of the object's bank file.
struct ReadBank {  // /object/{object}/bank
  ObjectRef object;
  std::uint32_t offset = 0;
  std::uint32_t bytes = kMaxBankBytes;
};
// An audio input that excites the object: a sample of 1 is this force.
struct Excite {  // /object/{object}/excite
  ObjectRef object;
  std::uint32_t input = 1;  // to kMaxInputs
  Vec3 point_m, force_n;    // no force: the input excites the object no more
};
// Something slides or rolls on the object.
struct SetContact {  // /object/{object}/contact
  ObjectRef object;
  Vec3 point_m;
  synth::Contact contact;
};
// A bow on the object, which feels how it moves.
struct SetBow {  // /object/{object}/bow
  ObjectRef object;
  Vec3 point_m;
  synth::Touch touch{.kind = synth::Touch::Kind::bow, .friction = 0.8};
};
// A mallet that flies at the object.
struct HitMallet {  // /object/{object}/mallet
  ObjectRef object;
  Vec3 point_m, velocity_m_s;
  synth::Touch touch{.kind = synth::Touch::Kind::mallet, .stiffness = 1e7, .bounce = 0.9};
};
// Another object that touches this one.
struct SetCoupling {  // /object/{object}/couple
  ObjectRef object;
  Vec3 point_m;
  ObjectRef other;
  synth::Touch touch{.kind = synth::Touch::Kind::couple, .friction = 0.3, .stiffness = 1e8, .bounce = 0.6};
};
// Where the object's frame lies in the scene, for a listener.
struct SetPose {  // /object/{object}/pose
  ObjectRef object;
  Pose pose;
};
// Many poses in one message: records as in bulk.h.
struct PoseMany {  // /poses
  wire::Blob records;
};
// Where the listener's frame lies: x to the front, y to the left, z up.
struct SetListener {  // /listener
  Pose pose;
};
struct ListenerOff {};   // /listener/off
struct SetListenerAir {  // /listener/air
  double temperature_c = 20;
  double humidity_percent = 50;
};
struct FreeObject {  // /object/{object}/free
  ObjectRef object;
};
// Loads a bank under a new name, or gives an existing object a new bank while the old one rings out.
struct LoadObject {  // /load
  std::string name;
  std::string bank_path;
};
struct ClearAll {};  // /clear

struct SceneLoad {  // /scene/load
  std::string path;
};
struct ScenePause {  // /scene/pause
  bool paused = true;
};
// Drops a new body into the scene. `object` sounds; without one the body is silent but strikes others.
struct SpawnBox {  // /scene/spawn/box
  std::optional<ObjectRef> object;
  Vec3 position_m, velocity_m_s;
  Vec3 size_m;               // edge lengths; 0 0 0: the bounding box of the object's bank
  double density_kg_m3 = 0;  // 0: mass and inertia from the object's bank
};
struct SpawnSphere {  // /scene/spawn/sphere
  std::optional<ObjectRef> object;
  Vec3 position_m, velocity_m_s;
  double radius_m = 0;       // 0: the radius that encloses the object's bank
  double density_kg_m3 = 0;  // 0: mass and inertia from the object's bank
};
struct SceneClear {};  // /scene/clear
// An impulse in the scene's axes at the body's centre of mass.
struct ScenePush {  // /scene/push
  std::int32_t body = 0;
  Vec3 impulse_ns;
};
struct SceneDescribe {};  // /scene/describe

struct Notify {  // /notify
  bool on = true;
  double rate_hz = 20;
};
// Whether the subscriber is sent the samples of the mix.
struct WatchSound {  // /watch/sound
  bool on = true;
};
struct Browse {};  // /browse
// A sine in the mix.
struct TestTone {                            // /test_tone
  double amplitude = kDefaultRingAmplitude;  // 0: none
  double frequency_hz = 440;
};
struct SaveState {  // /state/save
  std::string path;
};
// The scene as it is set now, as a scene file.
struct SaveScene {  // /scene/save
  std::string path;
  bool replace = false;  // a scene that was saved there before
};
struct RecordStart {  // /record/start
  std::string path;
};
struct RecordStop {                 // /record/stop
  std::optional<std::string> path;  // in place of the one given at the start
};
// The daemon captures what is heard in a sound file.
struct CaptureStart {  // /capture/start
  std::string path;
};
struct CaptureStop {};  // /capture/stop

struct Status {};  // /status
// A blow sets the object in motion as a whole. Its strikes are requests of their own.
struct Click {  // /object/{object}/click
  ObjectRef object;
  Vec3 impulse_ns;
  double contact_time_s = kDefaultContactTimeS;
};
struct Version {};  // /version
struct Sync {       // /sync
  std::int32_t id = 0;
};
struct Quit {};  // /quit

using Requests = Types<Strike, StrikeVertex, StrikeMany, SetGain, SetPan, SetMaterial, SetDamper, SetGroup, SetMute,
                       SetSolo, RingModes, SelectModes, WatchObject, DescribeObject, ReadBank, Excite, ClearObject,
                       SetContact, SetBow, HitMallet, SetCoupling, Click, SetPose, PoseMany, SetListener, ListenerOff,
                       SetListenerAir, FreeObject, LoadObject, ClearAll, SceneLoad, ScenePause, SpawnBox, SpawnSphere,
                       SceneClear, ScenePush, SceneDescribe, Notify, WatchSound, Browse, TestTone, SaveState, SaveScene,
                       RecordStart, RecordStop, CaptureStart, CaptureStop, Status, Version, Sync, Quit>;
using Request = OneOf<Requests>;
extern template class OneOf<Requests>;

// The request that would make this event of `object`.
Request request_for(const synth::Event& event, const ObjectRef& object);

// The requests that would lay these dampers on `object`, by ascending number.
std::vector<SetDamper> dampers_for(const modal::Dampers& dampers, const ObjectRef& object);

}  // namespace ringdown::protocol
