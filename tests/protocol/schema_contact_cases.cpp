#include "tests/protocol/schema_cases.h"

namespace ringdown::protocol {

Cases bow_cases() {
  const std::string a = "/object/bell/bow";
  return {{{a, {1, 2, 3, 0, 0, 2, 0.25f, 1.5f}, claim<SetBow>([](const SetBow& b) {
              return b.object == named("bell") && b.verb.point_m == Vec3{1, 2, 3} &&
                     b.verb.direction == Vec3{0, 0, 2} && b.verb.speed_m_s == 0.25 && b.verb.force_n == 1.5 &&
                     b.verb.rosin == 0.8 && b.verb.width_m == 0 && b.verb.number == 0;
            })},
           {a, {0, 0, 0, 1, 0, 0, -1, 0, 0.5f, 0.25f, 3}, claim<SetBow>([](const SetBow& b) {
              return b.verb.speed_m_s == -1 && b.verb.force_n == 0 && b.verb.width_m == 0.5 && b.verb.rosin == 0.25 &&
                     b.verb.number == 3;
            })}},
          {{"/object/b%/bow", {0, 0, 0, 0, 0, 1, 0, 0}, "object"},
           {a, {kNan, 0, 0, 0, 0, 1, 0, 0}, "x"},
           {a, {0, 1e5, 0, 0, 0, 1, 0, 0}, "y"},
           {a, {0, 0, "up", 0, 0, 1, 0, 0}, "z"},
           {a, {0, 0, 0, kInfinity, 0, 1, 0, 0}, "dx"},
           {a, {0, 0, 0, 0, 1e7, 1, 0, 0}, "dy"},
           {a, {0, 0, 0, 0, 0}, "dz"},
           {a, {0, 0, 0, 0, 0, 1, 1000, 0}, "speed"},
           {a, {0, 0, 0, 0, 0, 1, 0, -1}, "force"},
           {a, {0, 0, 0, 0, 0, 1, 0, 1, -1}, "width"},
           {a, {0, 0, 0, 0, 0, 1, 0, 1, 0, 6}, "rosin"},
           {a, {0, 0, 0, 0, 0, 1, 0, 1, 0, 1, -1}, "number"}}};
}

Cases mallet_cases() {
  const std::string a = "/object/bell/mallet";
  return {{{a, {1, 2, 3, 0, 0, -2, 0.25f}, claim<HitMallet>([](const HitMallet& m) {
              return m.object == named("bell") && m.verb.point_m == Vec3{1, 2, 3} &&
                     m.verb.velocity_m_s == Vec3{0, 0, -2} && m.verb.mass_kg == 0.25 && m.verb.head == 1e7 &&
                     m.verb.bounce == 0.9;
            })},
           {a, {0, 0, 0, 0, 0, -2, 0.25f, 1024, 0.5f}, claim<HitMallet>([](const HitMallet& m) {
              return m.verb.head == 1024 && m.verb.bounce == 0.5;
            })}},
          {{"/object/b%/mallet", {0, 0, 0, 0, 0, 1, 1}, "object"},
           {a, {kNan, 0, 0, 0, 0, 1, 1}, "x"},
           {a, {0, 1e5, 0, 0, 0, 1, 1}, "y"},
           {a, {0, 0, "up", 0, 0, 1, 1}, "z"},
           {a, {0, 0, 0, kInfinity, 0, 1, 1}, "vx"},
           {a, {0, 0, 0, 0, 1e7, 1, 1}, "vy"},
           {a, {0, 0, 0, 0, 0}, "vz"},
           {a, {0, 0, 0, 0, 0, 1, 0}, "mass"},
           {a, {0, 0, 0, 0, 0, 1, 1, 0}, "head"},
           {a, {0, 0, 0, 0, 0, 1, 1, 5, -1}, "bounce"}}};
}

Cases couple_cases() {
  const std::string a = "/object/bell/couple";
  return {{{a, {1, 2, 3, "plate", 4, 5, 6, 0, 0, 2}, claim<SetCoupling>([](const SetCoupling& c) {
              return c.object == named("bell") && c.verb.point_m == Vec3{1, 2, 3} && c.other == named("plate") &&
                     c.verb.other_point_m == Vec3{4, 5, 6} && c.verb.direction == Vec3{0, 0, 2} &&
                     c.verb.weight_n == 0 && c.verb.gap_m == 0 && c.verb.stiffness == 1e8 && c.verb.friction == 0.3 &&
                     c.verb.bounce == 0.6 && c.verb.mass_kg == 0;
            })},
           {a,
            {1, 2, 3, 7, 4, 5, 6, 0, 0, 1, 2, 0.0625f, 0, 0.25f, 0.75f, 0.5f, 2},
            claim<SetCoupling>([](const SetCoupling& c) {
              return c.other == numbered(7) && c.verb.weight_n == 2 && c.verb.gap_m == 0.0625 &&
                     c.verb.stiffness == 0 && c.verb.friction == 0.25 && c.verb.bounce == 0.75 &&
                     c.verb.mass_kg == 0.5 && c.verb.number == 2;
            })}},
          {{"/object/b%/couple", {0, 0, 0, 1, 0, 0, 0, 0, 0, 1}, "object"},
           {a, {kNan, 0, 0, 1, 0, 0, 0, 0, 0, 1}, "x"},
           {a, {0, 1e5, 0, 1, 0, 0, 0, 0, 0, 1}, "y"},
           {a, {0, 0, "up", 1, 0, 0, 0, 0, 0, 1}, "z"},
           {a, {0, 0, 0, "b%", 0, 0, 0, 0, 0, 1}, "other"},
           {a, {0, 0, 0, 1, kNan, 0, 0, 0, 0, 1}, "ox"},
           {a, {0, 0, 0, 1, 0, 1e5, 0, 0, 0, 1}, "oy"},
           {a, {0, 0, 0, 1, 0, 0, "up", 0, 0, 1}, "oz"},
           {a, {0, 0, 0, 1, 0, 0, 0, kInfinity, 0, 1}, "nx"},
           {a, {0, 0, 0, 1, 0, 0, 0, 0, 1e7, 1}, "ny"},
           {a, {0, 0, 0, 1, 0, 0, 0, 0, 0}, "nz"},
           {a, {0, 0, 0, 1, 0, 0, 0, 0, 0, 1, -1}, "weight"},
           {a, {0, 0, 0, 1, 0, 0, 0, 0, 0, 1, 0, 1}, "gap"},
           {a, {0, 0, 0, 1, 0, 0, 0, 0, 0, 1, 0, 0, -1}, "stiffness"},
           {a, {0, 0, 0, 1, 0, 0, 0, 0, 0, 1, 0, 0, 1, 6}, "friction"},
           {a, {0, 0, 0, 1, 0, 0, 0, 0, 0, 1, 0, 0, 1, 1, -1}, "bounce"},
           {a, {0, 0, 0, 1, 0, 0, 0, 0, 0, 1, 0, 0, 1, 1, 1, -1}, "mass"},
           {a, {0, 0, 0, 1, 0, 0, 0, 0, 0, 1, 0, 0, 1, 1, 1, 1, -1}, "number"}}};
}

Cases contact_cases() {
  const std::string a = "/object/bell/contact";
  return {{{a, {1, 2, 3, 0, 0, -0.5f, 0.25f}, claim<SetContact>([](const SetContact& k) {
              return k.object == named("bell") && k.verb.point_m == Vec3{1, 2, 3} &&
                     k.verb.contact.force_n == Vec3{0, 0, -0.5} && k.verb.contact.slip_m_s == 0.25 &&
                     k.verb.contact.roll_m_s == 0 && k.verb.contact.number == 0 &&
                     k.verb.contact.texture == synth::Texture{};
            })},
           {a, {0, 0, 0, 0, 0, 0, 0, 2, 7, 0.0625f, 0.25f, -2}, claim<SetContact>([](const SetContact& k) {
              return k.verb.contact.roll_m_s == 2 && k.verb.contact.number == 7 &&
                     k.verb.contact.texture == synth::Texture{0.0625, 0.25, -2};
            })}},
          {{"/object/b%/contact", {0, 0, 0, 0, 0, 0, 0}, "object"},
           {a, {kNan, 0, 0, 0, 0, 0, 0}, "x"},
           {a, {0, 1e5, 0, 0, 0, 0, 0}, "y"},
           {a, {0, 0, "up", 0, 0, 0, 0}, "z"},
           {a, {0, 0, 0, kInfinity, 0, 0, 0}, "fx"},
           {a, {0, 0, 0, 0, 1e7, 0, 0}, "fy"},
           {a, {0, 0, 0, 0, 0, -1e7, 0}, "fz"},
           {a, {0, 0, 0, 0, 0, 0}, "slip"},
           {a, {0, 0, 0, 0, 0, 0, -1}, "slip"},
           {a, {0, 0, 0, 0, 0, 0, 0, -1}, "roll"},
           {a, {0, 0, 0, 0, 0, 0, 0, 0, -1}, "number"},
           {a, {0, 0, 0, 0, 0, 0, 0, 0, 0, 1}, "roughness"},
           {a, {0, 0, 0, 0, 0, 0, 0, 0, 0, 0, 0}, "correlation"},
           {a, {0, 0, 0, 0, 0, 0, 0, 0, 0, 0, 1, 1}, "slope"}}};
}

Cases pickup_cases() {
  const std::string a = "/object/bell/pickup";
  return {{{a, {1, 2, 3, 0, 0, -1}, claim<SetPickup>([](const SetPickup& p) {
              return p.object == named("bell") && p.verb.point_m == Vec3{1, 2, 3} &&
                     p.verb.direction == Vec3{0, 0, -1} && p.verb.number == 1 && p.verb.motion == 1 && p.verb.gain == 1;
            })},
           {a, {0, 0, 0, 0, 0, 0, 8, 2, -1e6}, claim<SetPickup>([](const SetPickup& p) {
              return p.verb.direction == Vec3{} && p.verb.number == 8 && p.verb.motion == 2 && p.verb.gain == -1e6;
            })}},
          {{"/object/b%/pickup", {0, 0, 0, 0, 0, 1}, "object"},
           {a, {kNan, 0, 0, 0, 0, 1}, "x"},
           {a, {0, 1e5, 0, 0, 0, 1}, "y"},
           {a, {0, 0, "up", 0, 0, 1}, "z"},
           {a, {0, 0, 0, kInfinity, 0, 1}, "dx"},
           {a, {0, 0, 0, 0, 1e4, 1}, "dy"},
           {a, {0, 0, 0, 0, 1}, "dz"},
           {a, {0, 0, 0, 0, 0, 1, 0}, "bus"},
           {a, {0, 0, 0, 0, 0, 1, 9}, "bus"},
           {a, {0, 0, 0, 0, 0, 1, 1, 3}, "motion"},
           {a, {0, 0, 0, 0, 0, 1, 1, 1, 1e13}, "gain"}}};
}

Cases hold_cases() {
  const std::string a = "/object/bell/hold";
  return {{{a, {1, 2, 3, 5}, claim<Hold>([](const Hold& h) {
              return h.object == named("bell") && h.damper == modal::Damper{{1, 2, 3}, {0, 0, 0}, 5} && h.number == 0;
            })},
           {a, {1, 2, 3, 0, 0, 0, -1, 15}, claim<Hold>([](const Hold& h) {
              return h.damper == modal::Damper{{1, 2, 3}, {0, 0, -1}, 0} && h.number == 15;
            })}},
          {{"/object/b%/hold", {0, 0, 0, 0}, "object"},
           {a, {kNan, 0, 0, 0}, "x"},
           {a, {0, 1e5, 0, 0}, "y"},
           {a, {0, 0, "up", 0}, "z"},
           {a, {0, 0, 0}, "damping"},
           {a, {0, 0, 0, -1}, "damping"},
           {a, {0, 0, 0, 1, kInfinity, 0, 0}, "nx"},
           {a, {0, 0, 0, 1, 0, 1e4, 0}, "ny"},
           {a, {0, 0, 0, 1, 0, 0, -1e4}, "nz"},
           {a, {0, 0, 0, 1, 0, 0, 0, 16}, "number"}}};
}

}  // namespace ringdown::protocol
