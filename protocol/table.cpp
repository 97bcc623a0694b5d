// The table. A new address is a struct in request.h, a row here, and its cases in
// tests/protocol/schema_test.cpp.
#include "protocol/binding.h"
#include "protocol/bulk.h"

#include <limits>

namespace ringdown::protocol {
namespace {

constexpr Quantity kPosition{"m", -1e4, 1e4};
constexpr Quantity kVelocity{"m/s", -1e3, 1e3};
constexpr Quantity kSize{"m", 0, 1e3};
constexpr Quantity kDensity{"kg/m3", 0, 1e5};
constexpr Quantity kImpulse{"N s", -1e4, 1e4};
constexpr Quantity kForce{"N", -1e6, 1e6};
constexpr Quantity kTouch{"N s/m", 0, 1e6};
constexpr Quantity kDirection{"", -1e3, 1e3};
constexpr Quantity kSpeed{"m/s", 0, 1e3};
constexpr Quantity kRoughness{"m", 0, 0.1};
constexpr Quantity kCorrelation{"m", 1e-7, 10};
constexpr Quantity kSpectralSlope{"", -10, 0};
constexpr Quantity kTouchNumber{"", 0, kMostTouches - 1};
constexpr Quantity kInput{"", 1, kMostInputs};
constexpr Quantity kContactTime{"s", 0, 0.1};
constexpr Quantity kGain{"", 0, 100};
constexpr Quantity kLost{"s", 0, 1e9};
constexpr Quantity kRamp{"s", 0, 60};
constexpr Quantity kPan{"", -1, 1};
constexpr Quantity kScale{"", 1e-3, 1e3};
constexpr Quantity kDampingScale{"", 0, 1e3};
constexpr Quantity kSizeScale{"", 1e-2, 1e2};
constexpr Quantity kIndex{"", 0, kLargestNumber};
constexpr Quantity kCount{"", 0, std::numeric_limits<std::int32_t>::max()};
constexpr Quantity kId{"", std::numeric_limits<std::int32_t>::min(), kCount.most};
constexpr Quantity kLoad{"", 0, 1e6};
constexpr Quantity kRate{"Hz", 0, 1e7};
constexpr Quantity kNoticeRate{"Hz", 0.1, 200};
constexpr Quantity kUnit{"", -1.001, 1.001};  // rounding to float may pass 1
constexpr Quantity kAnyPosition{"m", -1e30, 1e30};
constexpr Quantity kAnyImpulse{"N s", -1e30, 1e30};
constexpr Quantity kPeak{"", 0, 1e30};

template <auto... path>
auto object() {
  return other<ValueType::object, path...>("object", "The object, by its name or by the number that /load answered.");
}

template <auto... path>
auto body_object() {
  return other<ValueType::object_or_none, path...>("object", "What sounds when the body is hit; - for a silent body.");
}

template <auto... path>
auto impulse() {
  return vector<path...>({"jx", "jy", "jz"}, kImpulse,
                         "The impulse it receives, in the object's own frame: mass times change of velocity.");
}

template <auto... path>
auto contact_time() {
  return optional(number<path...>("contact_time", kContactTime,
                                  "How long the blow lasts: short is bright, long is dull, 0 is an ideal impulse."));
}

template <auto... path>
auto position() {
  return vector<path...>({"x", "y", "z"}, kPosition, "Where its centre of mass starts, in the scene's frame.");
}

template <auto... path>
auto velocity() {
  return optional(vector<path...>({"vx", "vy", "vz"}, kVelocity, "Its velocity at the start."));
}

template <auto... path>
auto density() {
  return optional(
      number<path...>("density", kDensity, "Its density; 0 takes mass and inertia from the object's bank."));
}

const ObjectRef kBell{"bell", std::nullopt};
const BulkStrike kBlow{0, std::nullopt, {0.05, 0, 0.02}, {-0.02, 0, 0}, 0.0005, 0};

using Arguments = std::initializer_list<Columns<Request>>;

// An address that succeeds in silence. `example` is what docs/protocol.md shows; a test sends it through the
// parser.
template <class Struct>
Row<Request> silent(std::string_view address, const Struct& example, std::string_view sentence, Arguments arguments) {
  return make_row<Request>(address, sentence, arguments, example);
}

// One that is answered; `number` says what the number in /done is, if there is one.
template <class Struct>
Row<Request> answered(std::string_view address, const Struct& example, std::string_view sentence, Arguments arguments,
                      std::string_view reply = "/done", std::string_view number = "") {
  Row<Request> row = silent(address, example, sentence, arguments);
  row.spec.reply = reply;
  row.spec.reply_number = number;
  return row;
}

std::vector<Row<Request>> make_request_rows() {
  return {
      silent("/object/{object}/strike", Strike{kBell, {0.05, 0, 0.02}, {-0.02, 0, 0}, 0.0005},
             "Rings the object at the point of its surface that is nearest to x y z.",
             {object<&Strike::object>(),
              vector<&Strike::point_m>({"x", "y", "z"}, kPosition, "Where it is struck, in the object's own frame."),
              impulse<&Strike::impulse_ns>(), contact_time<&Strike::contact_time_s>()}),
      silent("/object/{object}/strike_vertex", StrikeVertex{kBell, 12, {-0.02, 0, 0}, 0.0005},
             "Rings the object at one sample point of its bank.",
             {object<&StrikeVertex::object>(),
              integer<&StrikeVertex::vertex>("vertex", kIndex, "The sample point's number, from 0."),
              impulse<&StrikeVertex::impulse_ns>(), contact_time<&StrikeVertex::contact_time_s>()}),
      silent(
          "/strikes", StrikeMany{encode_strikes(std::array{kBlow})},
          "Many strikes in one message, for simulators. Each record is 40 bytes, its numbers big-endian: int32 object "
          "(the number that /load answered), int32 vertex (or -1: the point x y z counts), float32 x y z [m], float32 "
          "jx jy jz [N s], float32 contact_time [s], float32 delay [s], 0 to 60, after the message's own time. Ranges "
          "are those of /object/{object}/strike. One wrong record refuses them all.",
          {records<&StrikeMany::records>("records", kBytesPerStrike, kMostBulkStrikes, "The records.")}),
      silent("/object/{object}/gain", SetGain{kBell, 0.5, 0.1}, "Sets the object's loudness.",
             {object<&SetGain::object>(),
              number<&SetGain::gain>("gain", kGain, "The factor on its signal; 1 is as computed, 0.5 is 6 dB less."),
              optional(number<&SetGain::ramp_s>("ramp", kRamp, "How long the change takes."))}),
      silent("/object/{object}/pan", SetPan{kBell, -0.3}, "Places the object between left and right, at equal power.",
             {object<&SetPan::object>(), number<&SetPan::pan>("pan", kPan, "-1 is left, 0 the middle, 1 right.")}),
      answered(
          "/object/{object}/material", SetMaterial{kBell, {1, 1, 1, 4, 0.5}},
          "Scales the material and the size the object was baked with: its modes, mass and click follow exactly, "
          "without "
          "a new analysis. The factors count from the bank, not from the last scale; 1 1 1 1 1 is the bank as baked. "
          "Points that later messages name lie on the object in its new size. Bodies of a running scene keep theirs.",
          {object<&SetMaterial::object>(),
           number<&SetMaterial::scale, &modal::MaterialScale::alpha>(
               "alpha", kDampingScale, "The factor on Rayleigh's alpha, the damping of low modes."),
           number<&SetMaterial::scale, &modal::MaterialScale::beta>(
               "beta", kDampingScale, "The factor on Rayleigh's beta, the damping of high modes."),
           number<&SetMaterial::scale, &modal::MaterialScale::density>("density", kScale, "The factor on the density."),
           number<&SetMaterial::scale, &modal::MaterialScale::stiffness>(
               "stiffness", kScale, "The factor on Young's modulus; 4 is an octave up."),
           optional(number<&SetMaterial::scale, &modal::MaterialScale::size>(
               "size", kSizeScale, "The factor on all lengths; 0.5 is an octave up."))}),
      answered(
          "/object/{object}/hold", Hold{kBell, {{0.05, 0, 0.02}, {}, 20}},
          "Lays a hand on the object, or puts it down on something: its modes die sooner, each by how much it moves "
          "there. What rings goes on from where it is. A damping of 0 takes the hand away. An object can have 16 "
          "touches "
          "at a time; an embedded scene uses those from 8 on.",
          {object<&Hold::object>(),
           vector<&Hold::touch, &modal::ContactDamping::point_m>({"x", "y", "z"}, kPosition,
                                                                 "Where it touches, in the object's own frame."),
           number<&Hold::touch, &modal::ContactDamping::damping_ns_m>(
               "damping", kTouch, "The force that resists the surface, per its speed there: a fingertip has some 5."),
           optional(vector<&Hold::touch, &modal::ContactDamping::direction>(
               {"nx", "ny", "nz"}, kDirection,
               "The direction of the motion that is resisted; 0 0 0 for any. Its length does not count.")),
           optional(integer<&Hold::number>("number", kTouchNumber, "Which of the object's touches."))}),
      answered("/object/{object}/group", SetGroup{kBell, "metal"},
               "Puts the object into a group. With --ports groups, each group is heard at an output port of its own.",
               {object<&SetGroup::object>(),
                optional(other<ValueType::name, &SetGroup::group>("group", "The group's name; left out: in none."))}),
      answered("/object/{object}/excite", Excite{kBell, 1, {0.05, 0, 0.02}, {0, 0, -1}},
               "Lets an audio input excite the object: what sounds in it is a force at x y z. The input is a port in_1 "
               "to in_4 of the JACK client, which is there from then on. It excites one object at a time; a force of "
               "0 0 0 ends it.",
               {object<&Excite::object>(), integer<&Excite::input>("input", kInput, "The input's number."),
                vector<&Excite::point_m>({"x", "y", "z"}, kPosition, "Where it acts, in the object's own frame."),
                vector<&Excite::force_n>({"fx", "fy", "fz"}, kForce, "The force that a sample of 1 is.")}),
      silent("/object/{object}/clear", ClearObject{kBell}, "Fades what rings in the object: a hand laid on it.",
             {object<&ClearObject::object>(),
              optional(number<&ClearObject::ramp_s>("ramp", kRamp, "How long that takes; some 10 ms at least."))}),
      silent(
          "/object/{object}/contact", KeepContact{kBell, {0.05, 0, 0.02}, {0, {0, 0, -2}, 0.3, 0, {}}},
          "Something slides or rolls on the object. The contact goes on as it was told last and changes evenly from "
          "one "
          "telling to the next; a force of 0 0 0 ends it, and so does a tenth of a second in which nothing is told of "
          "it. Tell it 50 to 250 times a second.",
          {object<&KeepContact::object>(),
           vector<&KeepContact::point_m>({"x", "y", "z"}, kPosition, "Where it touches, in the object's own frame."),
           vector<&KeepContact::contact, &Contact::force_n>(
               {"fx", "fy", "fz"}, kForce, "The force on the object, in its own frame: normal and friction together."),
           number<&KeepContact::contact, &Contact::slip_m_s>(
               "slip", kSpeed, "The speed at which the two surfaces slide past each other."),
           optional(number<&KeepContact::contact, &Contact::roll_m_s>(
               "roll", kSpeed, "The speed at which the point of contact travels as they roll.")),
           optional(integer<&KeepContact::contact, &Contact::number>(
               "number", kIndex, "Which of the object's contacts; it can have four at a time.")),
           optional(number<&KeepContact::contact, &Contact::texture, &Texture::roughness_m>(
               "roughness", kRoughness, "How high the asperities of both surfaces are, root mean square.")),
           optional(number<&KeepContact::contact, &Contact::texture, &Texture::correlation_m>(
               "correlation", kCorrelation, "The longest wavelength of the roughness.")),
           optional(number<&KeepContact::contact, &Contact::texture, &Texture::spectral_slope>(
               "slope", kSpectralSlope, "The power of the heights falls with spatial frequency f as f^slope."))}),
      silent(
          "/object/{object}/click", Click{kBell, {-0.02, 0, 0}, 0.0005},
          "A blow sets the object in motion as a whole: the click of that, which is heard beside its modes and where "
          "it has none. For objects that are free to move; strikes do not make it by themselves. Send it once for all "
          "points that are struck at a time.",
          {object<&Click::object>(), impulse<&Click::impulse_ns>(), contact_time<&Click::contact_time_s>()}),
      answered("/object/{object}/free", FreeObject{kBell},
               "Removes the object. What rings is faded, its name and number become free.",
               {object<&FreeObject::object>()}),
      answered("/load", LoadObject{"bell", "presets/banks/bell.glb"},
               "Reads a bank and gives it a name. A name that exists gets the new bank, while the old one "
               "rings out.",
               {other<ValueType::name, &LoadObject::name>("name", "The object's name."),
                other<ValueType::text, &LoadObject::bank_path>(
                    "path", "The bank, a .glb file; a relative path starts where the daemon was started.")},
               "/done", "the object's number"),
      silent("/clear", ClearAll{}, "Fades all that rings within a few milliseconds.", {}),
      answered("/scene/load", SceneLoad{"presets/scenes/demo.toml"},
               "Replaces the embedded scene, and loads the objects it names.",
               {other<ValueType::text, &SceneLoad::path>(
                   "path", "The scene, a .toml file; a relative path starts where the daemon was started.")},
               "/done", "the count of its bodies"),
      answered("/scene/pause", ScenePause{true}, "Stops or continues the scene. What rings goes on ringing.",
               {optional(other<ValueType::flag, &ScenePause::paused>("paused", "1 stops it, 0 lets it run."))}),
      answered("/scene/spawn/box", SpawnBox{kBell, {0, 0, 1}, {0, 0, -2}, {0.1, 0.1, 0.1}, 0},
               "Drops a new box into the scene.",
               {body_object<&SpawnBox::object>(), position<&SpawnBox::position_m>(),
                optional(vector<&SpawnBox::size_m>({"sx", "sy", "sz"}, kSize,
                                                   "Its edges; 0 0 0 takes the bounding box of the object's bank.")),
                velocity<&SpawnBox::velocity_m_s>(), density<&SpawnBox::density_kg_m3>()},
               "/done", "the body's number"),
      answered("/scene/spawn/sphere", SpawnSphere{std::nullopt, {0, 0, 1}, {0, 0, 0}, 0.01, 7850},
               "Drops a new ball into the scene.",
               {body_object<&SpawnSphere::object>(), position<&SpawnSphere::position_m>(),
                optional(number<&SpawnSphere::radius_m>(
                    "radius", kSize, "Its radius; 0 takes the one that encloses the object's bank.")),
                velocity<&SpawnSphere::velocity_m_s>(), density<&SpawnSphere::density_kg_m3>()},
               "/done", "the body's number"),
      answered("/scene/clear", SceneClear{}, "Removes all bodies from the scene.", {}),
      answered("/notify", Notify{true, 20},
               "Subscribes the sender, or ends that: /notify.object, /notify.group, /notify.contact, /notify.peak, "
               "/notify.object_peak, /notify.load and /notify.body come as bundles at the rate, first about every "
               "object there is. A subscriber that sends nothing for 60 s is forgotten; anything it sends keeps it, "
               "/notify itself too.",
               {optional(other<ValueType::flag, &Notify::on>("on", "1 subscribes, 0 ends it.")),
                optional(number<&Notify::rate_hz>("rate", kNoticeRate, "How often to tell."))}),
      answered(
          "/state/save", SaveState{"state.toml"},
          "Writes what there is as a readable file, which `ringdownd --state` loads: objects with their banks, gains, "
          "pans, groups and materials, what inputs excite, and the scene, which starts from its beginning.",
          {other<ValueType::text, &SaveState::path>(
              "path",
              "The file to write, .toml; it replaces none but a state. A relative path starts where the daemon was "
              "started.")}),
      answered(
          "/record/start", RecordStart{"session.osc"},
          "Records everything that is played as an OSC score, which `ringdown render --events` plays again, bit for "
          "bit at the same sample rate and block size. What rang before is not in it.",
          {other<ValueType::text, &RecordStart::path>(
              "path",
              "The score to write, .osc; it replaces none but a score. A relative path starts where the daemon "
              "was started.")}),
      answered("/record/stop", RecordStop{}, "Writes the score.", {}, "/done", "the count of its messages"),
      answered("/status", Status{}, "Asks how the daemon is doing.", {}, "/status.reply"),
      answered("/version", Version{}, "Asks which program this is.", {}, "/version.reply"),
      answered("/sync", Sync{7}, "Answers when all that was sent before it has been taken up.",
               {integer<&Sync::id>("id", kId, "Any number; the answer repeats it.")}, "/synced"),
      answered("/quit", Quit{}, "Stops the daemon.", {}),
  };
}

template <class Struct>
Row<Reply> reply(std::string_view address, const Struct& example, std::string_view sentence,
                 std::initializer_list<Columns<Reply>> arguments) {
  return make_row<Reply>(address, sentence, arguments, example);
}

std::vector<Row<Reply>> make_reply_rows() {
  return {
      reply("/done", Done{"/load", 3}, "The request was carried out.",
            {other<ValueType::any_text, &Done::address>("address", "The address that was asked."),
             optional(integer<&Done::number>("number", kCount, "What the address says it is; absent for most."))}),
      reply("/fail", Fail{"/load", "cannot open bell.glb: No such file or directory"},
            "The request was refused, and nothing was changed.",
            {other<ValueType::any_text, &Fail::address>("address", "The address that was asked."),
             other<ValueType::any_text, &Fail::sentence>("sentence", "What is wrong, and with which argument.")}),
      reply(
          "/status.reply", StatusReply{4, 1, 220, 6, 48000, 256, 0.031, 0.058, 0, 0, 0, 0, 0.042, 0, 0, 0, 0},
          "How the daemon is doing.",
          {integer<&StatusReply::objects>("objects", kCount, "How many objects are loaded."),
           integer<&StatusReply::sounding_objects>("sounding_objects", kCount, "How many of them ring."),
           integer<&StatusReply::sounding_modes>("sounding_modes", kCount, "How many modes ring in these."),
           integer<&StatusReply::bodies>("bodies", kCount, "How many bodies the scene has."),
           number<&StatusReply::sample_rate_hz>("sample_rate", kRate, "Of the audio driver."),
           integer<&StatusReply::block_frames>("block", kCount, "Frames per block of the audio driver."),
           number<&StatusReply::load_mean>("load_mean", kLoad,
                                           "Time spent per block over the block's duration: 1 is all of it."),
           number<&StatusReply::load_peak>("load_peak", kLoad, "The same for the slowest block so far."),
           integer<&StatusReply::xruns>("xruns", kCount, "Blocks that the audio server found late, ours or another's."),
           integer<&StatusReply::dropped_events>("dropped", kCount, "Events lost because a queue was full."),
           integer<&StatusReply::late_events>("late", kCount, "Events whose time was past when they arrived."),
           integer<&StatusReply::merged_events>("merged", kCount, "Strikes that a flood added to others."),
           number<&StatusReply::load_p99>("load_p99", kLoad,
                                          "What 99 of 100 blocks of the last five to ten seconds stayed below."),
           integer<&StatusReply::misses>("misses", kCount, "Blocks that took us longer than they last."),
           integer<&StatusReply::own_xruns>("own_xruns", kCount, "Of the xruns, those in which our block was late."),
           integer<&StatusReply::hidden_modes>("hidden_modes", kCount,
                                               "How many modes that ring are left out: masked, or for want of time."),
           integer<&StatusReply::shed>(
               "shed", kCount, "Times (128 frames or less each) something was left out or late for want of time."),
           number<&StatusReply::slowed_s>("slowed", kLost, "What the scene has lost because it could not keep up.")}),
      reply("/version.reply", VersionReply{"ringdownd", RINGDOWN_VERSION, kProtocolVersion}, "Which program this is.",
            {other<ValueType::any_text, &VersionReply::program>("program", "The program's name."),
             other<ValueType::any_text, &VersionReply::version>("version", "Its version."),
             integer<&VersionReply::protocol>("protocol", kCount,
                                              "Of this protocol; grows when an address changes its meaning.")}),
      reply("/synced", Synced{7}, "All that was sent before /sync has been taken up.",
            {integer<&Synced::id>("id", kId, "The number that /sync gave.")}),
      reply("/notify.object", NotifyObject{3, "bell", true}, "To subscribers: an object came, or went.",
            {integer<&NotifyObject::number>("number", kIndex, "Its number."),
             other<ValueType::any_text, &NotifyObject::name>("name", "Its name."),
             other<ValueType::flag, &NotifyObject::loaded>("loaded",
                                                           "1: it is there, perhaps with a new bank; 0: freed.")}),
      reply("/notify.group", NotifyGroup{3, "bell", "metal"},
            "To subscribers: an object came into a group, or is in none any more.",
            {integer<&NotifyGroup::number>("number", kIndex, "The object's number."),
             other<ValueType::any_text, &NotifyGroup::name>("name", "Its name."),
             optional(other<ValueType::any_text, &NotifyGroup::group>("group", "The group's name; absent: none."))}),
      reply("/notify.contact", NotifyContact{"bell", {0.05, 0, 0.02}, {-0.02, 0, 0}, 0.0005},
            "To subscribers: an object was struck, by a message or in the scene. At most the last 256 since the notice "
            "before are told.",
            {other<ValueType::any_text, &NotifyContact::object>("object", "Its name."),
             vector<&NotifyContact::point_m>({"x", "y", "z"}, kAnyPosition, "Where, in its own frame."),
             vector<&NotifyContact::impulse_ns>({"jx", "jy", "jz"}, kAnyImpulse, "The impulse it received."),
             number<&NotifyContact::contact_time_s>("contact_time", kContactTime, "How long the blow lasted.")}),
      reply("/notify.peak", NotifyPeak{0.25}, "To subscribers: how loud the mix was.",
            {number<&NotifyPeak::peak>("peak", kPeak, "The largest sample since the notice before; 1 is full scale.")}),
      reply("/notify.object_peak", NotifyObjectPeak{"bell", 0.25},
            "To subscribers: how loud an object was, of each that rings, and a last time when it is silent.",
            {other<ValueType::any_text, &NotifyObjectPeak::object>("object", "Its name."),
             number<&NotifyObjectPeak::peak>(
                 "peak", kPeak,
                 "What none of its samples since the notice before exceeded, at its gain: the sum of the amplitudes of "
                 "its modes, masked ones among them. Of one mode it is the peak; many do not peak together. Up to 64 "
                 "objects (2,048 modes) are looked at every 128 frames, more in turn.")}),
      reply("/notify.load", NotifyLoad{0.031, 0.058, 0, 1, 220}, "To subscribers: as in /status.reply.",
            {number<&NotifyLoad::mean>("load_mean", kLoad, "Time spent per block over the block's duration."),
             number<&NotifyLoad::peak>("load_peak", kLoad, "The same for the slowest block so far."),
             integer<&NotifyLoad::xruns>("xruns", kCount, "Blocks that came too late."),
             integer<&NotifyLoad::sounding_objects>("sounding_objects", kCount, "How many objects ring."),
             integer<&NotifyLoad::sounding_modes>("sounding_modes", kCount, "How many modes ring in these.")}),
      reply(
          "/notify.body", NotifyBody{2, "bell", "bell", {0, 0, 1}, 0, 0, 0, 1},
          "To subscribers: where a body of the scene is. The pose is that of its object's frame: the bank's mesh drawn "
          "with it is in place. One that is told no more has left the scene.",
          {integer<&NotifyBody::id>("body", kCount, "Its number."),
           other<ValueType::any_text, &NotifyBody::name>("name", "Its name in the scene file."),
           other<ValueType::any_text, &NotifyBody::object>("object",
                                                           "The object that rings when it is hit; - for none."),
           vector<&NotifyBody::position_m>({"x", "y", "z"}, kAnyPosition, "Where it is, in the scene's frame."),
           number<&NotifyBody::x>("qx", kUnit, "How it is turned: a unit quaternion."),
           number<&NotifyBody::y>("qy", kUnit, "Its y component."),
           number<&NotifyBody::z>("qz", kUnit, "Its z component."),
           number<&NotifyBody::w>("qw", kUnit, "Its real part.")}),
  };
}

}  // namespace

const std::vector<Row<Request>>& request_rows() {
  static const std::vector<Row<Request>> rows = make_request_rows();
  return rows;
}

const std::vector<Row<Reply>>& reply_rows() {
  static const std::vector<Row<Reply>> rows = make_reply_rows();
  return rows;
}

}  // namespace ringdown::protocol
