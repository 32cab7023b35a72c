#include "atlas/atlas_hdf5.h"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cstdint>
#include <limits>
#include <map>
#include <stdexcept>
#include <utility>

#include "atlas/hdf5_column.h"

namespace carnot::apps {
namespace {

using namespace hdf5;

constexpr std::size_t kConjugate = 8;  // conjugate times kept of a geodesic

// The values of this key of all geodesics.
Json of_all(const Json& geodesics, const std::string& key) {
  Json values = Json::array();
  for (const Json& geodesic : geodesics) {
    values.push_back(geodesic.contains(key) ? geodesic.at(key) : Json(nullptr));
  }
  return values;
}

class Hdf5Writer : public AtlasWriter {
 public:
  Hdf5Writer(const std::string& path, std::string name, const AtlasLayout& layout)
      : name_(std::move(name)), layout_(layout), file_(make(path)) {
    for (const Axis& axis : layout.axes) {
      shape_.push_back(axis.values.size());
      write_axis(axis);
    }
    if (shape_.empty()) shape_.push_back(static_cast<hsize_t>(layout.problems));
    for (const auto& [key, value] : layout.head.items()) {
      set_attribute(file_, key, value.is_string() ? value.get<std::string>() : json_line(value));
    }
    make_columns();
  }

  void add(const Json& record) override {
    guarded([&] { add_record(record); });
  }
  void finish() override {
    guarded([&] {
      for (auto& [key, column] : columns_) column.flush();
      columns_.clear();
      ensure(H5Fflush(file_, H5F_SCOPE_GLOBAL));
    });
  }

 private:
  using Kind = Column::Kind;

  static Handle make(const std::string& path) {
    H5Eset_auto2(H5E_DEFAULT, nullptr, nullptr);  // we say it ourselves
    return {H5Fcreate(path.c_str(), H5F_ACC_TRUNC, H5P_DEFAULT, H5P_DEFAULT), H5Fclose};
  }
  template <class Work>
  void guarded(const Work& work) const {
    try {
      work();
    } catch (const std::runtime_error& error) {
      throw std::runtime_error(fmt::format("cannot write '{}': {}", name_, error.what()));
    }
  }

  void write_axis(const Axis& axis) {
    const hsize_t size = axis.values.size();
    const Handle space(H5Screate_simple(1, &size, nullptr), H5Sclose);
    const Handle set(H5Dcreate2(file_,
                                axis.name.c_str(),
                                H5T_NATIVE_DOUBLE,
                                space,
                                H5P_DEFAULT,
                                without_times(),
                                H5P_DEFAULT),
                     H5Dclose);
    ensure(H5Dwrite(set, H5T_NATIVE_DOUBLE, H5S_ALL, H5S_ALL, H5P_DEFAULT, axis.values.data()));
    set_attribute(set, "unit", axis.unit);
  }

  void add_column(const std::string& key, Kind kind, const std::vector<hsize_t>& more = {}) {
    std::vector<hsize_t> shape = shape_;
    shape.insert(shape.end(), more.begin(), more.end());
    columns_.emplace(key, Column(file_, key, kind, shape, layout_.problems));
  }
  void make_columns() {
    const auto n = static_cast<hsize_t>(layout_.coordinates.size());
    const auto k = static_cast<hsize_t>(layout_.count);
    const std::vector<hsize_t> rank = k > 1 ? std::vector<hsize_t>{k} : std::vector<hsize_t>{};
    if (layout_.axes.empty()) {
      for (const std::string& name : layout_.coordinates) add_column("from_" + name, Kind::kReal);
      for (const std::string& name : layout_.coordinates) add_column("to_" + name, Kind::kReal);
      add_column("time", Kind::kReal);
    }
    for (const std::string& name : layout_.parameters) add_column("set_" + name, Kind::kReal);
    for (const char* key : {"status", "reason"}) add_column(key, Kind::kText);
    for (const char* key : {"starts"}) add_column(key, Kind::kInteger);
    add_column("missed_estimate", Kind::kReal);
    if (layout_.times) add_column("seconds", Kind::kReal);
    for (const char* key : kReals) add_column(key, Kind::kReal, rank);
    for (const char* key : kIntegers) add_column(key, Kind::kInteger, rank);
    for (const char* key : kTexts) add_column(key, Kind::kText, rank);
    for (const std::string& name : layout_.coordinates) add_column("p0_" + name, Kind::kReal, rank);
    for (int i = 1; i <= layout_.multipliers; ++i) {
      add_column(fmt::format("lambda0_{}", i), Kind::kReal, rank);
    }
    std::vector<hsize_t> times = rank;
    times.push_back(kConjugate);
    add_column("conjugate_times", Kind::kReal, times);
    if (layout_.free_ends) {
      for (const std::string& name : layout_.coordinates) {
        add_column("from_found_" + name, Kind::kReal, rank);
        add_column("to_found_" + name, Kind::kReal, rank);
      }
    }
    if (layout_.limited) {
      for (const char* key : {"lowest_slack", "limit_violation"})
        add_column(key, Kind::kReal, rank);
    }
    if (layout_.samples > 0) {
      std::vector<hsize_t> samples = rank;
      samples.push_back(static_cast<hsize_t>(layout_.samples));
      add_column("trajectory_t", Kind::kReal, samples);
      samples.push_back(n);
      add_column("trajectory_q", Kind::kReal, samples);
      add_column("trajectory_p", Kind::kReal, samples);
    }
  }

