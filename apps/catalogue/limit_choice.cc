#include "catalogue/limit_choice.h"

#include <fmt/format.h>

#include <algorithm>

#include "carnot/language/text_error.h"
#include "carnot/load_scene.h"
#include "catalogue/scene_texts.h"
#include "text/numbers.h"

namespace carnot::apps {
namespace {

constexpr const char* kLimitAccepted =
    "'EXPRESSION in A:B' with an expression in the coordinates and parameters of the scene, one of "
    "the bounds may be missing, such as 'phi-theta in -0.6:0.6'";

std::string trimmed(const std::string& text) {
  const std::size_t begin = text.find_first_not_of(' ');
  if (begin == std::string::npos) return "";
  return text.substr(begin, text.find_last_not_of(' ') - begin + 1);
}

// Statements of the scene language that say the same. What is typed stays on its line, and is one
// formula there.
std::string limit_statements(const std::string& text, std::size_t number) {
  const bool strange = std::any_of(text.begin(), text.end(), [](char c) {
    return static_cast<unsigned char>(c) < ' ' || c == '"' || c == '#';
  });
  if (strange) refuse("--limit", text, "holds a character that no formula has", kLimitAccepted);
  const std::size_t in = text.rfind(" in ");
  if (in == std::string::npos) refuse("--limit", text, "there is no ' in '", kLimitAccepted);
  const std::string expression = trimmed(text.substr(0, in));
  const std::string range = trimmed(text.substr(in + 4));
  const std::size_t colon = range.find(':');
  if (expression.empty() || colon == std::string::npos ||
      range.find(':', colon + 1) != range.npos) {
    refuse("--limit", text, "is no range of an expression", kLimitAccepted);
  }
  const std::string lower = trimmed(range.substr(0, colon));
  const std::string upper = trimmed(range.substr(colon + 1));
  if (lower.empty() && upper.empty()) refuse("--limit", text, "has no bound", kLimitAccepted);
  const std::string name = fmt::format("limited_{}", number);
  std::string statement = fmt::format("let {} = {}\nlimit ", name, expression);
  if (!lower.empty()) statement += fmt::format("{:.17g} < ", parse_real("--limit", lower));
  statement += name;
  if (!upper.empty()) statement += fmt::format(" < {:.17g}", parse_real("--limit", upper));
  return statement + " \"" + expression + "\"";
}

std::string disc_statement(const std::string& text) {
  const std::vector<double> disc = parse_disc("--disc", text);
  return fmt::format("disc ({:.17g}, {:.17g}), {:.17g}", disc[0], disc[1], disc[2]);
}

// What is wrong, without the place in a text that nobody typed.
std::string complaint(const std::string& what) {
  const std::string line = what.substr(0, what.find('\n'));
  std::size_t begin = 0;
  for (int colons = 0; colons < 3 && begin != std::string::npos; ++colons) {
    begin = line.find(':', begin);
    if (begin != std::string::npos) ++begin;
  }
  return begin == std::string::npos ? line : trimmed(line.substr(begin));
}

}  // namespace

std::vector<double> parse_disc(std::string_view option, const std::string& text) {
  std::vector<double> disc = parse_vector(option, text, {"x", "y", "radius"});
  if (!(disc[2] > 0)) refuse(option, text, "the radius is not positive", "X,Y,R with R > 0");
  return disc;
}

std::vector<Limit> choose_limits(const SceneEntry& entry,
                                 const ParameterValues& parameters,
                                 const AskedLimits& asked) {
  std::string text = text_of_scene(entry);
  if (!text.empty() && text.back() != '\n') text += '\n';
  TextScene known = scene_from_text(text, "scene", "scene");
  // One at a time, so that a refusal names the one that is wrong.
  const auto add = [&](const char* option, const std::string& typed, const std::string& statement) {
    text += statement + '\n';
    try {
      known = scene_from_text(text, "scene", "scene");
    } catch (const language::TextError& error) {
      throw std::invalid_argument(
          fmt::format("{} '{}': {}", option, typed, complaint(error.what())));
    }
  };
  for (std::size_t i = 0; i < asked.limits.size(); ++i) {
    add("--limit", asked.limits[i], limit_statements(asked.limits[i], i + 1));
  }
  for (const std::string& disc : asked.discs) add("--disc", disc, disc_statement(disc));
  std::map<std::string, double> values;
  for (const TextParameter& parameter : known.parameters()) {
    const auto found = parameters.find(parameter.name);
    if (found != parameters.end()) values.insert(*found);
  }
  return known.with(values).info().limits;
}

}  // namespace carnot::apps
