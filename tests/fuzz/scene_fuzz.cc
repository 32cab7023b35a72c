// Any bytes as the text of a scene: they are accepted or refused, and nothing else happens.
//
// With clang and -D CARNOT_FUZZ=ON this is the program scene_fuzz of libFuzzer; scripts/fuzz.sh
// builds and runs it. The corpus is replayed by scene_corpus_test.cc.
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
