// Pictures read back from OpenGL: what is seen where, and how bright. Small, so that software rendering is quick.
#include "clients/viewer/render/picture_file.h"
#include "clients/viewer/render/scene_renderer.h"
#include "tests/support/temporary_folder.h"
#include "tests/viewer/picture_window.h"

#include <glm/geometric.hpp>
#include <glm/gtc/matrix_transform.hpp>
#include <gtest/gtest.h>

#include <cmath>
#include <fstream>
#include <iterator>
#include <optional>
#include <set>
#include <utility>

namespace ringdown::viewer {
namespace {

constexpr int kWidth = 200, kHeight = 150;

class ScenePicture : public testing::Test {
 protected:
  void SetUp() override {
    if (!window_.display().works()) GTEST_SKIP() << "Xvfb is not installed";
    ASSERT_TRUE(window_.works());
    Result<SceneRenderer> made = SceneRenderer::create();
    ASSERT_TRUE(made) << made.error().message;
    renderer_.emplace(std::move(*made));
    frame_.interest = {{0, 0, 0}, 1};
  }
  void TearDown() override { renderer_.reset(); }

  DrawnBody& add(const DrawnMesh& mesh, glm::vec3 place, glm::vec3 colour) {
    DrawnBody body;
    body.mesh = renderer_->add_mesh(mesh);
    body.pose = glm::translate(glm::mat4(1), place);
    body.colour = colour;
    return frame_.bodies.emplace_back(body);
  }
  Image draw(int width = kWidth, int height = kHeight) {
    EXPECT_NE(renderer_->render(frame_, camera_, width, height), 0u);
    return renderer_->read_pixels();
  }
  [[nodiscard]] glm::vec3 seen(const Image& image, glm::vec3 point) const {
    const auto pixel = camera_.project(point, image.width, image.height);
    EXPECT_TRUE(pixel);
    const std::uint8_t* rgba = image.at(static_cast<int>(pixel->x), static_cast<int>(pixel->y));
    return {rgba[0], rgba[1], rgba[2]};
  }

