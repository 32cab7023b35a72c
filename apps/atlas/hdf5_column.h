// Columns of an HDF5 file: handles that close themselves, and data sets that are written bit by
// bit.
#pragma once

#include <hdf5.h>

#include <algorithm>
#include <cstdint>
#include <limits>
#include <stdexcept>
#include <string>
#include <utility>
#include <vector>

#include "text/json_text.h"

namespace carnot::apps::hdf5 {

inline constexpr double kNaN = std::numeric_limits<double>::quiet_NaN();
inline constexpr long kRows = 4096;           // problems written at a time
inline constexpr std::size_t kTextSize = 24;  // bytes of a text: the longest code has 21

// An identifier of the library and how it is closed.
class Handle {
 public:
  Handle(hid_t id, herr_t (*close)(hid_t)) : id_(id), close_(close) {
    if (id < 0) throw std::runtime_error("HDF5 refused a call");
  }
  ~Handle() {
    if (id_ >= 0) (void)close_(id_);
  }
  Handle(Handle&& other) noexcept : id_(std::exchange(other.id_, -1)), close_(other.close_) {}
  Handle& operator=(Handle&&) = delete;
  Handle(const Handle&) = delete;
  Handle& operator=(const Handle&) = delete;
  operator hid_t() const { return id_; }  // NOLINT: it stands for the identifier

 private:
  hid_t id_;
  herr_t (*close_)(hid_t);
};

inline void ensure(herr_t status) {
  if (status < 0) throw std::runtime_error("HDF5 could not write");
}

inline Handle text_type(std::size_t length) {
  Handle type(H5Tcopy(H5T_C_S1), H5Tclose);
  ensure(H5Tset_size(type, std::max<std::size_t>(length, 1)));
  return type;
}

// Of data sets that do not note when they were made: the same result is the same file.
inline Handle without_times() {
  Handle list(H5Pcreate(H5P_DATASET_CREATE), H5Pclose);
  ensure(H5Pset_obj_track_times(list, false));
  return list;
}

inline void set_attribute(hid_t of, const std::string& name, const std::string& text) {
  const Handle type = text_type(text.size());
  const Handle space(H5Screate(H5S_SCALAR), H5Sclose);
  const Handle attribute(H5Acreate2(of, name.c_str(), type, space, H5P_DEFAULT, H5P_DEFAULT),
                         H5Aclose);
  ensure(H5Awrite(attribute, type, text.empty() ? "\0" : text.data()));
}

// Numbers or texts of all problems, of which kRows are in memory. A problem has `width` of them.
class Column {
 public:
  enum class Kind { kReal, kInteger, kText };

  Column(hid_t file, const std::string& name, Kind kind, std::vector<hsize_t> shape, long problems)
      : kind_(kind),
        problems_(problems),
        type_(kind == Kind::kText
                  ? text_type(kTextSize)
                  : Handle(H5Tcopy(kind == Kind::kReal ? H5T_NATIVE_DOUBLE : H5T_NATIVE_INT32),
                           H5Tclose)),
        space_(H5Screate_simple(static_cast<int>(shape.size()), shape.data(), nullptr), H5Sclose),
        set_(H5Dcreate2(
                 file, name.c_str(), type_, space_, H5P_DEFAULT, without_times(), H5P_DEFAULT),
             H5Dclose) {
    hsize_t total = 1;
    for (const hsize_t size : shape) total *= size;
    width_ = total / static_cast<hsize_t>(problems);
  }

  [[nodiscard]] hid_t set() const { return set_; }
  [[nodiscard]] std::size_t width() const { return width_; }
  // The next problem, which has `width` entries; those that are missing are filled up.
  void add(const Json& values) {
    for (std::size_t i = 0; i < width_; ++i) {
      const Json value = i < values.size() ? values.at(i) : Json(nullptr);
      switch (kind_) {
        case Kind::kReal:
          reals_.push_back(value.is_number() ? value.get<double>() : kNaN);
          break;
        case Kind::kInteger:
          integers_.push_back(value.is_number() ? value.get<int>() : -1);
          break;
        case Kind::kText: {
          std::string text = value.is_string() ? value.get<std::string>() : "";
          text.resize(kTextSize);
          texts_ += text;
          break;
        }
      }
    }
    if (++held_ == kRows) flush();
  }
  void flush() {
    if (held_ == 0) return;
    // The data set seen as a line of numbers.
    const hsize_t all = width_ * static_cast<hsize_t>(problems_);
    const hsize_t start = width_ * static_cast<hsize_t>(written_);
    const hsize_t count = width_ * static_cast<hsize_t>(held_);
    const Handle memory(H5Screate_simple(1, &count, nullptr), H5Sclose);
    select(start, count, all);
    const void* const data = kind_ == Kind::kReal      ? static_cast<const void*>(reals_.data())
                             : kind_ == Kind::kInteger ? static_cast<const void*>(integers_.data())
                                                       : static_cast<const void*>(texts_.data());
    ensure(H5Dwrite(set_, type_, memory, space_, H5P_DEFAULT, data));
    written_ += held_;
    held_ = 0;
    reals_.clear();
    integers_.clear();
    texts_.clear();
  }

 private:
  // Selects entries start to start + count in the order of the file: a union of blocks.
  void select(hsize_t start, hsize_t count, hsize_t all) {
    std::vector<hsize_t> shape(H5Sget_simple_extent_ndims(space_));
    H5Sget_simple_extent_dims(space_, shape.data(), nullptr);
    ensure(H5Sselect_none(space_));
    add_blocks(shape, 0, all, start, start + count, std::vector<hsize_t>(shape.size(), 0));
  }
  // Adds those of a part of the array, where the first `depth` indices are fixed in `at` and which
  // holds entries 0 to `size`, that are between `from` and `to`.
  void add_blocks(const std::vector<hsize_t>& shape,
                  std::size_t depth,
                  hsize_t size,
                  hsize_t from,
                  hsize_t to,
                  std::vector<hsize_t> at) {
    if (from >= to) return;
    const hsize_t inner = size / shape[depth];
    const hsize_t first = (from + inner - 1) / inner;  // whole slices
    const hsize_t last = to / inner;
    if (first < last) {
      std::vector<hsize_t> count(shape.size(), 1);
      at[depth] = first;
      count[depth] = last - first;
      for (std::size_t d = depth + 1; d < shape.size(); ++d) {
        at[d] = 0;
        count[d] = shape[d];
      }
      ensure(H5Sselect_hyperslab(space_, H5S_SELECT_OR, at.data(), nullptr, count.data(), nullptr));
    }
    const auto part = [&](hsize_t slice, hsize_t begin, hsize_t end) {
      at[depth] = slice;
      add_blocks(shape, depth + 1, inner, begin - slice * inner, end - slice * inner, at);
    };
    if (first > last) {  // within one slice
      part(last, from, to);
      return;
    }
    if (from < first * inner) part(first - 1, from, first * inner);
    if (last * inner < to) part(last, last * inner, to);
  }

  Kind kind_;
  long problems_;
  Handle type_;
  Handle space_;
  Handle set_;
  hsize_t width_ = 1;
  long written_ = 0;
  long held_ = 0;
  std::vector<double> reals_;
  std::vector<std::int32_t> integers_;
  std::string texts_;
};

}  // namespace carnot::apps::hdf5
