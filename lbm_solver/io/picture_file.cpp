// SPDX-License-Identifier: GPL-2.0-or-later
#include "lbm_solver/io/picture_file.h"

#include <fmt/core.h>

#include <cstdint>
#include <cstring>
#include <stdexcept>
#include <vector>

#ifdef BPLBM_PNG
#include <png.h>
#endif
#ifdef BPLBM_TIFF
#include <tiffio.h>
#endif

#include <memory>

#include "lbm_solver/io/refusal.h"

namespace lbm {
namespace {

#if defined(BPLBM_PNG) || defined(BPLBM_TIFF)
constexpr std::uint32_t kMostPixels = 100'000;  // along a side

/// Number k of a row of a picture. @param bits  1, 8, 16 or 32
float number(const std::vector<unsigned char>& row, std::size_t k, int bits, bool real) {
  const auto as = [&]<class T>(T value) {
    std::memcpy(&value, &row[k * sizeof value], sizeof value);
    return static_cast<float>(value);
  };
  if (bits == 1) return static_cast<float>(row[k / 8] >> (7 - k % 8) & 1);
  if (bits == 8) return row[k];
  if (bits == 16) return as(std::uint16_t{});
  return real ? as(float{}) : as(std::uint32_t{});
}

void check_size(std::uint32_t width, std::uint32_t height) {
  if (width == 0 || height == 0 || width > kMostPixels || height > kMostPixels)
    refuse(fmt::format("has {} × {} pixels", width, height),
           fmt::format("give from 1 to {} a side", kMostPixels));
}
#endif

}  // namespace

#ifdef BPLBM_PNG
namespace {

/// libpng leaves by longjmp where a file is broken: this keeps what must be let go.
struct PngReader {
  std::FILE* file = nullptr;
  png_structp png = nullptr;
  png_infop info = nullptr;
  ~PngReader() {
    if (png) png_destroy_read_struct(&png, &info, nullptr);
    if (file) std::fclose(file);
  }
  /// Reads the header; false where the file is broken.
  bool begin(const std::string& path) {
    file = std::fopen(path.c_str(), "rb");
    png = png_create_read_struct(
        PNG_LIBPNG_VER_STRING, nullptr, [](png_structp p, png_const_charp) { png_longjmp(p, 1); },
        [](png_structp, png_const_charp) {});
    info = png ? png_create_info_struct(png) : nullptr;
    if (!file || !info || setjmp(png_jmpbuf(png))) return false;
    png_init_io(png, file);
    png_read_info(png, info);
    return true;
  }
  /// Reads all rows, to the file's end; false where the file is broken.
  bool read(png_bytep* rows, bool narrow) {
    if (setjmp(png_jmpbuf(png))) return false;
    if (narrow) png_set_expand_gray_1_2_4_to_8(png);
    png_set_swap(png);  // 16 bits are stored with the high byte first
    png_set_interlace_handling(png);
    png_read_update_info(png, info);
    png_read_image(png, rows);
    png_read_end(png, nullptr);
    return true;
  }
};

}  // namespace

GreyImage read_png(const std::string& path) {
  constexpr const char* kBroken = "is no whole .png file";
  PngReader reader;
  if (!reader.begin(path)) refuse(kBroken, "save it again");
  const std::uint32_t width = png_get_image_width(reader.png, reader.info);
  const std::uint32_t height = png_get_image_height(reader.png, reader.info);
  if (png_get_color_type(reader.png, reader.info) != PNG_COLOR_TYPE_GRAY)
    refuse("has colours or transparency", "save it as grey levels");
  check_size(width, height);
  const int depth = png_get_bit_depth(reader.png, reader.info), bits = depth < 8 ? 8 : depth;
  std::vector<std::vector<unsigned char>> rows(
      height, std::vector<unsigned char>(static_cast<std::size_t>(width) * bits / 8));
  std::vector<png_bytep> starts;
  for (auto& row : rows) starts.push_back(row.data());
  if (!reader.read(starts.data(), depth < 8)) refuse(kBroken, "save it again");
  GreyImage image{{static_cast<int>(width), static_cast<int>(height), 1}, {}};
  for (std::uint32_t y = 0; y < height; ++y)
    for (std::uint32_t x = 0; x < width; ++x)
      image.levels.push_back(number(rows[height - 1 - y], x, bits, false));
  return image;
}
#else
GreyImage read_png(const std::string&) {
  refuse("is a .png file, and this lbm was built without libpng",
         "install libpng-dev and build again, or save it as .npy or .raw");
}
#endif

#ifdef BPLBM_TIFF
namespace {

using Tiff = std::unique_ptr<TIFF, decltype(&TIFFClose)>;

template <class T>
T field(TIFF* file, std::uint32_t tag) {
  T value{};
  TIFFGetFieldDefaulted(file, tag, &value);
  return value;
}

/// Appends a page, its last row first.
void read_page(TIFF* file, GreyImage& image) {
  const auto bits = field<std::uint16_t>(file, TIFFTAG_BITSPERSAMPLE);
  const bool real = field<std::uint16_t>(file, TIFFTAG_SAMPLEFORMAT) == SAMPLEFORMAT_IEEEFP;
  const bool plain = bits == 1 || bits == 8 || bits == 16 || bits == 32;
  if (field<std::uint16_t>(file, TIFFTAG_SAMPLESPERPIXEL) != 1 || !plain || (real && bits != 32))
    refuse("has colours, or numbers of an unusual kind",
           "save it as grey levels of 1, 8, 16 or 32 bits");
  if (TIFFIsTiled(file)) refuse("is stored in tiles", "save it in strips");
  std::vector<unsigned char> row(TIFFScanlineSize(file));
  const std::size_t nx = image.size[0], ny = image.size[1], begin = image.levels.size();
  image.levels.resize(begin + nx * ny);
  for (std::size_t y = 0; y < ny; ++y) {
    if (TIFFReadScanline(file, row.data(), static_cast<std::uint32_t>(y)) < 0)
      refuse("is no whole .tif file", "save it again");
    for (std::size_t x = 0; x < nx; ++x)
      image.levels[begin + (ny - 1 - y) * nx + x] = number(row, x, bits, real);
  }
}

}  // namespace

GreyImage read_tiff(const std::string& path) {
  TIFFSetErrorHandler(nullptr);
  TIFFSetWarningHandler(nullptr);
  const Tiff file(TIFFOpen(path.c_str(), "r"), TIFFClose);
  if (!file) refuse("is no .tif file", "save it again");
  GreyImage image{{0, 0, 0}, {}};
  do {
    const auto width = field<std::uint32_t>(file.get(), TIFFTAG_IMAGEWIDTH);
    const auto height = field<std::uint32_t>(file.get(), TIFFTAG_IMAGELENGTH);
    check_size(width, height);
    const int nx = static_cast<int>(width), ny = static_cast<int>(height);
    if (image.size[2] > 0 && (nx != image.size[0] || ny != image.size[1]))
      refuse(fmt::format("has pages of {} × {} and of {} × {} pixels", image.size[0], image.size[1],
                         nx, ny),
             "give one slice a page, all of a size");
    image.size = {nx, ny, image.size[2] + 1};
    read_page(file.get(), image);
  } while (TIFFReadDirectory(file.get()));
  return image;
}
#else
GreyImage read_tiff(const std::string&) {
  refuse("is a .tif file, and this lbm was built without libtiff",
         "install libtiff-dev and build again, or save it as .npy or .raw");
}
#endif

}  // namespace lbm
