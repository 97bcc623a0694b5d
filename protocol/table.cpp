// The table of what can be asked. A new verb of the mixer is a struct in engine/synth/events/verbs.h and a row here.
// Any other new address is
//
//   - a struct in request.h, and its place in Requests;
//   - its place in a lane (lanes.h), which says who handles it, when and on which thread;
//   - a row here: its address and arguments, with an example of it in `s`, at whose members the arguments point;
//   - an overload in the visitor of that lane;
//   - its cases in tests/protocol/schema_cases.cpp.
//
// Whichever of the first four is forgotten, the compiler says so; of the last, Schema's first test does. Then
// `ringdown protocol --markdown > docs/reference/protocol.md` writes the page, which a test compares.
#include "protocol/bulk.h"
#include "protocol/quantities.h"

namespace ringdown::protocol {
namespace {

Columns object(const ObjectRef* member) {
  return object(member, "object", "The object, by its name or by the number that /load answered.");
}

Columns body_object(const std::optional<ObjectRef>* member) {
  return object_or_none(member, "object", "The object that sounds when the body is hit.");
}

Columns impulse(const Vec3* member) {
  return vector(member, "impulse", {"jx", "jy", "jz"}, kImpulse, "The impulse on the object.");
}

Columns contact_time(const double* member) {
  return optional(number(member, "contact_time", kContactTime, "The duration of the blow; a longer blow is duller."));
}

Columns position(const Vec3* member) {
  return vector(member, "position", {"x", "y", "z"}, kPosition,
                "The initial position of the body's centre of mass, in the scene's frame.");
}

Columns velocity(const Vec3* member) {
  return optional(vector(member, "velocity", {"vx", "vy", "vz"}, kVelocity, "The body's initial velocity."));
}

Columns density(const double* member) {
  return optional(number(member, "density", kDensity, "The body's density; 0 takes mass and inertia from the bank."));
}

Columns turn(const Rotation* member) {
  return optional(grouped(
      "rotation_wxyz",
      append(
          number(&member->w, "qw", kUnit,
                 "The rotation as a unit quaternion: qw is cos(a / 2) for a rotation by the angle a."),
          vector(member, "rotation_wxyz", {"qx", "qy", "qz"}, kUnit, "The axis of the rotation, times sin(a / 2)."))));
}

const ObjectRef kBell{"bell", std::nullopt};
const Pose kTurned{{0.5, 0, 1}, Rotation::from_xyzw(0, 0, 1, 0)};
const BulkPose kPlaced{0, kTurned, 0};
const BulkStrike kBlow{0, std::nullopt, {0.05, 0, 0.02}, {-0.02, 0, 0}, 0.0005, 0};

using Arguments = std::initializer_list<Columns>;

// An address that succeeds in silence. Tests send `example` through the parser and by oscsend.
template <class Struct>
Row silent(const Struct& example, const char* address, const char* sentence, Arguments arguments) {
  return make_row(&example, address, sentence, arguments);
}

// One that is answered; `number` says what the number in /done is, if there is one.
template <class Struct>
Row answered(const Struct& example, const char* address, const char* sentence, Arguments arguments,
             const char* reply = "/done", const char* number = "") {
  return make_row(&example, address, sentence, arguments, reply, number);
}

Row row(Strike& s) {
  return silent(s = {kBell, {{0.05, 0, 0.02}, {-0.02, 0, 0}, 0.0005}}, "/object/{object}/strike",
                "Strikes the object at the surface point nearest to x y z.",
                {object(&s.object), vector(&s.verb.point_m, "point", {"x", "y", "z"}, kPosition, "The struck point."),
                 impulse(&s.verb.impulse_ns), contact_time(&s.verb.contact_time_s)});
}

Row row(StrikeVertex& s) {
  return silent(s = {kBell, {12, {-0.02, 0, 0}, 0.0005}}, "/object/{object}/strike_vertex",
                "Strikes the object at a sample point of its bank.",
                {object(&s.object), integer(&s.verb.vertex, "vertex", kIndex, "The point's number, from 0."),
                 impulse(&s.verb.impulse_ns), contact_time(&s.verb.contact_time_s)});
}

Row row(StrikeMany& s) {
  return silent(s = {encode_strikes(std::array{kBlow})}, "/strikes",
                "Strikes many times by one message, for simulators (see clients/python/strike.py). A record has 40 "
                "bytes, big-endian: int32 object (the number that /load answered), int32 vertex (-1: at x y z), "
                "float32 x y z [m], jx jy jz [N s], contact_time [s] and delay [s], 0 to 60, after the message's time. "
                "Ranges are those of /strike. If one record is wrong, all are refused.",
                {records(&s.records, "records", kBytesPerStrike, kMaxBulkStrikes, "The records.")});
}

Row row(SetGain& s) {
  return silent(s = {kBell, {0.5, 0.1}}, "/object/{object}/gain", "Sets the object's loudness.",
                {object(&s.object),
                 number(&s.verb.gain, "gain", kGain, "The factor on the object's signal; 1 is the computed level."),
                 optional(number(&s.verb.ramp_s, "ramp", kRamp, "The duration of the change."))});
}

Row row(SetPan& s) {
  return silent(s = {kBell, {-0.3}}, "/object/{object}/pan", "Pans the object at equal power.",
                {object(&s.object), number(&s.verb.pan, "pan", kPan, "-1 is left, 0 the middle, 1 right.")});
}

Row row(SetPickup& s) {
  return silent(
      s = {kBell, {{0.05, 0, 0.02}, {1, 0, 0}, 1, 1, 10}}, "/object/{object}/pickup",
      "Sends the motion of a point of the object to an output of its own, as a contact microphone or a laser "
      "vibrometer "
      "measures it: port pickup_1 to pickup_8. Gain, pan, mute and listener do not change it. A pickup of this number "
      "on "
      "another object moves here; a direction of 0 0 0 removes it.",
      {object(&s.object),
       vector(&s.verb.point_m, "point", {"x", "y", "z"}, kPosition,
              "The point; the surface point nearest to it counts."),
       vector(&s.verb.direction, "direction", {"dx", "dy", "dz"}, kDirection,
              "The direction of the motion; any length."),
       optional(integer(&s.verb.number, "bus", kPickup, "The pickup's number, and that of its output.")),
       optional(integer(&s.verb.motion, "motion", kMotion, "0 is displacement, 1 velocity, 2 acceleration.")),
       optional(number(&s.verb.gain, "gain", kSensitivity, "The sample for a motion of 1 m, 1 m/s or 1 m/s2."))});
}

Row row(SetMaterial& s) {
  return answered(
      s = {kBell, {1, 1, 1, 4, 0.5}}, "/object/{object}/material",
      "Scales the bank's material, size and losses, exactly. If the material has Rayleigh's constants, alpha and beta "
      "scale these. Points in later messages lie on the object in its new size. Bodies of a running scene keep their "
      "size.",
      {object(&s.object), number(&s.scale.alpha, "alpha", kDampingScale, "The factor on the loss to supports."),
       number(&s.scale.beta, "beta", kDampingScale, "The factor on the loss to the material."),
       number(&s.scale.density, "density", kScale, "The factor on the density."),
       number(&s.scale.stiffness, "stiffness", kScale, "The factor on Young's modulus; 4 is an octave up."),
       optional(number(&s.scale.size, "size", kSizeScale, "The factor on all lengths; 0.5 is an octave up.")),
       optional(number(&s.scale.heat, "heat", kDampingScale, "The factor on the loss by heat flow.")),
       optional(number(&s.scale.air, "air", kDampingScale, "The factor on the loss to the air."))});
}

Row row(SetFill& s) {
  return answered(
      s = {kBell, 0.08}, "/object/{object}/fill",
      "Lets the liquid in the object stand at another level, and retunes what rings. The bank must know its levels "
      "(bake "
      "it with [fill] and levels = 16). For a glide, send steps of about 1 mm.",
      {object(&s.object), number(&s.level_m, "level", kPosition,
                                 "The height of the surface in the object's frame, from the bottom, where it is empty, "
                                 "to the rim.")});
}

Row row(SetResonator& s) {
  return answered(s = {kBell, {-20, 1}}, "/object/{object}/resonator",
                  "Tunes the tubes under the object, and retunes what rings. The bank must have a tube (bake it with "
                  "[[resonator]]). For a glide, send steps of about 2 cents.",
                  {object(&s.object), number(&s.tuning.detune_cents, "detune", kDetune, "From the tuning as baked."),
                   optional(number(&s.tuning.opening, "opening", kShare, "The share of the mouth that is open."))});
}

Row row(Hold& s) {
  return answered(
      s = {kBell, {{0.05, 0, 0.02}, {}, 20}}, "/object/{object}/hold",
      "Lays a damper, such as a hand or a table, on the object: modes decay faster the more they move there. An object "
      "can have 16 dampers; an embedded scene uses those from number 8 on.",
      {object(&s.object), vector(&s.damper.point_m, "point", {"x", "y", "z"}, kPosition, "The damped point."),
       number(&s.damper.damping_ns_m, "damping", kDamping,
              "The resisting force over the speed of the surface: about 5 for a fingertip; 0 removes the damper."),
       optional(vector(&s.damper.direction, "direction", {"nx", "ny", "nz"}, kDirection,
                       "The direction of the resisted motion; 0 0 0 for all.")),
       optional(integer(&s.number, "number", kDamperNumber, "The damper's number."))});
}

Row row(SetGroup& s) {
  return answered(s = {kBell, "metal"}, "/object/{object}/group",
                  "Puts the object into a group. With --ports groups, each group has its own output port.",
                  {object(&s.object), optional(name(&s.group, "group", "The group's name."))});
}

Row row(SetMute& s) {
  return answered(s = {kBell, true}, "/object/{object}/mute",
                  "Mutes or unmutes the object for everyone who listens. It continues to ring unheard. Subscribers get "
                  "a /notify.object.",
                  {object(&s.object), optional(flag(&s.on, "on", "1 starts, 0 ends."))});
}

Row row(SetSolo& s) {
  return answered(s = {kBell, true}, "/object/{object}/solo",
                  "Solos the object, or ends its solo. While any object is soloed, the others are silent. A muted "
                  "object is always silent.",
                  {object(&s.object), optional(flag(&s.on, "on", "1 starts, 0 ends."))});
}

Row row(RingModes& s) {
  return silent(s = {kBell, {0, 1, 0.1}}, "/object/{object}/ring",
                "Starts modes without a strike, each as a sine from 0.",
                {object(&s.object),
                 integer(&s.verb.first, "first", kIndex, "The lowest of these modes; mode 0 has the lowest frequency."),
                 optional(integer(&s.verb.count, "count", kCount, "The number of modes, counted upwards.")),
                 optional(number(&s.verb.amplitude, "amplitude", kAmplitude,
                                 "The amplitude of each mode, at gain 1, before the pan; 1 is full scale."))});
}

Row row(OnObject<synth::verb::Impart>& s) {
  return silent(
      s = {kBell, {0, 0.001}}, "/object/{object}/impart",
      "Starts one mode with a known motion, such as one of your own computation, or of a body that breaks.",
      {object(&s.object), integer(&s.verb.mode, "mode", kIndex, "The mode's number; mode 0 has the lowest frequency."),
       number(&s.verb.velocity, "velocity", kModalVelocity,
              "The mode's largest velocity, for a shape whose modal mass is 1 kg."),
       optional(number(&s.verb.phase_rad, "phase", kPhase,
                       "0 starts the mode as a blow does, pi/2 from rest at its largest displacement."))});
}

Row row(SelectModes& s) {
  return answered(
      s = {kBell, {0, 20}}, "/object/{object}/modes",
      "Restricts the object to these modes; the other modes stop ringing. The argument 0 alone restores all modes.",
      {object(&s.object),
       integer(&s.range.first, "first", kIndex, "The lowest of these modes; mode 0 has the lowest frequency."),
       optional(integer(&s.range.count, "count", kCount, "The number of modes, counted upwards."))});
}

Row row(WatchObject& s) {
  return answered(
      s = {kBell, true}, "/object/{object}/watch",
      "Sends a subscriber of /notify the amplitudes of the object's modes (/notify.modes), for up to 16 objects.",
      {object(&s.object), optional(flag(&s.on, "on", "1 starts, 0 stops."))});
}

Row row(DescribeObject& s) {
  return answered(s = {kBell}, "/object/{object}/describe", "Asks for the object's bank and settings.",
                  {object(&s.object)}, "/object.reply");
}

Row row(ReadBank& s) {
  return answered(
      s = {kBell, 0, 4096}, "/object/{object}/bank", "Asks for a piece of the object's bank file.",
      {object(&s.object), integer(&s.offset, "offset", kCount, "Where the piece begins, in bytes."),
       optional(integer(&s.bytes, "bytes", kBankBytes, "The length of the piece; the last piece may be shorter."))},
      "/bank.reply");
}

Row row(Excite& s) {
  return answered(
      s = {kBell, 1, {0.05, 0, 0.02}, {0, 0, -1}}, "/object/{object}/excite",
      "Lets an audio input, in_1 to in_4, excite the object as a force at x y z. An input excites one object at a "
      "time; a force of 0 0 0 disconnects it.",
      {object(&s.object), integer(&s.input, "input", kInput, "The input's number."),
       vector(&s.point_m, "point", {"x", "y", "z"}, kPosition, "The point on which the force acts."),
       vector(&s.force_n, "force", {"fx", "fy", "fz"}, kForce, "The force that a sample of 1 stands for.")});
}

Row row(ClearObject& s) {
  return silent(s = {kBell}, "/object/{object}/clear",
                "Fades everything that rings in the object, and ends its contacts.",
                {object(&s.object),
                 optional(number(&s.verb.ramp_s, "ramp", kRamp, "The duration of the fade, at least about 10 ms."))});
}

Row row(SetFan& s) {
  return silent(
      s = {kBell, {5, 0.8}}, "/object/{object}/fan",
      "Turns a fan in the mouth of the object's tube: a vibraphone's tremolo. Objects without a tube sound as "
      "before.",
      {object(&s.object), number(&s.verb.rate_hz, "rate", kFanRate, "Closings of the mouth per second."),
       number(&s.verb.depth, "depth", kShare, "1 closes the mouth; 0 stops the fan.")});
}

Row row(OnObject<synth::verb::Choke>& s) {
  return silent(s = {kBell, {0.2}}, "/object/{object}/choke",
                "Damps everything that rings in the object, like a hand on a cymbal. Bows and other contacts continue, "
                "and later strikes ring.",
                {object(&s.object),
                 optional(number(&s.verb.within_s, "within", kRamp,
                                 "The time in which the amplitude falls by 60 dB. Less than 5 ms causes a click."))});
}

Row row(OnObject<synth::verb::Slap>& s) {
  return silent(
      s = {kBell, {1e-4, 0.002}}, "/object/{object}/slap",
      "Slaps the mouth of the object, such as a bottle's, so that the air in it rings. The bank must have this air "
      "(bake "
      "it with [cavity]).",
      {object(&s.object), number(&s.verb.impulse_ns, "impulse", kImpulse, "The impulse on the air in the mouth."),
       contact_time(&s.verb.contact_time_s)});
}

Row row(OnObject<synth::verb::Blow>& s) {
  return silent(
      s = {kBell, {100}}, "/object/{object}/blow",
      "Blows over the mouth of the object, so that the air in it sounds, until a pressure of 0 or /clear ends it. The "
      "breath is noise that does not feel how the air moves: it colours, and does not lock into a tone. The bank must "
      "have this air (bake it with [cavity]).",
      {object(&s.object), number(&s.verb.pressure_pa, "pressure", kBreath,
                                 "The noise in the mouth from 20 Hz to 10 kHz, root mean square; 0 ends it.")});
}

Row row(SetContact& s) {
  return silent(
      s = {kBell, {{0.05, 0, 0.02}, {0, {0, 0, -2}, 0.3, 0, {}}}}, "/object/{object}/contact",
      "Lets something slide or roll on the object. Values are interpolated between messages: send 50 to 250 a second. "
      "A force of 0 0 0, or 0.1 s without a message, ends the contact.",
      {object(&s.object), vector(&s.verb.point_m, "point", {"x", "y", "z"}, kPosition, "The point of contact."),
       vector(&s.verb.contact.force_n, "force", {"fx", "fy", "fz"}, kForce,
              "The force on the object, friction included."),
       number(&s.verb.contact.slip_m_s, "slip", kSpeed, "The speed at which the surfaces slide past each other."),
       optional(number(&s.verb.contact.roll_m_s, "roll", kSpeed, "The speed at which the point of contact travels.")),
       optional(integer(&s.verb.contact.number, "number", kIndex,
                        "The contact's number; an object can have four contacts at once.")),
       optional(number(&s.verb.contact.texture.roughness_m, "roughness", kRoughness,
                       "The root mean square of the heights of both surfaces together.")),
       optional(number(&s.verb.contact.texture.correlation_m, "correlation", kCorrelation,
                       "The longest wavelength of the roughness.")),
       optional(number(&s.verb.contact.texture.spectral_slope, "slope", kSpectralSlope,
                       "The exponent of the power spectrum of the heights over spatial frequency."))});
}

Row row(SetBow& s) {
  return silent(
      s = {kBell, {.point_m = {0.05, 0, 0.02}, .direction = {0, 0, 1}, .speed_m_s = 0.2, .force_n = 1}},
      "/object/{object}/bow",
      "Bows the object: the hair sticks and slips, and reacts to the surface's motion. Send the message again to "
      "change speed or force, which glide to their new values within the time since the last message, 2 to 50 ms. A "
      "force of 0 lifts the bow.",
      {object(&s.object),
       vector(&s.verb.point_m, "point", {"x", "y", "z"}, kPosition, "The point on which the bow lies."),
       vector(&s.verb.direction, "direction", {"dx", "dy", "dz"}, kDirection,
              "The direction in which the hair moves along the surface; any length but 0."),
       number(&s.verb.speed_m_s, "speed", kBowSpeed, "The hair's speed; a negative speed reverses the direction."),
       number(&s.verb.force_n, "force", kPress, "The force that presses the bow on the surface."),
       optional(number(&s.verb.width_m, "width", kWidth,
                       "The width of the hair; modes with shorter wavelengths feel less of the bow.")),
       optional(number(&s.verb.rosin, "rosin", kFriction,
                       "The coefficient of static friction; that of sliding is three eighths of it.")),
       optional(integer(&s.verb.number, "number", kIndex, "The bow's number on this object."))});
}

Row row(HitMallet& s) {
  return silent(
      s = {kBell, {.point_m = {0.05, 0, 0.02}, .velocity_m_s = {0, 0, -1}}}, "/object/{object}/mallet",
      "Throws a mallet at the object. Mass, head, speed and the object's own motion decide how long the blow lasts and "
      "how often the mallet hits.",
      {object(&s.object),
       vector(&s.verb.point_m, "point", {"x", "y", "z"}, kPosition, "The point that the mallet hits."),
       vector(&s.verb.velocity_m_s, "velocity", {"vx", "vy", "vz"}, kVelocity, "The mallet's velocity; not 0."),
       optional(number(&s.verb.mass_kg, "mass", kMalletMass, "The mallet's mass, shaft and hand included.")),
       optional(number(&s.verb.head, "head", kHardness,
                       "The stiffness of the head: about 1e5 for yarn, 1e7 for rubber, 1e9 for wood, 1e10 for steel.")),
       optional(number(&s.verb.bounce, "bounce", kBounce,
                       "The mallet's speed after a blow on a rigid wall, divided by its speed before."))});
}

Row row(SetCoupling& s) {
  return silent(
      s = {kBell, {.point_m = {0.05, 0, 0.02}, .direction = {0, 0, 1}}, kBell}, "/object/{object}/couple",
      "Lets another object touch this one at a point of each, so that both rattle, buzz and ring together. The frames "
      "of the two are assumed to be parallel. A stiffness of 0 separates them.",
      {object(&s.object),
       vector(&s.verb.point_m, "point", {"x", "y", "z"}, kPosition, "The touched point of this object."),
       object(&s.other, "other", "The other object."),
       vector(&s.verb.other_point_m, "other_point", {"ox", "oy", "oz"}, kPosition,
              "The touched point of the other object, in its own frame."),
       vector(&s.verb.direction, "direction", {"nx", "ny", "nz"}, kDirection,
              "The direction in which the other object pushes this one; any length but 0."),
       optional(number(&s.verb.weight_n, "weight", kPress,
                       "The weight with which the other object rests on this one; 0: both are held in place.")),
       optional(number(&s.verb.gap_m, "gap", kGap,
                       "The distance between the two at rest; a negative gap presses them together.")),
       optional(number(&s.verb.stiffness, "stiffness", kStiffness, "The stiffness of the contact, by Hertz's law.")),
       optional(number(&s.verb.friction, "friction", kFriction, "Coefficient of static friction.")),
       optional(number(&s.verb.bounce, "bounce", kBounce, "The speed after an impact, divided by the speed before.")),
       optional(number(&s.verb.mass_kg, "mass", kRestingMass,
                       "The other object's mass, if it rests by its weight; 0 derives the mass from the weight.")),
       optional(integer(&s.verb.number, "number", kIndex, "The coupling's number on this object."))});
}

Row row(Click& s) {
  return silent(s = {kBell, {{-0.02, 0, 0}, 0.0005}}, "/object/{object}/click",
                "Plays the click of a free object that a blow sets in motion as a whole. Strikes do not include it. "
                "Send one click for all points that are struck at the same time.",
                {object(&s.object), impulse(&s.verb.impulse_ns), contact_time(&s.verb.contact_time_s)});
}

Row row(SetPose& s) {
  return silent(s = {kBell, {kTurned}}, "/object/{object}/pose",
                "Sets the object's pose, from which a listener (/listener) hears it. Send 30 to 250 poses a second for "
                "a moving object; the motion between poses is smooth. A pose sent one interval ahead of its time is "
                "reached exactly then, any other pose one interval after it arrives.",
                {object(&s.object),
                 vector(&s.verb.pose.position_m, "position", {"x", "y", "z"}, kPosition,
                        "The position of the object's origin in the scene."),
                 turn(&s.verb.pose.rotation)});
}

Row row(PoseMany& s) {
  return silent(s = {encode_poses(std::array{kPlaced})}, "/poses",
                "Sets many poses by one message. A record has 36 bytes, big-endian: int32 object (the number that "
                "/load answered), float32 x y z [m], qw qx qy qz and delay [s], 0 to 60, after the message's time. "
                "Ranges are those of /object/{object}/pose. If one record is wrong, all are refused.",
                {records(&s.records, "records", kBytesPerPose, kMaxBulkPoses, "The records.")});
}

Row row(SetListener& s) {
  return silent(s = {{kTurned}}, "/listener",
                "Sets the listener's pose. Objects with a pose are then heard from their places, with direction, "
                "distance and Doppler shift. Objects without a pose sound as before.",
                {vector(&s.verb.pose.position_m, "position", {"x", "y", "z"}, kPosition,
                        "The position of the listener's head in the scene. Without a rotation it faces along x, with "
                        "the left ear towards y."),
                 turn(&s.verb.pose.rotation)});
}

Row row(ListenerOff& s) { return silent(s, "/listener/off", "Removes the listener.", {}); }

Row row(SetListenerAir& s) {
  return silent(
      s = {{15, 70}}, "/listener/air",
      "Sets the air between objects and listener, which absorbs high frequencies more strongly over longer distances.",
      {number(&s.verb.temperature_c, "temperature", kTemperature, "The temperature of the air."),
       optional(number(&s.verb.humidity_percent, "humidity", kHumidity, "The relative humidity of the air."))});
}

Row row(ArmObject& s) {
  return answered(
      s = {kBell}, "/object/{object}/arm",
      "Makes the pieces ready that the object breaks into, as objects NAME.0, NAME.1 and so on, so that a break takes "
      "no time. /break does it by itself.",
      {object(&s.object),
       optional(integer(&s.pattern, "pattern", kPattern,
                        "Which of its bank's patterns of pieces, from 0; -1: the finest at the place of the first."))},
      "/done", "the number of pieces; pieces without a mode do not become objects");
}

Row row(BreakObject& s) {
  return answered(s = {kBell, {0.05, 0, 0.02}, {-0.5, 0, 0}, 0.0002}, "/object/{object}/break",
                  "Breaks the object at the peak of a blow: it falls silent, and its pieces take over its motion. Its "
                  "bank must have pieces ([shatter] in the object file).",
                  {object(&s.object), vector(&s.point_m, "point", {"x", "y", "z"}, kPosition, "The struck point."),
                   impulse(&s.impulse_ns), contact_time(&s.contact_time_s),
                   optional(integer(&s.pattern, "pattern", kPattern,
                                    "Which of its bank's patterns; -1: the one that is armed, else the nearest one."))},
                  "/broken");
}

Row row(MendObject& s) {
  return answered(s = {kBell}, "/object/{object}/mend", "Removes the object's pieces; it can be struck again.",
                  {object(&s.object)});
}

Row row(SetStrength& s) {
  return answered(s = {kBell, 5e7}, "/object/{object}/strength",
                  "Arms the object, and lets it break in place of any later /strike, /strike_vertex or /strikes that "
                  "strains its skin so far away from the blow. Strikes of scenes and MIDI do not count.",
                  {object(&s.object), number(&s.strength_pa, "strength", kStress,
                                             "Glass 4e7 to 7e7, plaster 5e6; 0: no blow breaks it.")});
}

Row row(DescribePieces& s) {
  return answered(
      s = {kBell}, "/object/{object}/pieces",
      "Asks how the object breaks: its patterns, and masses and flight of the pieces. A game asks for each pattern "
      "while it loads.",
      {object(&s.object), optional(integer(&s.pattern, "pattern", kPattern, "Whose pieces; -1: the armed one's."))},
      "/pieces.reply");
}

Row row(FreeObject& s) {
  return answered(s = {kBell}, "/object/{object}/free",
                  "Fades and removes the object; its name and number become free.", {object(&s.object)});
}

Row row(LoadObject& s) {
  return answered(s = {"bell", "presets/banks/bronze-bell.glb"}, "/load",
                  "Loads a bank under a name. An object of that name gets the new bank, while the old one rings out.",
                  {name(&s.name, "name", "The object's name."), text(&s.bank_path, "path", "The bank, a .glb file.")},
                  "/done", "the object's number");
}

Row row(ClearAll& s) { return silent(s, "/clear", "Fades everything that rings within a few milliseconds.", {}); }

Row row(SceneLoad& s) {
  return answered(s = {"presets/scenes/demo.toml"}, "/scene/load",
                  "Replaces the embedded scene and loads the objects it names.",
                  {text(&s.path, "path", "The scene, a .toml file."),
                   optional(flag(&s.paused, "paused", "1 loads it paused, until /scene/pause 0 lets it begin."))},
                  "/done", "the count of its bodies");
}

Row row(ScenePause& s) {
  return answered(s = {true}, "/scene/pause", "Pauses or continues the scene; sounds ring on.",
                  {optional(flag(&s.paused, "paused", "1 pauses, 0 continues."))});
}

Row row(SpawnBox& s) {
  return answered(s = {kBell, {0, 0, 1}, {0, 0, -2}, {0.1, 0.1, 0.1}, 0}, "/scene/spawn/box",
                  "Drops a new box into the scene.",
                  {body_object(&s.object), position(&s.position_m),
                   optional(vector(&s.size_m, "size", {"sx", "sy", "sz"}, kSize,
                                   "The box's edges; 0 0 0 takes the bank's bounding box.")),
                   velocity(&s.velocity_m_s), density(&s.density_kg_m3)},
                  "/done", "the body's number");
}

Row row(SpawnSphere& s) {
  return answered(
      s = {std::nullopt, {0, 0, 1}, {0, 0, 0}, 0.01, 7850}, "/scene/spawn/sphere", "Drops a new ball into the scene.",
      {body_object(&s.object), position(&s.position_m),
       optional(number(&s.radius_m, "radius", kSize, "The ball's radius; 0 takes a radius that encloses the bank.")),
       velocity(&s.velocity_m_s), density(&s.density_kg_m3)},
      "/done", "the body's number");
}

Row row(SceneClear& s) { return answered(s, "/scene/clear", "Removes all bodies from the scene.", {}); }

Row row(SceneRemove& s) {
  return answered(s = {2}, "/scene/remove", "Takes a body out of the scene, with its joints.",
                  {integer(&s.body, "body", kCount, "The body's number.")});
}

Row row(SceneRestore& s) {
  return answered(s = {2}, "/scene/restore",
                  "Puts a body back that /scene/remove took, under its number: where it was, at rest, with its joints.",
                  {integer(&s.body, "body", kCount, "The body's number.")});
}

Row row(ScenePlace& s) {
  return answered(s = {2, kTurned}, "/scene/place",
                  "Puts a body elsewhere, at rest. A body that a joint or a path holds is refused.",
                  {integer(&s.body, "body", kCount, "The body's number."),
                   vector(&s.pose.position_m, "position", {"x", "y", "z"}, kPosition,
                          "Where the body is to be, as in /notify.body."),
                   turn(&s.pose.rotation)});
}

Row row(ScenePush& s) {
  return answered(
      s = {2, {0, 0, 0.5}}, "/scene/push", "Gives a body of the scene an impulse at its centre of mass.",
      {integer(&s.body, "body", kCount, "The body's number."),
       vector(&s.impulse_ns, "impulse", {"jx", "jy", "jz"}, kImpulse, "The impulse, in the scene's frame.")});
}

Row row(SceneDescribe& s) {
  return answered(s, "/scene/describe",
                  "Asks for a description of the scene. A /scene.body for each body and a /scene.static for each "
                  "static follow the answer.",
                  {}, "/scene.reply");
}

Row row(Notify& s) {
  return answered(s = {true, 20}, "/notify",
                  "Subscribes the sender to bundles of /notify.object, .group, .contact, .peak, .object_peak, .load, "
                  ".scene and .body, and /broken. The first bundle reports every object. A subscriber that sends "
                  "nothing for 60 s is forgotten.",
                  {optional(flag(&s.on, "on", "1 subscribes, 0 ends the subscription.")),
                   optional(number(&s.rate_hz, "rate", kNoticeRate, "Bundles per second."))});
}

Row row(WatchSound& s) {
  return answered(s = {true}, "/watch/sound", "Sends a subscriber of /notify the samples of the mix (/notify.sound).",
                  {optional(flag(&s.on, "on", "1 starts, 0 stops."))});
}

Row row(Browse& s) {
  return answered(s, "/browse",
                  "Asks for the scenes and banks that can be loaded: a /browse.file for each follows the answer.", {},
                  "/browse.reply");
}

Row row(TestTone& s) {
  return answered(s = {0.1, 440}, "/test_tone", "Adds a sine to both sides of the mix.",
                  {number(&s.amplitude, "amplitude", kAmplitude, "1 is full scale, 0 ends the tone."),
                   optional(number(&s.frequency_hz, "frequency", kFrequency, "The tone's frequency."))});
}

Row row(SaveState& s) {
  return answered(
      s = {"state.toml"}, "/state/save",
      "Writes objects, inputs, listener and scene to a readable file, which `ringdownd --state` loads.",
      {text(&s.path, "path", "The .toml file to write. An existing file is replaced only if it is a state.")});
}

Row row(SaveScene& s) {
  return answered(
      s = {"scene.toml", false}, "/scene/save",
      "Writes a scene file with all objects in their present settings, and the dropped bodies at their times. Pushes, "
      "dampers, mutes, solos and choices of modes are not saved.",
      {text(&s.path, "path", "The .toml file to write."),
       optional(flag(&s.replace, "replace", "1 replaces a scene that /scene/save wrote; 0 replaces nothing."))});
}

Row row(RecordStart& s) {
  return answered(
      s = {"session.osc"}, "/record/start",
      "Records what is played as an OSC score, which `ringdown render --events` plays again: bit for bit, at the same "
      "sample rate and block size.",
      {text(&s.path, "path", "The .osc file to write. An existing file is replaced only if it is a score.")});
}

Row row(RecordStop& s) {
  return answered(s, "/record/stop",
                  "Writes the score, with everything that an earlier /sync confirmed. If it cannot be written, the "
                  "recording continues.",
                  {optional(text(&s.path, "path", "The .osc file to write, if it is not the one named at the start."))},
                  "/done", "the count of its messages");
}

Row row(CaptureStart& s) {
  return answered(
      s = {"session.wav"}, "/capture/start",
      "Writes the mix from now on to a WAV file of 32-bit floats. The file is complete when /capture/stop is answered.",
      {text(&s.path, "path", "The .wav file to write. No existing file is replaced.")});
}

Row row(CaptureStop& s) {
  return answered(s, "/capture/stop", "Completes the sound file.", {}, "/done", "the count of its frames");
}

Row row(Status& s) { return answered(s, "/status", "Asks for the daemon's state.", {}, "/status.reply"); }

Row row(Version& s) {
  return answered(s, "/version", "Asks for the program's name and version.", {}, "/version.reply");
}

Row row(Sync& s) {
  return answered(s = {7}, "/sync", "Answers when all earlier messages have been handled.",
                  {integer(&s.id, "id", kId, "A number that the answer repeats.")}, "/synced");
}

Row row(Quit& s) { return answered(s, "/quit", "Stops the daemon.", {}); }

}  // namespace

const Table<Requests>& request_table() {
  static const Table<Requests> table = make_table(Requests(), [](auto& request) { return row(request); });
  return table;
}

}  // namespace ringdown::protocol
