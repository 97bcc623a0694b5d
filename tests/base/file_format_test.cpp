#include "engine/base/file_format.h"

#include <gtest/gtest.h>

namespace ringdown {
namespace {

TEST(FileFormat, AnEndingIsKnownInAnyLetters) {
  for (const char* name : {"a.step", "A.STEP", "b/a.Step", "a.b.sTeP"}) {
    const FileFormat* format = format_of(name);
    ASSERT_NE(format, nullptr) << name;
    EXPECT_EQ(format->ending, ".step");
    EXPECT_EQ(format->kind, FileKind::geometry);
    EXPECT_EQ(format->unit_m, 0.001);
  }
  EXPECT_TRUE(is_of_kind("A.GLB", FileKind::gltf));
  EXPECT_TRUE(is_of_kind("BELL.TOML", FileKind::table));
  EXPECT_TRUE(is_of_kind("TAKE 1.WAV", FileKind::sound));
  EXPECT_TRUE(has_ending("x.GeO", ".geo"));
}

TEST(FileFormat, WhatIsNoEndingIsNone) {
  for (const char* name : {"step", "a.step/b", "a.stl.gz", "a.", ".stl", "", "a.st l"}) {
    EXPECT_EQ(format_of(name), nullptr) << name;
    EXPECT_FALSE(is_of_kind(name, FileKind::surface)) << name;
  }
}

TEST(FileFormat, TheListForSentencesHasEveryKindOfBody) {
  const std::string list = endings_of_bodies();
  for (const char* ending : {".stl", ".glb", ".step", ".geo", ".msh", ".inp"})
    EXPECT_NE(list.find(ending), std::string::npos) << ending;
  for (const char* ending : {".toml", ".wav"}) EXPECT_EQ(list.find(ending), std::string::npos) << ending;
}

TEST(FileFormat, ExamplesForHelpComeKindByKind) {
  EXPECT_EQ(example_endings({FileKind::program, FileKind::geometry}), ".geo .step .brep");
  EXPECT_EQ(example_endings({FileKind::surface, FileKind::gltf}), ".stl .obj .ply .glb");
  EXPECT_EQ(example_endings({FileKind::gmsh_mesh}), ".msh .vtk");
}

}  // namespace
}  // namespace ringdown
