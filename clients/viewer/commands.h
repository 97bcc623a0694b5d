// What the user's actions ask of the daemon. Knows nothing of windows: it reads the model, sends requests, and keeps
// what is chosen and what can be undone. [UI]
#pragma once

#include "clients/viewer/action.h"
#include "clients/viewer/history.h"
#include "clients/viewer/link/model.h"
#include "protocol/request.h"

#include <functional>
#include <map>
#include <string>

namespace ringdown::viewer {

// What actions are about.
struct Choice {
  std::string object;      // empty: there is none
  std::uint32_t node = 0;  // of the object's sample points
  std::uint32_t mode = 0;  // by ascending frequency
  bool vibrate = false;    // shown vibrating in that mode
  bool tone = false;       // the test tone sounds
  double impulse_ns = 0.05;
  double contact_time_s = 0.0005;
  Vec3 drop_m{0, 0, 1};  // where new bodies start
};

// How an object is set.
struct Adjustment {
  modal::MaterialScale scale;
  double gain = 1, pan = 0;
  modal::ModeRange range;
};

class Commands {
 public:
  using Send = std::function<void(protocol::Request)>;
  Commands(Model& model, Send send) : model_(model), send_(std::move(send)) {}

  // At every frame: chooses the object with the most modes as long as the user has chosen none that is there.
  void update(double now_s);

  // The daemon is another one: nothing that was done to the last can be undone in it.
  void restart();

  // Does what concerns sound, objects and bodies; false for what is the window's or the camera's to do.
  bool perform(Action action);

  [[nodiscard]] Choice& choice() { return choice_; }
  [[nodiscard]] const Choice& choice() const { return choice_; }
  [[nodiscard]] const History& history() const { return history_; }
  void choose_object(const std::string& name);

  // The object as it was set last, here or elsewhere.
  [[nodiscard]] Adjustment adjustment_of(const KnownObject& object) const;

  // Changes that can be undone: SetMaterial, SetGain, SetPan, SelectModes of an object that is known.
  void edit(const KnownObject& object, const protocol::Request& change, const std::string& what);

  // A blow at a point of the object, in its frame, against the surface whose outward normal is `normal`.
  void strike(const std::string& object, Vec3 point_m, Vec3 normal, double impulse_ns);
  void push(std::int32_t body, Vec3 impulse_ns) { send_(protocol::ScenePush{body, impulse_ns}); }
  // Leaves the object one mode, and rings it; once more gives it all back.
  void hear_alone(const KnownObject& object, std::uint32_t rank);

  void load_scene(const std::string& path) { send_(protocol::SceneLoad{path}); }
  void load_bank(const std::string& path);
  void toggle_recording();

 private:
  [[nodiscard]] const KnownObject* chosen() const { return model_.object(choice_.object); }
  bool perform_choice(Action action);
  bool perform_material(Action action);
  bool perform_modes(Action action);
  bool perform_scene(Action action);
  void step_object(int by);
  void step_node(int by);
  void step_mode(int by);
  void scale_material(double modal::MaterialScale::*factor, double by);
  void step_mode_count(int by);
  void play_modes(modal::ModeRange range);
  void project_test_force();
  void send_again(const std::optional<protocol::Request>& change);
  void carry_out(const protocol::Request& change);

  Model& model_;
  Send send_;
  Choice choice_;
  History history_;
  struct Pending {
    Adjustment as;
    double at_s;
  };
  std::map<std::string, Pending> pending_;  // what was sent and not yet told of
  bool chosen_by_hand_ = false;
  double now_s_ = 0;
};

// The direction out of the surface at a sample point: the mean of its triangles' normals; up where there are none.
Vec3 outward_normal(const modal::Bank& bank, std::uint32_t point);

}  // namespace ringdown::viewer
