#include "catalogue/scene_choice.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <filesystem>
#include <fstream>

#include "carnot/load_scene.h"

namespace carnot::apps::scene_choice_test {
namespace {

// An entry is made when it is asked for. So nothing but this test compares it with the list.
TEST(SceneChoice, ListedNamesAreThoseOfTheScenes) {
  ASSERT_FALSE(scene_names().empty());
  for (const std::string& name : scene_names()) {
    const SceneEntry& entry = find_scene(name);
    EXPECT_EQ(entry.info.name, name);
    EXPECT_TRUE(is_of_program(entry)) << name;
  }
}

TEST(SceneChoice, ASceneIsMadeOnce) {
  EXPECT_EQ(&find_scene("vehicle"), &find_scene("vehicle"));
  EXPECT_EQ(&find_scene("bicycle"), &find_scene("bicycle"));
}

TEST(SceneChoice, AFileMayGiveTheNameOfAScene) {
  const std::filesystem::path directory = testing::TempDir();
  const std::string file = directory / "bicycle.scene";
  std::ofstream(file) << find_scene("bicycle").text;
  const SceneEntry& entry = find_scene(file);
  EXPECT_EQ(entry.info.name, "bicycle");
  EXPECT_FALSE(is_of_program(entry));
  EXPECT_EQ(&find_scene(file), &entry);
  std::filesystem::remove(file);
}

TEST(SceneChoice, UnknownNamesAreRefusedWithTheKnownOnes) {
  try {
    (void)find_scene("vehikel");
    FAIL();
  } catch (const std::invalid_argument& error) {
    EXPECT_THAT(error.what(), testing::HasSubstr("vehicle"));
  }
}

}  // namespace
}  // namespace carnot::apps::scene_choice_test
