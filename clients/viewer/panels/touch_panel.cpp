#include "clients/viewer/panels/touch_panel.h"

#include "engine/base/formatted.h"

#include <algorithm>
#include <array>
#include <cmath>

namespace ringdown::viewer {
namespace {

constexpr float kTouch_em = 23;
constexpr float kHair_em = 2.5F;  // half of the length of a bow's mark
constexpr double kHairStep_m = 1e-3;

struct Entry {
  std::string text;
  bool is_chosen;
};

enum class Click { none, chooses, ends };

// Draws a row of a list with a button that ends what the row names.
Click draw_entry(const Entry& entry, const char* button) {
  ImGui::PushID(entry.text.c_str());
  const float width = ImGui::CalcTextSize(button).x + 3 * ImGui::GetStyle().FramePadding.x;
  const bool chooses =
      ImGui::Selectable(entry.text.c_str(), entry.is_chosen, 0,
                        {ImGui::GetContentRegionAvail().x - width - ImGui::GetStyle().ItemSpacing.x, 0});
  ImGui::SameLine();
  const bool ends = ImGui::SmallButton(button);
  ImGui::PopID();
  return ends ? Click::ends : chooses ? Click::chooses : Click::none;
}

}  // namespace

void TouchPanel::next() {
  complaint_.clear();
  if (is_open_ && kind_ == Kind::coupling) return end();
  kind_ = is_open_ && kind_ == Kind::mallet ? Kind::bow : is_open_ ? Kind::coupling : Kind::mallet;
  is_open_ = true;
}

void TouchPanel::touch(const SurfacePoint& from, Vec3 way, const std::optional<SurfacePoint>& to, Commands& commands) {
  complaint_.clear();
  commands.choose_object(from.object);
  if (kind_ == Kind::mallet) return commands.act_once(mallet_at(from, speed_m_s_, mallet_));
  if (kind_ == Kind::bow) {
    bowed_ = from.object;
    return commands.edits().touch(bow_at(from, way, bow_));
  }
  if (!to || to->object == from.object) {
    complaint_ = "A coupling joins two objects: drag from the surface of one to that of another.";
    return;
  }
  coupling_.number = coupling_number_ = commands.edits().touches().free_number();
  commands.edits().touch(coupling_of(from, *to, coupling_));
}

void TouchPanel::draw_mallet() {
  ImGui::TextDisabled("Click a surface to throw the mallet at it.");
  slider("Speed", "The speed of the mallet when it hits", speed_m_s_, {0.01, 20}, "%.3g m/s");
  slider("Mass", "The mass of the mallet, shaft and hand included", mallet_.mass_kg, {1e-4, 10}, "%.3g kg");
  slider("Head",
         "The stiffness of the head, by Hertz's law, in N/m^1.5: about 1e5 for yarn, 1e7 for rubber,\n"
         "1e9 for wood, 1e10 for steel",
         mallet_.head, {1e4, 1e11}, "%.2g");
  slider("Bounce", "The mallet's speed after a blow on a rigid wall, divided by its speed before", mallet_.bounce,
         {0.05, 1, false}, "%.2f");
}

void TouchPanel::draw_bow(Edits& edits) {
  ImGui::TextDisabled("Drag along a surface to draw the bow that way.");
  const protocol::SetBow* laid = edits.touches().bow_of(bowed_);
  if (laid) bow_ = laid->verb;
  bool changes =
      slider("Speed", "The speed of the hair. A faster bow is louder", bow_.speed_m_s, {0.005, 5}, "%.3g m/s");
  changes |=
      slider("Force", "Presses the hair on the surface. With too little the sound is thin, with too much it rasps",
             bow_.force_n, {0.01, 100}, "%.3g N");
  changes |= slider("Rosin", "The coefficient of friction while the hair sticks", bow_.rosin, {0.1, 2, false}, "%.2f");
  if (laid && changes) edits.touch(protocol::SetBow{laid->object, bow_});
  const std::vector<protocol::SetBow> bows = edits.touches().bows();  // a copy, because a row may end one
  for (const protocol::SetBow& bow : bows) {
    const Click click = draw_entry({bow.object.name, bow.object.name == bowed_}, "Lift");
    if (click == Click::chooses) bowed_ = bow.object.name;
    if (click == Click::ends) edits.touch(lifted(bow));
  }
}

void TouchPanel::draw_coupling(Edits& edits) {
  ImGui::TextDisabled("Drag from one object to another to couple them.");
  const protocol::SetCoupling* laid = edits.touches().coupling(coupling_number_);
  if (laid) coupling_ = laid->verb;
  bool changes = slider("Weight", "With which the second object rests on the first; at 0 both are held in place",
                        coupling_.weight_n, {0, 100, false}, "%.3g N");
  double gap_um = 1e6 * coupling_.gap_m;
  if (slider("Gap", "The distance at rest. Negative: pressed together. A few micrometres buzz", gap_um,
             {-100, 100, false}, "%.1f \xC2\xB5m")) {
    coupling_.gap_m = 1e-6 * gap_um;
    changes = true;
  }
  changes |= slider("Stiffness", "The stiffness of the contact, by Hertz's law, in N/m^1.5", coupling_.stiffness,
                    {1e4, 1e11}, "%.2g");
  changes |= slider("Friction", "The coefficient of friction while the surfaces stick", coupling_.friction,
                    {0, 2, false}, "%.2f");
  if (laid && changes) edits.touch(protocol::SetCoupling{laid->object, coupling_, laid->other});
  const std::vector<protocol::SetCoupling> all = edits.touches().couplings();
  for (const protocol::SetCoupling& one : all) {
    const std::string text = formatted("{} \xE2\x80\x93 {}##{}", one.object.name, one.other.name, one.verb.number);
    const Click click = draw_entry({text, one.verb.number == coupling_number_}, "Separate");
    if (click == Click::chooses) coupling_number_ = one.verb.number;
    if (click == Click::ends) edits.touch(separated(one));
  }
}

void TouchPanel::draw(const Skin& skin, ImVec2 origin, ImVec2 size, Commands& commands) {
  if (!is_open_) return;
  const float em = ImGui::GetFontSize();
  ImGui::SetNextWindowPos({origin.x + em, origin.y + size.y - em}, 0, {0, 1});
  ImGui::SetNextWindowSize({std::min(kTouch_em * em, size.x - 2 * em), 0});
  ImGui::Begin("Touch", nullptr,
               ImGuiWindowFlags_NoDecoration | ImGuiWindowFlags_NoMove | ImGuiWindowFlags_NoSavedSettings |
                   ImGuiWindowFlags_NoFocusOnAppearing);
  constexpr std::array<const char*, 3> kNames = {"Mallet", "Bow", "Coupling"};
  for (std::size_t i = 0; i < kNames.size(); ++i) {
    if (ImGui::RadioButton(kNames[i], kind_ == static_cast<Kind>(i))) kind_ = static_cast<Kind>(i);
    ImGui::SameLine();
  }
  ImGui::SameLine(ImGui::GetContentRegionMax().x - 3 * em);
  const bool ends = ImGui::SmallButton("Done");
  if (kind_ == Kind::mallet) draw_mallet();
  if (kind_ == Kind::bow) draw_bow(commands.edits());
  if (kind_ == Kind::coupling) draw_coupling(commands.edits());
  if (!complaint_.empty()) {
    ImGui::PushStyleColor(ImGuiCol_Text, skin.warning);
    ImGui::TextWrapped("%s", complaint_.c_str());
    ImGui::PopStyleColor();
  }
  ImGui::End();
  if (ends) end();
}

// A bow is a line along the hair, a coupling a line from surface to surface.
void TouchPanel::mark(const Skin& skin, const Touches& touches, const PlaceOf& place_of) const {
  ImDrawList* list = ImGui::GetWindowDrawList();
  const float em = ImGui::GetFontSize(), dot = 0.3F * em;
  for (const protocol::SetBow& bow : touches.bows()) {
    const auto at = place_of(bow.object.name, bow.verb.point_m);
    const auto ahead = place_of(bow.object.name, bow.verb.point_m + kHairStep_m * bow.verb.direction);
    if (!at || !ahead) continue;
    const float x = ahead->x - at->x, y = ahead->y - at->y, away = std::hypot(x, y);
    const float reach = away > 0 ? kHair_em * em / away : 0;
    list->AddLine({at->x - reach * x, at->y - reach * y}, {at->x + reach * x, at->y + reach * y}, skin.warning, 3);
    list->AddCircleFilled(*at, dot, skin.warning);
  }
  for (const protocol::SetCoupling& one : touches.couplings()) {
    const auto from = place_of(one.object.name, one.verb.point_m);
    const auto to = place_of(one.other.name, one.verb.other_point_m);
    if (!from || !to) continue;
    list->AddLine(*from, *to, skin.warning, 2);
    list->AddCircle(*from, dot, skin.warning, 0, 2);
    list->AddCircle(*to, dot, skin.warning, 0, 2);
  }
}

}  // namespace ringdown::viewer
