// carnot methods: the integrators that --method names.
#include <memory>

#include "delivery.h"
#include "method_table.h"
#include "subcommands.h"
#include "text_table.h"

namespace carnot::apps {
namespace {

constexpr const char* kFooter = R"(
All of them are symplectic, symmetric Gauss methods; the number is the order.

Examples
  carnot methods
  carnot methods --json

Exit status: 0 success, 1 a file could not be written, 2 bad input, 130 interrupted.)";

Json methods_json() {
  Json list = Json::array();
  for (const MethodEntry& method : method_table()) {
    list.push_back({{"name", method.name}, {"order", method.order}, {"stages", method.stages}});
  }
  return list;
}

std::string methods_text() {
  std::vector<std::vector<std::string>> rows{{"method", "order", "stages"}};
  for (const MethodEntry& method : method_table()) {
    rows.push_back({method.name, std::to_string(method.order), std::to_string(method.stages)});
  }
  return text_table(rows);
}

}  // namespace

void add_methods(CLI::App& app, Invocation& invocation) {
  auto destination = std::make_shared<Destination>();
  CLI::App& methods = *app.add_subcommand("methods", "List the methods of integration.");
  add_table_options(methods, *destination);
  methods.footer(kFooter);
  methods.callback([destination, &invocation] {
    check_table_output(*destination);
    Result result;
    result.json = result_head(invocation.arguments);
    result.json["methods"] = methods_json();
    result.text = methods_text;
    invocation.exit_status = deliver(result, *destination);
  });
}

}  // namespace carnot::apps
