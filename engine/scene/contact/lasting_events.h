// Turns the reports of lasting contacts into events for the objects on both sides, or into one for both where one of
// them is marked as two-way. Free of any physics engine. [one thread at a time]
#pragma once

#include "engine/scene/contact/bearing.h"
#include "engine/scene/contact/contact_life.h"
#include "engine/scene/contact/contact_side.h"
#include "engine/synth/events/event.h"

#include <array>
#include <cstddef>
#include <cstdint>
#include <map>
#include <optional>
#include <vector>

namespace ringdown::scene {

// Strikes, clicks and reports of lasting contacts together: room for a strike on both sides of every contact point that
// a step may have (kMaxContactsPerStep), and for two clicks or reports with each.
inline constexpr std::size_t kMaxEventsPerStep = 16384;

// The events of one step, up to kMaxEventsPerStep.
struct StepEvents {
  std::vector<synth::Event> events;
  std::size_t dropped = 0;  // events beyond the bound

  void push(const synth::Event& event);
  void clear() { events.clear(), dropped = 0; }
};

// Every object numbers its lasting contacts. A number is given at the first report and free again after the last.
class LastingEvents {
 public:
  // Adds an event for each of the two sides that has an object, or, two-way, for the first that has one. The event that
  // ends a contact has force zero.
  void add(const ContactReport& report, const ContactSides& sides, synth::Frame frame, StepEvents& events);

  // Returns true if the ends of all contacts have been reported.
  [[nodiscard]] bool empty() const { return numbers_.size() == 0; }

 private:
  struct Number {
    synth::ObjectNumber object = 0;
    std::uint32_t number = 0;  // of the object's contact
  };
  struct Numbers {
    std::array<std::optional<Number>, 2> of;  // of both sides
    bool two_way = false;                     // one of them
  };
  struct Half {  // what a report says about one side
    const ContactSide* side;
    const Motion& motion;
    Vec3 force_n;
    Vec3 push;         // unit, along the normal
    Vec3 passing_m_s;  // of the other side's surface
  };
  struct Felt {  // of both sides together
    synth::Texture texture;
    std::array<synth::Passing, 2> surfaces;
    FilterWidths widths;
  };
  static Felt felt(const ContactReport& report, const ContactSide& first, const ContactSide& second);
  struct Heard {  // by one object
    synth::ObjectNumber object;
    synth::verb::Contact contact;
  };
  std::optional<Heard> contact_of(const ContactReport& report, const Half& half, std::optional<Number>& number,
                                  const Felt& felt);
  static synth::verb::Rub feel_back(const Heard& heard, Vec3 point_m, const Half& struck, const Half& other);
  std::uint32_t take_number(synth::ObjectNumber object);

  PairMap<Numbers> numbers_;
  std::map<synth::ObjectNumber, std::vector<bool>> taken_;  // of each object's numbers
};

}  // namespace ringdown::scene