  test::PictureWindow window_;
  std::optional<SceneRenderer> renderer_;
  SceneFrame frame_;
  Camera camera_ = Camera::from({0, -4, 1.5F}, {});
};

constexpr glm::vec3 kRed(0.8F, 0.05F, 0.05F), kGreen(0.05F, 0.7F, 0.1F), kGrey(0.6F);

float brightness(glm::vec3 c) { return 0.2126F * c.r + 0.7152F * c.g + 0.0722F * c.b; }
bool is_red(glm::vec3 c) { return c.r > 2 * c.g && c.r > 60; }
bool is_green(glm::vec3 c) { return c.g > 2 * c.r && c.g > 60; }

TEST_F(ScenePicture, ABodyIsDrawnWhereTheCameraProjectsIt) {
  const glm::vec3 place(0.7F, 0.3F, 0.4F);
  add(sphere_mesh(0.15F), place, kRed);
  const Image image = draw();
  EXPECT_TRUE(is_red(seen(image, place)));
  for (const glm::vec3 aside : {camera_.right(), -camera_.right(), camera_.up(), -camera_.up()}) {
    EXPECT_TRUE(is_red(seen(image, place + 0.12F * aside)));
    EXPECT_FALSE(is_red(seen(image, place + 0.19F * aside)));
  }
  EXPECT_EQ(image.at(3, 3)[3], 255) << "opaque";
}

TEST_F(ScenePicture, ANearBodyHidesOneBehindIt) {
  add(sphere_mesh(0.3F), {0, 0, 0}, kRed);
  add(sphere_mesh(0.3F), 0.8F * camera_.forward(), kGreen);
  EXPECT_TRUE(is_red(seen(draw(), {})));
  std::swap(frame_.bodies[0], frame_.bodies[1]);
  EXPECT_TRUE(is_red(seen(draw(), {}))) << "whatever the order";
  std::swap(frame_.bodies[0].pose, frame_.bodies[1].pose);
  EXPECT_TRUE(is_green(seen(draw(), {})));
}

TEST_F(ScenePicture, ShadowsFallAwayFromTheLight) {
  frame_.statics.push_back({});
  camera_ = Camera::from({0, -3, 3}, {});
  const Image bare = draw();
  const glm::vec3 middle(0, 0, 0.5F), light = towards_light();
  add(sphere_mesh(0.2F), middle, kGrey);
  const Image image = draw();
  const glm::vec3 shadow = middle - light * (middle.z / light.z), across(shadow.x, shadow.y, 0);
  EXPECT_LT(brightness(seen(image, shadow)), 0.8F * brightness(seen(bare, shadow)));
  EXPECT_NEAR(brightness(seen(image, -across)), brightness(seen(bare, -across)), 2) << "towards the light";
  EXPECT_NEAR(brightness(seen(image, 2.5F * across)), brightness(seen(bare, 2.5F * across)), 2) << "beyond it";
}

TEST_F(ScenePicture, BodiesThatGlowAreBrighter) {
  for (const Theme theme : {Theme::dark, Theme::light}) {
    frame_.theme = theme;
    frame_.bodies.clear();
    add(sphere_mesh(0.5F), {}, {0, 0.447F, 0.698F});
    float before = 0;
    for (const float glow : {0.0F, 0.3F, 1.0F}) {
      frame_.bodies[0].glow = glow;
      const float now = brightness(seen(draw(), {}));
      EXPECT_GT(now, before + 10);
      before = now;
    }
  }
}

TEST_F(ScenePicture, AModesDisplacementMovesTheOutlineByItsAmplitude) {
  camera_ = Camera::from({0, -4, 0}, {});
  const DrawnMesh box = box_mesh({0.4F, 0.4F, 0.4F});
  std::vector<glm::vec3> stretch(box.positions.size());
  for (std::size_t i = 0; i < stretch.size(); ++i) stretch[i] = {box.positions[i].x > 0 ? 1 : 0, 0, 0};
  add(box, {}, kRed).displacement = std::make_shared<const std::vector<glm::vec3>>(stretch);
  const auto right_edge = [this] {
    const Image image = draw();
    int last = 0;
    for (int x = 0; x < kWidth; ++x) {
      const std::uint8_t* c = image.at(x, kHeight / 2);
      if (is_red({c[0], c[1], c[2]})) last = x + 1;
    }
    return static_cast<float>(last);
  };
  const auto expected = [this](float x) { return camera_.project({x, -0.2F, 0}, kWidth, kHeight)->x; };
  EXPECT_NEAR(right_edge(), expected(0.2F), 1.01);
  frame_.bodies[0].displacement_m = 0.5F;
  EXPECT_NEAR(right_edge(), expected(0.7F), 1.01);
  frame_.bodies[0].size = 1.5F;
  EXPECT_NEAR(right_edge(), camera_.project({1.05F, -0.3F, 0}, kWidth, kHeight)->x, 1.01);
  EXPECT_GT(expected(0.7F), expected(0.2F) + 20) << "far enough to tell";
}

TEST_F(ScenePicture, AFlashIsSeenAtItsPointUntilItHasFaded) {
  frame_.statics.push_back({});
  const Image dark_bare = draw();
  frame_.flashes.push_back({{0.3F, 0.2F, 0}, {0, 0, 1}, 1, 0.1F});
  EXPECT_GT(brightness(seen(draw(), {0.3F, 0.2F, 0})), brightness(seen(dark_bare, {0.3F, 0.2F, 0})) + 40);
  frame_.flashes[0].age = 1;
  EXPECT_EQ(draw().rgba, dark_bare.rgba);
  frame_.theme = Theme::light;
  const Image light = draw();
  frame_.flashes[0].age = 0.1F;
  EXPECT_LT(brightness(seen(draw(), {0.3F, 0.2F, 0})), brightness(seen(light, {0.3F, 0.2F, 0})) - 30)
      << "on light ground it is dark";
}

TEST_F(ScenePicture, SelectionOutlinesABodyAndChangesNothingInside) {
  const float radius = 0.3F;
  add(sphere_mesh(radius), {}, kRed);
  const Image plain = draw();
  frame_.bodies[0].selected = true;
  const Image outlined = draw();
  EXPECT_EQ(seen(plain, {}), seen(outlined, {}));
  const glm::vec2 middle = *camera_.project({}, kWidth, kHeight);
  int changed = 0;
  for (int y = 0; y < kHeight; ++y) {
    for (int x = 0; x < kWidth; ++x) {
      if (std::equal(plain.at(x, y), plain.at(x, y) + 4, outlined.at(x, y))) continue;
      ++changed;
      const float away = glm::distance(middle, glm::vec2(x, y) + 0.5F);
      const float edge = camera_.project(radius * camera_.right(), kWidth, kHeight)->x - middle.x;
      EXPECT_GT(away, edge - 2);
      EXPECT_LT(away, edge + 5);
    }
  }
  EXPECT_GT(changed, 60);
}

TEST_F(ScenePicture, PicturesHaveAnySizeAndBothThemes) {
  frame_.statics.push_back({});
  frame_.statics.push_back({StaticShape::box, {0, 0, 0.2F}, {1, 0, 0, 0}, {0.4F, 0.4F, 0.4F}});
  const Image dark = draw();
  EXPECT_GT((std::set<std::uint8_t>(dark.rgba.begin(), dark.rgba.end()).size()), 30u) << "not blank";
  frame_.theme = Theme::light;
  const Image light = draw();
  for (const int x : {1, kWidth / 2, kWidth - 2})
    EXPECT_GT(light.at(x, 10)[1], dark.at(x, 10)[1] + 80) << "the theme is in the background";
  for (const auto& [w, h] : {std::pair{1, 1}, {37, 201}, {kWidth, kHeight}}) {
    const Image image = draw(w, h);
    EXPECT_EQ(image.width, w);
    EXPECT_EQ(image.height, h);
  }
  EXPECT_EQ(draw().rgba, light.rgba) << "the same picture again";
  EXPECT_EQ(draw(0, -3).width, 1);
}

TEST_F(ScenePicture, ARemovedMeshIsNotDrawn) {
  add(sphere_mesh(0.5F), {}, kRed);
  EXPECT_TRUE(is_red(seen(draw(), {})));
  renderer_->remove_mesh(frame_.bodies[0].mesh);
  renderer_->remove_mesh(12345);
  EXPECT_FALSE(is_red(seen(draw(), {})));
  add(sphere_mesh(0.5F), {}, kGreen);
  EXPECT_NE(frame_.bodies[0].mesh, frame_.bodies[1].mesh);
  EXPECT_TRUE(is_green(seen(draw(), {})));
}

TEST_F(ScenePicture, APictureIsWrittenAsAPng) {
  const test::TemporaryFolder folder;
  add(sphere_mesh(0.5F), {}, kRed);
  ASSERT_TRUE(write_png(draw(), folder / "a.png"));
  std::ifstream file(folder / "a.png", std::ios::binary);
  const std::string bytes((std::istreambuf_iterator<char>(file)), {});
  ASSERT_GT(bytes.size(), 100u);
  EXPECT_EQ(bytes.substr(1, 3), "PNG");
  EXPECT_EQ(static_cast<unsigned char>(bytes[19]), kWidth);
  EXPECT_EQ(static_cast<unsigned char>(bytes[23]), kHeight);
  const auto refused = write_png(draw(), folder / "no/such/a.png");
  ASSERT_FALSE(refused);
  EXPECT_NE(refused.error().message.find("a.png"), std::string::npos);
}

TEST(OldContext, AnOldOpenGlContextIsRefusedInOneSentence) {
  setenv("MESA_GL_VERSION_OVERRIDE", "2.1", 1);
  const test::PictureWindow window(2, 1);
  if (!window.display().works()) GTEST_SKIP() << "Xvfb is not installed";
  ASSERT_TRUE(window.works());
  const Result<SceneRenderer> made = SceneRenderer::create();
  unsetenv("MESA_GL_VERSION_OVERRIDE");
  ASSERT_FALSE(made);
  EXPECT_NE(made.error().message.find("OpenGL 3.3"), std::string::npos) << made.error().message;
  EXPECT_NE(made.error().message.find("2.1"), std::string::npos) << made.error().message;
}

TEST(DetailControl, TheDetailFallsWhileFramesAreSlowAndRisesWhenTheyAreQuick) {
  DetailControl control;
  for (int i = 0; i < 100; ++i) control.observe(0.03);
  EXPECT_EQ(control.detail(), 1) << "fast enough";
  for (int i = 0; i < DetailControl::kFrames; ++i) control.observe(0.1);
  EXPECT_EQ(control.detail(), 0.75);
  for (int i = 0; i < 1000; ++i) control.observe(0.1);
  EXPECT_EQ(control.detail(), DetailControl::kCoarsest);
  for (int i = 0; i < 100; ++i) control.observe(0.01);
  EXPECT_EQ(control.detail(), 1);
}

}  // namespace
}  // namespace ringdown::viewer
