// The table of keys against the report's two tables: each of their functions has a key, with its letter where it was
// given.
#include "clients/viewer/keys.h"

#include <gtest/gtest.h>

#include <fstream>
#include <map>
#include <set>
#include <sstream>

namespace ringdown::viewer {
namespace {

std::set<std::pair<Pane, Action>> actions() {
  std::set<std::pair<Pane, Action>> all;
  for (const Binding& binding : bindings()) all.insert({binding.pane, binding.action});
  return all;
}

TEST(Keys, EveryFunctionOfTheReportsTestProgramHasAKeyInTheSoundPane) {
  for (const Action action :
       {Action::quit, Action::highest_modes, Action::test_tone, Action::clear_sound, Action::project_test_force,
        Action::all_modes, Action::more_modes, Action::fewer_modes, Action::alpha_up, Action::alpha_down,
        Action::beta_up, Action::beta_down, Action::density_up, Action::density_down, Action::stiffness_up,
        Action::stiffness_down, Action::next_node, Action::previous_node, Action::full_screen}) {
    EXPECT_TRUE(actions().contains({Pane::sound, action}) || actions().contains({Pane::any, action}))
        << static_cast<int>(action);
  }
}

TEST(Keys, TheScenePaneHasTheLettersOfTheReport) {
  const std::map<std::string, Action> expected = {
      {"W", Action::forward},    {"A", Action::left},           {"S", Action::back},
      {"D", Action::right},      {"space", Action::test_force}, {"H", Action::new_box},
      {"J", Action::new_sphere}, {"Q", Action::clear_scene},    {"escape", Action::quit}};
  for (const auto& [key, action] : expected) {
    const auto binding = binding_for(Pane::scene, key);
    ASSERT_TRUE(binding) << key;
    EXPECT_EQ(binding->action, action) << key;
  }
}

TEST(Keys, TheFocusedPaneDecidesWhatASharedLetterMeans) {
  for (const char* key : {"Q", "W", "E", "A", "S", "D"}) {
    const auto scene = binding_for(Pane::scene, key), sound = binding_for(Pane::sound, key);
    ASSERT_TRUE(scene && sound) << key;
    EXPECT_NE(scene->action, sound->action) << key;
  }
  EXPECT_FALSE(binding_for(Pane::side, "Q")) << "the third pane has no letters of its own";
  EXPECT_TRUE(binding_for(Pane::side, "F1"));
}

TEST(Keys, NoKeyMeansTwoThingsInOnePane) {
  std::set<std::pair<Pane, std::string_view>> seen;
  for (const Binding& binding : bindings()) {
    EXPECT_TRUE(seen.insert({binding.pane, binding.key}).second) << binding.key;
    EXPECT_FALSE(binding.sentence.empty()) << binding.key;
  }
}

TEST(Keys, AKeyHeldDownTogglesNothingTwice) {
  for (const char* key : {"ctrl+R", "F1", "F2", "F5", "F11", "tab", "escape", "P"}) {
    EXPECT_EQ(binding_for(Pane::scene, key)->while_down, WhileDown::once) << key;
  }
  EXPECT_EQ(binding_for(Pane::sound, "4")->while_down, WhileDown::once);
  EXPECT_EQ(binding_for(Pane::scene, "H")->while_down, WhileDown::once);
  EXPECT_EQ(binding_for(Pane::sound, "T")->while_down, WhileDown::repeats);
  EXPECT_EQ(binding_for(Pane::scene, "W")->while_down, WhileDown::continues);
}

TEST(Keys, ModifiersArePartOfAKeysName) {
  EXPECT_EQ(key_name("Z", true, false), "ctrl+Z");
  EXPECT_EQ(key_name("A", false, true), "A");
  EXPECT_FALSE(binding_for(Pane::scene, "Z")) << "ctrl+Z is another key";
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
