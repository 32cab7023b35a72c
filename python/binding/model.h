// A scene as Python holds it: with parameters, a method, limits and obstacles.
//
// What is asked comes as texts, under the names of the program's options, and is checked by the
// program's own functions. So bad input is refused in the same words, and answers are the same to
// the last bit.
#pragma once

#include <map>
#include <memory>
#include <string>
#include <vector>

#include "catalogue/limit_choice.h"
#include "geodesic/geodesic_request.h"
#include "run/run_options.h"

namespace carnot::python {

// Options by their names without dashes; what is not there keeps its default.
using Texts = std::map<std::string, std::string>;

// Sets `value` where the option is there.
void take(const Texts& options, const std::string& name, std::string& value);
// The same of a flag: "1" sets it.
void take(const Texts& options, const std::string& name, bool& value);

// What a model is made of, and what it is made of again when it is unpickled.
struct ModelSource {
  std::string name;                 // of a scene of the program, or what the text is called
  std::string text;                 // empty: a scene of the program
  std::vector<std::string> set;     // NAME=VALUE
  std::string method;               // empty: the default
  std::vector<std::string> limits;  // 'EXPRESSION in A:B'
  std::vector<std::string> discs;   // 'X,Y,R'
};

class Model {
 public:
  // Throws std::invalid_argument.
  explicit Model(ModelSource source);

  [[nodiscard]] const ModelSource& source() const { return source_; }
  [[nodiscard]] const apps::SceneEntry& entry() const { return *entry_; }
  // For searches and for flows: the methods differ where holonomic constraints need RATTLE.
  [[nodiscard]] const apps::Run& searching() const { return searching_; }
  [[nodiscard]] const apps::Run& flowing() const { return flowing_; }
  // With samples, seed and threads of these options.
  [[nodiscard]] apps::Run searching(const Texts& options) const;
  [[nodiscard]] apps::Run flowing(const Texts& options) const;
  // Limits and discs as they were typed.
  [[nodiscard]] apps::AskedLimits asked() const { return {source_.limits, source_.discs}; }
  // Of its scene, its own limits and its discs.
  [[nodiscard]] const std::vector<Limit>& limits() const { return limits_; }
  // What every search may be asked, checked.
  [[nodiscard]] apps::SearchOptions search_options(const Texts& options) const;

 private:
  ModelSource source_;
  std::shared_ptr<const apps::SceneEntry> entry_;
  apps::Run searching_;
  apps::Run flowing_;
  std::vector<Limit> limits_;
};

}  // namespace carnot::python
