// The table of keys against the 2011 report's two tables, which are written down here once more.
#include "clients/viewer/keys.h"

#include <gtest/gtest.h>

#include <fstream>
#include <map>
#include <optional>
#include <set>
#include <sstream>

namespace ringdown::viewer {
namespace {

// What a key does in a pane.
std::optional<Action> action_of(Pane pane, std::string_view key) {
  const auto binding = binding_for(pane, key);
  return binding ? std::optional(binding->action) : std::nullopt;
}

using Table = std::map<std::string, Action>;
const Table kBothWindows = {{"escape", Action::quit},    {"Z", Action::alpha_up},      {"X", Action::alpha_down},
                            {"C", Action::beta_up},      {"V", Action::beta_down},     {"B", Action::density_up},
                            {"N", Action::density_down}, {"M", Action::stiffness_up},  {",", Action::stiffness_down},
                            {".", Action::next_node},    {"/", Action::previous_node}, {"tab", Action::full_screen}};
const Table kTestWindow = {{"Q", Action::highest_modes},      {"W", Action::test_tone}, {"E", Action::clear_sound},
                           {"R", Action::project_test_force}, {"T", Action::all_modes}, {"A", Action::more_modes},
                           {"S", Action::fewer_modes}};
const Table kScene = {{"W", Action::forward},     {"S", Action::back},          {"A", Action::left},
                      {"D", Action::right},       {"H", Action::new_box},       {"J", Action::new_sphere},
                      {"Q", Action::clear_sound}, {"space", Action::test_force}};

TEST(Keys, BothWindowsHaveTheKeysOfTheReport) {
  for (const auto& [key, action] : kBothWindows) {
    for (const Pane pane : {Pane::scene, Pane::sound, Pane::side}) {
      EXPECT_EQ(action_of(pane, key), action) << key << " in pane " << static_cast<int>(pane);
    }
  }
}

TEST(Keys, TheSoundPaneHasTheKeysOfTheReportsTestWindow) {
  for (const auto& [key, action] : kTestWindow) EXPECT_EQ(action_of(Pane::sound, key), action) << key;
}

TEST(Keys, TheScenePaneHasTheKeysOfTheReportsScene) {
  for (const auto& [key, action] : kScene) EXPECT_EQ(action_of(Pane::scene, key), action) << key;
}

TEST(Keys, TheFocusedPaneDecidesWhatASharedLetterMeans) {
  for (const char* key : {"Q", "W", "A", "S"}) {
    EXPECT_NE(action_of(Pane::scene, key), action_of(Pane::sound, key)) << key;
    EXPECT_FALSE(action_of(Pane::side, key)) << "the third pane has no letters of its own: " << key;
  }
}

TEST(Keys, EveryActionHasAKey) {
  std::set<Action> bound;
  for (const Binding& binding : bindings()) bound.insert(binding.action);
  EXPECT_EQ(bound.size(), static_cast<std::size_t>(Action::restart) + 1) << "Action::restart is the last action";
}

TEST(Keys, NoKeyMeansTwoThingsInOnePane) {
  std::set<std::pair<Pane, std::string_view>> seen;
  for (const Binding& binding : bindings()) {
    EXPECT_TRUE(seen.insert({binding.pane, binding.key}).second) << binding.key;
    EXPECT_FALSE(binding.sentence.empty()) << binding.key;
  }
}

TEST(Keys, AKeyHeldDownTogglesNothingTwice) {
  for (const char* key : {"ctrl+R", "F1", "F2", "F5", "F11", "tab", "ctrl+tab", "escape", "P"}) {
    EXPECT_EQ(binding_for(Pane::scene, key)->while_down, WhileDown::once) << key;
  }
  EXPECT_EQ(binding_for(Pane::sound, "W")->while_down, WhileDown::once);
  EXPECT_EQ(binding_for(Pane::scene, "H")->while_down, WhileDown::once);
  EXPECT_EQ(binding_for(Pane::sound, "M")->while_down, WhileDown::repeats);
  EXPECT_EQ(binding_for(Pane::scene, "W")->while_down, WhileDown::continues);
}

TEST(Keys, ModifiersArePartOfAKeysName) {
  EXPECT_EQ(key_name("Z", true, false), "ctrl+Z");
  EXPECT_EQ(key_name("A", false, true), "A");
  EXPECT_NE(action_of(Pane::scene, "Z"), action_of(Pane::scene, "ctrl+Z"));
}

TEST(Keys, TheManualListsTheTableOfKeys) {
  std::ifstream file(RINGDOWN_SOURCE_DIR "/docs/use/window.md");
  std::stringstream text;
  text << file.rdbuf();
  EXPECT_NE(text.str().find(keys_as_markdown()), std::string::npos) << "run `./run docs`: docs/use/window.md lacks\n"
                                                                    << keys_as_markdown();
}

}  // namespace
}  // namespace ringdown::viewer
