// "did you mean": the known word that a mistyped one is nearest to.
#pragma once

#include <string>
#include <string_view>
#include <vector>

namespace carnot::language {

// Insertions, deletions and replacements that turn a into b (Levenshtein).
int edit_distance(std::string_view a, std::string_view b);

// The known word nearest to `word`; empty when none is near.
std::string nearest(std::string_view word, const std::vector<std::string>& known);

// " (did you mean X?)", or nothing.
std::string suggestion(std::string_view word, const std::vector<std::string>& known);

}  // namespace carnot::language