  void put(const std::string& key, const Json& values) {
    const auto found = columns_.find(key);
    if (found != columns_.end()) found->second.add(values);
  }
  // Entry j of a list of each geodesic.
  void put_entries(const std::string& prefix,
                   const std::vector<std::string>& names,
                   const Json& lists) {
    for (std::size_t j = 0; j < names.size(); ++j) {
      Json values = Json::array();
      for (const Json& list : lists) {
        values.push_back(list.is_array() && j < list.size() ? list[j] : Json(nullptr));
      }
      put(prefix + names[j], values);
    }
  }
  // All numbers of nested lists in a row, `width` for each geodesic.
  static void flatten(const Json& value, Json& out) {
    if (!value.is_array()) {
      out.push_back(value);
      return;
    }
    for (const Json& item : value) flatten(item, out);
  }
  void put_lists(const std::string& key, const Json& lists) {
    const auto found = columns_.find(key);
    if (found == columns_.end()) return;
    const std::size_t width =
        found->second.width() / static_cast<std::size_t>(std::max(1, layout_.count));
    Json all = Json::array();
    for (const Json& list : lists) {
      Json flat = Json::array();
      if (list.is_array()) flatten(list, flat);
      for (std::size_t i = 0; i < width; ++i) {
        all.push_back(i < flat.size() ? flat[i] : Json(nullptr));
      }
    }
    put(key, all);
  }

  void add_record(const Json& record) {
    const Json& geodesics = record.at("geodesics");
    const Json of_ends = Json::array({record.at("from")});
    put_entries("from_", layout_.coordinates, of_ends);
    put_entries("to_", layout_.coordinates, Json::array({record.at("to")}));
    for (const char* key : {"time", "status", "reason", "starts", "missed_estimate", "seconds"}) {
      put(key, Json::array({record.contains(key) ? record.at(key) : Json(nullptr)}));
    }
    for (const std::string& name : layout_.parameters) {
      put("set_" + name, Json::array({record.at("parameters").at(name)}));
    }
    for (const char* key : kReals) put(key, of_all(geodesics, key));
    for (const char* key : kIntegers) put(key, of_all(geodesics, key));
    for (const char* key : kTexts) put(key, of_all(geodesics, key));
    put_entries("p0_", layout_.coordinates, of_all(geodesics, "p0"));
    std::vector<std::string> numbers;
    for (int i = 1; i <= layout_.multipliers; ++i) numbers.push_back(std::to_string(i));
    put_entries("lambda0_", numbers, of_all(geodesics, "lambda0"));
    put_lists("conjugate_times", of_all(geodesics, "conjugate_times"));
    put_entries("from_found_", layout_.coordinates, of_all(geodesics, "from_found"));
    put_entries("to_found_", layout_.coordinates, of_all(geodesics, "to_found"));
    put_limits(geodesics);
    for (const char* key : {"t", "q", "p"}) {
      Json lists = Json::array();
      for (const Json& geodesic : geodesics) {
        lists.push_back(geodesic.contains("trajectory") ? geodesic.at("trajectory").at(key)
                                                        : Json(nullptr));
      }
      put_lists(std::string("trajectory_") + key, lists);
    }
  }
  void put_limits(const Json& geodesics) {
    if (!layout_.limited) return;
    Json lowest = Json::array();
    for (const Json& geodesic : geodesics) lowest.push_back(lowest_slack(geodesic));
    put("lowest_slack", lowest);
    put("limit_violation", of_all(geodesics, "limit_violation"));
  }

  static constexpr std::array kReals{"action", "length", "endpoint_error", "knot_defect"};
  static constexpr std::array kIntegers{"morse_index", "hits"};
  static constexpr std::array kTexts{"label", "verification"};

  std::string name_;
  AtlasLayout layout_;
  Handle file_;
  std::vector<hsize_t> shape_;
  std::map<std::string, Column> columns_;
};

}  // namespace

std::unique_ptr<AtlasWriter> make_hdf5_writer(const std::string& path,
                                              const std::string& name,
                                              const AtlasLayout& layout) {
  return std::make_unique<Hdf5Writer>(path, name, layout);
}

}  // namespace carnot::apps
