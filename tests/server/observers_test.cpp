// Who is told what, and when.
#include "server/session/observers.h"

#include "server/session/object_state.h"

#include <gtest/gtest.h>

#include <vector>

namespace ringdown::session {
namespace {

using synth::Producer;

class Listener final : public Observer {
 public:
  void played(const synth::Event& event) override { frames.push_back(event.frame); }
  void changed(const ObjectState* before, const ObjectState* after, synth::Frame) override {
    came += !before;
    went += !after;
  }
  std::vector<synth::Frame> frames;
  int came = 0, went = 0;
};

TEST(Observers, EventsAreReportedOnceAndInTheOrderOfTheirProducer) {
  Observers observers;
  Listener a, b;
  observers.add(a);
  observers.add(b);
  for (const synth::Frame frame : {7, 3, 5}) observers.keep(Producer::control, {.frame = frame});
  EXPECT_TRUE(a.frames.empty()) << "a producer does not wait for observers";
  observers.report_events();
  observers.report_events();
  EXPECT_EQ(a.frames, (std::vector<synth::Frame>{7, 3, 5}));
  EXPECT_EQ(b.frames, a.frames);
}

TEST(Observers, NoEventIsLostWhenMoreAreKeptThanARingHolds) {
  Observers observers;
  Listener listener;
  observers.add(listener);
  std::vector<synth::Frame> kept;
  for (std::size_t i = 0; i < 2 * synth::kQueueCapacity + 1; ++i) {
    kept.push_back(static_cast<synth::Frame>(i));
    observers.keep(Producer::scene, {.frame = kept.back()});
  }
  observers.report_events();
  EXPECT_EQ(listener.frames, kept);
}

TEST(Observers, ChangesAreReportedAtOnceAndCounted) {
  Observers observers;
  Listener listener;
  observers.add(listener);
  int calls = 0;
  observers.set_on_change([&calls] { ++calls; });
  const ObjectState bell{.name = "bell"};
  observers.report_change(nullptr, &bell, 0);
  observers.report_change(&bell, nullptr, 0);
  observers.report_change();  // of a bus or an input: the observers of objects hear nothing
  EXPECT_EQ(std::pair(listener.came, listener.went), std::pair(1, 1));
  EXPECT_EQ(observers.version(), 3u);
  EXPECT_EQ(calls, 3);
}

TEST(Observers, AnObserverThatWasRemovedHearsNothing) {
  Observers observers;
  Listener gone, there;
  observers.add(gone);
  observers.add(there);
  observers.remove(gone);
  observers.keep(Producer::worker, {.frame = 1});
  observers.report_events();
  EXPECT_TRUE(gone.frames.empty());
  EXPECT_EQ(there.frames.size(), 1u);
}

}  // namespace
}  // namespace ringdown::session
