// The table of what is answered: a struct in reply.h and a row here for each.
#include "engine/base/version.h"
#include "protocol/quantities.h"

namespace ringdown::protocol {

namespace {

template <class Struct>
Row reply(const Struct& example, const char* address, const char* sentence, std::initializer_list<Columns> arguments) {
  return make_row(&example, address, sentence, arguments);
}

Row row(Done& s) {
  return reply(s = {"/load", 3}, "/done", "The request was carried out.",
               {any_text(&s.address, "address", "The request's address."),
                optional(integer(&s.number, "number", kCount,
                                 "The number that the request's entry names; absent for most requests."))});
}

Row row(Fail& s) {
  return reply(s = {"/load", "cannot open bell.glb: No such file or directory"}, "/fail",
               "The request was refused, and nothing was changed.",
               {any_text(&s.address, "address", "The request's address."),
                any_text(&s.sentence, "sentence", "The fault, and the argument that has it.")});
}

Row row(StatusReply& s) {
  return reply(
      s = {4, 1, 220, 6, 48000, 256, 0.031, 0.058, 0, 0, 0, 0, 0.042, 0, 0, 0, 0, 0, 0, false, 0, 20, 0, 0, 1},
      "/status.reply", "The daemon's state.",
      {integer(&s.objects, "objects", kCount, "Objects that are loaded, and those that ring."),
       integer(&s.sounding_objects, "sounding_objects", kCount, "The same."),
       integer(&s.sounding_modes, "sounding_modes", kCount, "Modes that ring."),
       integer(&s.bodies, "bodies", kCount, "Bodies of the scene."),
       number(&s.sample_rate_hz, "sample_rate", kRate, "The audio driver's sample rate."),
       integer(&s.block_frames, "block", kCount, "Frames per block."),
       number(&s.load_mean, "load_mean", kLoad,
              "The time spent on a block over the block's duration, mean of a second."),
       number(&s.load_peak, "load_peak", kLoad, "The load of the slowest block so far."),
       integer(&s.xruns, "xruns", kCount, "Late blocks that the audio server counted."),
       integer(&s.dropped_events, "dropped", kCount, "Events lost to a full queue."),
       integer(&s.late_events, "late", kCount, "Events that arrived after their time."),
       integer(&s.merged_events, "merged", kCount, "Strikes added to others in a flood."),
       number(&s.load_p99, "load_p99", kLoad, "The load that 99 of 100 blocks of the last 5 to 10 s stayed below."),
       integer(&s.misses, "misses", kCount, "Blocks that took longer to render than they last."),
       integer(&s.own_xruns, "own_xruns", kCount, "Xruns in which the daemon was late."),
       integer(&s.hidden_modes, "hidden_modes", kCount, "Ringing modes that are muted for lack of time."),
       integer(&s.shed, "shed", kCount, "Chunks in which something was left out or late for lack of time."),
       number(&s.slowed_s, "slowed", kLost, "Time that the scene lost because it could not keep up."),
       number(&s.skipped_s, "skipped", kLost,
              "Sound that was never rendered, because the audio server did not wait for the daemon."),
       flag(&s.recording, "recording", "1 while a score is recorded."),
       number(&s.captured_s, "captured", kDuration, "Length of the sound file so far."),
       number(&s.full_scale_pa, "full_scale", kPressure, "The sound pressure, 1 m from an object, that is full scale."),
       integer(&s.limited, "limited", kCount,
               "Strikes that were weakened, because they would have bent a thin object by more than three times its "
               "thickness."),
       integer(&s.coupled_objects, "coupled", kCount, "Objects whose modes are exchanging energy."),
       number(&s.psi, "psi", kSignedRatio,
              "A check of their energy, ideally 1: the solver's auxiliary variable over the quantity that it "
              "represents, of the object where it is farthest from 1."),
       optional(any_text(&s.capture, "capture", "The sound file that is being written."))});
}

Row row(VersionReply& s) {
  return reply(s = {"ringdownd", kVersion, kProtocolVersion}, "/version.reply", "The program's name and version.",
               {any_text(&s.program, "program", "Its name and version."), any_text(&s.version, "version", "The same."),
                integer(&s.protocol, "protocol", kCount,
                        "The version of this protocol, which grows when an address changes its meaning.")});
}

Row row(Synced& s) {
  return reply(s = {7}, "/synced", "Everything sent before /sync has been handled.",
               {integer(&s.id, "id", kId, "The number from /sync.")});
}

Row row(ObjectReply& s) {
  return reply(
      s = {3,
           "bell",
           1,
           299292,
           "5417b50ece5c2d666e8abfc6c0fc1541",
           "presets/banks/bronze-bell.glb",
           120,
           0,
           120,
           {},
           0.5,
           0,
           false,
           false,
           0,
           "metal"},
      "/object.reply", "An object's bank and settings.",
      {integer(&s.number, "number", kIndex, "Its number and name."),
       any_text(&s.name, "name", "The same."),
       integer(&s.version, "version", kCount, "A number that grows with each new bank."),
       integer(&s.bank_bytes, "bytes", kCount, "The size of the bank's file."),
       any_text(&s.bank_content, "content", "32 hexadecimal digits; the same for the same bank."),
       any_text(&s.bank, "bank", "The bank's path."),
       integer(&s.modes, "modes", kCount, "Modes of the bank."),
       integer(&s.first_mode, "first", kCount, "The modes that /modes selected: the lowest one, and their number."),
       integer(&s.selected_modes, "selected", kCount, "The same."),
       number(&s.scale.alpha, "alpha", kDampingScale, "The factors that /material set."),
       number(&s.scale.beta, "beta", kDampingScale, "The same."),
       number(&s.scale.density, "density", kScale, "The same."),
       number(&s.scale.stiffness, "stiffness", kScale, "The same."),
       number(&s.scale.size, "size", kSizeScale, "The same."),
       number(&s.gain, "gain", kGain, "The values that /gain and /pan set."),
       number(&s.pan, "pan", kPan, "The same."),
       flag(&s.mute, "mute", "The states that /mute and /solo set."),
       flag(&s.solo, "solo", "The same."),
       number(&s.scale.heat, "heat", kDampingScale, "The factors that /material set."),
       number(&s.scale.air, "air", kDampingScale, "The same."),
       number(&s.level_m, "level", kPosition, "The height of its liquid; 0 if the bank knows no levels."),
       optional(any_text(&s.group, "group", "The object's group; absent if it has none."))});
}

Row row(BankReply& s) {
  return reply(
      s = {"bell", 1, 0, 299292, wire::Blob(4)}, "/bank.reply", "A piece of a bank file.",
      {any_text(&s.name, "name", "The object's name."),
       integer(&s.version, "version", kCount, "Pieces of one version belong together."),
       integer(&s.offset, "offset", kCount, "Where the piece begins, and the size of the whole file."),
       integer(&s.total, "total", kCount, "The same."), records(&s.bytes, "bytes", 1, kMaxBankBytes, "The piece.")});
}

Row row(PiecesReply& s) {
  return reply(
      s = {"plate", 0, 1, true, 36, true, 0}, "/pieces.reply", "What an object breaks into.",
      {any_text(&s.name, "name", "The object's name."),
       integer(&s.pattern, "pattern", kCount, "The pattern of the pieces."),
       integer(&s.patterns, "patterns", kCount, "How many its bank has: a /pieces.pattern follows for each."),
       flag(&s.broken, "broken", "0: it is whole."),
       integer(&s.pieces, "pieces", kCount, "How many /pieces.piece follow; 0: it is not armed, and none was named."),
       flag(&s.armed, "armed", "1: its pieces are ready, in this pattern."),
       number(&s.strength_pa, "strength", kStress, "As /strength set it; 0: no blow breaks it.")});
}

Row row(PatternReply& s) {
  return reply(s = {0, {0.03, 0.02, 0}, 30, 0.13}, "/pieces.pattern", "One way in which an object can break.",
               {integer(&s.number, "pattern", kCount, "Its number, from 0."),
                vector(&s.at_m, "place", {"x", "y", "z"}, kAnyPosition,
                       "Where it is struck. Patterns of one place come with ascending numbers of pieces."),
                integer(&s.pieces, "pieces", kCount, "How many pieces it has."),
                number(&s.crack_energy_j, "crack_energy", kEnergy,
                       "What the crack takes from the object's vibration; 0: the bank does not know.")});
}

Row row(BrokenReply& s) {
  return reply(s = {"plate", 0, 36}, "/broken",
               "An object has broken. The sender of /break and all subscribers of /notify are told.",
               {any_text(&s.name, "name", "The object's name."),
                integer(&s.pattern, "pattern", kCount, "In which of its bank's patterns."),
                integer(&s.pieces, "pieces", kCount, "How many /pieces.piece follow.")});
}

Row row(PieceReply& s) {
  return reply(
      s = {0, "plate.0", 12, 0.02, {0.05, 0, 0.01}, {1e-6, 2e-6, 3e-6}, 0, 0, 0, 1, {0, 0, -0.5}, {1, 0, 0}},
      "/pieces.piece", "A piece, in the frame of the object that it is from.",
      {integer(&s.number, "piece", kCount, "Its number, from 0, and its name."), any_text(&s.name, "name", "The same."),
       integer(&s.object, "object", kObjectOrNone,
               "The number of the object that it is; -1: it does not ring and is none."),
       number(&s.mass_kg, "mass", kPieceMass, "Its mass."),
       vector(&s.center_m, "centre", {"x", "y", "z"}, kAnyPosition, "Its centre of mass."),
       vector(&s.inertia_kg_m2, "inertia", {"ix", "iy", "iz"}, kInertia, "Its principal moments of inertia."),
       number(&s.x, "qx", kUnit, "How its principal axes are turned, a unit quaternion, real part last."),
       number(&s.y, "qy", kUnit, "Its y component."), number(&s.z, "qz", kUnit, "Its z component."),
       number(&s.w, "qw", kUnit, "The same."),
       vector(&s.velocity_m_s, "velocity", {"vx", "vy", "vz"}, kAnyVelocity,
              "How it flies, beyond the motion that the object had before the blow; 0 before it breaks."),
       vector(&s.spin_rad_s, "spin", {"sx", "sy", "sz"}, kAnySpin, "Its angular velocity.")});
}

Row row(SceneReply& s) {
  return reply(
      s = {3, 6, 1, 12, {0, -2, 1}, {0, 0, 0.3}, 50, "presets/scenes/demo.toml"}, "/scene.reply",
      "The scene that is played.",
      {integer(&s.version, "version", kCount, "A number that grows when the description changes."),
       integer(&s.bodies, "bodies", kCount, "The numbers of /scene.body and /scene.static messages that follow."),
       integer(&s.statics, "statics", kCount, "The same."),
       number(&s.duration_s, "duration", kDuration, "The length of a rendering."),
       vector(&s.camera_m, "camera", {"x", "y", "z"}, kAnyPosition, "The position of the scene's camera."),
       vector(&s.target_m, "target", {"tx", "ty", "tz"}, kAnyPosition, "The point that the camera looks at."),
       number(&s.field_of_view_degrees, "field_of_view", kAngle,
              "The camera's vertical field of view; 0 if the scene has no camera."),
       optional(any_text(&s.file, "file", "The scene's file; absent if there is no scene."))});
}

Row row(SceneBody& s) {
  return reply(s = {3, 2, "bell", "bell", "convex", {0.2, 0.2, 0.15}, false}, "/scene.body",
               "A body of the scene; /notify.body says where it is.",
               {integer(&s.version, "version", kCount, "As in /scene.reply."),
                integer(&s.id, "body", kCount, "Its number, and its name in the scene file."),
                any_text(&s.name, "name", "The same."),
                any_text(&s.object, "object", "The object that rings when the body is hit; - for none."),
                any_text(&s.shape, "shape", "box, sphere, convex or trimesh."),
                vector(&s.size_m, "size", {"sx", "sy", "sz"}, kAnyPosition, "Edges of its bounding box."),
                flag(&s.fixed, "fixed", "1 if the body does not move.")});
}

Row row(SceneStatic& s) {
  return reply(s = {3, 0, "floor", "plane", {}, {}, 0, 0, 0, 1}, "/scene.static",
               "A part of the scene that never moves.",
               {integer(&s.version, "version", kCount, "As in /scene.reply."),
                integer(&s.number, "number", kCount, "Its number, from 0, and its name in the scene file."),
                any_text(&s.name, "name", "The same."), any_text(&s.shape, "shape", "plane or box."),
                vector(&s.size_m, "size", {"sx", "sy", "sz"}, kAnyPosition, "A box's edges."),
                vector(&s.position_m, "position", {"x", "y", "z"}, kAnyPosition,
                       "A box's centre; a plane's point nearest to the origin."),
                number(&s.x, "qx", kUnit,
                       "Its rotation, a unit quaternion, real part last. A plane faces along its rotated z axis."),
                number(&s.y, "qy", kUnit, "Its y component."), number(&s.z, "qz", kUnit, "Its z component."),
                number(&s.w, "qw", kUnit, "The same.")});
}

Row row(BrowseReply& s) {
  return reply(s = {2}, "/browse.reply", "The number of files that can be loaded.",
               {integer(&s.files, "files", kCount, "The number of /browse.file messages that follow.")});
}

Row row(BrowseFile& s) {
  return reply(
      s = {0, "scene", "presets/scenes/demo.toml"}, "/browse.file", "A file that can be loaded.",
      {integer(&s.number, "number", kCount, "Its number, from 0."), any_text(&s.kind, "kind", "scene or bank."),
       any_text(&s.path, "path", "The path, for /scene/load or /load.")});
}

Row row(NotifyObject& s) {
  return reply(s = {3, "bell", true}, "/notify.object", "An object was loaded or freed, or its mute or solo changed.",
               {integer(&s.number, "number", kIndex, "Its number and name."), any_text(&s.name, "name", "The same."),
                flag(&s.loaded, "loaded",
                     "1 if the object is loaded; /describe then asks for its settings. 0 if it was freed.")});
}

Row row(NotifyGroup& s) {
  return reply(
      s = {3, "bell", "metal"}, "/notify.group", "An object joined or left a group.",
      {integer(&s.number, "number", kIndex, "The object's number and name."), any_text(&s.name, "name", "The same."),
       optional(any_text(&s.group, "group", "The object's group; absent if it has none."))});
}

Row row(NotifyContact& s) {
  return reply(s = {"bell", {0.05, 0, 0.02}, {-0.02, 0, 0}, 0.0005}, "/notify.contact",
               "An object was struck. At most the last 256 strikes since the last notice are sent.",
               {any_text(&s.object, "object", "Its name."),
                vector(&s.point_m, "point", {"x", "y", "z"}, kAnyPosition, "The struck point, in the object's frame."),
                vector(&s.impulse_ns, "impulse", {"jx", "jy", "jz"}, kAnyImpulse, "The impulse it received."),
                number(&s.contact_time_s, "contact_time", kContactTime, "The duration of the blow.")});
}

Row row(NotifyPeak& s) {
  return reply(s = {0.25}, "/notify.peak", "The peak of the mix.",
               {number(&s.peak, "peak", kPeak, "The largest sample since the last notice; 1 is full scale.")});
}

Row row(NotifyObjectPeak& s) {
  return reply(s = {"bell", 0.25}, "/notify.object_peak",
               "The peak of a ringing object; sent once more when the object is silent.",
               {any_text(&s.object, "object", "Its name."),
                number(&s.peak, "peak", kPeak,
                       "A bound on the object's samples since the last notice: the sum of its modes' amplitudes, at "
                       "its gain. If more than 64 objects (2,048 modes) ring, they are measured in turn.")});
}

Row row(NotifyLoad& s) {
  return reply(s = {0.031, 0.058, 0, 1, 220}, "/notify.load", "The daemon's state.",
               {number(&s.mean, "load_mean", kLoad, "As in /status.reply."),
                number(&s.peak, "load_peak", kLoad, "The same."), integer(&s.xruns, "xruns", kCount, "The same."),
                integer(&s.sounding_objects, "sounding_objects", kCount, "The same."),
                integer(&s.sounding_modes, "sounding_modes", kCount, "The same.")});
}

Row row(NotifyBody& s) {
  return reply(
      s = {2, "bell", "bell", {0, 0, 1}, 0, 0, 0, 1}, "/notify.body",
      "The pose of a body of the scene, as that of its bank's mesh. A body that is no longer sent has left the scene.",
      {integer(&s.id, "body", kCount, "Its number, and its name in the scene file."),
       any_text(&s.name, "name", "The same."),
       any_text(&s.object, "object", "The object that rings when the body is hit; - for none."),
       vector(&s.position_m, "position", {"x", "y", "z"}, kAnyPosition, "The position in the scene's frame."),
       number(&s.x, "qx", kUnit, "Its rotation, a unit quaternion, real part last."),
       number(&s.y, "qy", kUnit, "Its y component."), number(&s.z, "qz", kUnit, "Its z component."),
       number(&s.w, "qw", kUnit, "The same.")});
}

Row row(NotifyScene& s) {
  return reply(
      s = {3, 2.5, false}, "/notify.scene", "The time of the poses in this notice.",
      {integer(&s.version, "version", kCount, "As in /scene.reply."),
       number(&s.time_s, "time", kDuration, "The scene's time."), flag(&s.paused, "paused", "1 while it is paused.")});
}

Row row(NotifySound& s) {
  return reply(
      s = {48000, 48000, wire::Blob(8)}, "/notify.sound", "A piece of the mix, after /watch/sound.",
      {integer(&s.frame, "frame", kCount, "The first frame's number, modulo 2^30."),
       number(&s.sample_rate_hz, "sample_rate", kRate, "The audio driver's sample rate."),
       records(&s.samples, "samples", 8, kMaxSoundFrames, "Two float32 for each frame, left and right, big-endian.")});
}

Row row(NotifyModes& s) {
  return reply(s = {"bell", 0, wire::Blob(4)}, "/notify.modes",
               "The amplitudes of a watched object's modes, at its gain; 1 is full scale.",
               {any_text(&s.object, "object", "Its name."),
                integer(&s.first, "first", kCount, "The first mode; 0 has the lowest frequency."),
                records(&s.amplitudes, "amplitudes", 4, kMaxModeAmplitudes, "One float32 for each mode, big-endian.")});
}

}  // namespace

const Table<Replies>& reply_table() {
  static const Table<Replies> table = make_table(Replies(), [](auto& reply) { return row(reply); });
  return table;
}

}  // namespace ringdown::protocol

template class ringdown::detail::OneOfStorage<ringdown::protocol::Replies>;
