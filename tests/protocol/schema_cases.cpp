#include "tests/protocol/schema_cases.h"

namespace ringdown::protocol {
namespace {

Cases strike_cases() {
  const std::string a = "/object/bell/strike";
  return {{{a, {1.f, 2.f, 3.f, -4.f, 5.f, -6.f}, claim<Strike>([](const Strike& s) {
              return s.object == named("bell") && s.verb.point_m == Vec3{1, 2, 3} &&
                     s.verb.impulse_ns == Vec3{-4, 5, -6} && s.verb.contact_time_s == 0.0002;
            })},
           {"/object/7/strike", {1, std::int64_t{-2}, 0.5, 0.25f, 0, 0, 0.1}, claim<Strike>([](const Strike& s) {
              return s.object == numbered(7) && s.verb.point_m == Vec3{1, -2, 0.5} &&
                     s.verb.impulse_ns == Vec3{0.25, 0, 0} && s.verb.contact_time_s == 0.1;
            })}},
          {{"/object//strike", {0, 0, 0, 0, 0, 0}, "object"},
           {"/object/a bell/strike", {0, 0, 0, 0, 0, 0}, "object"},
           {"/object/*/strike", {0, 0, 0, 0, 0, 0}, "object"},
           {"/object/-/strike", {0, 0, 0, 0, 0, 0}, "object"},
           {"/object/99999999999/strike", {0, 0, 0, 0, 0, 0}, "object"},
           {"/object/" + std::string(65, 'a') + "/strike", {0, 0, 0, 0, 0, 0}, "object"},
           {a, {}, "x"},
           {a, {kNan, 0, 0, 0, 0, 0}, "x"},
           {a, {wire::Blob(40), 0, 0, 0, 0, 0}, "x"},
           {a, {"1", 0, 0, 0, 0, 0}, "x"},
           {a, {0, kInfinity, 0, 0, 0, 0}, "y"},
           {a, {0, 0, 10001, 0, 0, 0}, "z"},
           {a, {0, 0, 0, 1e5, 0, 0}, "jx"},
           {a, {0, 0, 0, 0}, "jy"},
           {a, {0, 0, 0, 0, 0}, "jz"},
           {a, {0, 0, 0, 0, 0, 0, 0.11}, "contact_time"},
           {a, {0, 0, 0, 0, 0, 0, -0.001}, "contact_time"}}};
}

Cases strike_vertex_cases() {
  const std::string a = "/object/bell/strike_vertex";
  return {{{a, {12.f, 0, 0, 1}, claim<StrikeVertex>([](const StrikeVertex& s) {
              return s.object == named("bell") && s.verb.vertex == 12 && s.verb.impulse_ns == Vec3{0, 0, 1} &&
                     s.verb.contact_time_s == 0.0002;
            })},
           {a, {16777215, 0, 0, 1, 0}, claim<StrikeVertex>([](const StrikeVertex& s) {
              return s.verb.vertex == 16777215 && s.verb.contact_time_s == 0;
            })}},
          {{"/object/b+ll/strike_vertex", {1, 0, 0, 0}, "object"},
           {a, {0.5f, 0, 0, 0}, "vertex"},
           {a, {-1, 0, 0, 0}, "vertex"},
           {a, {1e20, 0, 0, 0}, "vertex"},
           {a, {kNan, 0, 0, 0}, "vertex"},
           {a, {16777216, 0, 0, 0}, "vertex"},
           {a, {std::numeric_limits<std::int64_t>::max(), 0, 0, 0}, "vertex"},
           {a, {1, "a", 0, 0}, "jx"},
           {a, {1, 0, -1e9, 0}, "jy"},
           {a, {1, 0, 0, kNan}, "jz"},
           {a, {1, 0, 0, 0, "soft"}, "contact_time"}}};
}

Cases strikes_cases() {
  const std::string a = "/strikes";
  return {{{a, {wire::Blob(40)}, claim<StrikeMany>([](const StrikeMany& s) { return s.records.size() == 40; })},
           {a, {wire::Blob(64000)}, is_a<StrikeMany>()}},
          {{a, {}, "records"},
           {a, {wire::Blob()}, "records"},
           {a, {wire::Blob(41)}, "records"},
           {a, {wire::Blob(64040)}, "records"},
           {a, {1.f}, "records"},
           {a, {"text"}, "records"}}};
}

Cases notify_cases() {
  return {{{"/notify", {}, claim<Notify>([](const Notify& n) { return n.on && n.rate_hz == 20; })},
           {"/notify", {0}, claim<Notify>([](const Notify& n) { return !n.on; })},
           {"/notify", {1, 200.f}, claim<Notify>([](const Notify& n) { return n.on && n.rate_hz == 200; })}},
          {{"/notify", {2}, "on"},
           {"/notify", {1, 0}, "rate"},
           {"/notify", {1, 200.1}, "rate"},
           {"/notify", {1, kNan}, "rate"}}};
}

Cases record_start_cases() {
  const std::string a = "/record/start";
  return {{{a, {"a b.osc"}, claim<RecordStart>([](const RecordStart& s) { return s.path == "a b.osc"; })}},
          {{a, {}, "path"}, {a, {""}, "path"}, {a, {7}, "path"}, {a, {"a\nb"}, "path"}}};
}

Cases gain_cases() {
  const std::string a = "/object/bell/gain";
  return {{{a, {0.5f}, claim<SetGain>([](const SetGain& s) { return s.verb.gain == 0.5 && s.verb.ramp_s == 0; })},
           {a, {100, 60}, claim<SetGain>([](const SetGain& s) { return s.verb.gain == 100 && s.verb.ramp_s == 60; })}},
          {{"/object/b%/gain", {1}, "object"},
           {a, {-0.1}, "gain"},
           {a, {100.1}, "gain"},
           {a, {1, 61}, "ramp"},
           {a, {1, -1}, "ramp"}}};
}

Cases pan_cases() {
  const std::string a = "/object/bell/pan";
  return {{{a, {-1}, claim<SetPan>([](const SetPan& s) { return s.verb.pan == -1 && s.object == named("bell"); })}},
          {{"/object/b%/pan", {1}, "object"}, {a, {1.01}, "pan"}, {a, {-1.01f}, "pan"}}};
}

Cases fill_cases() {
  const std::string a = "/object/bell/fill";
  return {{{a, {0.08}, claim<SetFill>([](const SetFill& s) { return s.object == named("bell") && s.level_m == 0.08; })},
           {"/object/3/fill", {-1}, is_a<SetFill>()}},
          {{"/object/b%/fill", {0.1}, "object"}, {a, {}, "level"}, {a, {1e5}, "level"}, {a, {0.1, 1}, "argument 2"}}};
}

Cases resonator_cases() {
  const std::string a = "/object/bell/resonator";
  return {{{a, {-20}, claim<SetResonator>([](const SetResonator& s) {
              return s.object == named("bell") && s.tuning == modal::TubeTuning{-20, 1};
            })},
           {a, {5, 0.5}, claim<SetResonator>([](const SetResonator& s) {
              return s.tuning == modal::TubeTuning{5, 0.5};
            })}},
          {{"/object/b%/resonator", {0}, "object"},
           {a, {}, "detune"},
           {a, {1201}, "detune"},
           {a, {0, 1.1}, "opening"},
           {a, {0, 1, 1}, "argument 3"}}};
}

Cases fan_cases() {
  const std::string a = "/object/bell/fan";
  return {{{a, {5, 0.5}, claim<SetFan>([](const SetFan& s) {
              return s.object == named("bell") && s.verb.rate_hz == 5 && s.verb.depth == 0.5;
            })}},
          {{"/object/b%/fan", {5, 0.5}, "object"},
           {a, {5}, "depth"},
           {a, {21, 1}, "rate"},
           {a, {-1, 1}, "rate"},
           {a, {5, 1.1}, "depth"}}};
}

Cases material_cases() {
  const std::string a = "/object/bell/material";
  return {{{a, {1, 2, 3, 4}, claim<SetMaterial>([](const SetMaterial& s) {
              return s.scale == modal::MaterialScale{1, 2, 3, 4};
            })},
           {a, {1, 2, 3, 4, 0.5}, claim<SetMaterial>([](const SetMaterial& s) {
              return s.scale == modal::MaterialScale{1, 2, 3, 4, 0.5};
            })},
           {a, {1, 2, 3, 4, 0.5, 6, 7}, claim<SetMaterial>([](const SetMaterial& s) {
              return s.scale == modal::MaterialScale{1, 2, 3, 4, 0.5, 6, 7};
            })},
           {a, {0, 0, 0.001, 1000, 100}, is_a<SetMaterial>()}},
          {{"/object/b%/material", {1, 1, 1, 1}, "object"},
           {a, {1, 1, 1, 1, 1, -1}, "heat"},
           {a, {1, 1, 1, 1, 1, 1, 1001}, "air"},
           {a, {-1, 1, 1, 1}, "alpha"},
           {a, {1, 1001, 1, 1}, "beta"},
           {a, {1, 1, 0, 1}, "density"},
           {a, {1, 1, 1, 0}, "stiffness"},
           {a, {1, 1, 1}, "stiffness"},
           {a, {1, 1, 1, 1, 0.009}, "size"},
           {a, {1, 1, 1, 1, 101}, "size"}}};
}

Cases group_cases() {
  const std::string a = "/object/bell/group";
  return {{{a, {"metal"}, claim<SetGroup>([](const SetGroup& s) { return s.group == "metal"; })},
           {a, {}, claim<SetGroup>([](const SetGroup& s) { return !s.group; })}},
          {{"/object/b%/group", {"metal"}, "object"}, {a, {"two words"}, "group"}, {a, {7}, "group"}}};
}

Cases excite_cases() {
  const std::string a = "/object/bell/excite";
  return {{{a, {4, 1, 2, 3, 0, 0, -0.5f}, claim<Excite>([](const Excite& e) {
              return e.object == named("bell") && e.input == 4 && e.point_m == Vec3{1, 2, 3} &&
                     e.force_n == Vec3{0, 0, -0.5};
            })}},
          {{"/object/b%/excite", {1, 0, 0, 0, 0, 0, 0}, "object"},
           {a, {0, 0, 0, 0, 0, 0, 0}, "input"},
           {a, {5, 0, 0, 0, 0, 0, 0}, "input"},
           {a, {1.5, 0, 0, 0, 0, 0, 0}, "input"},
           {a, {1, kNan, 0, 0, 0, 0, 0}, "x"},
           {a, {1, 0, 1e5, 0, 0, 0, 0}, "y"},
           {a, {1, 0, 0, "up", 0, 0, 0}, "z"},
           {a, {1, 0, 0, 0, kInfinity, 0, 0}, "fx"},
           {a, {1, 0, 0, 0, 0, 1e7, 0}, "fy"},
           {a, {1, 0, 0, 0, 0, 0}, "fz"}}};
}

Cases click_cases() {
  const std::string a = "/object/bell/click";
  return {
      {{a, {1, 2, -3, 0.0625f}, claim<Click>([](const Click& c) {
          return c.object == named("bell") && c.verb.impulse_ns == Vec3{1, 2, -3} && c.verb.contact_time_s == 0.0625;
        })}},
      {{"/object/b%/click", {0, 0, 0}, "object"},
       {a, {kNan, 0, 0}, "jx"},
       {a, {0, 1e7, 0}, "jy"},
       {a, {0, 0}, "jz"},
       {a, {0, 0, 0, -1}, "contact_time"}}};
}

template <class Struct>
Cases object_only_cases(const std::string& verb) {
  return {
      {{"/object/b.e-l_L9/" + verb, {}, claim<Struct>([](const Struct& s) { return s.object == named("b.e-l_L9"); })},
       {"/object/0/" + verb, {}, claim<Struct>([](const Struct& s) { return s.object == numbered(0); })}},
      {{"/object/b ll/" + verb, {}, "object"}}};
}

Cases pose_cases() {
  const std::string a = "/object/bell/pose";
  return {{{a, {1, 2, 3}, claim<SetPose>([](const SetPose& s) {
              return s.object == named("bell") && s.verb.pose == Pose{{1, 2, 3}, Rotation::from_xyzw(0, 0, 0, 1)};
            })},
           {a, {0, 0, 0, 0.5f, 0.5f, -0.5f, 0.5f}, claim<SetPose>([](const SetPose& s) {
              return s.verb.pose == Pose{{0, 0, 0}, Rotation::from_xyzw(0.5, -0.5, 0.5, 0.5)};
            })}},
          {{"/object/b%/pose", {0, 0, 0}, "object"},
           {a, {kNan, 0, 0}, "x"},
           {a, {0, 1e5, 0}, "y"},
           {a, {0, 0}, "z"},
           {a, {0, 0, 0, kNan, 0, 0, 0}, "qw"},
           {a, {0, 0, 0, 1, 2, 0, 0}, "qx"},
           {a, {0, 0, 0, 1, 0, "up", 0}, "qy"},
           {a, {0, 0, 0, 1, 0, 0, kInfinity}, "qz"}}};
}

Cases poses_cases() {
  return {{{"/poses", {wire::Blob(36)}, claim<PoseMany>([](const PoseMany& p) { return p.records.size() == 36; })}},
          {{"/poses", {}, "records"}, {"/poses", {wire::Blob(40)}, "records"}}};
}

Cases listener_cases() {
  return {{{"/listener", {1, 2, 3, 0, 0, 0, 1}, claim<SetListener>([](const SetListener& s) {
              return s.verb.pose == Pose{{1, 2, 3}, Rotation::from_xyzw(0, 0, 1, 0)};
            })}},
          {{"/listener", {1, 2}, "z"},
           {"/listener", {0, kNan, 0}, "y"},
           {"/listener", {kInfinity, 0, 0}, "x"},
           {"/listener", {0, 0, 0, 1, kNan, 0, 0}, "qx"},
           {"/listener", {0, 0, 0, 5}, "qw"},
           {"/listener", {0, 0, 0, 1, 0, 2}, "qy"},
           {"/listener", {0, 0, 0, 1, 0, 0, 2}, "qz"}}};
}

Cases air_cases() {
  const std::string a = "/listener/air";
  return {{{a, {10}, claim<SetListenerAir>([](const SetListenerAir& s) {
              return s.verb.temperature_c == 10 && s.verb.humidity_percent == 50;
            })}},
          {{a, {}, "temperature"}, {a, {61}, "temperature"}, {a, {kNan}, "temperature"}, {a, {20, 101}, "humidity"}}};
}

Cases load_cases() {
  return {{{"/load", {"bell", "a/b c.glb"}, claim<LoadObject>([](const LoadObject& s) {
              return s.name == "bell" && s.bank_path == "a/b c.glb";
            })}},
          {{"/load", {"12", "a.glb"}, "name"},
           {"/load", {12, "a.glb"}, "name"},
           {"/load", {"-", "a.glb"}, "name"},
           {"/load", {"bell"}, "path"},
           {"/load", {"bell", ""}, "path"},
           {"/load", {"bell", "a\nb"}, "path"},
           {"/load", {"bell", 3.f}, "path"},
           {"/load", {"bell", std::string(4097, 'a')}, "path"}}};
}

Cases pause_cases() {
  const auto paused = [](bool value) {
    return claim<ScenePause>([value](const ScenePause& s) { return s.paused == value; });
  };
  return {
      {{"/scene/pause", {}, paused(true)}, {"/scene/pause", {1.f}, paused(true)}, {"/scene/pause", {0}, paused(false)}},
      {{"/scene/pause", {2}, "paused"}, {"/scene/pause", {"yes"}, "paused"}, {"/scene/pause", {0.5}, "paused"}}};
}

Cases box_cases() {
  const std::string a = "/scene/spawn/box";
  return {{{a, {"bell", 1, 2, 3}, claim<SpawnBox>([](const SpawnBox& s) {
              return s.object == named("bell") && s.position_m == Vec3{1, 2, 3} && s.size_m == Vec3{} &&
                     s.velocity_m_s == Vec3{} && s.density_kg_m3 == 0;
            })},
           {a, {"-", 1, 2, 3, 4, 5, 6, 7, 8, 9, 10}, claim<SpawnBox>([](const SpawnBox& s) {
              return !s.object && s.size_m == Vec3{4, 5, 6} && s.velocity_m_s == Vec3{7, 8, 9} && s.density_kg_m3 == 10;
            })},
           {a, {3.f, 0, 0, 0}, claim<SpawnBox>([](const SpawnBox& s) { return s.object == numbered(3); })},
           {a, {"3", 0, 0, 0}, claim<SpawnBox>([](const SpawnBox& s) { return s.object == numbered(3); })}},
          {{a, {"", 0, 0, 0}, "object"},
           {a, {0.5, 0, 0, 0}, "object"},
           {a, {kNan, 0, 0, 0}, "object"},
           {a, {-1, 0, 0, 0}, "object"},
           {a, {"-", "-", 0, 0}, "x"},
           {a, {"-", 0, kNan, 0}, "y"},
           {a, {"-", 0, 0}, "z"},
           {a, {"-", 0, 0, 0, -1}, "sx"},
           {a, {"-", 0, 0, 0, 1, kInfinity}, "sy"},
           {a, {"-", 0, 0, 0, 1, 1, 1001}, "sz"},
           {a, {"-", 0, 0, 0, 1, 1, 1, 1001}, "vx"},
           {a, {"-", 0, 0, 0, 1, 1, 1, 0, -1001}, "vy"},
           {a, {"-", 0, 0, 0, 1, 1, 1, 0, 0, "x"}, "vz"},
           {a, {"-", 0, 0, 0, 1, 1, 1, 0, 0, 0, -1}, "density"}}};
}

Cases sphere_cases() {
  const std::string a = "/scene/spawn/sphere";
  return {{{a, {"bell", 0, 0, 1}, claim<SpawnSphere>([](const SpawnSphere& s) { return s.radius_m == 0; })},
           {a, {"-", 1, 2, 3, 4, 5, 6, 7, 8}, claim<SpawnSphere>([](const SpawnSphere& s) {
              return !s.object && s.position_m == Vec3{1, 2, 3} && s.radius_m == 4 && s.velocity_m_s == Vec3{5, 6, 7} &&
                     s.density_kg_m3 == 8;
            })}},
          {{a, {}, "object"},
           {a, {"-", kNan, 0, 0}, "x"},
           {a, {"-", 0, 2e4, 0}, "y"},
           {a, {"-", 0, 0, "up"}, "z"},
           {a, {"-", 0, 0, 0, -1}, "radius"},
           {a, {"-", 0, 0, 0, 1, kNan}, "vx"},
           {a, {"-", 0, 0, 0, 1, 0, kNan}, "vy"},
           {a, {"-", 0, 0, 0, 1, 0, 0, kNan}, "vz"},
           {a, {"-", 0, 0, 0, 1, 0, 0, 0, 1e6}, "density"}}};
}

Cases sync_cases() {
  const auto id = [](std::int32_t value) { return claim<Sync>([value](const Sync& s) { return s.id == value; }); };
  return {{{"/sync", {-2147483647 - 1}, id(-2147483647 - 1)}, {"/sync", {2147483647.0}, id(2147483647)}},
          {{"/sync", {2147483648.0}, "id"}, {"/sync", {1e20f}, "id"}, {"/sync", {}, "id"}, {"/sync", {"1"}, "id"}}};
}

Cases clear_cases() {
  Cases cases = object_only_cases<ClearObject>("clear");
  const std::string a = "/object/bell/clear";
  cases.good.push_back({a, {0.5f}, claim<ClearObject>([](const ClearObject& c) { return c.verb.ramp_s == 0.5; })});
  cases.bad.push_back({a, {-1}, "ramp"});
  cases.bad.push_back({a, {61}, "ramp"});
  return cases;
}

Cases choke_cases() {
  using Choke = OnObject<synth::verb::Choke>;
  Cases cases = object_only_cases<Choke>("choke");
  const std::string a = "/object/bell/choke";
  cases.good.push_back({a, {}, claim<Choke>([](const Choke& c) { return c.verb.within_s == 0.2; })});
  cases.good.push_back({a, {0.5f}, claim<Choke>([](const Choke& c) { return c.verb.within_s == 0.5; })});
  cases.bad.push_back({a, {-1}, "within"});
  cases.bad.push_back({a, {61}, "within"});
  return cases;
}

Cases slap_cases() {
  using Slap = OnObject<synth::verb::Slap>;
  const std::string a = "/object/bell/slap";
  return {{{a, {0.25f}, claim<Slap>([](const Slap& s) {
              return s.object == named("bell") && s.verb.impulse_ns == 0.25 && s.verb.contact_time_s == 0.001;
            })},
           {a, {-1, 0.0625f}, claim<Slap>([](const Slap& s) { return s.verb.contact_time_s == 0.0625; })}},
          {{"/object/b%/slap", {1}, "object"},
           {a, {}, "impulse"},
           {a, {kNan}, "impulse"},
           {a, {1, 0.125f}, "contact_time"}}};
}

Cases blow_cases() {
  using Blow = OnObject<synth::verb::Blow>;
  const std::string a = "/object/bell/blow";
  return {
      {{a, {100}, claim<Blow>([](const Blow& b) { return b.object == named("bell") && b.verb.pressure_pa == 100; })},
       {a, {0}, is_a<Blow>()}},
      {{"/object/b%/blow", {1}, "object"},
       {a, {}, "pressure"},
       {a, {-1}, "pressure"},
       {a, {kNan}, "pressure"},
       {a, {1e6}, "pressure"},
       {a, {1, 1}, "argument 2"}}};
}

Cases impart_cases() {
  using Impart = OnObject<synth::verb::Impart>;
  const std::string a = "/object/bell/impart";
  return {{{a, {3, -0.5f}, claim<Impart>([](const Impart& i) {
              return i.object == named("bell") && i.verb.mode == 3 && i.verb.velocity == -0.5 && i.verb.phase_rad == 0;
            })},
           {a, {0, 1, 1.5f}, claim<Impart>([](const Impart& i) { return i.verb.phase_rad == 1.5; })}},
          {{"/object/b%/impart", {0, 1}, "object"},
           {a, {}, "mode"},
           {a, {-1, 1}, "mode"},
           {a, {0}, "velocity"},
           {a, {0, kNan}, "velocity"},
           {a, {0, 1, 2e3f}, "phase"}}};
}

Cases arm_cases() {
  Cases cases = object_only_cases<ArmObject>("arm");
  const std::string a = "/object/bell/arm";
  cases.good.push_back({a, {2}, claim<ArmObject>([](const ArmObject& arm) { return arm.pattern == 2; })});
  cases.good.push_back({a, {}, claim<ArmObject>([](const ArmObject& arm) { return arm.pattern == -1; })});
  cases.bad.push_back({a, {-2}, "pattern"});
  return cases;
}

Cases strength_cases() {
  const std::string a = "/object/bell/strength";
  return {
      {{a, {5e7f}, claim<SetStrength>([](const SetStrength& s) {
          return s.object == named("bell") && s.strength_pa == 5e7;
        })},
       {a, {0}, is_a<SetStrength>()}},
      {{"/object/b%/strength", {1}, "object"}, {a, {}, "strength"}, {a, {-1}, "strength"}, {a, {kNan}, "strength"}}};
}

Cases pieces_cases() {
  Cases cases = object_only_cases<DescribePieces>("pieces");
  const std::string a = "/object/bell/pieces";
  cases.good.push_back({a, {}, claim<DescribePieces>([](const DescribePieces& p) { return p.pattern == -1; })});
  cases.good.push_back({a, {2}, claim<DescribePieces>([](const DescribePieces& p) { return p.pattern == 2; })});
  cases.bad.push_back({a, {-2}, "pattern"});
  return cases;
}

Cases break_cases() {
  const std::string a = "/object/bell/break";
  return {{{a, {1, 2, 3, 0, 0, -1}, claim<BreakObject>([](const BreakObject& b) {
              return b.object == named("bell") && b.point_m == Vec3{1, 2, 3} && b.impulse_ns == Vec3{0, 0, -1} &&
                     b.contact_time_s == synth::kDefaultContactTime_s && b.pattern == -1;
            })},
           {a, {0, 0, 0, 0, 0, 0, 0, 3}, claim<BreakObject>([](const BreakObject& b) {
              return b.contact_time_s == 0 && b.pattern == 3;
            })}},
          {{"/object/b%/break", {0, 0, 0, 0, 0, 0}, "object"},
           {a, {kNan, 0, 0, 0, 0, 0}, "x"},
           {a, {0, 1e5f, 0, 0, 0, 0}, "y"},
           {a, {0, 0, kNan, 0, 0, 0}, "z"},
           {a, {0, 0, 0, 1e5f, 0, 0}, "jx"},
           {a, {0, 0, 0, 0, "1", 0}, "jy"},
           {a, {0, 0, 0, 0, 0}, "jz"},
           {a, {0, 0, 0, 0, 0, 0, -1}, "contact_time"},
           {a, {0, 0, 0, 0, 0, 0, 0, -2}, "pattern"}}};
}

template <class Struct>
Cases switch_cases(const std::string& address) {
  const auto on = [](bool value) { return claim<Struct>([value](const Struct& s) { return s.on == value; }); };
  return {{{address, {}, on(true)}, {address, {1.f}, on(true)}, {address, {0}, on(false)}},
          {{address, {2}, "on"}, {address, {"yes"}, "on"}}};
}

template <class Struct>
Cases object_switch_cases(const std::string& verb) {
  Cases cases = switch_cases<Struct>("/object/bell/" + verb);
  cases.bad.push_back({"/object/b%/" + verb, {1}, "object"});
  return cases;
}

Cases save_scene_cases() {
  const std::string a = "/scene/save";
  return {{{a, {"a.toml"}, claim<SaveScene>([](const SaveScene& s) { return s.path == "a.toml" && !s.replace; })},
           {a, {"a.toml", 1}, claim<SaveScene>([](const SaveScene& s) { return s.replace; })}},
          {{a, {}, "path"}, {a, {1}, "path"}, {a, {"a.toml", 2}, "replace"}}};
}

Cases capture_start_cases() {
  const std::string a = "/capture/start";
  return {{{a, {"a.wav"}, claim<CaptureStart>([](const CaptureStart& c) { return c.path == "a.wav"; })}},
          {{a, {}, "path"}, {a, {1}, "path"}, {a, {""}, "path"}}};
}

Cases ring_cases() {
  const std::string a = "/object/bell/ring";
  return {{{a, {3}, claim<RingModes>([](const RingModes& r) {
              return r.object == named("bell") && r.verb.first == 3 && r.verb.count == 1 && r.verb.amplitude == 0.1;
            })},
           {a, {0, 2147483647, 1}, claim<RingModes>([](const RingModes& r) {
              return r.verb.first == 0 && r.verb.count == 2147483647 && r.verb.amplitude == 1;
            })}},
          {{"/object/b%/ring", {0}, "object"},
           {a, {}, "first"},
           {a, {-1}, "first"},
           {a, {0.5}, "first"},
           {a, {0, -1}, "count"},
           {a, {0, 1, 1.01}, "amplitude"},
           {a, {0, 1, -0.1}, "amplitude"},
           {a, {0, 1, kNan}, "amplitude"}}};
}

Cases modes_cases() {
  const std::string a = "/object/bell/modes";
  return {{{a, {2, 20}, claim<SelectModes>([](const SelectModes& s) {
              return s.object == named("bell") && s.range.first == 2 && s.range.count == 20;
            })},
           {a, {0}, claim<SelectModes>([](const SelectModes& s) { return s.range == modal::ModeRange{}; })},
           {a, {0, 0}, claim<SelectModes>([](const SelectModes& s) { return s.range.count == 0; })}},
          {{"/object/b%/modes", {0}, "object"},
           {a, {}, "first"},
           {a, {-1}, "first"},
           {a, {16777216}, "first"},
           {a, {0, -1}, "count"},
           {a, {0, 0.5}, "count"}}};
}

Cases bank_cases() {
  const std::string a = "/object/bell/bank";
  return {{{a, {8192}, claim<ReadBank>([](const ReadBank& r) {
              return r.object == named("bell") && r.offset == 8192 && r.bytes == 8192;
            })},
           {a, {0, 1}, claim<ReadBank>([](const ReadBank& r) { return r.offset == 0 && r.bytes == 1; })}},
          {{"/object/b%/bank", {0}, "object"},
           {a, {}, "offset"},
           {a, {-1}, "offset"},
           {a, {0, 0}, "bytes"},
           {a, {0, 8193}, "bytes"}}};
}

template <class Request>
Cases body_cases(const std::string& a) {
  return {{{a, {7}, claim<Request>([](const Request& r) { return r.body == 7; })}},
          {{a, {}, "body"}, {a, {-1}, "body"}, {a, {"bell"}, "body"}}};
}

Cases push_cases() {
  const std::string a = "/scene/push";
  return {{{a, {7, 1, 2, -3}, claim<ScenePush>([](const ScenePush& p) {
              return p.body == 7 && p.impulse_ns == Vec3{1, 2, -3};
            })}},
          {{a, {-1, 0, 0, 0}, "body"},
           {a, {"bell", 0, 0, 0}, "body"},
           {a, {0, kNan, 0, 0}, "jx"},
           {a, {0, 0, 1e5, 0}, "jy"},
           {a, {0, 0, 0}, "jz"}}};
}

Cases place_cases() {
  const std::string a = "/scene/place";
  return {{{a, {7, 1, 2, -3}, claim<ScenePlace>([](const ScenePlace& p) {
              return p.body == 7 && p.pose == Pose{{1, 2, -3}, {}};
            })},
           {a, {7, 0, 0, 0, 0, 0, 1, 0}, claim<ScenePlace>([](const ScenePlace& p) {
              return p.pose == Pose{{0, 0, 0}, Rotation::from_xyzw(0, 1, 0, 0)};
            })}},
          {{a, {-1, 0, 0, 0}, "body"},
           {a, {0, kNan, 0, 0}, "x"},
           {a, {0, 0, 1e5, 0}, "y"},
           {a, {0, 0, 0}, "z"},
           {a, {0, 0, 0, 0, kNan, 0, 0, 0}, "qw"},
           {a, {0, 0, 0, 0, 1, 2, 0, 0}, "qx"},
           {a, {0, 0, 0, 0, 1, 0, "up", 0}, "qy"},
           {a, {0, 0, 0, 0, 1, 0, 0, kInfinity}, "qz"}}};
}

Cases test_tone_cases() {
  const std::string a = "/test_tone";
  return {
      {{a, {0.5f}, claim<TestTone>([](const TestTone& t) { return t.amplitude == 0.5 && t.frequency_hz == 440; })},
       {a, {0, 1000}, claim<TestTone>([](const TestTone& t) { return t.amplitude == 0 && t.frequency_hz == 1000; })}},
      {{a, {}, "amplitude"},
       {a, {1.01}, "amplitude"},
       {a, {-0.1}, "amplitude"},
       {a, {0.1, 0}, "frequency"},
       {a, {0.1, kNan}, "frequency"}}};
}

Cases record_stop_cases() {
  const std::string a = "/record/stop";
  return {{{a, {}, claim<RecordStop>([](const RecordStop& s) { return !s.path; })},
           {a, {"b.osc"}, claim<RecordStop>([](const RecordStop& s) { return s.path == "b.osc"; })}},
          {{a, {7}, "path"}, {a, {""}, "path"}, {a, {"b.osc", 1}, "argument 2"}}};
}

template <class Struct>
Cases bare_cases(const std::string& address) {
  return {{{address, {}, is_a<Struct>()}}, {{address, {1}, "argument 1"}}};
}

}  // namespace

const std::map<std::string, Cases>& all_cases() {
  static const std::map<std::string, Cases> cases = {
      {"/object/{object}/strike", strike_cases()},
      {"/object/{object}/strike_vertex", strike_vertex_cases()},
      {"/strikes", strikes_cases()},
      {"/notify", notify_cases()},
      {"/state/save",
       {{{"/state/save", {"a.toml"}, claim<SaveState>([](const SaveState& s) { return s.path == "a.toml"; })}},
        {{"/state/save", {1}, "path"}}}},
      {"/scene/save", save_scene_cases()},
      {"/capture/start", capture_start_cases()},
      {"/capture/stop", {{{"/capture/stop", {}, is_a<CaptureStop>()}}, {}}},
      {"/object/{object}/mute", object_switch_cases<SetMute>("mute")},
      {"/object/{object}/solo", object_switch_cases<SetSolo>("solo")},
      {"/record/start", record_start_cases()},
      {"/record/stop", record_stop_cases()},
      {"/object/{object}/fill", fill_cases()},
      {"/object/{object}/resonator", resonator_cases()},
      {"/object/{object}/fan", fan_cases()},
      {"/object/{object}/gain", gain_cases()},
      {"/object/{object}/pan", pan_cases()},
      {"/object/{object}/pickup", pickup_cases()},
      {"/object/{object}/pose", pose_cases()},
      {"/poses", poses_cases()},
      {"/listener", listener_cases()},
      {"/listener/off", bare_cases<ListenerOff>("/listener/off")},
      {"/listener/air", air_cases()},
      {"/object/{object}/group", group_cases()},
      {"/object/{object}/excite", excite_cases()},
      {"/object/{object}/material", material_cases()},
      {"/object/{object}/clear", clear_cases()},
      {"/object/{object}/arm", arm_cases()},
      {"/object/{object}/break", break_cases()},
      {"/object/{object}/mend", object_only_cases<MendObject>("mend")},
      {"/object/{object}/strength", strength_cases()},
      {"/object/{object}/pieces", pieces_cases()},
      {"/object/{object}/choke", choke_cases()},
      {"/object/{object}/slap", slap_cases()},
      {"/object/{object}/blow", blow_cases()},
      {"/object/{object}/impart", impart_cases()},
      {"/object/{object}/hold", hold_cases()},
      {"/object/{object}/contact", contact_cases()},
      {"/object/{object}/bow", bow_cases()},
      {"/object/{object}/mallet", mallet_cases()},
      {"/object/{object}/couple", couple_cases()},
      {"/object/{object}/click", click_cases()},
      {"/object/{object}/ring", ring_cases()},
      {"/object/{object}/modes", modes_cases()},
      {"/object/{object}/watch", object_switch_cases<WatchObject>("watch")},
      {"/object/{object}/describe", object_only_cases<DescribeObject>("describe")},
      {"/object/{object}/bank", bank_cases()},
      {"/scene/push", push_cases()},
      {"/scene/describe", bare_cases<SceneDescribe>("/scene/describe")},
      {"/watch/sound", switch_cases<WatchSound>("/watch/sound")},
      {"/browse", bare_cases<Browse>("/browse")},
      {"/test_tone", test_tone_cases()},
      {"/object/{object}/free", object_only_cases<FreeObject>("free")},
      {"/load", load_cases()},
      {"/clear", bare_cases<ClearAll>("/clear")},
      {"/scene/load",
       {{{"/scene/load", {"a.toml"}, claim<SceneLoad>([](const SceneLoad& s) {
            return s.path == "a.toml" && !s.paused;
          })},
         {"/scene/load", {"a.toml", 1}, claim<SceneLoad>([](const SceneLoad& s) { return s.paused; })}},
        {{"/scene/load", {1}, "path"}, {"/scene/load", {"a.toml", "yes"}, "paused"}}}},
      {"/scene/pause", pause_cases()},
      {"/scene/spawn/box", box_cases()},
      {"/scene/spawn/sphere", sphere_cases()},
      {"/scene/remove", body_cases<SceneRemove>("/scene/remove")},
      {"/scene/restore", body_cases<SceneRestore>("/scene/restore")},
      {"/scene/place", place_cases()},
      {"/scene/clear", bare_cases<SceneClear>("/scene/clear")},
      {"/status", bare_cases<Status>("/status")},
      {"/version", bare_cases<Version>("/version")},
      {"/sync", sync_cases()},
      {"/quit", bare_cases<Quit>("/quit")},
  };
  return cases;
}

}  // namespace ringdown::protocol
