// Everything a client can ask of Ringdown, one struct each. schema.h turns messages into these and back.
//
// Values are SI and already checked: finite, inside the range the schema states. Points and impulses are in the
// object's own frame. A member's initialiser is the default of an optional argument. [any thread]
#pragma once

#include "engine/base/one_of.h"
#include "engine/base/rotation.h"
#include "engine/base/vec3.h"
#include "engine/modal/damper.h"
#include "engine/modal/material_scale.h"
#include "engine/modal/mode_range.h"
#include "engine/modal/tubes/tube_tuning.h"
#include "engine/synth/events/event.h"
#include "protocol/defaults.h"
#include "protocol/wire/message.h"

#include <cstdint>
#include <optional>
#include <string>
#include <type_traits>
#include <vector>

namespace ringdown::protocol {

// An object as a client names it: by name, or by the number that /load replied.
struct ObjectRef {
  std::string name;                     // empty when given by number
  std::optional<std::uint32_t> number;  // empty when given by name
  friend bool operator==(const ObjectRef&, const ObjectRef&) = default;
};

// A verb of the mixer (engine/synth/events/verbs.h) that happens to an object, and one that happens to the listener.
// If a verb concerns a second object, as Couple does, the client names it as `other`.
template <class Verb>
struct OnObject {
  ObjectRef object;
  Verb verb;
};
template <class Verb>
requires requires(Verb verb) { verb.other; }
struct OnObject<Verb> {
  ObjectRef object;
  Verb verb;
  ObjectRef other;
};
template <class Verb>
struct OnListener {
  Verb verb;
};
template <class Verb>
using RequestOf = std::conditional_t<Verb::kEffect == synth::Effect::listens, OnListener<Verb>, OnObject<Verb>>;

using Strike = RequestOf<synth::verb::Strike>;
using StrikeVertex = RequestOf<synth::verb::StrikeVertex>;
using SetGain = RequestOf<synth::verb::Gain>;
using SetPan = RequestOf<synth::verb::Pan>;
using SetFan = RequestOf<synth::verb::Fan>;
using SetPickup = RequestOf<synth::verb::Pickup>;
using RingModes = RequestOf<synth::verb::Ring>;
using ClearObject = RequestOf<synth::verb::Clear>;
using SetContact = RequestOf<synth::verb::Contact>;
using SetBow = RequestOf<synth::verb::Bow>;
using HitMallet = RequestOf<synth::verb::Mallet>;
using SetCoupling = RequestOf<synth::verb::Couple>;
using Click = RequestOf<synth::verb::Click>;
using SetPose = RequestOf<synth::verb::Pose>;
using SetListener = RequestOf<synth::verb::Listener>;
using ListenerOff = RequestOf<synth::verb::ListenerOff>;
using SetListenerAir = RequestOf<synth::verb::ListenerAir>;

// Many strikes in one message, for simulators: records as in bulk.h.
struct StrikeMany {  // /strikes
  wire::Blob records;
};
struct SetMaterial {  // /object/{object}/material
  ObjectRef object;
  modal::MaterialScale scale;
};
// Lets the liquid in the object stand at another level.
struct SetFill {  // /object/{object}/fill
  ObjectRef object;
  double level_m = 0;  // along the liquid's `up`, in the frame of the object in its size
};
// Tunes the tubes under the object.
struct SetResonator {  // /object/{object}/resonator
  ObjectRef object;
  modal::TubeTuning tuning;
};
// Lays a damper on the object, or takes it away.
struct Hold {  // /object/{object}/hold
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
// Chooses the modes that the object has from now on.
struct SelectModes {  // /object/{object}/modes
  ObjectRef object;
  modal::ModeRange range;
};
// Starts or stops sending the amplitudes of the object's modes to the subscriber.
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
// Many poses in one message: records as in bulk.h.
struct PoseMany {  // /poses
  wire::Blob records;
};
// Makes the pieces ready that the object breaks into.
struct ArmObject {  // /object/{object}/arm
  ObjectRef object;
  std::int32_t pattern = -1;  // of its bank; -1: the finest of the first one's place
};
// A blow under which the object breaks.
struct BreakObject {  // /object/{object}/break
  ObjectRef object;
  Vec3 point_m, impulse_ns;
  double contact_time_s = synth::kDefaultContactTime_s;
  std::int32_t pattern = -1;  // -1: the one that is armed, or else the one nearest to the point
};
// The pieces go, and the object is whole.
struct MendObject {  // /object/{object}/mend
  ObjectRef object;
};
// Sets the strength of an object: later blows that cause this stress on its skin break it.
struct SetStrength {  // /object/{object}/strength
  ObjectRef object;
  double strength_pa = 0;  // 0: no blow does
};
struct DescribePieces {  // /object/{object}/pieces
  ObjectRef object;
  std::int32_t pattern = -1;  // -1: the one that is armed
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
  bool paused = false;  // until /scene/pause 0
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
// Takes a body out of the scene; SceneRestore puts it back where it was, at rest and under its number.
struct SceneRemove {  // /scene/remove
  std::int32_t body = 0;
};
struct SceneRestore {  // /scene/restore
  std::int32_t body = 0;
};
// Puts a body elsewhere, at rest. The pose is that of the object's frame.
struct ScenePlace {  // /scene/place
  std::int32_t body = 0;
  Pose pose;
};
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
// Starts or stops sending the samples of the mix to the subscriber.
struct WatchSound {  // /watch/sound
  bool on = true;
};
struct Browse {};  // /browse
// A sine in the mix.
struct TestTone {                                   // /test_tone
  double amplitude = synth::kDefaultRingAmplitude;  // 0: none
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

struct Status {};   // /status
struct Version {};  // /version
struct Sync {       // /sync
  std::int32_t id = 0;
};
struct Quit {};  // /quit

// The requests of all public verbs.
namespace detail {
template <class... Verbs>
Types<RequestOf<Verbs>...> requests_of(Types<Verbs...>);
}
using VerbRequests = decltype(detail::requests_of(synth::PublicVerbs()));

using Requests =
    Joined<VerbRequests, Types<StrikeMany, PoseMany, ClearAll, SetMaterial, SetFill, SetResonator, Hold, SetGroup,
                               SetMute, SetSolo, SelectModes, WatchObject, DescribeObject, ReadBank, Excite, ArmObject,
                               BreakObject, MendObject, SetStrength, DescribePieces, FreeObject, LoadObject, SceneLoad,
                               ScenePause, SpawnBox, SpawnSphere, SceneClear, SceneRemove, SceneRestore, ScenePlace,
                               ScenePush, SceneDescribe, Notify, WatchSound, Browse, TestTone, SaveState, SaveScene,
                               RecordStart, RecordStop, CaptureStart, CaptureStop, Status, Version, Sync, Quit>>;
using Request = OneOf<Requests>;

// The request that would make this event of `object`.
Request request_for(const synth::Event& event, const ObjectRef& object);

// The requests that would lay these dampers on `object`, by ascending number.
std::vector<Hold> dampers_for(const modal::Dampers& dampers, const ObjectRef& object);

}  // namespace ringdown::protocol

extern template class ringdown::detail::OneOfStorage<ringdown::protocol::Requests>;
