// SPDX-License-Identifier: GPL-2.0-or-later
#include "lbm_solver/io/image_file.h"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>
#include <array>
#include <bit>
#include <cmath>
#include <cstdint>
#include <cstring>
#include <filesystem>
#include <fstream>
#include <iterator>
#include <optional>
#include <span>
#include <stdexcept>

#include "lbm_solver/io/hdf5_files.h"
#include "lbm_solver/io/picture_file.h"
#include "lbm_solver/io/refusal.h"
#ifdef BPLBM_HDF5
#include "protocol/transport/hdf5_file.h"
#endif
#include "protocol/wire/numbers.h"

namespace lbm {
namespace {

constexpr double kMostVoxels = 2e9;

/// A type of number in a file.
struct NumberType {
  const char *name, *numpy;  ///< for .raw files; as .npy files call it
  int bytes;
  float (*read)(const char* bytes);
};
template <class T>
float read_as(const char* bytes) {
  T value;
  std::memcpy(&value, bytes, sizeof value);
  return static_cast<float>(value);
}
constexpr std::array kTypes{NumberType{"uint8", "u1", 1, read_as<std::uint8_t>},
                            NumberType{"int8", "i1", 1, read_as<std::int8_t>},
                            NumberType{"bool", "b1", 1, read_as<std::uint8_t>},
                            NumberType{"uint16", "u2", 2, read_as<std::uint16_t>},
                            NumberType{"int16", "i2", 2, read_as<std::int16_t>},
                            NumberType{"uint32", "u4", 4, read_as<std::uint32_t>},
                            NumberType{"int32", "i4", 4, read_as<std::int32_t>},
                            NumberType{"float32", "f4", 4, read_as<float>},
                            NumberType{"float64", "f8", 8, read_as<double>}};

std::size_t voxels_of(const Cell3& size) {
  double count = 1.0;
  for (const int n : size) count *= n;
  if (!(count >= 1.0 && count <= kMostVoxels))
    refuse(fmt::format("holds {} × {} × {} voxels", size[0], size[1], size[2]),
           fmt::format("give from 1 to {:.0e}", kMostVoxels));
  return static_cast<std::size_t>(count);
}

std::vector<char> read_bytes(const std::string& path, std::size_t from = 0) {
  std::ifstream file(path, std::ios::binary);
  file.seekg(0, std::ios::end);
  const auto size = static_cast<std::size_t>(std::max<std::streamoff>(0, file.tellg()));
  std::vector<char> bytes(size > from ? size - from : 0);
  file.seekg(static_cast<std::streamoff>(from));
  file.read(bytes.data(), static_cast<std::streamsize>(bytes.size()));
  if (!file) refuse("cannot be read", "look at the file");
  return bytes;
}

/// An image of numbers in the file's order, which is ours.
GreyImage from_numbers(std::vector<char> bytes, const NumberType& type, const Cell3& size,
                       bool swapped) {
  GreyImage image{size, std::vector<float>(voxels_of(size))};
  for (std::size_t i = 0; i < image.levels.size(); ++i) {
    char* number = &bytes[i * type.bytes];
    if (swapped) std::reverse(number, number + type.bytes);
    image.levels[i] = type.read(number);
  }
  return image;
}

GreyImage read_raw(const std::string& path, const ImageLayout& layout) {
  const auto type = std::find_if(kTypes.begin(), kTypes.end(), [&](const NumberType& known) {
    return layout.raw_type == known.name;
  });
  if (type == kTypes.end() || layout.raw_size[0] == 0)
    refuse("does not say what it holds",
           fmt::format("give raw_size = [x, y, z] and raw_type, one of {}",
                       fmt::join(known_raw_types(), ", ")));
  const Cell3& n = layout.raw_size;
  const std::uintmax_t wanted = static_cast<std::uintmax_t>(voxels_of(n)) * type->bytes;
  const std::uintmax_t found = std::filesystem::file_size(path);
  if (found != wanted)
    refuse(fmt::format("has {} bytes, but {} × {} × {} voxels of {} are {}", found, n[0], n[1],
                       n[2], layout.raw_type, wanted),
           "correct raw_size or raw_type (a header must be cut off)");
  return from_numbers(read_bytes(path), *type, n, std::endian::native == std::endian::big);
}

/// What follows a key of the header of a .npy file.
std::string after(const std::string& header, const std::string& key) {
  const auto at = header.find("'" + key + "':");
  if (at == std::string::npos) refuse("has a broken header", "save it again with numpy.save");
  return header.substr(header.find_first_not_of(' ', at + key.size() + 3));
}

/// x, y, z of a shape (z, y, x) or (y, x).
Cell3 size_of(const std::vector<std::uint64_t>& shape) {
  if (shape.size() != 2 && shape.size() != 3) {
    const bool colours = shape.size() == 4 && (shape[3] == 3 || shape[3] == 4);
    refuse(fmt::format("is an array of {} dimensions, of shape ({}){}", shape.size(),
                       fmt::join(shape, ", "), colours ? ": colours of each voxel, it seems" : ""),
           colours ? "give [z][y][x]; of colours make grey levels: array.mean(axis=3)"
                   : "give [y][x] or [z][y][x]");
  }
  Cell3 size{0, 0, 1};
  for (std::size_t k = 0; k < shape.size(); ++k)
    size[shape.size() - 1 - k] = static_cast<int>(std::min<std::uint64_t>(shape[k], 1U << 30));
  return size;
}

std::vector<std::uint64_t> shape_in(const std::string& text) {
  std::vector<std::uint64_t> shape;
  std::string number;
  for (const char c : text.substr(0, text.find(')') + 1)) {
    if ((c >= '0' && c <= '9') || c == '-') number += c;
    if (c != ',' && c != ')') continue;
    if (const auto n = protocol::to_number<std::uint64_t>(number))
      shape.push_back(*n);
    else if (!number.empty())
      refuse("has a size of " + number + " in its header", "save it again with numpy.save");
    number.clear();
  }
  return shape;
}

GreyImage read_npy(const std::string& path) {
  const std::vector<char> start = read_bytes(path);
  constexpr std::size_t kPrefix = 10;  // magic, version, length of the header
  if (start.size() < kPrefix + 2 || std::memcmp(start.data(), "\x93NUMPY", 6) != 0)
    refuse("is no .npy file", "save it with numpy.save");
  const bool old = start[6] == 1;
  std::uint32_t length = 0;
  std::memcpy(&length, &start[8], old ? 2 : 4);
  const std::size_t begin = kPrefix + (old ? 0 : 2);
  if (length > start.size() - begin) refuse("has a broken header", "save it again with numpy.save");
  const std::string header(&start[begin], length);
  const std::string quoted = after(header, "descr").substr(1);
  const std::string descr = quoted.substr(0, quoted.find_first_of("'\""));
  if (after(header, "fortran_order").starts_with("True"))
    refuse("is stored in Fortran's order", "save numpy.ascontiguousarray of it");
  const auto type = std::find_if(kTypes.begin(), kTypes.end(), [&](const NumberType& known) {
    return !descr.empty() && descr.substr(1) == known.numpy;
  });
  if (type == kTypes.end())
    refuse(fmt::format("has numbers of type '{}'", descr),
           fmt::format("give one of {}", fmt::join(known_raw_types(), ", ")));
  const Cell3 size = size_of(shape_in(after(header, "shape")));
  const std::size_t data = begin + length, wanted = voxels_of(size) * type->bytes;
  if (start.size() - data != wanted)
    refuse(fmt::format("has {} bytes of data where {} are due", start.size() - data, wanted),
           "save it again with numpy.save");
  return from_numbers({start.begin() + static_cast<std::ptrdiff_t>(data), start.end()}, *type, size,
                      descr[0] == '>');
}

#ifdef BPLBM_HDF5
GreyImage read_h5(const std::string& path, const std::string& dataset) try {
  using protocol::hdf5::Handle;
  if (dataset.empty()) refuse("may hold many arrays", "name one: dataset = \"/rock\"");
  const Handle file = protocol::hdf5::open_file(path, protocol::hdf5::Open::Read);
  if (H5Lexists(file, dataset.c_str(), H5P_DEFAULT) <= 0)
    refuse("has no dataset '" + dataset + "'", "h5ls -r lists those that it has");
  const Handle set(H5Dopen2(file, dataset.c_str(), H5P_DEFAULT), H5Dclose, "open " + dataset);
  const Handle space(H5Dget_space(set), H5Sclose, "read a space");
  std::array<hsize_t, H5S_MAX_RANK> shape{};
  const int rank = H5Sget_simple_extent_dims(space, shape.data(), nullptr);
  const std::span dims(shape.data(), rank > 0 ? rank : 0);
  GreyImage image{size_of({dims.begin(), dims.end()}), {}};
  image.levels.resize(voxels_of(image.size));
  protocol::hdf5::check(
      H5Dread(set, H5T_NATIVE_FLOAT, H5S_ALL, H5S_ALL, H5P_DEFAULT, image.levels.data()),
      "read " + dataset);
  return image;
} catch (const std::runtime_error& error) {
  refuse(error.what(), "look at it with h5dump");
}
#else
GreyImage read_h5(const std::string&, const std::string&) {
  refuse(kNeedsHdf5, "save it as .npy or .raw, or build lbm with HDF5");
}
#endif

/// Of a kind that we do not read: what we do, and a line of Python that makes such a file of it.
[[noreturn]] void refuse_kind(const std::string& path, const std::string& kind) {
  constexpr std::array kPictures{".jpg", ".jpeg", ".bmp", ".gif", ".webp", ".jp2"};
  const std::filesystem::path name = std::filesystem::path(path).filename();
  const auto as = [&](const char* other) {
    return std::filesystem::path(name).replace_extension(other).string();
  };
  const std::string how =
      std::ranges::find(kPictures, kind) != kPictures.end()
          ? fmt::format("PIL.Image.open(\"{}\").convert(\"L\").save(\"{}\")", name.string(),
                        as(".png"))
          : fmt::format("numpy.save(\"{}\", array), the array as [y][x] or [z][y][x]", as(".npy"));
  refuse(kind.empty() ? "does not say by its name of which kind it is"
                      : fmt::format("is of a kind that is not read ({})", kind),
         "give grey levels as .png, .tif, .npy, .h5 or .raw, in Python by " + how);
}

/// A voxel that is no number.
void check_finite(const GreyImage& image) {
  const auto bad = std::find_if(image.levels.begin(), image.levels.end(),
                                [](float level) { return !std::isfinite(level); });
  if (bad == image.levels.end()) return;
  const auto at = static_cast<std::size_t>(bad - image.levels.begin());
  const auto nx = static_cast<std::size_t>(image.size[0]),
             ny = static_cast<std::size_t>(image.size[1]);
  refuse(fmt::format("is {} at voxel [{}, {}, {}]", *bad, at % nx, at / nx % ny, at / nx / ny),
         "give a number to every voxel");
}

}  // namespace

std::vector<std::string> known_raw_types() {
  std::vector<std::string> names;
  for (const NumberType& type : kTypes) names.emplace_back(type.name);
  return names;
}

std::string image_kind(const std::string& path) {
  std::string kind = std::filesystem::path(path).extension().string();
  for (char& c : kind)
    if (c >= 'A' && c <= 'Z') c = static_cast<char>(c - 'A' + 'a');
  return kind;
}

GreyImage read_image(const std::string& path, const ImageLayout& layout) {
  const std::string kind = image_kind(path);
  GreyImage image;
  if (kind == ".raw")
    image = read_raw(path, layout);
  else if (kind == ".npy")
    image = read_npy(path);
  else if (kind == ".h5" || kind == ".hdf5")
    image = read_h5(path, layout.dataset);
  else if (kind == ".png")
    image = read_png(path);
  else if (kind == ".tif" || kind == ".tiff")
    image = read_tiff(path);
  else
    refuse_kind(path, kind);
  check_finite(image);
  return image;
}

}  // namespace lbm
