// Any bytes as the texts of options (numbers, angles, vectors, ends, seeds, limits, discs, grids),
// as a file of problems and as the journal of an atlas; the first byte says which. Built and run as
// scene_fuzz.cc is:
//
//   build/fuzz/tests/text_fuzz -max_total_time=600 -max_len=300 NEW tests/fuzz/text_corpus
//
// apps/text_corpus_test.cc reads the corpus again.
#include <cstddef>
#include <cstdint>

#include "testing/text_parsers.h"

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size);

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  (void)carnot::test::reads({reinterpret_cast<const char*>(data), size});
  return 0;
}
