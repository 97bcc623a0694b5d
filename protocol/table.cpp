// The table of what can be asked. A new address is
//
//   - a struct in request.h, and its place among the alternatives of Request;
//   - its place in a lane (lanes.h), which says who handles it, when and on which thread;
//   - a row here, in the order of Request's alternatives, which names the lane;
//   - an overload in the visitor of that lane;
//   - its cases in tests/protocol/schema_cases.cpp.
//
// Whichever of the first four is forgotten, the compiler says so; of the last, Schema's first test does. Then
// `ringdown protocol --markdown > docs/reference/protocol.md` writes the page, which a test compares.
#include "protocol/bulk.h"
#include "protocol/quantities.h"

namespace ringdown::protocol {
namespace {

template <auto... path>
auto object() {
  return other<ValueType::object, path...>("object", "The object, by its name or by the number that /load answered.");
}

template <auto... path>
auto body_object() {
  return other<ValueType::object_or_none, path...>("object", "What sounds when it is hit.");
}

template <auto... path>
auto impulse() {
  return vector<path...>({"jx", "jy", "jz"}, kImpulse, "The impulse it receives.");
}

template <auto... path>
auto contact_time() {
  return optional(number<path...>("contact_time", kContactTime, "How long the blow lasts; longer is duller."));
}

template <auto... path>
auto position() {
  return vector<path...>({"x", "y", "z"}, kPosition, "Where its centre of mass starts, in the scene.");
}

template <auto... path>
auto velocity() {
  return optional(vector<path...>({"vx", "vy", "vz"}, kVelocity, "Its velocity at the start."));
}

template <auto... path>
auto density() {
  return optional(number<path...>("density", kDensity, "0 takes mass and inertia from the bank."));
}

template <auto... path>
auto pose(std::string_view sentence) {
  auto columns = vector<path..., &Pose::position_m>({"x", "y", "z"}, kPosition, sentence);
  const auto turn = [&](auto part) { columns.push_back(optional(part)[0]); };
  turn(number<path..., &Pose::rotation, &Rotation::w>(
      "qw", kUnit, "How it is turned, as a unit quaternion: cos(a / 2) for a turn by the angle a."));
  turn(number<path..., &Pose::rotation, &Rotation::x>("qx", kUnit, "The axis of the turn, times sin(a / 2)."));
  turn(number<path..., &Pose::rotation, &Rotation::y>("qy", kUnit, "Its y component."));
  turn(number<path..., &Pose::rotation, &Rotation::z>("qz", kUnit, "Its z component."));
  return columns;
}

const ObjectRef kBell{"bell", std::nullopt};
const Pose kTurned{{0.5, 0, 1}, Rotation::from_xyzw(0, 0, 1, 0)};
const BulkPose kPlaced{0, kTurned, 0};
const BulkStrike kBlow{0, std::nullopt, {0.05, 0, 0.02}, {-0.02, 0, 0}, 0.0005, 0};

using Arguments = std::initializer_list<Columns<Request>>;

// An address that succeeds in silence, and the lane that handles it. Tests send `example` through the parser and by
// oscsend.
template <Lane lane, class Struct>
RowOf<Request, Struct> silent(std::string_view address, const Struct& example, std::string_view sentence,
                              Arguments arguments) {
  static_assert(lane == kLaneOf<Struct>, "protocol/lanes.h puts this request into another lane");
  RowOf<Request, Struct> row = make_row<Request>(address, sentence, arguments, example);
  row.row.spec.lane = lane;
  return row;
}

// One that is answered; `number` says what the number in /done is, if there is one.
template <Lane lane, class Struct>
RowOf<Request, Struct> answered(std::string_view address, const Struct& example, std::string_view sentence,
                                Arguments arguments, std::string_view reply = "/done", std::string_view number = "") {
  RowOf<Request, Struct> row = silent<lane>(address, example, sentence, arguments);
  row.row.spec.reply = reply;
  row.row.spec.reply_number = number;
  return row;
}

std::vector<Row<Request>> make_request_rows() {
  return make_table<Request>(
      silent<Lane::mixer>(
          "/object/{object}/strike", Strike{kBell, {0.05, 0, 0.02}, {-0.02, 0, 0}, 0.0005},
          "Strikes the object at the surface point nearest to x y z.",
          {object<&Strike::object>(), vector<&Strike::point_m>({"x", "y", "z"}, kPosition, "Where it is struck."),
           impulse<&Strike::impulse_ns>(), contact_time<&Strike::contact_time_s>()}),
      silent<Lane::mixer>("/object/{object}/strike_vertex", StrikeVertex{kBell, 12, {-0.02, 0, 0}, 0.0005},
                          "Strikes the object at a sample point of its bank.",
                          {object<&StrikeVertex::object>(),
                           integer<&StrikeVertex::vertex>("vertex", kIndex, "The point's number, from 0."),
                           impulse<&StrikeVertex::impulse_ns>(), contact_time<&StrikeVertex::contact_time_s>()}),
      silent<Lane::mixer>("/strikes", StrikeMany{encode_strikes(std::array{kBlow})},
                          "Many strikes in one message, for simulators, as clients/python/strike.py sends them. A "
                          "record is 40 bytes, big-endian: int32 object (the number that /load answered), int32 vertex "
                          "(-1: at x y z), float32 x y z [m], jx jy jz [N s], contact_time [s] and delay [s], 0 to 60, "
                          "after the message's time. Ranges are those of /strike. One wrong record refuses them all.",
                          {records<&StrikeMany::records>("records", kBytesPerStrike, kMaxBulkStrikes, "The records.")}),
      silent<Lane::mixer>("/object/{object}/gain", SetGain{kBell, 0.5, 0.1}, "Sets the object's loudness.",
                          {object<&SetGain::object>(),
                           number<&SetGain::gain>("gain", kGain, "The factor on its signal; 1 is as computed."),
                           optional(number<&SetGain::ramp_s>("ramp", kRamp, "How long the change takes."))}),
      silent<Lane::mixer>(
          "/object/{object}/pan", SetPan{kBell, -0.3}, "Pans the object at equal power.",
          {object<&SetPan::object>(), number<&SetPan::pan>("pan", kPan, "-1 is left, 0 the middle, 1 right.")}),
      answered<Lane::worker>(
          "/object/{object}/material", SetMaterial{kBell, {1, 1, 1, 4, 0.5}},
          "Scales the bank's material and size, exactly. Points in later messages lie on the object in its new size. "
          "Bodies of a running scene keep theirs.",
          {object<&SetMaterial::object>(),
           number<&SetMaterial::scale, &modal::MaterialScale::alpha>(
               "alpha", kDampingScale, "The factor on Rayleigh's alpha: damping of low modes."),
           number<&SetMaterial::scale, &modal::MaterialScale::beta>(
               "beta", kDampingScale, "The factor on Rayleigh's beta: damping of high modes."),
           number<&SetMaterial::scale, &modal::MaterialScale::density>("density", kScale, "The factor on the density."),
           number<&SetMaterial::scale, &modal::MaterialScale::stiffness>(
               "stiffness", kScale, "The factor on Young's modulus; 4 is an octave up."),
           optional(number<&SetMaterial::scale, &modal::MaterialScale::size>(
               "size", kSizeScale, "The factor on all lengths; 0.5 is an octave up."))}),
      answered<Lane::timed_worker>(
          "/object/{object}/hold",
          SetDamper{kBell, {{0.05, 0, 0.02}, {}, 20}},
          "Lays a hand on the object, or puts it down on something: modes die sooner the more they move there. An "
          "object can have 16 dampers, of which an embedded scene uses those from 8 on.",
          {object<&SetDamper::object>(),
           vector<&SetDamper::damper, &modal::Damper::point_m>({"x", "y", "z"}, kPosition, "Where it touches."),
           number<&SetDamper::damper, &modal::Damper::damping_ns_m>(
               "damping", kDamping,
               "Resisting force over speed of the surface: about 5 for a fingertip; 0 takes the hand away."),
           optional(vector<&SetDamper::damper, &modal::Damper::direction>(
               {"nx", "ny", "nz"}, kDirection, "The direction of the resisted motion; 0 0 0 for all.")),
           optional(integer<&SetDamper::number>("number", kDamperNumber, "Which damper."))}),
      answered<Lane::worker>("/object/{object}/group", SetGroup{kBell, "metal"},
                             "Puts the object into a group, which --ports groups gives an output port of its own.",
                             {object<&SetGroup::object>(),
                              optional(other<ValueType::name, &SetGroup::group>("group", "The group's name."))}),
      answered<Lane::worker>(
          "/object/{object}/mute", SetMute{kBell, true},
          "Silences the object for all listeners, or ends that. What rings goes on unheard. /notify.object tells "
          "subscribers.",
          {object<&SetMute::object>(), optional(other<ValueType::flag, &SetMute::on>("on", "0 ends it."))}),
      answered<Lane::worker>(
          "/object/{object}/solo", SetSolo{kBell, true},
          "While any object is soloed, the others are silent. A muted one stays silent even so.",
          {object<&SetSolo::object>(), optional(other<ValueType::flag, &SetSolo::on>("on", "0 ends it."))}),
      silent<Lane::mixer>("/object/{object}/ring", RingModes{kBell, 0, 1, 0.1},
                          "Starts these modes without a strike, each as a sine from 0.",
                          {object<&RingModes::object>(),
                           integer<&RingModes::first>("first", kIndex, "The lowest one; 0 has the lowest frequency."),
                           optional(integer<&RingModes::count>("count", kCount, "How many, counted upwards.")),
                           optional(number<&RingModes::amplitude>(
                               "amplitude", kAmplitude, "Of each, at gain 1, before the pan; 1 is full scale."))}),
      answered<Lane::worker>("/object/{object}/modes", SelectModes{kBell, {0, 20}},
                             "Leaves the object only these modes and ends what the others ring. 0 alone restores all.",
                             {object<&SelectModes::object>(),
                              integer<&SelectModes::range, &modal::ModeRange::first>(
                                  "first", kIndex, "The lowest one; 0 has the lowest frequency."),
                              optional(integer<&SelectModes::range, &modal::ModeRange::count>(
                                  "count", kCount, "How many, counted upwards."))}),
      answered<Lane::subscription>(
          "/object/{object}/watch", WatchObject{kBell, true},
          "Sends a subscriber of /notify the amplitudes of the object's modes (/notify.modes), for up to 16 objects.",
          {object<&WatchObject::object>(),
           optional(other<ValueType::flag, &WatchObject::on>("on", "1 starts, 0 stops."))}),
      answered<Lane::question>("/object/{object}/describe", DescribeObject{kBell},
                               "Asks what the object is and how it is set.", {object<&DescribeObject::object>()},
                               "/object.reply"),
      answered<Lane::question>(
          "/object/{object}/bank", ReadBank{kBell, 0, 4096}, "Asks for a piece of the object's bank file.",
          {object<&ReadBank::object>(),
           integer<&ReadBank::offset>("offset", kCount, "Where the piece begins, in bytes."),
           optional(integer<&ReadBank::bytes>("bytes", kBankBytes, "Its length; the last piece is shorter."))},
          "/bank.reply"),
      answered<Lane::worker>(
          "/object/{object}/excite", Excite{kBell, 1, {0.05, 0, 0.02}, {0, 0, -1}},
          "Lets an audio input, in_1 to in_4, excite the object as a force at x y z. An input excites one object at a "
          "time; a force of 0 0 0 ends it.",
          {object<&Excite::object>(), integer<&Excite::input>("input", kInput, "The input's number."),
           vector<&Excite::point_m>({"x", "y", "z"}, kPosition, "Where it acts."),
           vector<&Excite::force_n>({"fx", "fy", "fz"}, kForce, "The force that a sample of 1 stands for.")}),
      silent<Lane::mixer>(
          "/object/{object}/clear", ClearObject{kBell}, "Fades what rings in the object.",
          {object<&ClearObject::object>(),
           optional(number<&ClearObject::ramp_s>("ramp", kRamp, "How long that takes; at least some 10 ms."))}),
      silent<Lane::mixer>(
          "/object/{object}/contact", SetContact{kBell, {0.05, 0, 0.02}, {0, {0, 0, -2}, 0.3, 0, {}}},
          "Something slides or rolls on the object. Values are interpolated between messages: send 50 to 250 a second. "
          "A force of 0 0 0, or 0.1 s without a message, ends the contact.",
          {object<&SetContact::object>(), vector<&SetContact::point_m>({"x", "y", "z"}, kPosition, "Where it touches."),
           vector<&SetContact::contact, &synth::Contact::force_n>({"fx", "fy", "fz"}, kForce,
                                                                  "The force on the object, friction included."),
           number<&SetContact::contact, &synth::Contact::slip_m_s>(
               "slip", kSpeed, "Speed at which the surfaces slide past each other."),
           optional(number<&SetContact::contact, &synth::Contact::roll_m_s>(
               "roll", kSpeed, "Speed at which the point of contact travels.")),
           optional(integer<&SetContact::contact, &synth::Contact::number>(
               "number", kIndex, "Which contact; an object can have four at once.")),
           optional(number<&SetContact::contact, &synth::Contact::texture, &synth::Texture::roughness_m>(
               "roughness", kRoughness, "Of both surfaces together, root mean square.")),
           optional(number<&SetContact::contact, &synth::Contact::texture, &synth::Texture::correlation_m>(
               "correlation", kCorrelation, "The longest wavelength of the roughness.")),
           optional(number<&SetContact::contact, &synth::Contact::texture, &synth::Texture::spectral_slope>(
               "slope", kSpectralSlope, "The power of the heights over spatial frequency f goes as f^slope."))}),
      silent<Lane::mixer>(
          "/object/{object}/bow",
          SetBow{kBell,
                 {0.05, 0, 0.02},
                 {.kind = synth::Touch::Kind::bow,
                  .direction = {0, 0, 1},
                  .speed_m_s = 0.2,
                  .force_n = 1,
                  .friction = 0.8,
                  .width_m = 0}},
          "Bows the object: the hair sticks to the surface, slips, and feels how it moves. Send it again to change "
          "speed "
          "or force, which then move there in the time since the last message, 2 to 50 ms. A force of 0 lifts the bow.",
          {object<&SetBow::object>(), vector<&SetBow::point_m>({"x", "y", "z"}, kPosition, "Where the bow lies."),
           vector<&SetBow::touch, &synth::Touch::direction>(
               {"dx", "dy", "dz"}, kDirection, "The way the hair moves, along the surface; any length but 0."),
           number<&SetBow::touch, &synth::Touch::speed_m_s>("speed", kBowSpeed,
                                                            "The hair's speed; negative for the way back."),
           number<&SetBow::touch, &synth::Touch::force_n>("force", kPress, "How hard the bow is pressed."),
           optional(number<&SetBow::touch, &synth::Touch::width_m>(
               "width", kWidth, "Of the hair: modes whose waves are shorter feel less of it.")),
           optional(number<&SetBow::touch, &synth::Touch::friction>(
               "rosin", kFriction, "Coefficient of static friction; sliding has three eighths of it.")),
           optional(integer<&SetBow::touch, &synth::Touch::number>("number", kIndex, "Which of the object's bows."))}),
      silent<Lane::mixer>(
          "/object/{object}/mallet",
          HitMallet{kBell,
                    {0.05, 0, 0.02},
                    {0, 0, -1},
                    {.kind = synth::Touch::Kind::mallet, .mass_kg = 0.02, .stiffness = 1e7, .bounce = 0.9}},
          "A mallet flies at the object and feels it: how long the blow lasts, and how often it hits, follows from "
          "mass, "
          "head and speed, and from what the object does.",
          {object<&HitMallet::object>(),
           vector<&HitMallet::point_m>({"x", "y", "z"}, kPosition, "Where the mallet lands."),
           vector<&HitMallet::velocity_m_s>({"vx", "vy", "vz"}, kVelocity, "Its velocity; not 0."),
           number<&HitMallet::touch, &synth::Touch::mass_kg>("mass", kMalletMass, "Its mass, shaft and hand included."),
           optional(number<&HitMallet::touch, &synth::Touch::stiffness>(
               "head", kHardness,
               "How hard the head is: some 1e5 for yarn, 1e7 for rubber, 1e9 for wood, 1e10 for steel.")),
           optional(number<&HitMallet::touch, &synth::Touch::bounce>(
               "bounce", kBounce, "Its speed after a blow on a wall, over that before."))}),
      silent<Lane::mixer>(
          "/object/{object}/couple",
          SetCoupling{kBell,
                      {0.05, 0, 0.02},
                      kBell,
                      {.kind = synth::Touch::Kind::couple,
                       .direction = {0, 0, 1},
                       .friction = 0.3,
                       .stiffness = 1e8,
                       .bounce = 0.6}},
          "Lets another object touch this one at a point of each, so that both rattle, buzz and ring together. The "
          "axes "
          "of the two are taken as parallel. A stiffness of 0 parts them.",
          {object<&SetCoupling::object>(),
           vector<&SetCoupling::point_m>({"x", "y", "z"}, kPosition, "Where this object is touched."),
           other<ValueType::object, &SetCoupling::other>("other", "The other object."),
           vector<&SetCoupling::touch, &synth::Touch::other_point_m>({"ox", "oy", "oz"}, kPosition,
                                                                     "Where the other is touched, in its own frame."),
           vector<&SetCoupling::touch, &synth::Touch::direction>(
               {"nx", "ny", "nz"}, kDirection, "The way in which the other pushes this object; any length but 0."),
           optional(number<&SetCoupling::touch, &synth::Touch::force_n>(
               "weight", kPress, "With which the other rests on this object; 0: both are held where they are.")),
           optional(number<&SetCoupling::touch, &synth::Touch::gap_m>(
               "gap", kGap, "Between the two at rest; negative: pressed together so deep.")),
           optional(number<&SetCoupling::touch, &synth::Touch::stiffness>("stiffness", kStiffness,
                                                                          "Of the contact, by Hertz's law.")),
           optional(number<&SetCoupling::touch, &synth::Touch::friction>("friction", kFriction,
                                                                         "Coefficient of static friction.")),
           optional(number<&SetCoupling::touch, &synth::Touch::bounce>("bounce", kBounce,
                                                                       "Speed after an impact over that before.")),
           optional(number<&SetCoupling::touch, &synth::Touch::mass_kg>(
               "mass", kRestingMass, "Of the other, where it rests by its weight; 0 follows from the weight.")),
           optional(integer<&SetCoupling::touch, &synth::Touch::number>("number", kIndex,
                                                                        "Which of this object's couplings."))}),
      silent<Lane::mixer>(
          "/object/{object}/click", Click{kBell, {-0.02, 0, 0}, 0.0005},
          "The click of a free object that a blow sets in motion as a whole, which strikes do not include. Send it "
          "once for all points struck at one time.",
          {object<&Click::object>(), impulse<&Click::impulse_ns>(), contact_time<&Click::contact_time_s>()}),
      silent<Lane::mixer>(
          "/object/{object}/pose", SetPose{kBell, kTurned},
          "Says where the object is, for a listener (/listener), who then hears it from there. Send 30 to 250 a second "
          "of what moves; motion between poses is smooth. A pose sent one interval ahead of its time is reached "
          "exactly then, any other one interval after it comes.",
          {object<&SetPose::object>(), pose<&SetPose::pose>("Where the object's origin lies in the scene.")}),
      silent<Lane::mixer>("/poses", PoseMany{encode_poses(std::array{kPlaced})},
                          "Many poses in one message. A record is 36 bytes, big-endian: int32 object (the number that "
                          "/load answered), float32 x y z [m], qw qx qy qz and delay [s], 0 to 60, after the message's "
                          "time. Ranges are those of /object/{object}/pose. One wrong record refuses them all.",
                          {records<&PoseMany::records>("records", kBytesPerPose, kMaxBulkPoses, "The records.")}),
      silent<Lane::mixer>(
          "/listener", SetListener{kTurned},
          "Says where somebody listens. Objects with a pose are then heard from their places: by what each mode sends "
          "that way, by distance, and higher or lower as they come and go. Objects without a pose sound as before.",
          {pose<&SetListener::pose>("Where the listener's head is in the scene. Not turned, it faces along x with its "
                                    "left ear to y.")}),
      silent<Lane::mixer>("/listener/off", ListenerOff{}, "Ends that: everything sounds as without a listener.", {}),
      silent<Lane::mixer>(
          "/listener/air", SetListenerAir{15, 70},
          "Sets the air between objects and listener, which takes more of high "
          "pitches the longer the way.",
          {number<&SetListenerAir::temperature_c>("temperature", kTemperature, "Of the air."),
           optional(number<&SetListenerAir::humidity_percent>("humidity", kHumidity, "Relative humidity."))}),
      answered<Lane::worker>("/object/{object}/free", FreeObject{kBell},
                             "Fades and removes the object; its name and number become free.",
                             {object<&FreeObject::object>()}),
      answered<Lane::worker>(
          "/load", LoadObject{"bell", "presets/banks/bronze-bell.glb"},
          "Loads a bank under a name. An object of that name gets the new bank, while the old one rings out.",
          {other<ValueType::name, &LoadObject::name>("name", "The object's name."),
           other<ValueType::text, &LoadObject::bank_path>("path", "The bank, a .glb file.")},
          "/done", "the object's number"),
      silent<Lane::mixer>("/clear", ClearAll{}, "Fades all that rings within a few milliseconds.", {}),
      answered<Lane::worker>("/scene/load", SceneLoad{"presets/scenes/demo.toml"},
                             "Replaces the embedded scene and loads the objects it names.",
                             {other<ValueType::text, &SceneLoad::path>("path", "The scene, a .toml file.")}, "/done",
                             "the count of its bodies"),
      answered<Lane::worker>(
          "/scene/pause", ScenePause{true}, "Stops or continues the scene; what rings rings on.",
          {optional(other<ValueType::flag, &ScenePause::paused>("paused", "1 stops it, 0 lets it run."))}),
      answered<Lane::worker>("/scene/spawn/box", SpawnBox{kBell, {0, 0, 1}, {0, 0, -2}, {0.1, 0.1, 0.1}, 0},
                             "Drops a new box into the scene.",
                             {body_object<&SpawnBox::object>(), position<&SpawnBox::position_m>(),
                              optional(vector<&SpawnBox::size_m>({"sx", "sy", "sz"}, kSize,
                                                                 "Its edges; 0 0 0 takes the bank's bounding box.")),
                              velocity<&SpawnBox::velocity_m_s>(), density<&SpawnBox::density_kg_m3>()},
                             "/done", "the body's number"),
      answered<Lane::worker>(
          "/scene/spawn/sphere", SpawnSphere{std::nullopt, {0, 0, 1}, {0, 0, 0}, 0.01, 7850},
          "Drops a new ball into the scene.",
          {body_object<&SpawnSphere::object>(), position<&SpawnSphere::position_m>(),
           optional(number<&SpawnSphere::radius_m>("radius", kSize, "0 takes the one that encloses the bank.")),
           velocity<&SpawnSphere::velocity_m_s>(), density<&SpawnSphere::density_kg_m3>()},
          "/done", "the body's number"),
      answered<Lane::worker>("/scene/clear", SceneClear{}, "Removes all bodies from the scene.", {}),
      answered<Lane::worker>(
          "/scene/push", ScenePush{2, {0, 0, 0.5}}, "Gives a body of the scene an impulse at its centre of mass.",
          {integer<&ScenePush::body>("body", kCount, "Its number."),
           vector<&ScenePush::impulse_ns>({"jx", "jy", "jz"}, kImpulse, "The impulse, in the scene's frame.")}),
      answered<Lane::question>("/scene/describe", SceneDescribe{},
                               "Asks what the scene looks like: /scene.body and /scene.static follow the answer.", {},
                               "/scene.reply"),
      answered<Lane::subscription>(
          "/notify", Notify{true, 20},
          "Subscribes the sender to bundles of /notify.object, .group, .contact, .peak, .object_peak, .load, .scene "
          "and .body; the first is about every object. A subscriber that sends nothing for 60 s is forgotten.",
          {optional(other<ValueType::flag, &Notify::on>("on", "1 subscribes, 0 ends the subscription.")),
           optional(number<&Notify::rate_hz>("rate", kNoticeRate, "Bundles per second."))}),
      answered<Lane::subscription>("/watch/sound", WatchSound{true},
                                   "Sends a subscriber of /notify the samples of the mix (/notify.sound).",
                                   {optional(other<ValueType::flag, &WatchSound::on>("on", "1 starts, 0 stops."))}),
      answered<Lane::question>(
          "/browse", Browse{},
          "Asks for the scenes and banks that can be loaded: a /browse.file for each follows the answer.", {},
          "/browse.reply"),
      answered<Lane::worker>(
          "/test_tone", TestTone{0.1, 440}, "Adds a sine to both sides of the mix.",
          {number<&TestTone::amplitude>("amplitude", kAmplitude, "1 is full scale, 0 ends the tone."),
           optional(number<&TestTone::frequency_hz>("frequency", kFrequency, "Its frequency."))}),
      answered<Lane::file>(
          "/state/save", SaveState{"state.toml"},
          "Writes objects, inputs, listener and scene to a readable file, which `ringdownd --state` loads.",
          {other<ValueType::text, &SaveState::path>("path", "The .toml file to write; it replaces only a state.")}),
      answered<Lane::file>("/scene/save", SaveScene{"scene.toml", false},
                           "Writes a scene file with every object as it is set now, and with what was dropped, each at "
                           "its time. Pushes, "
                           "holds, mutes, solos and choices of modes are not in it.",
                           {other<ValueType::text, &SaveScene::path>("path", "The .toml file to write."),
                            optional(other<ValueType::flag, &SaveScene::replace>(
                                "replace", "1 replaces a scene that /scene/save wrote; 0 replaces nothing."))}),
      answered<Lane::file>("/record/start", RecordStart{"session.osc"},
                           "Records what is played as an OSC score, which `ringdown render --events` plays again: bit "
                           "for bit, at the same sample rate and block size.",
                           {other<ValueType::text, &RecordStart::path>(
                               "path", "The .osc file to write; it replaces only a score.")}),
      answered<Lane::file>("/record/stop", RecordStop{},
                           "Writes the score, with everything that was confirmed by /sync before. When it cannot be "
                           "written, the recording goes on.",
                           {optional(other<ValueType::text, &RecordStop::path>(
                               "path", "Another .osc file than the one named at the start."))},
                           "/done", "the count of its messages"),
      answered<Lane::file>(
          "/capture/start", CaptureStart{"session.wav"},
          "Writes the mix from now on to a WAV file of 32-bit floats, complete when /capture/stop is "
          "answered.",
          {other<ValueType::text, &CaptureStart::path>("path", "The .wav file to write; it replaces nothing.")}),
      answered<Lane::file>("/capture/stop", CaptureStop{}, "Completes the sound file.", {}, "/done",
                           "the count of its frames"),
      answered<Lane::daemon>("/status", Status{}, "Asks how the daemon is doing.", {}, "/status.reply"),
      answered<Lane::daemon>("/version", Version{}, "Asks which program this is.", {}, "/version.reply"),
      answered<Lane::question>("/sync", Sync{7}, "Answers when everything sent before it has been handled.",
                               {integer<&Sync::id>("id", kId, "Repeated in the answer.")}, "/synced"),
      answered<Lane::daemon>("/quit", Quit{}, "Stops the daemon.", {}));
}

}  // namespace

const std::vector<Row<Request>>& request_rows() {
  static const std::vector<Row<Request>> rows = make_request_rows();
  return rows;
}

}  // namespace ringdown::protocol
