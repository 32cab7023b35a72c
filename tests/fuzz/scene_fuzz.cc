// Any bytes as the text of a scene: they are accepted or refused, and nothing else happens.
//
// With clang and -D CARNOT_FUZZ=ON, the preset fuzz, this is a program of libFuzzer:
//
//   cmake --preset fuzz && cmake --build --preset fuzz
//   build/fuzz/tests/scene_fuzz -max_total_time=600 -max_len=3000 -dict=tests/fuzz/scene.dict
//       NEW tests/fuzz/corpus lib/carnot/scenes docs/examples/scenes
//
// where NEW is a folder for what it finds. lib/scene_corpus_test.cc reads the corpus again.
#include <cstddef>
#include <cstdint>
#include <stdexcept>
#include <string>

#include "carnot/load_scene.h"

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size);

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  try {
    (void)carnot::scene_from_text(std::string(reinterpret_cast<const char*>(data), size));
  } catch (const std::invalid_argument&) {
  }
  return 0;
}
