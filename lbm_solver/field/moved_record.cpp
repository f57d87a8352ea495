// SPDX-License-Identifier: GPL-2.0-or-later
#include "lbm_solver/field/moved_record.h"

#include <algorithm>
#include <cstring>
#include <memory>

namespace lbm {
namespace {

constexpr int kTag = 7130;

/// A record without its cells as bytes, which travel as the doubles that they would be.
class Writer {
 public:
  void put(const Record& record) {
    put(record.values().size());
    for (const auto& [name, value] : record.values()) {
      put(name);
      put(value.index());
      std::visit([this](const auto& v) { put(v); }, value);
    }
    put(record.parts().size());
    for (const auto& [name, part] : record.parts()) {
      put(name);
      put(part);
    }
  }
  std::vector<double> numbers() const {
    std::vector<double> all((bytes_.size() + sizeof(double) - 1) / sizeof(double));
    if (!bytes_.empty()) std::memcpy(all.data(), bytes_.data(), bytes_.size());
    return all;
  }

 private:
  void put(const void* data, std::size_t size) {
    const auto* const first = static_cast<const char*>(data);
    bytes_.insert(bytes_.end(), first, first + size);
  }
  void put(std::size_t count) { put(&count, sizeof count); }
  void put(std::int64_t value) { put(&value, sizeof value); }
  void put(double value) { put(&value, sizeof value); }
  void put(const std::string& text) {
    put(text.size());
    put(text.data(), text.size());
  }
  template <class T>
  void put(const std::vector<T>& list) {
    put(list.size());
    put(list.data(), list.size() * sizeof(T));
  }

  std::vector<char> bytes_;
};

class Reader {
 public:
  explicit Reader(const std::vector<double>& numbers)
      : at_(reinterpret_cast<const char*>(numbers.data())) {}

  Record record() {
    Record record;
    for (auto n = take<std::size_t>(); n > 0; --n) {
      const auto name = text();
      record.set(name, value(take<std::size_t>()));
    }
    for (auto n = take<std::size_t>(); n > 0; --n) {
      const auto name = text();
      record.set(name, this->record());
    }
    return record;
  }

 private:
  template <class T>
  T take() {
    T value;
    std::memcpy(&value, at_, sizeof value);
    at_ += sizeof value;
    return value;
  }
  std::string text() {
    const auto size = take<std::size_t>();
    at_ += size;
    return {at_ - size, size};
  }
  template <class T>
  std::vector<T> list() {
    std::vector<T> list(take<std::size_t>());
    if (!list.empty()) std::memcpy(list.data(), at_, list.size() * sizeof(T));
    at_ += list.size() * sizeof(T);
    return list;
  }
  Record::Value value(std::size_t kind) {
    switch (kind) {
      case 0:
        return take<std::int64_t>();
      case 1:
        return take<double>();
      case 2:
        return text();
      case 3:
        return list<std::int64_t>();
      default:
        return list<double>();
    }
  }

  const char* at_;
};

CellRange common(const Block& a, const Block& b) {
  CellRange range;
  for (int k = 0; k < 3; ++k) {
    range.begin[k] = std::max(a.begin[k], b.begin[k]);
    range.size[k] = std::min(a.begin[k] + a.size[k], b.begin[k] + b.size[k]) - range.begin[k];
    if (range.size[k] <= 0) return {};
  }
  return range;
}

/// Numbers of a block's cells, in the precision that they are stored in.
template <class T>
class BlockList {
 public:
  BlockList(const Block& cells, int components)
      : cells_(cells),
        components_(static_cast<std::size_t>(components)),
        list_(components_ * range_of(cells).count()) {}

  void put(const CellRange& piece, const std::vector<T>& values) {
    piece.each([&](const Cell3& c, std::size_t number) {
      std::copy_n(&values[number * components_], components_, &list_[place(c)]);
    });
  }
  void read(const CellRange& piece, std::span<double> to) const {
    piece.each([&](const Cell3& c, std::size_t number) {
      std::copy_n(&list_[place(c)], components_, &to[number * components_]);
    });
  }

 private:
  std::size_t place(const Cell3& c) const {
    const auto row = static_cast<std::size_t>(c[2] - cells_.begin[2]) * cells_.size[1] +
                     static_cast<std::size_t>(c[1] - cells_.begin[1]);
    return (row * cells_.size[0] + static_cast<std::size_t>(c[0] - cells_.begin[0])) * components_;
  }

  Block cells_;
  std::size_t components_;
  std::vector<T> list_;
};

/// In rounds: in each, every rank gives to one rank and takes from one.
template <class T>
CellValues moved_cells(const CellValues& values, const Decomposition& from,
                       const Decomposition& to) {
  const auto count = static_cast<std::size_t>(values.components);
  const MPI_Datatype type = std::is_same_v<T, float> ? MPI_FLOAT : MPI_DOUBLE;
  const int rank = from.rank(), size = from.size();
  const auto list = std::make_shared<BlockList<T>>(to.cells(), values.components);
  std::vector<double> read;
  std::vector<T> gives, takes;
  for (int round = 0; round < size; ++round) {
    const int taker = (rank + round) % size, giver = (rank + size - round) % size;
    const auto out = pieces_of(common(from.cells(), to.cells_of(taker)), count * sizeof(double));
    const auto in = pieces_of(common(from.cells_of(giver), to.cells()), count * sizeof(double));
    for (std::size_t k = 0; k < std::max(out.size(), in.size()); ++k) {
      gives.clear();
      if (k < out.size()) {
        read.resize(count * out[k].count());
        values.read(out[k], read);
        gives.assign(read.begin(), read.end());
      }
      takes.resize(k < in.size() ? count * in[k].count() : 0);
      MPI_Sendrecv(gives.data(), static_cast<int>(gives.size()), type,
                   k < out.size() ? taker : MPI_PROC_NULL, kTag, takes.data(),
                   static_cast<int>(takes.size()), type, k < in.size() ? giver : MPI_PROC_NULL,
                   kTag, from.comm(), MPI_STATUS_IGNORE);
      if (k < in.size()) list->put(in[k], takes);
    }
  }
  return {values.box, values.components, values.single, range_of(to.cells()),
          [list](const CellRange& piece, std::span<double> into) { list->read(piece, into); }};
}

Record with_cells(Record whole, const Record& mine, const Decomposition& from,
                  const Decomposition& to) {
  for (const auto& [name, values] : mine.cells())
    whole.set(name, values.single ? moved_cells<float>(values, from, to)
                                  : moved_cells<double>(values, from, to));
  for (const auto& [name, part] : mine.parts())
    whole.set(name, with_cells(whole.part(name), part, from, to));
  return whole;
}

}  // namespace

Record moved(const Record& record, const Decomposition& from, const Decomposition& to) {
  Writer writer;
  if (from.rank() == 0) writer.put(record);
  std::vector<double> numbers = writer.numbers();
  from.broadcast(numbers);
  return with_cells(Reader(numbers).record(), record, from, to);
}

}  // namespace lbm
